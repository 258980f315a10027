#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <string>

namespace mascot {

/// A place (m) for people: "[0.02, 4.01, 1.00]".
inline std::string PlaceText(const Eigen::Vector3d& p) {
  return fmt::format("[{:.2f}, {:.2f}, {:.2f}]", p.x(), p.y(), p.z());
}

}  // namespace mascot
