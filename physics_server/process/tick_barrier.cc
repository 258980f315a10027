#include "physics_server/process/tick_barrier.h"

#include <cassert>
#include <utility>

namespace mascot {

TickBarrier::TickBarrier(int agents)
    : is_excluded_(static_cast<std::size_t>(agents)), answered_(static_cast<std::size_t>(agents), -1) {}

void TickBarrier::Exclude(int id) {
  const auto i = static_cast<std::size_t>(id - 1);
  if (std::exchange(is_excluded_.at(i), true) != 0) return;
  ++excluded_;
  if (tick_ >= 0 && answered_[i] != tick_) --missing_;
}

void TickBarrier::Include(int id) {
  const auto i = static_cast<std::size_t>(id - 1);
  if (std::exchange(is_excluded_.at(i), false) == 0) return;
  --excluded_;
  if (tick_ >= 0 && answered_[i] != tick_) ++missing_;
}

void TickBarrier::Open(std::int64_t tick) {
  assert(tick > tick_);
  tick_ = tick;
  missing_ = static_cast<int>(answered_.size()) - excluded_;
}

bool TickBarrier::Answer(int id, std::int64_t tick) {
  std::int64_t& last = answered_.at(static_cast<std::size_t>(id - 1));
  if (tick != tick_ || last == tick || is_excluded_[static_cast<std::size_t>(id - 1)] != 0) return false;
  last = tick;
  return --missing_ == 0;
}

std::vector<int> TickBarrier::Late() const {
  std::vector<int> late;
  for (std::size_t i = 0; i < answered_.size(); ++i)
    if (answered_[i] != tick_ && is_excluded_[i] == 0) late.push_back(static_cast<int>(i) + 1);
  return late;
}

}  // namespace mascot
