// Properties of the changes of frames, and values of published conversion tables.
#include "vehicle/frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "base/random.h"
#include "base/yaw.h"

namespace mascot {
namespace {

constexpr double kPi = std::numbers::pi, kTolerance = 1e-14;

Eigen::Vector3d AnyVector(Random& random) { return {random.In(-10, 10), random.In(-10, 10), random.In(-10, 10)}; }

Eigen::Quaterniond AnyOrientation(Random& random) {
  Eigen::Quaterniond q{random.In(-1, 1), random.In(-1, 1), random.In(-1, 1), random.In(-1, 1)};
  return q.normalized();
}

Eigen::Quaterniond FromYaw(double yaw_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
}

TEST(Frames, AxesAreThoseOfTheStandards) {
  const Eigen::Vector3d east = Eigen::Vector3d::UnitX(), north = Eigen::Vector3d::UnitY(),
                        up = Eigen::Vector3d::UnitZ();
  EXPECT_EQ(SwapWorldAxes(north), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(SwapWorldAxes(east), Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(SwapWorldAxes(up), Eigen::Vector3d(0, 0, -1));
  EXPECT_EQ(SwapBodyAxes({1, 2, 3}), Eigen::Vector3d(1, -2, -3));
}

TEST(Frames, ChangedTwiceAreAsBefore) {
  Random random(1, Random::Stream::kPositions);
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Vector3d v = AnyVector(random);
    const Eigen::Quaterniond q = AnyOrientation(random);
    EXPECT_EQ(SwapWorldAxes(SwapWorldAxes(v)), v);
    EXPECT_EQ(SwapBodyAxes(SwapBodyAxes(v)), v);
    EXPECT_TRUE(SwapOrientation(SwapOrientation(q)).coeffs().isApprox(q.coeffs(), kTolerance));
    const double yaw = random.In(-kPi, kPi);
    EXPECT_NEAR(std::remainder(SwapYaw(SwapYaw(yaw)) - yaw, 2 * kPi), 0, kTolerance);
  }
}

/// What is seen from the body does not depend on the names of the axes.
TEST(Frames, AVectorOfTheBodyIsTheSameInBothWorlds) {
  Random random(2, Random::Stream::kPositions);
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Quaterniond q_WB = AnyOrientation(random), q_NF = SwapOrientation(q_WB);
    const Eigen::Vector3d v_B = AnyVector(random);
    EXPECT_NEAR(q_NF.norm(), 1, kTolerance);
    EXPECT_TRUE((q_NF * SwapBodyAxes(v_B)).isApprox(SwapWorldAxes(q_WB * v_B), 1e-13));
  }
}

/// Level, by what the body faces: the values of PX4's and MAVROS's documentation.
TEST(Frames, OrientationsHaveThePublishedValues) {
  struct Row {
    double yaw_enu, yaw_ned;
    Eigen::Quaterniond q_NF;
  };
  const double r = std::sqrt(0.5);
  const std::vector<Row> rows = {{0, kPi / 2, {r, 0, 0, r}},      // east
                                 {kPi / 2, 0, {1, 0, 0, 0}},      // north
                                 {kPi, -kPi / 2, {r, 0, 0, -r}},  // west
                                 {-kPi / 2, kPi, {0, 0, 0, 1}}};  // south
  for (const Row& row : rows) {
    EXPECT_NEAR(std::remainder(SwapYaw(row.yaw_enu) - row.yaw_ned, 2 * kPi), 0, kTolerance) << row.yaw_enu;
    const Eigen::Quaterniond q_NF = SwapOrientation(FromYaw(row.yaw_enu));
    EXPECT_NEAR(std::abs(q_NF.dot(row.q_NF)), 1, kTolerance) << row.yaw_enu;
  }
}

/// Pitched up by ours is nose down by the right-hand rule about y left, and nose up about y right.
TEST(Frames, TiltKeepsItsSense) {
  const double angle = 0.3;
  const Eigen::Quaterniond nose_down_B(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  const Eigen::Quaterniond q_NF = SwapOrientation(FromYaw(kPi / 2) * nose_down_B);  // faces north
  const Eigen::Quaterniond expected(Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitY()));
  EXPECT_NEAR(std::abs(q_NF.dot(expected)), 1, kTolerance);
  EXPECT_GT((q_NF * Eigen::Vector3d::UnitX()).z(), 0) << "down is positive";
}

TEST(Frames, YawIsThatOfTheForwardAxis) {
  Random random(3, Random::Stream::kPositions);
  for (int k = 0; k < 1000; ++k) {
    const double yaw = random.In(-kPi, kPi), pitch = random.In(-1.5, 1.5), roll = random.In(-kPi, kPi);
    const Eigen::Quaterniond q = FromYaw(yaw) * Eigen::Quaterniond(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY())) *
                                 Eigen::Quaterniond(Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()));
    EXPECT_NEAR(YawOf(q), yaw, 1e-12);
  }
  EXPECT_EQ(YawOf({0, 0, 1, 0}), std::atan2(0.0, -1.0));
}

TEST(LocalFrame, GoesThereAndBack) {
  Random random(4, Random::Stream::kPositions);
  for (int k = 0; k < 1000; ++k) {
    const LocalFrame frame{.p_WL = AnyVector(random), .yaw_WL = random.In(-kPi, kPi)};
    const Motion motion{.p_WB = AnyVector(random),
                        .q_WB = AnyOrientation(random),
                        .v_WB = AnyVector(random),
                        .w_WB_B = AnyVector(random),
                        .a_WB = AnyVector(random)};
    const Motion back = frame.FromWorld(frame.ToWorld(motion));
    EXPECT_TRUE(back.p_WB.isApprox(motion.p_WB, 1e-12));
    EXPECT_TRUE(back.q_WB.coeffs().isApprox(motion.q_WB.coeffs(), 1e-12));
    EXPECT_TRUE(back.v_WB.isApprox(motion.v_WB, 1e-12));
    EXPECT_EQ(back.w_WB_B, motion.w_WB_B);
    EXPECT_TRUE(back.a_WB.isApprox(motion.a_WB, 1e-12));
  }
}

TEST(LocalFrame, IsTurnedAboutItsOrigin) {
  const LocalFrame frame{.p_WL = {10, 20, 1}, .yaw_WL = kPi / 2};
  const Motion in_W = frame.ToWorld({.p_WB = {2, 0, 3}, .v_WB = {1, 0, 0}});
  EXPECT_TRUE(in_W.p_WB.isApprox(Eigen::Vector3d(10, 22, 4), kTolerance));
  EXPECT_TRUE(in_W.v_WB.isApprox(Eigen::Vector3d(0, 1, 0), kTolerance));
  EXPECT_NEAR(YawOf(in_W.q_WB), kPi / 2, kTolerance);
}

}  // namespace
}  // namespace mascot
