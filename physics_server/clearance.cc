#include "physics_server/clearance.h"

#include <algorithm>
#include <numeric>

namespace mascot {
namespace {

// More would let rooms last longer, and a look compare more pairs.
constexpr double kLargestSpare_m = 0.5;

/// How far two boxes are apart along the axis that parts them most; not above 0: they meet.
double Gap(const Clearance::Box& a, const Clearance::Box& b) { return (a.low - b.high).max(b.low - a.high).maxCoeff(); }

}  // namespace

Clearance::Clearance(Scene scene)
    : scene_(std::move(scene)),
      rooms_(scene_.heeds_floor.size()),
      spare_m_(scene_.heeds_floor.size()),
      by_x_(scene_.heeds_floor.size()) {
  std::iota(by_x_.begin(), by_x_.end(), std::size_t{0});
}

bool Clearance::IsClear(std::span<const Box> boxes) { return (looked_ && HaveRoom(boxes)) || Look(boxes); }

bool Clearance::HaveRoom(std::span<const Box> boxes) const {
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if ((boxes[i].low < rooms_[i].low).any() || (boxes[i].high > rooms_[i].high).any()) return false;
  return true;
}

bool Clearance::Look(std::span<const Box> boxes) {
  std::ranges::fill(spare_m_, kLargestSpare_m);
  looked_ = LookAtFixed(boxes) && (!scene_.heeds_each_other || LookAtEachOther(boxes));
  for (std::size_t i = 0; i < boxes.size() && looked_; ++i)
    rooms_[i] = {boxes[i].low - spare_m_[i], boxes[i].high + spare_m_[i]};
  return looked_;
}

bool Clearance::LookAtFixed(std::span<const Box> boxes) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    double gap_m = scene_.heeds_floor[i] ? boxes[i].low.z() : kLargestSpare_m;
    for (const Box& fixed : scene_.fixed) gap_m = std::min(gap_m, Gap(boxes[i], fixed));
    if (gap_m <= 0) return false;
    spare_m_[i] = std::min(spare_m_[i], gap_m);
  }
  return true;
}

// Each of two may use half of what is between them.
bool Clearance::LookAtEachOther(std::span<const Box> boxes) {
  std::ranges::sort(by_x_, {}, [&](std::size_t i) { return boxes[i].low.x(); });
  for (auto a = by_x_.begin(); a != by_x_.end(); ++a) {
    const double reach_m = boxes[*a].high.x() + 2 * kLargestSpare_m;
    for (auto b = a + 1; b != by_x_.end() && boxes[*b].low.x() < reach_m; ++b) {
      const double gap_m = Gap(boxes[*a], boxes[*b]);
      if (gap_m <= 0) return false;
      spare_m_[*a] = std::min(spare_m_[*a], gap_m / 2);
      spare_m_[*b] = std::min(spare_m_[*b], gap_m / 2);
    }
  }
  return true;
}

}  // namespace mascot
