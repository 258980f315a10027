// The nearest point in half-spaces, beside all subsets of active constraints tried one by one.
#include "agent/safety_qp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace mascot {
namespace {

constexpr double kTolerance = 1e-8;  // of the comparison; the numbers are of the order of 1 to 10

double WorstViolation(const std::vector<HalfSpace>& halves, const Eigen::Vector3d& u) {
  double worst = -std::numeric_limits<double>::infinity();
  for (const HalfSpace& half : halves) worst = std::max(worst, half.b - half.n.dot(u));
  return worst;
}

/// Brute force, in plain numbers: builds without optimisation run it, too.
class BruteForce {
 public:
  BruteForce(const std::vector<HalfSpace>& halves, const Eigen::Vector3d& wanted) : wanted_{Plain(wanted)} {
    for (const HalfSpace& half : halves) halves_.push_back({Plain(half.n), half.b});
    Consider(wanted_);
    for (std::size_t i = 0; i < halves_.size(); ++i) {
      OnOne(halves_[i]);
      for (std::size_t j = 0; j < i; ++j) {
        OnTwo(halves_[i], halves_[j]);
        for (std::size_t k = 0; k < j; ++k) OnThree(halves_[i], halves_[j], halves_[k]);
      }
    }
  }
  bool is_feasible() const { return std::isfinite(best2_); }
  /// The nearest point that is in all half-spaces, among those on the boundaries of up to three.
  Eigen::Vector3d best() const { return {best_.x, best_.y, best_.z}; }

