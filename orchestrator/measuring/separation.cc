#include "orchestrator/measuring/separation.h"

#include <algorithm>
#include <cmath>

namespace mascot {

/// Brings the line up to date. Sorting by insertion takes as many steps as agents have passed each other.
void Separation::Sort(Line& line, int axis, std::span<const Motion> motions, std::span<const Axes> axes) {
  std::vector<Place>& places = line.places;
  const auto before = [axis](const Place& a, const Place& b) { return a.p_W[axis] < b.p_W[axis]; };
  const bool is_sorted_before = line.axis == axis && places.size() == motions.size();
  if (places.size() != motions.size()) {
    places.clear();
    for (std::size_t i = 0; i < motions.size(); ++i) places.push_back({.agent = i});
  }
  for (Place& place : places) {
    place.p_W = motions[place.agent].p_WB;
    place.in_plane = axes[place.agent] == Axes::kXy;
  }
  line.axis = axis;
  if (!is_sorted_before) {
    std::ranges::sort(places, before);
    return;
  }
  for (std::size_t i = 1; i < places.size(); ++i)
    for (std::size_t j = i; j > 0 && before(places[j], places[j - 1]); --j) std::swap(places[j], places[j - 1]);
}

// Places are in order of one coordinate, so that a search ends where this coordinate alone differs by more than the
// smallest distance so far.
void Separation::Add(std::span<const Motion> motions, std::span<const Axes> axes) {
  if (motions.empty()) return;
  Eigen::Vector3d low = motions.front().p_WB, high = low;
  for (const Motion& motion : motions) {
    low = low.cwiseMin(motion.p_WB);
    high = high.cwiseMax(motion.p_WB);
  }
  int widest = along_widest_.axis;
  // Not for a hair: a line along another axis is sorted from scratch.
  for (int axis = 0; axis < 3; ++axis)
    if (high[axis] - low[axis] > 1.5 * (high[widest] - low[widest])) widest = axis;
  Sort(along_widest_, widest, motions, axes);
  bool any_in_plane = false;
  const std::vector<Place>& in_space = along_widest_.places;
  for (auto a = in_space.begin(); a != in_space.end(); ++a) {
    any_in_plane = any_in_plane || a->in_plane;
    for (auto b = a + 1; b != in_space.end(); ++b) {
      const Eigen::Vector3d dp_W = b->p_W - a->p_W;
      if (dp_W[widest] * dp_W[widest] >= min_in_space2_) break;
      min_in_space2_ = std::min(min_in_space2_, dp_W.squaredNorm());
    }
  }
  // That along axes is never the larger one.
  min_along_axes2_ = std::min(min_along_axes2_, min_in_space2_);
  if (!any_in_plane) return;
  Sort(along_x_, 0, motions, axes);
  const std::vector<Place>& by_x = along_x_.places;
  for (auto a = by_x.begin(); a != by_x.end(); ++a)
    for (auto b = a + 1; b != by_x.end(); ++b) {
      const Eigen::Vector2d dp_W = (b->p_W - a->p_W).head<2>();
      if (dp_W.x() * dp_W.x() >= min_along_axes2_) break;
      if (a->in_plane || b->in_plane) min_along_axes2_ = std::min(min_along_axes2_, dp_W.squaredNorm());
    }
}

double Separation::in_space_m() const { return std::sqrt(min_in_space2_); }
double Separation::along_axes_m() const { return std::sqrt(min_along_axes2_); }

}  // namespace mascot
