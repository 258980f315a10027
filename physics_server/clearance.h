#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace mascot {

/// Finds out cheaply that no body can touch anything. Each body has an upright bounding box. A check of all pairs puts
/// a larger free box around it, which meets no other free box, nothing fixed and not the floor. As long as every body's
/// box stays in its free box nothing can touch, and knowing that costs six comparisons per body. When a box leaves its
/// free box, the next check is due.
class Clearance {
 public:
  /// Aligned with the axes of W; low <= high in x, y, z (m). Wide enough that bodies whose boxes are apart do not act
  /// on each other.
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

  /// True if all `boxes`, by body, are apart from each other and from fixed boxes, as far as the scene lets them touch.
  bool IsClear(std::span<const Box> boxes);

 private:
  /// True if no box has left its free box.
  bool AreInFreeBoxes(std::span<const Box> boxes) const;
  /// Compares all boxes, and makes new free boxes. Returns true if no boxes meet.
  bool Check(std::span<const Box> boxes);
  bool CheckFixed(std::span<const Box> boxes);
  bool CheckPairs(std::span<const Box> boxes);

  Scene scene_;
  bool has_free_boxes_ = false;    // free_boxes_ are valid
  std::vector<Box> free_boxes_;    // by body
  std::vector<double> margin_m_;   // by body: how far its free box exceeds its box
  std::vector<std::size_t> by_x_;  // bodies, in order of low.x at the last check
};

}  // namespace mascot
