#include "physics_server/clearance.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mascot {
namespace {

// With a larger margin the lists would last longer, and be longer.
constexpr double kMargin_m = 0.5;

using Box = Clearance::Box;

bool DoBoxesMeet(const Box& a, const Box& b) { return (a.low <= b.high).all() && (b.low <= a.high).all(); }

Box Around(const Box& box, double margin_m) { return {box.low - margin_m, box.high + margin_m}; }

}  // namespace

Clearance::Clearance(Scene scene)
    : scene_(std::move(scene)),
      rooms_(scene_.can_touch_floor.size()),
      by_x_(scene_.can_touch_floor.size()),
      met_(scene_.can_touch_floor.size()) {
  std::iota(by_x_.begin(), by_x_.end(), std::size_t{0});
  for (std::vector<Pair>* pairs : {&near_bodies_, &near_fixed_, &met_bodies_, &met_fixed_})
    pairs->reserve(by_x_.size());
  met_floor_.reserve(by_x_.size());
}

void Clearance::Look(std::span<const Box> boxes) {
  if (!is_listed_ || !AreInTheirRooms(boxes)) List(boxes);
  std::ranges::fill(met_, char{false});
  met_bodies_.clear();
  met_fixed_.clear();
  met_floor_.clear();
  for (const Pair& pair : near_bodies_)
    if (DoBoxesMeet(boxes[pair.first], boxes[pair.second])) {
      met_bodies_.push_back(pair);
      met_[pair.first] = met_[pair.second] = true;
    }
  for (const Pair& pair : near_fixed_)
    if (DoBoxesMeet(boxes[pair.first], scene_.fixed[pair.second])) {
      met_fixed_.push_back(pair);
      met_[pair.first] = true;
    }
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (scene_.can_touch_floor[i] && boxes[i].low.z() <= 0) {
      met_floor_.push_back(i);
      met_[i] = true;
    }
}

bool Clearance::DoMeet(std::span<const Box> boxes) const {
  return std::ranges::any_of(met_floor_, [&](std::size_t i) { return boxes[i].low.z() <= 0; }) ||
         std::ranges::any_of(met_fixed_,
                             [&](const Pair& of) { return DoBoxesMeet(boxes[of.first], scene_.fixed[of.second]); }) ||
         std::ranges::any_of(met_bodies_,
                             [&](const Pair& of) { return DoBoxesMeet(boxes[of.first], boxes[of.second]); });
}

bool Clearance::AreInTheirRooms(std::span<const Box> boxes) const {
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if ((boxes[i].low < rooms_[i].low).any() || (boxes[i].high > rooms_[i].high).any()) return false;
  return true;
}

void Clearance::List(std::span<const Box> boxes) {
  is_listed_ = true;
  near_bodies_.clear();
  near_fixed_.clear();
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    rooms_[i] = Around(boxes[i], kMargin_m);
    // An infinite room would never be left, though the box might become small.
    is_listed_ = is_listed_ && rooms_[i].low.allFinite() && rooms_[i].high.allFinite();
    for (std::size_t k = 0; k < scene_.fixed.size(); ++k)
      if (DoBoxesMeet(rooms_[i], scene_.fixed[k])) near_fixed_.emplace_back(i, k);
  }
  if (!scene_.can_touch_each_other) return;
  std::ranges::sort(by_x_, {}, [&](std::size_t i) { return boxes[i].low.x(); });
  for (auto a = by_x_.begin(); a != by_x_.end(); ++a)
    for (auto b = a + 1; b != by_x_.end() && rooms_[*b].low.x() <= rooms_[*a].high.x(); ++b)
      if (DoBoxesMeet(rooms_[*a], rooms_[*b])) near_bodies_.emplace_back(*a, *b);
}

}  // namespace mascot
