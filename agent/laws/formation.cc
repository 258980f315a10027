// Displacement-based formation of double integrators; Oh, Park & Ahn, "A survey of multi-agent formation control",
// Automatica 53 (2015), section 4; Ren & Atkins, Int. J. Robust Nonlinear Control 17 (2007):
//   a_i = -sum_j a_ij [ p_gain ((p_i - p_j) - (d_i - d_j)) + v_gain (v_i - v_j) ] - beta v_i
// This is consensus on p_i - d_i. A leader does not use what it hears: it keeps its velocity (a = 0), or flies
// waypoints.
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "agent/laws/consensus.h"
#include "agent/laws/leader.h"
#include "experiment/experiment.h"

namespace mascot {
namespace {

constexpr std::string_view kFormationShapes[] = {"circle", "line", "grid", "vee"};

constexpr auto kFormationParameters = Joined(
    std::array{
        key::Points("offsets_m", {-1e6, 1e6}, "d_i: each agent's place, relative to a point that all agents share")
            .Live(),
        key::OneOf("shape", kFormationShapes, "places of a family, instead of offsets_m; in x and y"),
        key::Number("spacing_m", Above(0, 1e4), "with shape: between neighbouring places").Default("2.0").Live(),
        key::Number("p_gain", kGain, "pull towards the place that each neighbour's position means, times its weight")
            .Default("1.0")
            .Unit("1/s^2")
            .Live(),
    },
    kVelocityAndLeaderParameters);

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

/// Place `i`, from 0, of `count` places in a shape; neighbouring places are one unit apart.
Eigen::Vector3d PlaceOf(std::string_view shape, int i, int count) {
  if (shape == "line") return {static_cast<double>(i), 0, 0};
  if (shape == "vee") {  // agent 1 at the tip, ranks behind it to both sides
    const int rank = (i + 1) / 2;
    const double side = std::numbers::sqrt2 / 2 * rank;
    return {-side, i % 2 == 1 ? side : -side, 0};
  }
  if (shape == "grid") {
    const int width = static_cast<int>(std::ceil(std::sqrt(count)));
    const int row = i / width, column = i % width;
    return {static_cast<double>(column), static_cast<double>(row), 0};
  }
  const double angle = 2 * std::numbers::pi * i / count;
  const double radius = count > 1 ? 0.5 / std::sin(std::numbers::pi / count) : 0;
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

std::vector<Eigen::Vector3d> ReadPlaces(Section& law, int agents) {
  const auto count = static_cast<std::size_t>(agents);
  law.Supersede("offsets_m", {"shape", "spacing_m"});
  law.Supersede("shape", {"offsets_m"});
  if (law.Has("offsets_m") == law.Has("shape")) {
    law.Fail(law.Has("shape") ? "shape" : "",
             std::string("expected one of offsets_m, shape, got ") + (law.Has("shape") ? "both" : "none"));
    return std::vector<Eigen::Vector3d>(count, Eigen::Vector3d::Zero());
  }
  std::vector<Eigen::Vector3d> places;
  if (law.Has("shape")) {
    const std::string shape = law.OneOf("shape");
    const double spacing_m = law.Number("spacing_m");
    for (int i = 0; i < agents; ++i) places.push_back(spacing_m * PlaceOf(shape, i, agents));
    return places;
  }
  places = law.Points("offsets_m");
  if (!law.Wrong("offsets_m") && places.size() != count)
    law.Fail("offsets_m", "expected " + std::to_string(count) + " points, one per agent, got a list of " +
                              std::to_string(places.size()));
  places.resize(count, Eigen::Vector3d::Zero());
  return places;
}

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

std::span<const Eigen::Vector3d> WaypointsOfFormation(const LawConfig& law) {
  return WaypointsOf(ParamsOf<FormationParams>(law).leader_flight);
}

LinearForm LinearFormation(const LawConfig& law) { return LinearFormOf(ParamsOf<FormationParams>(law)); }

std::span<const Eigen::Vector3d> FormationPlaces_W(const LawConfig& law) { return ParamsOf<FormationParams>(law).d_W; }

}  // namespace

LawEntry FormationLaw() {
  return {.name = "formation",
          .summary = "agents keep given displacements from each other, alone or behind a leader",
          .equation =
              "a_i = -sum_j a_ij [p_gain ((p_i - p_j) - (d_i - d_j)) + v_gain (v_i - v_j)] - beta v_i;  leader: a = "
              "0, or its waypoints",
          .theory =
              "consensus on p_i - d_i: the formation's point meets at the mean of p(0) - d plus that of v(0) / beta "
              "(undirected)",
          .source = "Oh, Park & Ahn (2015); Ren & Atkins (2007)",
          .parameters = kFormationParameters,
          .agrees = true,
          .drawing = {.pictures = kDisagreementPicture},
          .read = ReadFormation,
          .make = MakeFormation,
          .places_W = FormationPlaces_W,
          .go_to = GoToOfConsensus,
          .waypoints_W = WaypointsOfFormation,
          .linear = LinearFormation};
}

}  // namespace mascot
