#include "agent/laws/distance_formation/distance_theory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "agent/laws/distance_formation/distance_descent.h"
#include "agent/laws/distance_formation/global_rigidity.h"
#include "agent/laws/distance_formation/start_shape.h"
#include "agent/laws/laws.h"
#include "agent/laws/parts/fly_ahead.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/stable_period.h"

namespace mascot {

double LargestDistanceError(std::span<const Bar> bars, const LawConfig& law, std::span<const Eigen::Vector3d> p_W,
                            bool as_share) {
  const auto& d_W = ParamsOf<DistanceFormationParams>(law).d_W;
  double largest = 0;
  for (const Bar& bar : bars) {
    const double d_m = LengthOf(bar, d_W, law.axes);
    largest = std::max(largest, std::abs(LengthOf(bar, p_W, law.axes) - d_m) / (as_share ? d_m : 1));
  }
  return largest;
}

namespace {

/// What is true of the start whatever the bodies are.
std::vector<std::string> DistanceStartWarnings(const Experiment& experiment, std::span<const Bar> bars) {
  const auto& d_W = ParamsOf<DistanceFormationParams>(experiment.law).d_W;
  const std::vector<Eigen::Vector3d> starts_W = StartsOf(experiment);
  std::vector<std::string> warnings = FlatStartWarnings(starts_W, d_W, experiment.law.axes);
  if (warnings.empty()) warnings = TwinWarnings(bars, starts_W, d_W, experiment.law.axes);
  if (!IsGloballyRigid(bars, experiment.size(), experiment.law.axes))
    warnings.emplace_back(
        "graph: rigid, but not globally rigid: other shapes, with a part flipped over, may have the same distances "
        "between "
        "neighbours, and the team may end in one of them");
  return warnings;
}

FlownAhead FlyDistancesAhead(const Experiment& experiment, std::span<const Bar> bars) {
  const auto& params = ParamsOf<DistanceFormationParams>(experiment.law);
  const auto velocities_W = [&](std::span<const Eigen::Vector3d> p_W) {
    std::vector<Eigen::Vector3d> v_W = Descent(bars, params.d_W, p_W, experiment.law.axes);
    for (Eigen::Vector3d& v : v_W) v *= params.gain;
    return v_W;
  };
  const auto error = [&](std::span<const Eigen::Vector3d> p_W) {
    return LargestDistanceError(bars, experiment.law, p_W, true);
  };
  return FlyAhead(experiment, {.velocities_W = velocities_W, .error = error, .settled = kShapeShare});
}

/// What flying ahead has shown of the start.
std::vector<std::string> DistanceEndWarnings(const Experiment& experiment, std::span<const Bar> bars,
                                             const FlownAhead& ahead) {
  if (ahead.rests_at_start && LargestDistanceError(bars, experiment.law, StartsOf(experiment), true) > kShapeShare)
    return {"agents.position_m: the law moves nobody from this start, which is not the formation"};
  if (ahead.rest_W.empty()) return {};
  return {
      fmt::format("agents.position_m: from this start the law comes to rest in another shape, with distances off "
                  "by up to {:.4g} m",
                  LargestDistanceError(bars, experiment.law, ahead.rest_W, false))};
}

LawTheory PredictIdealDistances(const Experiment& experiment, std::span<const Bar> bars) {
  const auto& params = ParamsOf<DistanceFormationParams>(experiment.law);
  if (std::string why = WhyNotIdeal(experiment, Wanted::kVelocity); !why.empty()) return {.silent = std::move(why)};
  const double stiffness_m2 = LargestStiffness(bars, params.d_W, experiment.law.axes);
  if (auto unstable = WhyUnstable(experiment, 1 / (params.gain * stiffness_m2))) return *unstable;
  const FlownAhead ahead = FlyDistancesAhead(experiment, bars);
  LawTheory theory{.silent = ahead.silent, .warnings = DistanceEndWarnings(experiment, bars, ahead)};
  if (ahead.silent.empty()) {
    constexpr double kNothing_m = 1e-11;  // rounding
    const double error_m = LargestDistanceError(bars, experiment.law, ahead.p_W, false);
    theory.holds_from =
        WhenShaped(experiment, ahead, fmt::format("distances are still off by up to {:.4g} m", error_m));
    theory.figures = {
        {.values = {error_m < kNothing_m ? 0 : error_m}},
        {.values = {0.0}},
        {.values = {ahead.settled_s}, .why = ahead.settled_s ? "" : "that is not so by the end of the run"}};
  }
  return theory;
}

}  // namespace

LawTheory PredictDistanceFormation(const Experiment& experiment) {
  if (!experiment.graph.IsSymmetric()) return {.silent = "the closed forms are of undirected graphs"};
  if (experiment.size() > kMaxAgentsOfRigidity) return {.silent = "the team is large: its rigidity is not checked"};
  const std::vector<Bar> bars = BarsOf(experiment.graph);
  LawTheory theory = PredictIdealDistances(experiment, bars);
  std::vector<std::string> warnings = DistanceStartWarnings(experiment, bars);
  theory.warnings.insert(theory.warnings.begin(), warnings.begin(), warnings.end());
  return theory;
}

}  // namespace mascot
