// The commander of a simulated Crazyflie, in a time of its own.
#include "orchestrator/crazyswarm/commander.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mascot::crazyswarm {
namespace {

using Eigen::Vector3d;

const Vector3d kGround(1, 2, 0.05);

Commander Flying() {
  Commander commander(kGround);
  commander.TakeOff(1, 2, kGround, 0);
  return commander;
}

TEST(Commander, TakesOffFromRestToRest) {
  Commander commander(kGround);
  EXPECT_FALSE(commander.At(0)) << "its motors stand";
  commander.TakeOff(1, 2, kGround, 10);
  EXPECT_TRUE(commander.is_flying());
  const auto begin = *commander.At(10), middle = *commander.At(11), end = *commander.At(12), later = *commander.At(99);
  EXPECT_EQ(begin.p_W, kGround);
  EXPECT_EQ(begin.v_W, Vector3d::Zero().eval());
  EXPECT_NEAR(middle.p_W.z(), (kGround.z() + 1) / 2, 1e-12);
  EXPECT_NEAR(middle.v_W.z(), 15.0 / 8 * (1 - kGround.z()) / 2, 1e-12) << "of 10 s^3 - 15 s^4 + 6 s^5";
  EXPECT_TRUE(end.p_W.isApprox(Vector3d(1, 2, 1), 1e-12));
  EXPECT_NEAR(end.v_W.norm() + end.a_W.norm(), 0, 1e-12);
  EXPECT_TRUE(later.p_W.isApprox(Vector3d(1, 2, 1), 1e-12));
}

TEST(Commander, VelocityAndAccelerationAreDerivatives) {
  Commander commander = Flying();
  commander.GoTo({3, -1, 2}, false, 4, {1, 2, 1}, 10);
  constexpr double h = 1e-4;
  for (double t = 10.1; t < 13.9; t += 0.3) {
    const auto before = *commander.At(t - h), now = *commander.At(t), after = *commander.At(t + h);
    EXPECT_LT((now.v_W - (after.p_W - before.p_W) / (2 * h)).norm(), 1e-6);
    EXPECT_LT((now.a_W - (after.v_W - before.v_W) / (2 * h)).norm(), 1e-6);
  }
  EXPECT_TRUE(commander.At(14)->p_W.isApprox(Vector3d(3, -1, 2), 1e-12));
  commander.GoTo({1, 1, 0}, true, 1, {3, -1, 2}, 20);
  EXPECT_TRUE(commander.At(21)->p_W.isApprox(Vector3d(4, 0, 2), 1e-12));
}

TEST(Commander, StopsItsMotorsAtTheEndOfALanding) {
  Commander commander = Flying();
  commander.Land(0.05, 2, {1, 2, 1}, 10);
  EXPECT_TRUE(commander.At(11.9));
  EXPECT_FALSE(commander.At(12));
  EXPECT_FALSE(commander.is_flying());
  commander.GoTo({0, 0, 1}, false, 1, kGround, 13);
  EXPECT_FALSE(commander.At(13.5)) << "it has to take off first";
}

TEST(Commander, WhatIsStreamedComesFirstAndEndsAsInTheFirmware) {
  Commander commander = Flying();
  const Vector3d place(5, 5, 1);
  commander.Stream({place, Vector3d::Zero(), Vector3d::Zero()}, 10);
  EXPECT_EQ(commander.At(10.5)->p_W, place);
  const auto level = *commander.At(10.51);
  EXPECT_TRUE(level.p_W.array().isNaN().all());
  EXPECT_EQ(level.a_W, Vector3d::Zero().eval());
  EXPECT_FALSE(commander.At(12.01));
  EXPECT_TRUE(commander.is_locked());
  commander.TakeOff(1, 1, kGround, 13);
  EXPECT_FALSE(commander.At(13.5)) << "locked";
}

TEST(Commander, AfterNotifySetpointsStopOrdersHold) {
  Commander commander = Flying();
  const Vector3d place(5, 5, 1);
  commander.Stream({place, Vector3d::Zero(), Vector3d::Zero()}, 10);
  commander.GoTo({0, 0, 1}, false, 1, place, 10.1);
  EXPECT_EQ(commander.At(10.3)->p_W, place) << "what is streamed comes first";
  commander.NotifySetpointsStop({5.1, 5, 1}, 10.3);
  EXPECT_EQ(commander.At(30)->p_W, place) << "it stays where it was";
  commander.Land(0.05, 1, place, 31);
  EXPECT_FALSE(commander.At(32));
}

TEST(Commander, AfterNotifySetpointsStopItStaysWhereItIsWhateverWasAskedBefore) {
  const Vector3d free = Vector3d::Constant(std::nan("")), there(3, 0, 1);
  Commander commander = Flying();
  commander.Land(0.05, 1, {0, 0, 1}, 10);
  commander.Stream({free, Vector3d(1, 0, 0), Vector3d::Zero()}, 10.5);  // before it is down; by velocity
  commander.NotifySetpointsStop(there, 11);
  for (const double now : {11.0, 12.0, 30.0}) {
    ASSERT_TRUE(commander.At(now)) << "it does not land";
    EXPECT_EQ(commander.At(now)->p_W, there);
  }
}

TEST(Commander, OnceInAnEmergencyItDoesNotFlyAgain) {
  Commander commander = Flying();
  commander.Emergency();
  EXPECT_FALSE(commander.At(1));
  EXPECT_FALSE(commander.is_armed());
  commander.Arm(true);
  EXPECT_FALSE(commander.is_armed());
  commander.Stream({kGround, kGround, kGround}, 2);
  EXPECT_FALSE(commander.At(2));
}

/// x = t^2 for 2 s, then x = 4 + 4 t for 1 s.
Trajectory Ahead() {
  Trajectory::Piece first, second;
  first.axes[0][2] = 1;
  first.duration_s = 2;
  second.axes[0][0] = 4;
  second.axes[0][1] = 4;
  second.duration_s = 1;
  return Trajectory({first, second});
}

TEST(Trajectory, IsItsPolynomialsOneAfterTheOther) {
  const Trajectory ahead = Ahead();
  EXPECT_EQ(ahead.duration_s(), 3);
  EXPECT_NEAR(ahead.At(1.5).p.x(), 2.25, 1e-12);
  EXPECT_NEAR(ahead.At(1.5).v.x(), 3, 1e-12);
  EXPECT_NEAR(ahead.At(1.5).a.x(), 2, 1e-12);
  EXPECT_NEAR(ahead.At(2.5).p.x(), 6, 1e-12);
  EXPECT_NEAR(ahead.At(2.5).v.x(), 4, 1e-12);
  EXPECT_NEAR(ahead.At(-1).p.x(), 0, 1e-12);
  EXPECT_NEAR(ahead.At(9).p.x(), 8, 1e-12);
  EXPECT_EQ(ahead.At(9).v, Vector3d::Zero().eval()) << "it rests there";
}

TEST(Commander, FollowsATrajectoryInItsOwnTime) {
  Commander commander = Flying();
  commander.Follow(Ahead(), 2, false, false, {0, 0, 1}, 10);
  EXPECT_NEAR(commander.At(13)->p_W.x(), 2.25, 1e-12) << "half as fast";
  EXPECT_NEAR(commander.At(13)->v_W.x(), 1.5, 1e-12);
  EXPECT_NEAR(commander.At(13)->a_W.x(), 0.5, 1e-12);
  commander.Follow(Ahead(), 1, true, true, {1, 1, 1}, 20);
  EXPECT_TRUE(commander.At(20)->p_W.isApprox(Vector3d(1, 1, 1), 1e-12)) << "from where it is";
  EXPECT_TRUE(commander.At(23)->p_W.isApprox(Vector3d(-7, 1, 1), 1e-12)) << "backwards";
  EXPECT_NEAR(commander.At(20.5)->v_W.x(), -4, 1e-12);
}

}  // namespace
}  // namespace mascot::crazyswarm
