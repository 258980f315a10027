// min |u - w|^2 subject to n_k.u >= b_k; Goldfarb & Idnani, "A numerically stable dual method for solving strictly
// convex quadratic programs", Mathematical Programming 27 (1983). With the Hessian 1:
//   u starts at w, without active constraints. While some n_p.u < b_p (the most violated one):
//     z = n_p - N r is n_p without its components along the active normals N
//     go from u along z until n_p.u = b_p (step t2), but only until a multiplier lambda - t r of N becomes 0 (step t1)
//     t2 <= t1: p becomes active; else the constraint of that multiplier becomes inactive, and p is tried again
//     neither step has an end: the constraints contradict each other
// Each round raises |u - w|^2, the value of the dual, so that no active set returns.
#include "agent/safety_qp.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace mascot {
namespace {

constexpr double kTolerance = 1e-10;  // of half-spaces, relative to the size of the numbers
constexpr double kParallel = 1e-12;   // squared sine of the angle between a normal and the span of others
constexpr int kMaxRounds = 200;       // far more than problems in space take: a guard against rounding
constexpr int kMaxBisections = 200;   // of the least violation
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The active constraints: at most three, of linearly independent normals.
class ActiveSet {
 public:
  void Add(const Eigen::Vector3d& n, double multiplier) {
    n_[At(size_)] = n;
    multiplier_[At(size_)] = multiplier;
    ++size_;
  }
  void Remove(int i) {
    for (--size_; i < size_; ++i) {
      n_[At(i)] = n_[At(i + 1)];
      multiplier_[At(i)] = multiplier_[At(i + 1)];
    }
  }
  /// The step t after which the first of the multipliers lambda - t r is 0, and whose that is; infinite: none will be.
  std::pair<double, int> FirstToVanish(const std::array<double, 3>& r) const {
    std::pair<double, int> first{kInfinity, -1};
    for (int i = 0; i < size_; ++i)
      if (r[At(i)] > kParallel) first = std::min(first, {std::max(multiplier_[At(i)], 0.0) / r[At(i)], i});
    return first;
  }
  /// Takes t r from the multipliers.
  void Step(double t, const std::array<double, 3>& r) {
    for (int i = 0; i < size_; ++i) multiplier_[At(i)] -= t * r[At(i)];
  }
  /// `n` without its components along the active normals: z = n - sum r_i n_i, by orthonormalising these.
  Eigen::Vector3d Reduce(const Eigen::Vector3d& n, std::array<double, 3>& r) const {
    std::array<Eigen::Vector3d, 3> q;  // orthonormal; normal i is sum over k <= i of R_ki q_k
    double R[3][3] = {};
    for (int i = 0; i < size_; ++i) {
      Eigen::Vector3d rest = n_[At(i)];
      for (int k = 0; k < i; ++k) {
        R[k][i] = q[At(k)].dot(rest);
        rest -= R[k][i] * q[At(k)];
      }
      R[i][i] = rest.norm();
      q[At(i)] = rest / R[i][i];
    }
    Eigen::Vector3d z = n;
    std::array<double, 3> c{};
    for (int i = 0; i < size_; ++i) {
      c[At(i)] = q[At(i)].dot(z);
      z -= c[At(i)] * q[At(i)];
    }
    for (int i = size_ - 1; i >= 0; --i) {
      r[At(i)] = c[At(i)];
      for (int k = i + 1; k < size_; ++k) r[At(i)] -= R[i][k] * r[At(k)];
      r[At(i)] /= R[i][i];
    }
    return z;
  }

 private:
  static std::size_t At(int i) { return static_cast<std::size_t>(i); }
  int size_ = 0;
  std::array<Eigen::Vector3d, 3> n_;
  std::array<double, 3> multiplier_{};
};

/// The half-spaces, of which those from `kept` on are wider by `widened`.
struct Problem {
  std::span<const HalfSpace> halves;
  std::size_t kept = 0;
  double widened = 0;

  double b(std::size_t k) const { return k < kept ? halves[k].b : halves[k].b - widened; }
  double Violation(std::size_t k, const Eigen::Vector3d& u) const { return b(k) - halves[k].n.dot(u); }
  /// The half-space that `u` is outside of by most; absent: it is in all of them.
  std::optional<std::size_t> MostViolated(const Eigen::Vector3d& u) const {
    std::optional<std::size_t> worst;
    double most = 0;
    for (std::size_t k = 0; k < halves.size(); ++k) {
      const double violation = Violation(k, u), size = 1 + u.cwiseAbs().maxCoeff() + std::abs(b(k));
      if (violation <= std::max(most, kTolerance * size)) continue;
      most = violation;
      worst = k;
    }
    return worst;
  }
};

std::optional<Eigen::Vector3d> Solve(const Problem& problem, const Eigen::Vector3d& wanted) {
  Eigen::Vector3d u = wanted;
  ActiveSet active;
  std::optional<std::size_t> p = problem.MostViolated(u);
  double multiplier = 0;  // of p
  for (int round = 0; p && round < kMaxRounds; ++round) {
    const Eigen::Vector3d& n = problem.halves[*p].n;
    std::array<double, 3> r{};
    const Eigen::Vector3d z = active.Reduce(n, r);
    const double z2 = z.squaredNorm();
    const double t2 = z2 > kParallel ? problem.Violation(*p, u) / z2 : kInfinity;
    const auto [t1, leaves] = active.FirstToVanish(r);
    const double t = std::min(t1, t2);
    if (t == kInfinity) return std::nullopt;
    active.Step(t, r);
    multiplier += t;
    if (t2 < kInfinity) u += t * z;
    if (t1 < t2) {
      active.Remove(leaves);
      continue;
    }
    active.Add(n, multiplier);
    multiplier = 0;
    p = problem.MostViolated(u);
  }
  return p ? std::nullopt : std::optional(u);
}

}  // namespace

bool IsIn(std::span<const HalfSpace> halves, const Eigen::Vector3d& u) {
  return !Problem{.halves = halves}.MostViolated(u);
}

std::optional<Eigen::Vector3d> NearestIn(std::span<const HalfSpace> halves, const Eigen::Vector3d& wanted) {
  return Solve({.halves = halves}, wanted);
}

MinViolation NearestWithin(std::span<const HalfSpace> halves, std::size_t kept, const Eigen::Vector3d& wanted) {
  Problem problem{.halves = halves, .kept = kept};
  if (const auto u = Solve(problem, wanted)) return {*u, 0};
  const auto start = Solve({.halves = halves.first(kept), .kept = kept}, wanted);
  assert(start);
  MinViolation best{start.value_or(Eigen::Vector3d::Zero()), 0};
  for (std::size_t k = kept; k < halves.size(); ++k)
    best.violation = std::max(best.violation, problem.Violation(k, best.u));
  double too_narrow = 0;
  for (int i = 0; i < kMaxBisections && best.violation - too_narrow > kTolerance * (1 + best.violation); ++i) {
    problem.widened = too_narrow + (best.violation - too_narrow) / 2;
    if (const auto u = Solve(problem, wanted))
      best = {*u, problem.widened};
    else
      too_narrow = problem.widened;
  }
  return best;
}

}  // namespace mascot
