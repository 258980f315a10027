#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "agent/laws/parts/rigidity.h"

namespace mascot {

// The potential of distances, V = (1/4) sum over bars of weight (|z|^2 - d^2)^2: |z| the length of a bar between
// `points`, d that between `places`. Lengths are along `axes`.

/// -grad V at `points`.
std::vector<Eigen::Vector3d> Descent(std::span<const Bar> bars, std::span<const Eigen::Vector3d> places,
                                     std::span<const Eigen::Vector3d> points, Axes axes);

}  // namespace mascot
