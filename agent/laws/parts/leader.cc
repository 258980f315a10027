#include "agent/laws/parts/leader.h"

namespace mascot {
namespace {

class Leader final : public Law {
 public:
  Leader(LeaderFlight* flight_of, const AgentConfig& agent) : flight_of_(flight_of) { Adopt(agent); }

  void Adopt(const AgentConfig& agent) override { FlyAs(flight_of_(agent.law), agent, flight_); }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> /*heard*/) override {
    return flight_ ? flight_->Accel_W(t_s, self) : Eigen::Vector3d::Zero();
  }

 private:
  LeaderFlight* flight_of_;
  std::optional<WaypointFlight> flight_;
};

}  // namespace

std::unique_ptr<Law> MakeLeader(LeaderFlight* flight_of, const AgentConfig& agent) {
  return std::make_unique<Leader>(flight_of, agent);
}

std::map<std::string, Value> GoToOfLeader(LeaderFlight* flight_of, const AgentConfig& agent, const Eigen::Vector3d& p_W,
                                          double t_s) {
  if (agent.id != agent.law.leader) return {};
  const std::optional<WaypointParams>& flight = flight_of(agent.law);
  return Destination("leader_", flight ? &*flight : nullptr, p_W, t_s);
}

}  // namespace mascot
