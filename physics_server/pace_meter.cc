#include "physics_server/pace_meter.h"

#include <algorithm>
#include <cmath>

namespace mascot {
namespace {

constexpr double kQuantiles[] = {0.5, 0.99, 1.0};

/// Index of a quantile among `count` sorted values: the smallest value that has at least this part of them at or below
/// it.
std::uint64_t Place(double quantile, std::uint64_t count) {
  return static_cast<std::uint64_t>(std::ceil(quantile * static_cast<double>(count))) - 1;
}

}  // namespace

void PaceMeter::AddCommand(std::int64_t ticks) {
  const auto age = static_cast<std::size_t>(std::max<std::int64_t>(ticks, 0));
  if (commands_.size() <= age) commands_.resize(age + 1, 0);
  ++commands_[age];
}

Pacing PaceMeter::Result(double period_s) const {
  Pacing pacing;
  std::vector<double> sorted = lateness_s_;
  std::ranges::sort(sorted);
  std::uint64_t used = 0;
  for (std::size_t age = 0; age < commands_.size(); ++age) {
    used += commands_[age];
    if (age > 0) pacing.misses += commands_[age];
  }
  for (std::size_t q = 0; q < 3; ++q) {
    if (!sorted.empty()) pacing.tick_lateness_s[q] = sorted[Place(kQuantiles[q], sorted.size())];
    std::uint64_t passed = 0;
    for (std::size_t age = 0; age < commands_.size() && used > 0; ++age) {
      passed += commands_[age];
      if (passed <= Place(kQuantiles[q], used)) continue;
      pacing.command_age_s[q] = static_cast<double>(age) * period_s;
      break;
    }
  }
  return pacing;
}

}  // namespace mascot
