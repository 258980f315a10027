// Stability of modes: gains and control period.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "orchestrator/theory/parts.h"

namespace mascot {

namespace {

/// Whether the modes decay so slowly against how fast they swing that holding a command takes their damping away.
bool HardlyDamped(std::span<const LinearMode> modes) {
  constexpr double kHardly = 0.05;  // of critical damping
  return std::ranges::any_of(modes, [](const LinearMode& mode) {
    return mode.order == 2 && std::abs(mode.damping) < 2 * kHardly * std::sqrt(std::abs(mode.stiffness));
  });
}

}  // namespace

bool JudgePeriod(const Experiment& experiment, double longest_s, Prediction& prediction) {
  if (std::isfinite(longest_s)) prediction.control_period_bound_s = longest_s;
  constexpr double kRounding = 1e-9;  // relative: at the bound itself the loop oscillates for ever
  if (experiment.period_s() < longest_s * (1 - kRounding)) return true;
  prediction.warnings.push_back(fmt::format("control.rate_hz: unstable at this rate, it must be above {:.4g}, got {}",
                                            1 / longest_s, experiment.control.rate_hz));
  return false;
}

bool JudgeModes(const Experiment& experiment, std::span<const LinearMode> modes, const GainBound& gain,
                Prediction& prediction) {
  if (std::ranges::any_of(modes, [](const LinearMode& mode) { return mode.stiffness == 0.0; })) {
    prediction.warnings.push_back("law.p_gain: 0 means that nothing pulls an agent anywhere");
    return false;
  }
  if (!std::ranges::all_of(modes, Decays)) {
    prediction.warnings.push_back(
        fmt::format("{}: unstable, it must be above {:.5g}, got {:.5g}", gain.key, gain.least, gain.got));
    return false;
  }
  const bool decays = JudgePeriod(experiment, LongestPeriod(modes), prediction);
  if (!decays && HardlyDamped(modes))
    prediction.warnings.back() +=
        fmt::format(": {} = {:.5g} damps so little that holding a command for a tick undoes it", gain.key, gain.got);
  return decays;
}

}  // namespace mascot
