#include "agent/laws/affine_formation/stress_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "agent/laws/affine_formation/definite_matrix.h"
#include "agent/laws/parts/leaders.h"
#include "agent/laws/parts/reach.h"
#include "base/linear_algebra.h"

namespace mascot {
namespace {

constexpr int kFewSteps = 200, kManySteps = 20000;
constexpr double kZeroEigenvalue = 1e-12;  // of a Gram matrix, as a share of its largest one

/// Points about their mean, with coordinates of at most 1, and a last column of ones: [p 1].
Eigen::MatrixXd Homogeneous(std::span<const Eigen::Vector3d> points, Axes axes) {
  const Eigen::Index count = std::ssize(points), d = CountOf(axes);
  const Eigen::Vector3d centre = CentroidOf(points);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Ones(count, d + 1);
  for (Eigen::Index i = 0; i < count; ++i)
    rows.row(i).head(d) = (points[static_cast<std::size_t>(i)] - centre).head(d).transpose();
  const double largest = rows.leftCols(d).cwiseAbs().maxCoeff();
  if (largest > 0) rows.leftCols(d) /= largest;
  return rows;
}

/// Orthonormal columns x with matrix x = 0.
Eigen::MatrixXd Kernel(const Eigen::MatrixXd& matrix) {
  const SymmetricEigensystem system = SymmetricEigensystemOf(matrix.transpose() * matrix);
  const double zero = kZeroEigenvalue * std::max(system.values.maxCoeff(), 1e-300);
  return system.vectors.leftCols((system.values.array() <= zero).count());
}

/// The matrix that stresses on the bars make: -stress at (i, j) and (j, i), rows with the sum 0.
Eigen::MatrixXd MatrixOf(const Eigen::VectorXd& stresses, std::span<const Bar> bars, Eigen::Index count) {
  Eigen::MatrixXd omega = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t k = 0; k < bars.size(); ++k) {
    const double stress = stresses(static_cast<Eigen::Index>(k));
    const Eigen::Index i = bars[k].i - 1, j = bars[k].j - 1;
    omega(i, j) = omega(j, i) = -stress;
    omega(i, i) += stress;
    omega(j, j) += stress;
  }
  return omega;
}

/// All stresses with which the forces at every point cancel: orthonormal columns.
Eigen::MatrixXd EquilibriumStresses(std::span<const Bar> bars, const Eigen::MatrixXd& homogeneous) {
  const Eigen::Index count = homogeneous.rows(), columns = homogeneous.cols();
  Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(count * columns, std::ssize(bars));
  for (Eigen::Index k = 0; k < std::ssize(bars); ++k) {
    const Bar& bar = bars[static_cast<std::size_t>(k)];
    const Eigen::VectorXd span = (homogeneous.row(bar.j - 1) - homogeneous.row(bar.i - 1)).transpose();
    forces.block((bar.i - 1) * columns, k, columns, 1) = span;
    forces.block((bar.j - 1) * columns, k, columns, 1) = -span;
  }
  return Kernel(forces);
}

}  // namespace

bool Span(std::span<const Eigen::Vector3d> points, Axes axes) {
  return !points.empty() && RankOf(Homogeneous(points, axes)) == CountOf(axes) + 1;
}

