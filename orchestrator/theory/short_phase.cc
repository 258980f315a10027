#include "orchestrator/theory/short_phase.h"

#include <fmt/format.h>

namespace mascot {
namespace {

bool HoldsAt(const HoldsFrom& holds, double time_s) {
  return holds.bound == Bound::kAtLeast ? holds.time_s < time_s : holds.time_s <= time_s;
}

}  // namespace

std::optional<HoldsFrom> WhenItHolds(const Prediction& prediction) {
  if (prediction.holds_from) return prediction.holds_from;
  const bool knows_the_flight = !prediction.of_agreement && !prediction.law_figures.empty();  // not a mode alone
  if (prediction.settling_time_s && !knows_the_flight)
    return HoldsFrom{*prediction.settling_time_s, prediction.from_start ? Bound::kEqual : Bound::kAtMost};
  return std::nullopt;
}

std::string ShortPhaseWarning(const Experiment& phase, bool is_last, const Prediction& prediction) {
  const std::optional<HoldsFrom> holds = WhenItHolds(prediction);
  if (!holds || HoldsAt(*holds, phase.run.duration_s)) return "";
  const std::string ends = fmt::format(
      "{} ends after {:.4g} s", is_last ? "run.duration_s: the run" : "law.schedule: the phase", phase.run.duration_s);
  const std::string so = holds->until_then.empty() ? "" : ": " + holds->until_then;
  if (holds->bound == Bound::kAtMost)
    return fmt::format("{}; what theory expects may take until {:.4g} s{}", ends, holds->time_s, so);
  if (holds->bound == Bound::kAtLeast) return fmt::format("{}, before what theory expects{}", ends, so);
  return fmt::format("{}, before what theory expects at {:.4g} s{}", ends, holds->time_s, so);
}

}  // namespace mascot
