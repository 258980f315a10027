#pragma once

#include <Eigen/Core>
#include <optional>

namespace mascot {

/// Above this many matrices, no positive definite one is sought among their combinations.
inline constexpr Eigen::Index kMaxCombined = 300;

struct DefiniteMatrix {
  std::optional<Eigen::MatrixXd> found;
  /// True: no combination has a smallest eigenvalue of more than 1e-7 of its mean eigenvalue. False, and nothing found:
  /// it is not known whether one has.
  bool none = false;
};

/// Seeks the linear combination of symmetric `size` x `size` matrices, linearly independent, one to a column of
/// `basis`, whose smallest eigenvalue is the largest share of their mean. It is found to a tenth of that eigenvalue.
DefiniteMatrix MostDefinite(const Eigen::MatrixXd& basis, Eigen::Index size);

}  // namespace mascot
