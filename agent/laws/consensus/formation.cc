// Displacement-based formation of double integrators; Oh, Park & Ahn (2015), section 4; Ren & Atkins (2007):
//   a_i = -sum_j a_ij [ p_gain ((p_i - p_j) - (d_i - d_j)) + v_gain (v_i - v_j) ] - beta v_i
// This is consensus on p_i - d_i. A leader does not use what it hears: it keeps its velocity (a = 0), or flies
// waypoints.
#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "agent/laws/consensus/consensus.h"
#include "agent/laws/parts/leader.h"
#include "agent/laws/parts/places.h"
#include "experiment/experiment.h"

namespace mascot {
namespace {

constexpr std::array kFormationGain = {
    key::Number("p_gain", kGain, "pull towards the place that each neighbour's position means, times its weight")
        .Default("1.0")
        .Unit("1/s^2")
        .Live(),
};
constexpr auto kFormationParameters = Joined(kPlaceKeys, Joined(kFormationGain, kVelocityAndLeaderParameters));

struct FormationParams final : ConsensusParams {
  std::vector<Eigen::Vector3d> d_W;  ///< d_i by id - 1: each agent's place in the formation, in W (m)
};

class Formation final : public Law {
 public:
  Formation(const FormationParams& params, int id) : params_(&params), id_(id) {}

  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<FormationParams>(agent.law); }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    Eigen::Vector3d a_W = -params_->beta * self.v_WB;
    for (const Heard& j : heard) {
      const Eigen::Vector3d place_W = (self.p_WB - j.motion.p_WB) - (d_W(id_) - d_W(j.id));
      a_W -= j.weight * (params_->p_gain * place_W + params_->v_gain * (self.v_WB - j.motion.v_WB));
    }
    return a_W;
  }

 private:
  const Eigen::Vector3d& d_W(int id) const { return params_->d_W[static_cast<std::size_t>(id - 1)]; }

  const FormationParams* params_;  // the experiment owns them
  int id_;
};

std::shared_ptr<const LawParams> ReadFormation(const Experiment& experiment, const LawConfig& law, Section& section) {
  auto params = std::make_shared<FormationParams>();
  params->d_W = ReadPlaces(section, experiment.size());
  ReadGains(law, section, *params);
  return params;
}

std::unique_ptr<Law> MakeFormation(const Experiment& experiment, int id) {
  const AgentConfig& agent = experiment.agent(id);
  const auto& params = ParamsOf<FormationParams>(agent.law);
  if (id == agent.law.leader) return MakeLeader(FlightOfLeader, agent);
  return std::make_unique<Formation>(params, id);
}

LinearForm LinearFormation(const LawConfig& law) { return LinearFormOf(ParamsOf<FormationParams>(law)); }

std::span<const Eigen::Vector3d> FormationPlaces_W(const LawConfig& law) { return ParamsOf<FormationParams>(law).d_W; }

}  // namespace

LawEntry FormationLaw() {
  return {
      .name = "formation",
      .summary = "agents keep given displacements from each other, alone or behind a leader",
      .equation =
          "a_i = -sum_j a_ij [p_gain ((p_i - p_j) - (d_i - d_j)) + v_gain (v_i - v_j)] - beta v_i;  leader: a = "
          "0, or its waypoints",
      .tex =
          R"(a_i = -\sum_j a_{ij} \bigl[ k_p \bigl( (p_i - p_j) - (d_i - d_j) \bigr) + k_v (v_i - v_j) \bigr] - \beta v_i \\
\text{leader: } a_i = 0 \text{, or its waypoints})",
      .symbols = {{"p_gain", "k_p"}, {"v_gain", "k_v"}, {"beta", R"(\beta)"}, {"offsets_m", "d_i"}},
      .graph = "a directed spanning tree, with a leader one rooted at it",
      .details =
          "d_i is the agent's place, from offsets_m or shape.\n"
          "A leader uses nothing of what it hears. Without leader_waypoints_m it wants the acceleration 0; "
          "with them it flies as the law waypoint does, with leader_p_gain and leader_d_gain.",
      .theory =
          "consensus on p_i - d_i: the formation's point meets at the mean of p(0) - d plus that of v(0) / beta "
          "(undirected)",
      .source =
          "Oh, Park & Ahn, A survey of multi-agent formation control, Automatica 53 (2015); with v_gain: Ren & "
          "Atkins, Distributed multi-vehicle coordinated control via local information exchange, Int. J. Robust "
          "Nonlinear Control 17 (2007)",
      .parameters = kFormationParameters,
      .agrees = true,
      .drawing = {.pictures = kDisagreementPicture},
      .read = ReadFormation,
      .make = MakeFormation,
      .places_W = FormationPlaces_W,
      .go_to = GoToOf<FlightOfLeader>,
      .waypoints_W = LeaderWaypointsOf<FlightOfLeader>,
      .linear = LinearFormation};
}

}  // namespace mascot