StressMatrix StressMatrixOf(std::span<const Bar> bars, std::span<const Eigen::Vector3d> points, Axes axes) {
  if (bars.empty()) return {.omega = std::nullopt, .none = true};
  const Eigen::MatrixXd homogeneous = Homogeneous(points, axes);
  const Eigen::MatrixXd q = Kernel(homogeneous.transpose());  // Omega = q X q'
  const Eigen::MatrixXd stresses = EquilibriumStresses(bars, homogeneous);
  if (q.cols() == 0 || stresses.cols() == 0) return {.omega = std::nullopt, .none = true};
  const Eigen::Index size = q.cols() * q.cols();
  Eigen::MatrixXd basis(size, stresses.cols());  // a column for each X that the stresses span
  for (Eigen::Index k = 0; k < stresses.cols(); ++k)
    basis.col(k) = (q.transpose() * MatrixOf(stresses.col(k), bars, homogeneous.rows()) * q).reshaped();
  const Eigen::MatrixXd gram = basis.transpose() * basis;
  const auto omega = [&q](const Eigen::MatrixXd& x, double largest) -> Eigen::MatrixXd {
    const Eigen::MatrixXd one = q * x * q.transpose() / largest;
    return (one + one.transpose()) / 2;
  };

  // Projects by turns on the X of stresses, and on those with no eigenvalue below 1: quick, where the eigenvalues of
  // the X sought differ little. Else it is found, or found missing, by a method that is slow where stresses are many.
  Eigen::MatrixXd x = Eigen::MatrixXd::Identity(q.cols(), q.cols());
  DefiniteMatrix best;
  for (int step = 0; step < kManySteps; ++step) {
    if (step == kFewSteps && (best = MostDefinite(basis, q.cols())).none) return {.omega = std::nullopt, .none = true};
    x.reshaped() = basis * Solve(gram, basis.transpose() * x.reshaped());
    const SymmetricEigensystem system = SymmetricEigensystemOf(x);
    if (system.values.minCoeff() > 0.5) return {.omega = omega(x, system.values.maxCoeff()), .none = false};
    x = system.vectors * system.values.cwiseMax(1.0).asDiagonal() * system.vectors.transpose();
  }
  if (!best.found) return {};
  return {.omega = omega(*best.found, SymmetricEigenvalues(*best.found).maxCoeff()), .none = false};
}

namespace {

/// Notes what is wrong; the stress matrix may still be missing.
void CheckSpan(std::span<const Eigen::Vector3d> places_W, std::span<const int> leaders, Axes axes, Section& section) {
  std::vector<Eigen::Vector3d> led_by;
  for (const int id : leaders) led_by.push_back(places_W[static_cast<std::size_t>(id - 1)]);
  if (Span(led_by, axes)) return;
  section.Fail("leaders", fmt::format("expected leaders whose places span {}, got {}",
                                      axes == Axes::kXyz ? "space: four that are not in a plane"
                                                         : "the plane: three that are not on a line",
                                      AgentList({leaders.begin(), leaders.end()})));
}

}  // namespace

Eigen::MatrixXd ReadStressMatrix(const Experiment& experiment, std::span<const Eigen::Vector3d> places_W,
                                 std::span<const int> leaders, Axes axes, Section& section) {
  const int agents = experiment.size();
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(agents, agents);
  if (section.Wrong("") || experiment.graph.size() != agents) return none;
  CheckSpan(places_W, leaders, axes, section);
  if (section.Wrong("leaders")) return none;
  if (agents > kMaxAgentsOfStress) {
    section.Fail("name",
                 fmt::format("expected at most {} agents, for a stress matrix, got {}", kMaxAgentsOfStress, agents));
    return none;
  }
  if (!experiment.graph.IsSymmetric()) {
    section.Fail("name", std::string(kExpectedUndirected));
    return none;
  }
  const std::vector<Bar> bars = BarsOf(experiment.graph);
  const StressMatrix stress = StressMatrixOf(bars, places_W, axes);
  if (stress.omega) {
    const LedTeam team({leaders.begin(), leaders.end()}, agents);
    return *stress.omega / SymmetricEigenvalues(BlockOf(*stress.omega, team.followers, team.followers)).minCoeff();
  }
  section.Fail("name",
               fmt::format("expected a graph and places with a positive semidefinite stress matrix of rank {}, got "
                           "{} pairs {}",
                           agents - CountOf(axes) - 1, bars.size(),
                           stress.none ? "that have none, but for rounding" : "for which none was found"));
  return none;
}

}  // namespace mascot
