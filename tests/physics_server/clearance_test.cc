#include "physics_server/clearance.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace mascot {
namespace {

using Box = Clearance::Box;

Box At(double x, double y, double z, double half_m = 0.5) {
  const Eigen::Array3d centre(x, y, z);
  return {centre - half_m, centre + half_m};
}

Clearance Boxes(std::size_t count, std::vector<Box> fixed = {}, bool can_touch_each_other = true,
                bool can_touch_floor = true) {
  return Clearance({std::vector<bool>(count, can_touch_floor), can_touch_each_other, std::move(fixed)});
}

bool IsClear(Clearance clearance, const std::vector<Box>& boxes) {
  clearance.Look(boxes);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (clearance.MetSomething(i)) return false;
  return true;
}

TEST(Clearance, SeesBoxesThatMeet) {
  EXPECT_TRUE(IsClear(Boxes(2), {At(0, 0, 5), At(1.1, 0, 5)}));
  EXPECT_FALSE(IsClear(Boxes(2), {At(0, 0, 5), At(0.9, 0.9, 5.9)}));
  EXPECT_TRUE(IsClear(Boxes(2), {At(0, 0, 5), At(0.9, 0.9, 6.1)}));
  EXPECT_TRUE(IsClear(Boxes(2, {}, false), {At(0, 0, 5), At(0, 0, 5)})) << "they pass through each other";
}

TEST(Clearance, SeesTheFloorAndWhatIsFixed) {
  EXPECT_FALSE(IsClear(Boxes(1), {At(0, 0, 0.4)}));
  EXPECT_TRUE(IsClear(Boxes(1, {}, true, false), {At(0, 0, 0.4)}));
  EXPECT_FALSE(IsClear(Boxes(1, {At(0, 0, 5)}), {At(0.9, 0, 5)}));
  EXPECT_TRUE(IsClear(Boxes(1, {At(0, 0, 5)}), {At(1.1, 0, 5)}));
}

TEST(Clearance, SeesABodyComeAndGo) {
  Clearance clearance = Boxes(3);
  for (int step = 0; step <= 400; ++step) {
    const double x = -2 + 0.01 * step;
    const bool meets = std::abs(x) < 1;
    if (std::abs(std::abs(x) - 1) < 1e-9) continue;
    clearance.Look(std::vector{At(x, 0, 5), At(0, 0, 5), At(0, 3, 5)});
    EXPECT_EQ(clearance.MetSomething(0), meets) << x;
    EXPECT_EQ(clearance.MetSomething(1), meets) << x;
    EXPECT_FALSE(clearance.MetSomething(2)) << x;
  }
}

TEST(Clearance, ComparesAgainOnlyWhatMet) {
  Clearance clearance = Boxes(4, {At(10, 0, 5)});
  const std::vector<Box> boxes = {At(0, 0, 5), At(0.9, 0, 5), At(9.1, 0, 5), At(-5, 0, 0.4)};
  clearance.Look(boxes);
  EXPECT_TRUE(clearance.DoMeet(boxes));
  const std::vector<Box> apart = {At(-0.2, 0, 5), At(1, 0, 5), At(8.9, 0, 5), At(-5, 0, 0.6)};
  EXPECT_FALSE(clearance.DoMeet(apart));
  for (std::size_t i = 1; i < apart.size(); ++i) {
    std::vector<Box> one = apart;
    one[i] = boxes[i];
    EXPECT_EQ(clearance.DoMeet(one), i > 1) << i;
  }
  clearance.Look(apart);
  EXPECT_FALSE(clearance.DoMeet(boxes)) << "these did not meet";
}

TEST(Clearance, TakesInfiniteBoxes) {
  Clearance clearance = Boxes(2);
  const Eigen::Array3d infinite = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity());
  clearance.Look(std::vector{At(0, 0, 5), At(100, 0, 5)});
  clearance.Look(std::vector{At(0, 0, 5), Box{-infinite, infinite}});
  EXPECT_TRUE(clearance.MetSomething(0) && clearance.MetSomething(1));
  clearance.Look(std::vector{At(0, 0, 5), At(100, 0, 5)});
  EXPECT_FALSE(clearance.MetSomething(0) || clearance.MetSomething(1));
}

/// Random walks, looked at in every step, beside a comparison of all pairs.
TEST(Clearance, AgreesWithComparingAllPairs) {
  const auto meet = [](const Box& a, const Box& b) { return (a.low <= b.high).all() && (b.low <= a.high).all(); };
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(-4, 4), move(-0.05, 0.05), size(0.02, 0.4);
  int apart = 0, met = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const std::vector<Box> fixed = {At(place(random), place(random), place(random), size(random))};
    std::vector<Eigen::Array3d> at(8);
    std::vector<double> half_m(at.size());
    for (std::size_t i = 0; i < at.size(); ++i) {
      at[i] = {place(random), place(random), 4 + place(random)};
      half_m[i] = size(random);
    }
    Clearance clearance = Boxes(at.size(), fixed);
    for (int step = 0; step < 300; ++step) {
      std::vector<Box> boxes;
      for (std::size_t i = 0; i < at.size(); ++i) {
        at[i] += Eigen::Array3d(move(random), move(random), move(random));
        boxes.push_back(At(at[i].x(), at[i].y(), at[i].z(), half_m[i]));
      }
      clearance.Look(boxes);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        bool meets = boxes[i].low.z() <= 0 || meet(boxes[i], fixed[0]);
        for (std::size_t j = 0; j < boxes.size(); ++j) meets = meets || (j != i && meet(boxes[i], boxes[j]));
        ASSERT_EQ(clearance.MetSomething(i), meets) << "trial " << trial << ", step " << step << ", body " << i;
        ++(meets ? met : apart);
      }
    }
  }
  EXPECT_GT(apart, 10'000);
  EXPECT_GT(met, 2000);
}

}  // namespace
}  // namespace mascot
