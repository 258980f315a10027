#include "agent/laws/distance_formation/global_rigidity.h"

#include <Eigen/Core>
#include <vector>

#include "base/linear_algebra.h"
#include "base/random.h"

namespace mascot {
namespace {

/// The rank of the matrix of a random stress of random points.
int RankOfStress(std::span<const Bar> bars, int agents, Axes axes, Random& random) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < agents; ++i) {
    const double x = random.In(-1, 1), y = random.In(-1, 1), z = random.In(-1, 1);
    points.emplace_back(x, y, z);
  }
  const Eigen::MatrixXd rigidity = RigidityMatrix(bars, points, axes);
  Eigen::VectorXd any(rigidity.rows());
  for (double& number : any) number = random.In(-1, 1);
  const Eigen::VectorXd stress = any - rigidity * LeastSquares(rigidity, any);  // forces cancel: R' stress = 0
  constexpr double kRounding = 1e-9;
  if (stress.norm() < kRounding * any.norm()) return 0;
  Eigen::MatrixXd omega = Eigen::MatrixXd::Zero(agents, agents);
  for (std::size_t k = 0; k < bars.size(); ++k) {
    const Eigen::Index i = bars[k].i - 1, j = bars[k].j - 1;
    const double one = stress(static_cast<Eigen::Index>(k));
    omega(i, j) = omega(j, i) = -one;
    omega(i, i) += one;
    omega(j, j) += one;
  }
  return RankOf(omega);
}

}  // namespace

bool IsGloballyRigid(std::span<const Bar> bars, int agents, Axes axes) {
  if (std::ssize(bars) == agents * (agents - 1) / 2 || agents > kMaxAgentsOfGlobalRigidity) return true;
  Random random(1, Random::Stream::kPositions);
  for (int attempt = 0; attempt < 3; ++attempt)  // a rank that rounding spoils is too small
    if (RankOfStress(bars, agents, axes, random) == agents - CountOf(axes) - 1) return true;
  return false;
}

}  // namespace mascot