 private:
  struct Point {
    double x, y, z;
  };
  struct Half {
    Point n;
    double b;
  };
  static Point Plain(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
  static double Dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static Point Cross(const Point& a, const Point& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  /// f a + g b + h c
  static Point Sum(double f, const Point& a, double g, const Point& b, double h, const Point& c) {
    return {f * a.x + g * b.x + h * c.x, f * a.y + g * b.y + h * c.y, f * a.z + g * b.z + h * c.z};
  }
  double Gap(const Half& half) const { return half.b - Dot(half.n, wanted_); }

  void Consider(const Point& u) {
    const Point way = Sum(1, u, -1, wanted_, 0, u);
    if (Dot(way, way) >= best2_) return;
    for (const Half& half : halves_)
      if (half.b - Dot(half.n, u) > 1e-9) return;
    best_ = u;
    best2_ = Dot(way, way);
  }
  void OnOne(const Half& a) { Consider(Sum(1, wanted_, Gap(a), a.n, 0, a.n)); }
  void OnTwo(const Half& a, const Half& b) {
    const double c = Dot(a.n, b.n), det = 1 - c * c;
    if (det > 1e-12) Consider(Sum(1, wanted_, (Gap(a) - c * Gap(b)) / det, a.n, (Gap(b) - c * Gap(a)) / det, b.n));
  }
  void OnThree(const Half& a, const Half& b, const Half& c) {
    const Point bc = Cross(b.n, c.n);
    const double det = Dot(a.n, bc);
    if (std::abs(det) > 1e-6) Consider(Sum(a.b / det, bc, b.b / det, Cross(c.n, a.n), c.b / det, Cross(a.n, b.n)));
  }

  Point wanted_;
  std::vector<Half> halves_;
  Point best_{};
  double best2_ = std::numeric_limits<double>::infinity();
};

/// A random problem in the plane or in space: a box, and half-spaces of which some are twice in it, are parallel, or
/// face each other.
struct RandomProblem {
  explicit RandomProblem(std::uint64_t seed) : random(seed) {
    const int axes = seed % 2 == 0 ? 2 : 3;
    for (int axis = 0; axis < axes; ++axis)
      for (const double sign : {1.0, -1.0}) halves.push_back({sign * Eigen::Vector3d::Unit(axis), -3});
    box = halves.size();
    const int count = static_cast<int>(random() % 6);
    for (int i = 0; i < count; ++i) halves.push_back(Another(axes));
    wanted = Vector(axes, 8);
  }

  HalfSpace Another(int axes) {
    const std::uint64_t kind = random() % 8;
    if (kind > 2 || halves.size() == box) return {Vector(axes, 1).normalized(), Number(4)};
    const HalfSpace& last = halves.back();
    if (kind == 0) return last;
    if (kind == 1) return {last.n, last.b + Number(1)};
    return {-last.n, -last.b + Number(1)};
  }
  double Number(double size) { return std::uniform_real_distribution(-size, size)(random); }
  Eigen::Vector3d Vector(int axes, double size) { return {Number(size), Number(size), axes == 3 ? Number(size) : 0}; }

  std::mt19937_64 random;
  std::vector<HalfSpace> halves;
  std::size_t box = 0;
  Eigen::Vector3d wanted;
};

TEST(SafetyQp, FindsTheNearestPointOrThatThereIsNoneAsBruteForceDoesIn10000RandomProblems) {
  int feasible = 0, infeasible = 0, untouched = 0;
  for (std::uint64_t seed = 0; seed < 10000; ++seed) {
    const RandomProblem problem(seed);
    const BruteForce expected(problem.halves, problem.wanted);
    const auto found = NearestIn(problem.halves, problem.wanted);
    ASSERT_EQ(found.has_value(), expected.is_feasible()) << "seed " << seed;
    ++(found ? feasible : infeasible);
    if (!found) continue;
    ASSERT_LT((*found - expected.best()).norm(), kTolerance) << "seed " << seed;
    ASSERT_LT(WorstViolation(problem.halves, *found), kTolerance) << "seed " << seed;
    untouched += *found == problem.wanted;
    EXPECT_EQ(IsIn(problem.halves, problem.wanted), *found == problem.wanted) << "seed " << seed;
  }
  EXPECT_GT(feasible, 3000);
  EXPECT_GT(infeasible, 1000);
  EXPECT_GT(untouched, 10);
}

TEST(SafetyQp, ViolatesInfeasibleHalfSpacesByTheLeastAndTheBoxNotAtAll) {
  int infeasible = 0;
  for (std::uint64_t seed = 0; seed < 10000; ++seed) {
    const RandomProblem problem(seed);
    const MinViolation found = NearestWithin(problem.halves, problem.box, problem.wanted);
    if (const auto nearest = NearestIn(problem.halves, problem.wanted)) {
      ASSERT_EQ(found.violation, 0);
      ASSERT_EQ(found.u, *nearest);
      continue;
    }
    ++infeasible;
    std::vector<HalfSpace> wider = problem.halves;
    for (std::size_t k = problem.box; k < wider.size(); ++k) wider[k].b -= found.violation;
    ASSERT_LT(WorstViolation(wider, found.u), kTolerance) << "seed " << seed;
    for (std::size_t k = problem.box; k < wider.size(); ++k) wider[k].b += 1e-6;
    ASSERT_FALSE(BruteForce(wider, problem.wanted).is_feasible()) << "seed " << seed << ": less would have done";
  }
  EXPECT_GT(infeasible, 1000);
}

TEST(SafetyQp, LeavesAlonePointsThatAreInAndStaysInThePlane) {
  const std::vector<HalfSpace> halves = {{{1, 0, 0}, -1}, {{-0.6, -0.8, 0}, -1}};
  const Eigen::Vector3d inside(0.1, 0.2, 0);
  EXPECT_EQ(*NearestIn(halves, inside), inside);
  const Eigen::Vector3d outside = *NearestIn(halves, {5, 7, 0});
  EXPECT_EQ(outside.z(), 0);
  EXPECT_NEAR(outside.x(), 5 - 0.6 * (0.6 * 5 + 0.8 * 7 - 1), 1e-12);
  EXPECT_NEAR(outside.y(), 7 - 0.8 * (0.6 * 5 + 0.8 * 7 - 1), 1e-12);
}

}  // namespace
}  // namespace mascot
