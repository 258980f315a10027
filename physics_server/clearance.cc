#include "physics_server/clearance.h"

#include <algorithm>
#include <numeric>

namespace mascot {
namespace {

// A larger margin would last longer, but a check would compare more pairs.
constexpr double kLargestMargin_m = 0.5;

/// Distance of two boxes along the axis on which it is largest; 0 or less: they meet.
double Gap(const Clearance::Box& a, const Clearance::Box& b) { return (a.low - b.high).max(b.low - a.high).maxCoeff(); }

}  // namespace

Clearance::Clearance(Scene scene)
    : scene_(std::move(scene)),
      free_boxes_(scene_.can_touch_floor.size()),
      margin_m_(scene_.can_touch_floor.size()),
      by_x_(scene_.can_touch_floor.size()) {
  std::iota(by_x_.begin(), by_x_.end(), std::size_t{0});
}

bool Clearance::IsClear(std::span<const Box> boxes) {
  return (has_free_boxes_ && AreInFreeBoxes(boxes)) || Check(boxes);
}

bool Clearance::AreInFreeBoxes(std::span<const Box> boxes) const {
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if ((boxes[i].low < free_boxes_[i].low).any() || (boxes[i].high > free_boxes_[i].high).any()) return false;
  return true;
}

bool Clearance::Check(std::span<const Box> boxes) {
  std::ranges::fill(margin_m_, kLargestMargin_m);
  has_free_boxes_ = CheckFixed(boxes) && (!scene_.can_touch_each_other || CheckPairs(boxes));
  for (std::size_t i = 0; i < boxes.size() && has_free_boxes_; ++i)
    free_boxes_[i] = {boxes[i].low - margin_m_[i], boxes[i].high + margin_m_[i]};
  return has_free_boxes_;
}

bool Clearance::CheckFixed(std::span<const Box> boxes) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    double gap_m = scene_.can_touch_floor[i] ? boxes[i].low.z() : kLargestMargin_m;
    for (const Box& fixed : scene_.fixed) gap_m = std::min(gap_m, Gap(boxes[i], fixed));
    if (gap_m <= 0) return false;
    margin_m_[i] = std::min(margin_m_[i], gap_m);
  }
  return true;
}

// Two bodies share the gap between them: each may use half of it.
bool Clearance::CheckPairs(std::span<const Box> boxes) {
  std::ranges::sort(by_x_, {}, [&](std::size_t i) { return boxes[i].low.x(); });
  for (auto a = by_x_.begin(); a != by_x_.end(); ++a) {
    const double reach_m = boxes[*a].high.x() + 2 * kLargestMargin_m;
    for (auto b = a + 1; b != by_x_.end() && boxes[*b].low.x() < reach_m; ++b) {
      const double gap_m = Gap(boxes[*a], boxes[*b]);
      if (gap_m <= 0) return false;
      margin_m_[*a] = std::min(margin_m_[*a], gap_m / 2);
      margin_m_[*b] = std::min(margin_m_[*b], gap_m / 2);
    }
  }
  return true;
}

}  // namespace mascot
