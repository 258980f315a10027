#include "physics_server/clearance.h"

#include <gtest/gtest.h>

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

TEST(Clearance, SeesBoxesThatMeet) {
  EXPECT_TRUE(Boxes(2).IsClear(std::vector{At(0, 0, 5), At(1.1, 0, 5)}));
  EXPECT_FALSE(Boxes(2).IsClear(std::vector{At(0, 0, 5), At(0.9, 0.9, 5.9)}));
  EXPECT_TRUE(Boxes(2).IsClear(std::vector{At(0, 0, 5), At(0.9, 0.9, 6.1)}));
  EXPECT_TRUE(Boxes(2, {}, false).IsClear(std::vector{At(0, 0, 5), At(0, 0, 5)})) << "they pass through each other";
}

TEST(Clearance, SeesTheFloorAndWhatIsFixed) {
  EXPECT_FALSE(Boxes(1).IsClear(std::vector{At(0, 0, 0.4)}));
  EXPECT_TRUE(Boxes(1, {}, true, false).IsClear(std::vector{At(0, 0, 0.4)}));
  EXPECT_FALSE(Boxes(1, {At(0, 0, 5)}).IsClear(std::vector{At(0.9, 0, 5)}));
  EXPECT_TRUE(Boxes(1, {At(0, 0, 5)}).IsClear(std::vector{At(1.1, 0, 5)}));
}

TEST(Clearance, SeesABodyComeAndGo) {
  Clearance clearance = Boxes(2);
  for (int step = 0; step <= 400; ++step) {
    const double x = -2 + 0.01 * step;
    const bool meets = std::abs(x) < 1;
    if (std::abs(std::abs(x) - 1) > 1e-9) {
      EXPECT_EQ(clearance.IsClear(std::vector{At(x, 0, 5), At(0, 0, 5)}), !meets) << x;
    }
  }
}

/// Random walks, checked at every step: "not clear" if and only if boxes meet each other or the floor.
TEST(Clearance, AgreesWithComparingAllPairs) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(-4, 4), move(-0.05, 0.05), size(0.02, 0.4);
  int clear = 0, not_clear = 0;
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
      const auto meet = [](const Box& a, const Box& b) { return (a.low <= b.high).all() && (b.low <= a.high).all(); };
      bool any = false;
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        any = any || boxes[i].low.z() <= 0 || meet(boxes[i], fixed[0]);
        for (std::size_t j = 0; j < i; ++j) any = any || meet(boxes[i], boxes[j]);
      }
      ASSERT_EQ(clearance.IsClear(boxes), !any);
      ++(any ? not_clear : clear);
    }
  }
  EXPECT_GT(clear, 1000);
  EXPECT_GT(not_clear, 1000);
}

}  // namespace
}  // namespace mascot
