#pragma once

#include <Eigen/Core>

namespace mascot {

// What Eigen's solvers answer for dense matrices of any size. They are compiled once, in linear_algebra.cc: every other
// file that named them would spend ten seconds of compiling on it.

/// The eigenvalues of a square matrix, in the order in which the solver finds them.
Eigen::VectorXcd Eigenvalues(const Eigen::MatrixXd& matrix);
Eigen::VectorXcd Eigenvalues(const Eigen::MatrixXcd& matrix);
/// The eigenvalues of a symmetric matrix, in increasing order; reads the lower triangle only.
Eigen::VectorXd SymmetricEigenvalues(const Eigen::MatrixXd& matrix);

struct Eigensystem {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;  // column k belongs to values(k)
};
Eigensystem EigensystemOf(const Eigen::MatrixXd& matrix);
struct SymmetricEigensystem {
  Eigen::VectorXd values;   // in increasing order
  Eigen::MatrixXd vectors;  // orthonormal; column k belongs to values(k)
};
/// For a symmetric matrix, of which only the lower triangle is read.
SymmetricEigensystem SymmetricEigensystemOf(const Eigen::MatrixXd& matrix);

/// The solution x of matrix x = right, for an invertible matrix.
Eigen::VectorXd Solve(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);
/// The solution X of matrix X = right, for an invertible matrix: column k of X is that of column k of `right`.
Eigen::MatrixXd SolveColumns(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);
/// The x with the smallest |matrix x - right|.
Eigen::VectorXd LeastSquares(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);
/// The number of independent rows, where 1e-9 of the largest pivot counts as 0.
int RankOf(const Eigen::MatrixXd& matrix);

}  // namespace mascot
