#include "agent/laws/leader.h"

#include <utility>

namespace mascot {
namespace {

class Leader final : public Law {
 public:
  explicit Leader(std::optional<WaypointFlight> flight) : flight_(std::move(flight)) {}

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> /*heard*/) override {
    return flight_ ? flight_->Accel_W(t_s, self) : Eigen::Vector3d::Zero();
  }

 private:
  std::optional<WaypointFlight> flight_;
};

}  // namespace

std::unique_ptr<Law> MakeLeader(const std::optional<WaypointParams>& flight, const AgentConfig& agent) {
  std::optional<WaypointFlight> flown;
  if (flight) flown.emplace(*flight, agent.law.axes, agent.p_W);
  return std::make_unique<Leader>(std::move(flown));
}

}  // namespace mascot
