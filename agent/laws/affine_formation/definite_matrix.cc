// A semidefinite program, by an interior point method; Vandenberghe & Boyd, "Semidefinite programming", SIAM Review 38
// (1996), section 5: maximise t so that S = X - t I >= 0, X a combination of trace m, the size. On the central path,
// the minima of -t / mu - log det S, the matrix Y = mu S^-1 has the trace 1 and <Y, D> = 0 for all combinations D of
// trace 0. So t <= <Y, X> of any X, which there is t + m mu: a proof that no X does better.
#include "agent/laws/affine_formation/definite_matrix.h"

#include <cmath>

#include "base/linear_algebra.h"

namespace mascot {
namespace {

constexpr double kMinEigenvalue = 1e-7;  // of a mean one of 1
constexpr int kMaxNewtonSteps = 2000;

/// Orthonormal columns that are orthogonal to `a`, which is not 0.
Eigen::MatrixXd Across(const Eigen::VectorXd& a) {
  const Eigen::MatrixXd projection =
      Eigen::MatrixXd::Identity(a.size(), a.size()) - a * a.transpose() / a.squaredNorm();
  return SymmetricEigensystemOf(projection).vectors.rightCols(a.size() - 1);
}

/// S, and the directions in which it may change: all combinations of trace 0, and -I.
class Barrier {
 public:
  Barrier(Eigen::MatrixXd s, Eigen::MatrixXd directions) : s_(std::move(s)), directions_(std::move(directions)) {}

  /// A step of Newton's towards the central path at `mu`. Returns what t grew by, and in `decrement` how far from the
  /// path it began.
  double Step(double mu, double& decrement) {
    const Eigen::Index size = s_.rows(), last = directions_.cols() - 1;
    const SymmetricEigensystem system = SymmetricEigensystemOf(s_);
    const Eigen::MatrixXd root = system.vectors * system.values.cwiseSqrt().cwiseInverse().asDiagonal();
    Eigen::MatrixXd relative(directions_.rows(), directions_.cols());  // S^-1/2 D S^-1/2
    Eigen::VectorXd descent(directions_.cols());                       // minus the gradient
    for (Eigen::Index k = 0; k <= last; ++k) {
      const Eigen::MatrixXd one = root.transpose() * directions_.col(k).reshaped(size, size) * root;
      relative.col(k) = one.reshaped();
      descent(k) = one.trace();
    }
    descent(last) += 1 / mu;
    const Eigen::VectorXd step = Solve(relative.transpose() * relative, descent);
    decrement = std::sqrt(std::max(0.0, step.dot(descent)));
    const double damped = decrement < 0.25 ? 1 : 1 / (1 + decrement);  // S stays positive definite
    s_.reshaped() += damped * directions_ * step;
    s_ = (s_ + s_.transpose()) / 2;
    return damped * step(last);
  }
  const Eigen::MatrixXd& s() const { return s_; }

 private:
  Eigen::MatrixXd s_, directions_;
};

}  // namespace

DefiniteMatrix MostDefinite(const Eigen::MatrixXd& basis, Eigen::Index size) {
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(size, size);
  if (basis.cols() == 0) return {.found = std::nullopt, .none = true};
  if (basis.cols() > kMaxCombined) return {};
  const Eigen::VectorXd traces = basis.transpose() * identity.reshaped();
  const auto m = static_cast<double>(size);
  if (traces.norm() < 1e-12 * basis.norm()) return {.found = std::nullopt, .none = true};  // all have the trace 0
  Eigen::MatrixXd x = (basis * traces * m / traces.squaredNorm()).reshaped(size, size);
  x = (x + x.transpose()).eval() / 2;
  Eigen::MatrixXd directions(basis.rows(), basis.cols());
  directions << basis * Across(traces), -identity.reshaped();

  double t = SymmetricEigenvalues(x).minCoeff() - 1, mu = 1, decrement = 0;
  Barrier barrier(x - t * identity, std::move(directions));
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    t += barrier.Step(mu, decrement);
    if (!std::isfinite(t)) return {};
    if (decrement > 1e-3) continue;
    if (t > kMinEigenvalue && m * mu < 0.1 * t) return {.found = barrier.s() + t * identity, .none = false};
    if (t + 2 * m * mu < kMinEigenvalue) return {.found = std::nullopt, .none = true};
    mu /= 5;
  }
  return {};
}

}  // namespace mascot
