#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "agent/laws/parts/rigidity.h"

namespace mascot {

// Starts that a law cannot leave by which agents fly along the ways to others, as fast as distances say. Each is a
// warning of agents.position_m.

/// The team starts at one place, on a line, or in a plane, and its places are not there. Such a law moves agents along
/// ways to each other, and so within that line or plane.
std::vector<std::string> FlatStartWarnings(std::span<const Eigen::Vector3d> starts_W,
                                           std::span<const Eigen::Vector3d> places_W, Axes axes);
/// Two agents start at one place, have others, and are at the same distances from the same neighbours there: they get
/// the same velocities for ever.
std::vector<std::string> TwinWarnings(std::span<const Bar> bars, std::span<const Eigen::Vector3d> starts_W,
                                      std::span<const Eigen::Vector3d> places_W, Axes axes);

}  // namespace mascot
