// Consensus of double integrators with absolute velocity damping; MASCOT (Pandit, Njattuvetty, Mulla), the laws
// "leaderless" and "leader-follower"; Ren & Beard, "Distributed Consensus in Multi-vehicle Cooperative Control" (2008):
//   a_i = p_gain sum_j a_ij (p_j - p_i) - beta v_i
// A leader listens to nobody: it keeps its velocity (a = 0), or flies waypoints.
#include "agent/laws/consensus.h"

#include <memory>
#include <utility>

namespace mascot {
namespace {

class Consensus final : public Law {
 public:
  Consensus(double p_gain, double beta) : p_gain_(p_gain), beta_(beta) {}

  Eigen::Vector3d Accel_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    Eigen::Vector3d pull_W = Eigen::Vector3d::Zero();
    for (const Heard& j : heard) pull_W += j.weight * (j.motion.p_WB - self.p_WB);
    return p_gain_ * pull_W - beta_ * self.v_WB;
  }

 private:
  double p_gain_;
  double beta_;
};

class Leader final : public Law {
 public:
  explicit Leader(std::optional<WaypointFlight> flight) : flight_(std::move(flight)) {}

  Eigen::Vector3d Accel_W(double t_s, const Motion& self, std::span<const Heard> /*heard*/) override {
    return flight_ ? flight_->Accel_W(t_s, self) : Eigen::Vector3d::Zero();
  }

 private:
  std::optional<WaypointFlight> flight_;
};

}  // namespace

ConsensusParams ReadConsensus(Experiment& experiment) {
  Section& law = experiment.law.section;
  ConsensusParams params;
  params.p_gain = law.Number("p_gain", 0, 1000, 1.0);
  params.beta = law.Number("beta", 0, 1000, 1.0);
  params.leader_flight = ReadLeaderWaypoints(experiment);
  return params;
}

std::unique_ptr<Law> MakeConsensus(Experiment& experiment, int id) {
  const ConsensusParams params = ReadConsensus(experiment);
  if (id != experiment.law.leader) return std::make_unique<Consensus>(params.p_gain, params.beta);
  std::optional<WaypointFlight> flight;
  if (params.leader_flight) flight.emplace(*params.leader_flight, experiment.law.axes, experiment.agent(id).p_W);
  return std::make_unique<Leader>(std::move(flight));
}

}  // namespace mascot
