#pragma once

#include <Eigen/Core>
#include <span>

#include "agent/laws/coverage/polygon.h"

namespace mascot {

/// A Gaussian bump of a density: weight exp(-|q - centre|^2 / (2 width^2)).
struct GaussianBump {
  Eigen::Vector2d centre_m;
  double width_m = 1, weight = 1;
};

/// Integrals of the sum of the bumps over `polygon`, about `o`. However narrow, broad or far away the bumps are, mass
/// and second are exact to a share of 1e-11, and so is the centroid, as a share of its distance from `o` or of the
/// width of the part of the bump in the polygon. Moments::log_unit is chosen for the heaviest bump there: a mass is 0
/// only if the polygon has no area.
Moments MomentsOf(const Polygon& polygon, const Eigen::Vector2d& o, std::span<const GaussianBump> bumps);

/// The distance of a bump's centre from a polygon, in widths.
double DistanceInWidths(const Polygon& polygon, const GaussianBump& bump);

}  // namespace mascot
