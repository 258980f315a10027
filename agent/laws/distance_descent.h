#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "agent/laws/rigidity.h"

namespace mascot {

// The potential of distances, V = (1/4) sum over bars of weight (|z|^2 - d^2)^2: |z| the length of a bar between
// `points`, d that between `places`. Lengths are along `axes`.

/// The largest error of a length, as long as V does not exceed what it is at `points` (m): |z| - d = (|z|^2 - d^2) /
/// (|z| + d), and one bar may have all of V.
double LargestErrorBelow(std::span<const Bar> bars, std::span<const Eigen::Vector3d> places,
                         std::span<const Eigen::Vector3d> points, Axes axes);
/// Whether V never grows from `points` on, if these go by -step grad V from tick to tick (step in 1/m^2). It does not
/// if step times the largest curvature of V, where V is no more than at `points`, is at most 2. In the direction of z,
/// the curvature of a bar is weight (3 |z|^2 - d^2), and the sum over an agent's bars, twice, bounds that of V.
bool PotentialNeverGrows(std::span<const Bar> bars, std::span<const Eigen::Vector3d> places,
                         std::span<const Eigen::Vector3d> points, Axes axes, double step);

/// The error of the length of a single bar between two points that have gone so for so many ticks (m): with each, |z|
/// becomes |z| - 2 step weight (|z|^2 - d^2) |z|.
double ErrorOfTwo(const Bar& bar, std::span<const Eigen::Vector3d> places, std::span<const Eigen::Vector3d> points,
                  Axes axes, double step, std::int64_t ticks);

}  // namespace mascot
