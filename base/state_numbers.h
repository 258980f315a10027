#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "base/motion.h"

namespace mascot {

/// How many numbers a motion is for programs outside: p (3, m), v (3, m/s), attitude (4: x, y, z, w with w >= 0 of the
/// unit quaternion that takes B to W), angular velocity in B (3, rad/s).
inline constexpr std::size_t kStateNumbers = 13;

/// A list of these numbers: its name for programs outside, and where it begins among all.
struct StatePart {
  const char *name, *unit, *meaning;
  std::size_t begin, size;
};
inline constexpr std::array kStateParts = {
    StatePart{"p", "m", "position in W", 0, 3},
    StatePart{"v", "m/s", "velocity in W", 3, 3},
    StatePart{"attitude", "1", "x, y, z, w of the unit quaternion that takes components in B to components in W", 6, 4},
    StatePart{"w", "rad/s", "angular velocity, components in B", 10, 3},
};
static_assert(kStateParts.back().begin + kStateParts.back().size == kStateNumbers);

/// Writes these numbers.
inline void StateTo(const Motion& motion, std::span<double, kStateNumbers> to) {
  auto next = to.begin();
  const auto put = [&next](const auto& numbers, double sign) {
    for (Eigen::Index n = 0; n < numbers.size(); ++n) *next++ = sign * numbers[n];
  };
  put(motion.p_WB, 1);
  put(motion.v_WB, 1);
  put(motion.q_WB.coeffs(), motion.q_WB.w() < 0 ? -1 : 1);  // x, y, z, w
  put(motion.w_WB_B, 1);
}

}  // namespace mascot
