#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "agent/laws/parts/rigidity.h"

namespace mascot {

/// Above this many agents no stress matrix is sought.
inline constexpr int kMaxAgentsOfStress = 60;

/// Whether points span the plane, or space: three that are not on a line, or four that are not in a plane.
bool Span(std::span<const Eigen::Vector3d> points, Axes axes);

struct StressMatrix {
  std::optional<Eigen::MatrixXd> omega;
  bool none = false;  ///< it is known that there is none (DefiniteMatrix::none); false, and no omega: it is not known
};
/// A stress matrix of a framework whose points span the plane, or space: symmetric, 0 outside the diagonal and the
/// bars, Omega [p 1] = 0, positive semidefinite of rank N - d - 1 with d = CountOf(axes), largest eigenvalue 1. For
/// generic points there is one exactly if the framework is universally rigid (Gortler & Thurston 2014); for others,
/// none says nothing about rigidity.
StressMatrix StressMatrixOf(std::span<const Bar> bars, std::span<const Eigen::Vector3d> points, Axes axes);

/// The stress matrix of the team's graph and places, times a factor that makes 1 the smallest eigenvalue of the
/// followers' block, which is positive definite. Mistakes are noted in `section`, a law's table without others: none
/// was found, or the places of agents `leaders` do not span the plane, or space. Zero after a mistake.
Eigen::MatrixXd ReadStressMatrix(const Experiment& experiment, std::span<const Eigen::Vector3d> places_W,
                                 std::span<const int> leaders, Axes axes, Section& section);

}  // namespace mascot
