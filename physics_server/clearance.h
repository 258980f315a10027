#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace mascot {

/// Finds out cheaply which bodies may touch something. Each body has an upright bounding box; what counts is which of
/// the boxes meet. A list of the pairs that are near each other serves until a box has moved by some decimetres, so
/// that most looks compare few of them.
class Clearance {
 public:
  /// Aligned with the axes of W; low <= high in x, y, z (m). Wide enough that bodies whose boxes are apart do not act
  /// on each other. May be infinite.
  struct Box {
    Eigen::Array3d low, high;
  };

  /// The number of bodies, and what they can touch.
  struct Scene {
    std::vector<bool> can_touch_floor;  ///< by body: it can touch the plane z = 0
    bool can_touch_each_other = true;
    std::vector<Box> fixed;  ///< boxes that do not move; all bodies can touch them
  };
  explicit Clearance(Scene scene);

  /// Finds which of these boxes, by body, meet each other, something fixed or the floor, as far as the scene lets them
  /// touch.
  void Look(std::span<const Box> boxes);
  /// Whether the body's box met something at the last Look().
  bool MetSomething(std::size_t body) const { return met_[body]; }
  /// Whether any of what met at the last Look() meets with these boxes, too; the others may be anything.
  bool DoMeet(std::span<const Box> boxes) const;

 private:
  using Pair = std::pair<std::size_t, std::size_t>;  // of bodies, or of a body and something fixed

  /// True if no box has left the room that the lists leave it.
  bool AreInTheirRooms(std::span<const Box> boxes) const;
  void List(std::span<const Box> boxes);

  Scene scene_;
  bool is_listed_ = false;
  std::vector<Box> rooms_;         // by body: as long as each box is in its room, no pairs meet that are not listed
  std::vector<std::size_t> by_x_;  // bodies, in order of low.x when they were listed
  std::vector<Pair> near_bodies_, near_fixed_;

  std::vector<char> met_;  // by body
  std::vector<Pair> met_bodies_, met_fixed_;
  std::vector<std::size_t> met_floor_;
};

}  // namespace mascot
