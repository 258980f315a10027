#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace mascot {

/// Tells when no body can touch anything. Around each body lies an upright box; a look gives every box room to move in
/// which it meets nobody else's room, nothing fixed and not the floor. Until a box leaves its room, all are clear, and
/// to know that costs six comparisons a body; only then is it time for the next look.
class Clearance {
 public:
  /// Upright; low <= high in x, y, z (m). Wide enough that bodies whose boxes are apart do not act on each other.
  struct Box {
    Eigen::Array3d low, high;
  };

  /// What the bodies keep clear of, and how many there are.
  struct Scene {
    std::vector<bool> heeds_floor;  ///< by body: the plane z = 0 is solid for it
    bool heeds_each_other = true;
    std::vector<Box> fixed;  ///< heeded by all
  };
  explicit Clearance(Scene scene);

  /// Whether all `boxes` (by body) are apart from each other and from what is fixed, as far as those concern them.
  bool IsClear(std::span<const Box> boxes);

 private:
  bool HaveRoom(std::span<const Box> boxes) const;
  bool Look(std::span<const Box> boxes);
  bool LookAtFixed(std::span<const Box> boxes);
  bool LookAtEachOther(std::span<const Box> boxes);

  Scene scene_;
  bool looked_ = false;            // rooms_ hold
  std::vector<Box> rooms_;         // by body
  std::vector<double> spare_m_;    // by body: how far its room reaches beyond its box
  std::vector<std::size_t> by_x_;  // bodies, in order of low.x at the last look
};

}  // namespace mascot
