#include "agent/laws/affine_formation/maneuver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mascot {
namespace {

/// Notes a mistake unless there are as many values under `key` as times.
template <class List>
List OnePerTime(Section& section, const char* key, List values, std::size_t times) {
  if (!section.Has(key)) return {};
  if (!section.Wrong(key) && values.size() != times)
    section.Fail(key, fmt::format("expected {} values, one for each of times_s, got {}", times, values.size()));
  values.resize(times);
  return values;
}

}  // namespace

Maneuver Maneuver::Read(Section& section) {
  const std::vector<double> times_s = section.Numbers("times_s");
  for (std::size_t n = 1; n < times_s.size() && !section.Wrong("times_s"); ++n)
    if (times_s[n] <= times_s[n - 1])
      section.FailRow("times_s", n,
                      "expected a time after " + ShortestFloat(times_s[n - 1]) + ", got " + ShortestFloat(times_s[n]));
  const std::size_t count = times_s.size();
  const auto turns = OnePerTime(section, "turns_deg", section.Numbers("turns_deg"), count);
  const auto stretches = OnePerTime(section, "stretches", section.Points("stretches"), count);
  const auto shears = OnePerTime(section, "shears", section.Numbers("shears"), count);
  const auto shifts = OnePerTime(section, "shifts_m", section.Points("shifts_m"), count);
  Maneuver maneuver;
  maneuver.gain_per_s_ = section.Number("leader_gain");
  for (std::size_t k = 0; k < count; ++k) {
    Step step{.at_s = times_s[k]};
    if (!turns.empty()) step.turn_deg = turns[k];
    if (!stretches.empty()) step.stretch = stretches[k];
    if (!shears.empty()) step.shear = shears[k];
    if (!shifts.empty()) step.shift_m = shifts[k];
    maneuver.steps_.push_back(step);
  }
  return maneuver;
}

Maneuver::Step Maneuver::StepAt(double t_s) const {
  if (steps_.empty()) return {};
  const auto next = std::ranges::upper_bound(steps_, t_s, {}, &Step::at_s);
  if (next == steps_.begin()) return steps_.front();
  if (next == steps_.end()) return steps_.back();
  const Step &a = *(next - 1), &b = *next;
  const double share = (t_s - a.at_s) / (b.at_s - a.at_s);
  const auto between = [share](const auto& from, const auto& to) { return from + share * (to - from); };
  return {.at_s = t_s,
          .turn_deg = between(a.turn_deg, b.turn_deg),
          .stretch = between(a.stretch, b.stretch),
          .shear = between(a.shear, b.shear),
          .shift_m = between(a.shift_m, b.shift_m)};
}

Eigen::Vector3d Maneuver::At(double t_s, const Eigen::Vector3d& r) const {
  const Step step = StepAt(t_s);
  Eigen::Vector3d p = step.stretch.cwiseProduct(r);
  p.x() += step.shear * p.y();
  const double angle_rad = step.turn_deg * std::numbers::pi / 180;
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return Eigen::Vector3d(c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z()) + step.shift_m;
}

Eigen::Vector3d Maneuver::Velocity_W(double t_s, double period_s, const Eigen::Vector3d& r,
                                     const Eigen::Vector3d& p_WB) const {
  const Eigen::Vector3d now_W = At(t_s, r), next_W = At(t_s + period_s, r);
  return (next_W - now_W) / period_s + gain_per_s_ * (now_W - p_WB);
}

}  // namespace mascot
