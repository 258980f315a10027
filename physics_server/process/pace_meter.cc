#include "physics_server/process/pace_meter.h"

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

void PaceMeter::AddCommand(int agent, std::int64_t tick, std::int64_t age) {
  const auto ticks = static_cast<std::size_t>(std::max<std::int64_t>(age, 0));
  if (commands_.size() <= ticks) commands_.resize(ticks + 1, 0);
  ++commands_[ticks];
  if (ticks > 0) NoteLate(agent, tick);
}

void PaceMeter::NoteLate(int agent, std::int64_t tick) {
  const auto i = static_cast<std::size_t>(agent - 1);
  if (lasting_.size() <= i) lasting_.resize(i + 1);
  if (lasting_[i].IsOver(tick, EpisodeGapTicks(rate_hz_))) {
    if (late_.size() < kMaxLatesTold) late_.push_back({agent, lasting_[i]});
    lasting_[i] = {};
  }
  lasting_[i].Add(tick);
}

std::vector<LateCommands> PaceMeter::Late() const {
  std::vector<LateCommands> all = late_;
  for (std::size_t i = 0; i < lasting_.size(); ++i)
    if (lasting_[i].count > 0) all.push_back({static_cast<int>(i) + 1, lasting_[i]});
  std::ranges::stable_sort(all, {}, [](const LateCommands& late) { return late.ticks.from; });
  if (all.size() > kMaxLatesTold) all.resize(kMaxLatesTold);
  return all;
}

Pacing PaceMeter::Result() const {
  Pacing pacing{.late = Late()};
  std::uint64_t used = 0;
  for (std::size_t age = 0; age < commands_.size(); ++age) {
    used += commands_[age];
    if (age > 0) pacing.misses += commands_[age];
  }
  for (std::size_t q = 0; q < 3; ++q) {
    pacing.tick_lateness_s[q] = lateness_.Quantile(kQuantiles[q]);
    std::uint64_t passed = 0;
    for (std::size_t age = 0; age < commands_.size() && used > 0; ++age) {
      passed += commands_[age];
      if (passed <= Place(kQuantiles[q], used)) continue;
      pacing.command_age_s[q] = static_cast<double>(age) / rate_hz_;
      break;
    }
  }
  return pacing;
}

}  // namespace mascot
