#include "agent/laws/bearing_formation/bearing_theory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "agent/laws/laws.h"
#include "agent/laws/parts/fly_ahead.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/stable_period.h"

namespace mascot {

double LargestTurn_deg(std::span<const Bar> bars, const LawConfig& law, std::span<const Eigen::Vector3d> p_W) {
  const auto& d_W = ParamsOf<BearingFormationParams>(law).d_W;
  double largest_rad = 0;
  for (const Bar& bar : bars) {
    const Eigen::Vector3d is_W = SpanOf(bar, p_W, law.axes), wanted_W = SpanOf(bar, d_W, law.axes);
    largest_rad = std::max(largest_rad, std::atan2(is_W.cross(wanted_W).norm(), is_W.dot(wanted_W)));
  }
  return largest_rad * 180 / std::numbers::pi;
}

namespace {

/// The longest control period that is stable near the shape, at the scale `start_m` (s).
double LongestPeriod_s(const Experiment& experiment, double start_m) {
  const auto& params = ParamsOf<BearingFormationParams>(experiment.law);
  std::vector<Eigen::Vector3d> shape_W = params.d_W;
  const double larger = start_m / ScaleOf(shape_W, experiment.law.axes);
  for (Eigen::Vector3d& p : shape_W) p *= larger;
  return 2 / (params.gain * LargestTurnStiffness(BarsOf(experiment.graph), shape_W, experiment.law.axes));
}

FlownAhead FlyDirectionsAhead(const Experiment& experiment, std::span<const Bar> bars) {
  const auto& params = ParamsOf<BearingFormationParams>(experiment.law);
  const auto velocities_W = [&](std::span<const Eigen::Vector3d> p_W) {
    std::vector<Eigen::Vector3d> v_W(p_W.size(), Eigen::Vector3d::Zero());
    for (const Bar& bar : bars) {
      const Eigen::Vector3d g = SpanOf(bar, p_W, experiment.law.axes).normalized();
      const Eigen::Vector3d wanted_g = SpanOf(bar, params.d_W, experiment.law.axes).normalized();
      const Eigen::Vector3d turn_W = params.gain * bar.weight * (wanted_g - g * g.dot(wanted_g));
      v_W[static_cast<std::size_t>(bar.i - 1)] -= turn_W;
      v_W[static_cast<std::size_t>(bar.j - 1)] += turn_W;
    }
    return v_W;
  };
  const auto error = [&](std::span<const Eigen::Vector3d> p_W) { return LargestTurn_deg(bars, experiment.law, p_W); };
  return FlyAhead(experiment, {.velocities_W = velocities_W, .error = error, .settled = kSettled_deg});
}

/// What flying ahead has shown of the start.
std::vector<std::string> BearingWarnings(const Experiment& experiment, std::span<const Bar> bars,
                                         const FlownAhead& ahead) {
  const double start_deg = LargestTurn_deg(bars, experiment.law, StartsOf(experiment));
  if (ahead.rests_at_start && start_deg > kSettled_deg)
    return {
        fmt::format("agents.position_m: the law moves nobody from this start, where directions are off by up to {:.4g} "
                    "deg: they are opposite to those of the formation",
                    start_deg)};
  if (ahead.rest_W.empty()) return {};
  return {
      fmt::format("agents.position_m: from this start the law comes to rest with directions off by up to {:.4g} deg",
                  LargestTurn_deg(bars, experiment.law, ahead.rest_W))};
}

}  // namespace

LawTheory PredictBearingFormation(const Experiment& experiment) {
  if (std::string why = WhyNotIdeal(experiment, Wanted::kVelocity); !why.empty()) return {.silent = std::move(why)};
  if (experiment.size() > kMaxAgentsOfRigidity) return {.silent = "the team is large: its rigidity is not checked"};
  const std::vector<Eigen::Vector3d> starts_W = StartsOf(experiment);
  const double start_m = ScaleOf(starts_W, experiment.law.axes);
  if (start_m == 0) return {.silent = "all agents start at one place, from which there are no directions"};
  if (auto unstable = WhyUnstable(experiment, LongestPeriod_s(experiment, start_m))) return *unstable;
  const std::vector<Bar> bars = BarsOf(experiment.graph);
  const FlownAhead ahead = FlyDirectionsAhead(experiment, bars);
  LawTheory theory{.silent = ahead.silent,
                   .holds_from = WhenShaped(experiment, ahead,
                                            fmt::format("directions are still off by up to {:.4g} deg", ahead.error)),
                   .warnings = BearingWarnings(experiment, bars, ahead)};
  constexpr double kRounding_deg = 1e-9;
  if (ahead.silent.empty())
    theory.figures = {
        {.values = {ahead.error < kRounding_deg ? 0 : ahead.error}},
        {.values = {ScaleOf(ahead.p_W, experiment.law.axes) / start_m}},
        {.values = {0.0}},
        {.values = {ahead.settled_s}, .why = ahead.settled_s ? "" : "that is not so by the end of the run"}};
  return theory;
}

}  // namespace mascot
