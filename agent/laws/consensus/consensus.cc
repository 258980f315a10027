// Consensus of double integrators with absolute velocity damping; MASCOT (Pandit, Njattuvetty, Mulla), the laws
// "leaderless" and "leader-follower"; Ren & Beard (2008):
//   a_i = p_gain sum_j a_ij (p_j - p_i) - beta v_i
// and with damping of relative velocities, Ren & Atkins (2007):
//         + v_gain sum_j a_ij (v_j - v_i)
// A leader does not use what it hears: it keeps its velocity (a = 0), or flies waypoints.
#include "agent/laws/consensus/consensus.h"

#include <memory>

#include "agent/laws/parts/leader.h"

namespace mascot {
namespace {

class Consensus final : public Law {
 public:
  explicit Consensus(const ConsensusParams& params) { Take(params); }

  void Adopt(const AgentConfig& agent) override { Take(ParamsOf<ConsensusParams>(agent.law)); }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    Eigen::Vector3d pull_W = Eigen::Vector3d::Zero(), match_W = Eigen::Vector3d::Zero();
    for (const Heard& j : heard) {
      pull_W += j.weight * (j.motion.p_WB - self.p_WB);
      match_W += j.weight * (j.motion.v_WB - self.v_WB);
    }
    return p_gain_ * pull_W + v_gain_ * match_W - beta_ * self.v_WB;
  }

 private:
  void Take(const ConsensusParams& params) {
    p_gain_ = params.p_gain;
    v_gain_ = params.v_gain;
    beta_ = params.beta;
  }

  double p_gain_ = 0;
  double v_gain_ = 0;
  double beta_ = 0;
};

std::shared_ptr<const LawParams> ReadConsensus(const Experiment& /*experiment*/, const LawConfig& law,
                                               Section& section) {
  auto params = std::make_shared<ConsensusParams>();
  ReadGains(law, section, *params);
  return params;
}

std::unique_ptr<Law> MakeConsensus(const Experiment& experiment, int id) {
  const AgentConfig& agent = experiment.agent(id);
  const auto& params = ParamsOf<ConsensusParams>(agent.law);
  if (id == agent.law.leader) return MakeLeader(FlightOfLeader, agent);
  return std::make_unique<Consensus>(params);
}

LinearForm LinearConsensus(const LawConfig& law) { return LinearFormOf(ParamsOf<ConsensusParams>(law)); }

}  // namespace

void ReadGains(const LawConfig& law, Section& section, ConsensusParams& params) {
  params.p_gain = section.Number("p_gain");
  params.v_gain = section.Number("v_gain");
  params.beta = section.Number("beta");
  params.leader_flight = ReadLeaderWaypoints(law, section);
}

LinearForm LinearFormOf(const ConsensusParams& params) {
  return {
      .p = params.p_gain, .g = params.v_gain, .beta = params.beta, .leader_flies = params.leader_flight.has_value()};
}

const std::optional<WaypointParams>& FlightOfLeader(const LawConfig& law) {
  return ParamsOf<ConsensusParams>(law).leader_flight;
}

LawEntry ConsensusLaw() {
  return {.name = "consensus",
          .summary = "agents meet, or gather at a leader, by what they hear of their neighbours",
          .equation =
              "a_i = sum_j a_ij [p_gain (p_j - p_i) + v_gain (v_j - v_i)] - beta v_i;  leader: a = 0, or its waypoints",
          .tex = R"(a_i = \sum_j a_{ij} \bigl[ k_p (p_j - p_i) + k_v (v_j - v_i) \bigr] - \beta v_i \\
\text{leader: } a_i = 0 \text{, or its waypoints})",
          .symbols = {{"p_gain", "k_p"}, {"v_gain", "k_v"}, {"beta", R"(\beta)"}},
          .graph = "a directed spanning tree, with a leader one rooted at it",
          .details =
              "Position and velocity of j are the newest that i has heard; an agent that is not heard at a tick does "
              "not pull.\n"
              "A leader uses nothing of what it hears. Without leader_waypoints_m it wants the acceleration 0; "
              "with them it flies as the law waypoint does, with leader_p_gain and leader_d_gain.",
          .theory =
              "leaderless: meets at g'p(0) + g'v(0) / beta, g the left null vector of L, if a spanning tree exists and "
              "s^2 + (beta + v_gain lambda) s + p_gain lambda is stable for every eigenvalue lambda != 0 of L; "
              "a leader at constant v is followed with a constant lag",
          .source =
              "Pandit, Njattuvetty & Mulla, ROS-based multi-agent systems control simulation testbed (MASCOT), Indian "
              "Control Conference 2022; Ren & Beard, Distributed consensus in multi-vehicle cooperative control, "
              "Springer 2008; with v_gain: Ren & Atkins, Distributed multi-vehicle coordinated control via local "
              "information exchange, Int. J. Robust Nonlinear Control 17 (2007)",
          .parameters = kConsensusParameters,
          .agrees = true,
          .gathers = true,
          .drawing = {.pictures = kDisagreementPicture},
          .read = ReadConsensus,
          .make = MakeConsensus,
          .go_to = GoToOf<FlightOfLeader>,
          .waypoints_W = LeaderWaypointsOf<FlightOfLeader>,
          .linear = LinearConsensus};
}

}  // namespace mascot
