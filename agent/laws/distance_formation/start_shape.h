#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "agent/laws/parts/rigidity.h"

namespace mascot {

// Warnings about starts (agents.position_m) that a team cannot leave if its law moves agents along the ways to each
// other, at speeds that depend on distances only.

/// The team starts at one place, on a line, or in a plane, and its places in the formation do not lie like this. Such a
/// law moves agents along the ways to each other, and so within that line or plane.
std::vector<std::string> FlatStartWarnings(std::span<const Eigen::Vector3d> starts_W,
                                           std::span<const Eigen::Vector3d> places_W, Axes axes);
/// Two agents start at one place, have different places in the formation, and there have the same distances from the
/// same neighbours: they get the same velocities for ever.
std::vector<std::string> TwinWarnings(std::span<const Bar> bars, std::span<const Eigen::Vector3d> starts_W,
                                      std::span<const Eigen::Vector3d> places_W, Axes axes);

}  // namespace mascot
