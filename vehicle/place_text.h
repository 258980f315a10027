#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <string>

namespace mascot {

/// A number for people, who need no "-0.00".
inline double ToHundredths(double number) { return std::round(100 * number) / 100 + 0.0; }

/// A place (m) for people: "[0.02, 4.01, 1.00]".
inline std::string PlaceText(const Eigen::Vector3d& p) {
  return fmt::format("[{:.2f}, {:.2f}, {:.2f}]", ToHundredths(p.x()), ToHundredths(p.y()), ToHundredths(p.z()));
}

}  // namespace mascot
