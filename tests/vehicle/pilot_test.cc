// A pilot flies a vehicle that is an ideal point: it is where its set-point is, a moment later.
#include "vehicle/pilot.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mascot {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using Time = Pilot::Time;

constexpr auto kStep = 20ms;

class PilotTest : public testing::Test {
 protected:
  PilotTest() {
    report_.release = "PX4 1.15";
    report_.motion_L = Motion{};
    rules_.start_W = {1, 2, 1.5};
    rules_.frame.p_WL = {1, 2, 0};
  }

  /// Another vehicle on the ground, and another pilot.
  void SetUpAnew() {
    pilot_.reset();
    motion_L_ = Motion{};
    report_ = VehicleReport{.release = "PX4 1.15", .motion_L = Motion{}};
    a_W_.setZero();
    words_.clear();
    agent_flies_ = false;
    tracks_ = true;
    tick_ = 0;
  }
  Pilot& pilot() {
    if (!pilot_) pilot_.emplace(rules_);
    return *pilot_;
  }
  /// One step of time: the vehicle is heard, the pilot looks, and the vehicle does what it is told.
  void Step() {
    now_ += kStep;
    if (is_heard_) {
      report_.measured_at = report_.status_at = now_;
      report_.motion_L = motion_L_;
      report_.motion_L->p_WB += offset_L_;
    }
    if (agent_flies_) pilot().Command(tick_++, a_W_, now_);
    const Pilot::Turn turn = pilot().Look(report_, now_);
    for (std::string& words : pilot().TakeWords()) words_.push_back(std::move(words));
    Obey(turn);
  }
  void Obey(const Pilot::Turn& turn) {
    setpoint_ = turn.setpoint;
    if (setpoint_) last_setpoint_ = now_;
    if (report_.follows && now_ - last_setpoint_ > 1s) report_.follows = false;
    if (turn.order) orders_.push_back(*turn.order);
    if (turn.order == VehicleOrder::kFollow && obeys_) report_.follows = true;
    if (turn.order == VehicleOrder::kArm && obeys_) {
      EXPECT_TRUE(report_.follows);
      report_.is_armed = true;
    }
    if (turn.order == VehicleOrder::kStopMotors && stops_motors_) report_.is_armed = false;
    if (turn.order == VehicleOrder::kLand && obeys_) {
      report_.is_landing = true;
      report_.follows = false;
    }
    if (report_.is_landing) motion_L_.p_WB.z() = std::max(0.0, motion_L_.p_WB.z() - 0.02);
    if (report_.is_armed && report_.follows && setpoint_ && setpoint_->p_L.allFinite() && tracks_)
      motion_L_.p_WB = setpoint_->p_L - offset_L_;
    report_.is_on_ground = motion_L_.p_WB.z() <= 0;
    if (report_.is_landing && report_.is_on_ground) report_.is_armed = false;
  }
  /// Steps until the phase, at most `limit`.
  [[nodiscard]] bool Until(FlightPhase phase, std::chrono::milliseconds limit = 30s) {
    for (const Time end = now_ + limit; now_ < end && pilot().phase() != phase;) Step();
    return pilot().phase() == phase;
  }
  void For(std::chrono::milliseconds time) {
    for (const Time end = now_ + time; now_ < end;) Step();
  }
  [[nodiscard]] bool UntilFlying() {
    Step();
    pilot().Start();
    if (!Until(FlightPhase::kReady)) return false;
    agent_flies_ = true;
    return Until(FlightPhase::kFlying);
  }

  PilotRules rules_ = {.rate_hz = 50};
  std::optional<Pilot> pilot_;
  VehicleReport report_;
  Motion motion_L_;
  Eigen::Vector3d offset_L_ = Eigen::Vector3d::Zero(), a_W_ = Eigen::Vector3d::Zero();
  bool is_heard_ = true, obeys_ = true, tracks_ = true, agent_flies_ = false, stops_motors_ = true;
  std::int64_t tick_ = 0;
  std::optional<VehicleSetpoint> setpoint_;
  Time now_ = Time(1h), last_setpoint_ = now_;
  std::vector<VehicleOrder> orders_;
  std::vector<std::string> words_;
};

TEST_F(PilotTest, FliesFromTheGroundToItsStartAndBack) {
  Step();
  EXPECT_EQ(pilot().phase(), FlightPhase::kFound);
  EXPECT_THAT(words_, Contains("found: PX4 1.15, at [1.00, 2.00, 0.00]"));
  For(5s);
  EXPECT_EQ(pilot().phase(), FlightPhase::kFound) << "nothing arms before somebody says so";
  EXPECT_FALSE(setpoint_);
  EXPECT_TRUE(orders_.empty());
  pilot().Start();
  ASSERT_TRUE(Until(FlightPhase::kReady));
  EXPECT_TRUE(pilot().motion_W()->p_WB.isApprox(rules_.start_W, 1e-9));
  EXPECT_EQ(orders_, (std::vector{VehicleOrder::kFollow, VehicleOrder::kArm}));
  For(10s);
  EXPECT_EQ(pilot().phase(), FlightPhase::kReady) << "it waits for its agent";
  agent_flies_ = true;
  a_W_ = {0.1, 0, 0};
  ASSERT_TRUE(Until(FlightPhase::kFlying));
  For(2s);
  const double t_s = static_cast<double>(tick_ - 1) / 50;
  EXPECT_NEAR(pilot().reference().p_W().x(), 1 + 0.1 * t_s * t_s / 2, 1e-12);
  pilot().Land("the run is over");
  ASSERT_TRUE(Until(FlightPhase::kLanded));
  EXPECT_THAT(words_, Contains("landing: the run is over"));
  For(5s);
  EXPECT_FALSE(setpoint_);
  EXPECT_EQ(std::ranges::count(orders_, VehicleOrder::kLand), 1);
}

TEST_F(PilotTest, SetpointsComeBeforeOrders) {
  Step();
  pilot().Start();
  const Time begin = now_;
  while (orders_.empty()) {
    Step();
    ASSERT_TRUE(setpoint_);
  }
  EXPECT_GE(now_ - begin, Pilot::kStreamFirst);
}

TEST_F(PilotTest, AnOrderThatIsNotFollowedIsRepeatedAndGivenUpInWords) {
  obeys_ = false;
  Step();
  pilot().Start();
  ASSERT_TRUE(Until(FlightPhase::kStreaming));
  ASSERT_TRUE(Until(FlightPhase::kFound));
  EXPECT_NEAR(static_cast<double>(orders_.size()), Pilot::kObeyWithin / Pilot::kAskEvery, 2);
  EXPECT_THAT(
      words_,
      Contains("found: it does not follow set-points: it has not answered (is system_id right? does it hear us?)"));
  report_.follows = true;
  report_.refusal = "arming is denied";
  pilot().Start();
  ASSERT_TRUE(Until(FlightPhase::kStreaming));
  For(1s);
  report_.follows = true;
  ASSERT_TRUE(Until(FlightPhase::kFound));
  EXPECT_THAT(words_, Contains(HasSubstr("found: it does not ")));
  EXPECT_THAT(words_.back(), HasSubstr(": arming is denied"));
}

TEST_F(PilotTest, AVehicleThatIsNotAtItsStartDoesNotStart) {
  offset_L_ = {4, 0, 0};  // the origin of its frame is not that of the file
  Step();
  pilot().Start();
  For(3s);
  EXPECT_EQ(words_.back(),
            "it does not start: it is 4.00 m from its start, and 0.5 m are allowed: is its origin that of the file?");
  EXPECT_EQ(pilot().phase(), FlightPhase::kFound);
}

TEST_F(PilotTest, OneThatArmsItselfMayBeArmed) {
  rules_.arms_itself = true;
  report_.is_armed = report_.follows = true;
  EXPECT_TRUE(UntilFlying());
}

TEST_F(PilotTest, WhatMayNotFlyDoesNotStart) {
  struct Row {
    std::string problem;
    std::optional<double> battery;
    bool is_armed;
    std::string words;
  };
  for (const Row& row : {Row{"its heading is unknown", {}, false, "it does not start: its heading is unknown"},
                         Row{"", 0.25, false, "it does not start: its battery is at 25 %, and 30 % are wanted"},
                         Row{"", {}, true, "it does not start: it is armed already"}}) {
    report_.problem = row.problem;
    report_.battery = row.battery;
    report_.is_armed = row.is_armed;
    Step();
    pilot().Start();
    For(3s);
    EXPECT_EQ(words_.back(), row.words);
    EXPECT_EQ(pilot().phase(), FlightPhase::kFound);
  }
  EXPECT_TRUE(orders_.empty());
}

TEST_F(PilotTest, LandsBeyondItsFence) {
  rules_.fence = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -1, 0), Eigen::Vector3d(2, 3, 3));
  a_W_ = {0.5, 0, 0};
  ASSERT_TRUE(UntilFlying());
  ASSERT_TRUE(Until(FlightPhase::kLanded));
  EXPECT_THAT(words_, Contains(HasSubstr("landing: it is beyond its fence, at [2.0")));
}

TEST_F(PilotTest, ComesToAStopBeforeItLands) {
  a_W_ = {0.5, 0, 0};
  ASSERT_TRUE(UntilFlying());
  For(4s);
  motion_L_.v_WB = {2, 0, 0};
  const double x_m = motion_L_.p_WB.x();
  const auto orders = orders_.size();
  pilot().Land("asked to land");
  ASSERT_TRUE(Until(FlightPhase::kLanding));
  For(1900ms);
  EXPECT_EQ(orders_.size(), orders) << "it slows down";
  EXPECT_NEAR(setpoint_->v_L.x(), 0.1, 0.05);
  ASSERT_TRUE(Until(FlightPhase::kLanded));
  EXPECT_EQ(orders_.back(), VehicleOrder::kLand);
  EXPECT_NEAR(motion_L_.p_WB.x() - x_m, 2, 0.1) << "v^2 / 2a at 1 m/s^2";
}

TEST_F(PilotTest, ThatMoreThanItsPlaceIsMissingIsTold) {
  is_heard_ = false;
  report_.motion_L.reset();
  report_.problem = "its heading is unknown";
  For(2s);
  EXPECT_EQ(words_, std::vector<std::string>{"absent: its heading is unknown"}) << "once";
  EXPECT_EQ(pilot().phase(), FlightPhase::kAbsent);
}

TEST_F(PilotTest, LandsFarFromItsReferenceWhateverItIsSent) {
  for (const SetpointKind kind : {SetpointKind::kReference, SetpointKind::kAcceleration, SetpointKind::kVelocity}) {
    SetUpAnew();
    rules_.setpoint = kind;
    ASSERT_TRUE(UntilFlying());
    For(1s);
    tracks_ = false;
    a_W_ = {0, 1, 0};
    ASSERT_TRUE(Until(FlightPhase::kLanding));
    EXPECT_THAT(words_, Contains(HasSubstr("m from its reference")));
  }
}

TEST_F(PilotTest, LandsWithALowBattery) {
  report_.battery = 0.9;
  ASSERT_TRUE(UntilFlying());
  report_.battery = 0.14;
  ASSERT_TRUE(Until(FlightPhase::kLanded));
  EXPECT_THAT(words_, Contains("landing: its battery is at 14 %"));
}

TEST_F(PilotTest, IsLostWhenNothingIsHeardAndThenNothingIsSent) {
  ASSERT_TRUE(UntilFlying());
  is_heard_ = false;
  ASSERT_TRUE(Until(FlightPhase::kLost));
  EXPECT_THAT(words_, Contains("lost: nothing has been heard of where it is for 1.0 s"));
  const auto orders = orders_.size();
  For(30s);
  is_heard_ = true;
  For(5s);
  EXPECT_EQ(pilot().phase(), FlightPhase::kLost) << "its autopilot has decided";
  EXPECT_FALSE(setpoint_);
  EXPECT_EQ(orders_.size(), orders);
}

TEST_F(PilotTest, IsLostWhenSomebodyElseTakesOver) {
  ASSERT_TRUE(UntilFlying());
  report_.follows = false;
  Step();
  EXPECT_EQ(pilot().phase(), FlightPhase::kLost);
  EXPECT_FALSE(setpoint_);
  EXPECT_THAT(words_, Contains("lost: it follows no set-points any more: a pilot or its own failsafe has taken over"));
}

TEST_F(PilotTest, AFrozenAgentLeavesTheVehicleToItsOwnFailsafe) {
  ASSERT_TRUE(UntilFlying());
  agent_flies_ = false;
  For(700ms);
  EXPECT_FALSE(setpoint_);
  EXPECT_THAT(words_, Contains("its agent has not commanded for 0.5 s: nothing is sent until it does"));
  agent_flies_ = true;
  Step();
  EXPECT_TRUE(setpoint_) << "it was a short one";
  EXPECT_THAT(words_, Contains("its agent commands again"));
  agent_flies_ = false;
  ASSERT_TRUE(Until(FlightPhase::kLost));
}

TEST_F(PilotTest, AJumpOfTheEstimatorMovesNothing) {
  ASSERT_TRUE(UntilFlying());
  const Eigen::Vector3d before_W = pilot().motion_W()->p_WB, jump(0.5, -3, 0.25);
  offset_L_ += jump;  // it says so of the same place
  ++report_.resets;
  Step();
  EXPECT_TRUE(pilot().motion_W()->p_WB.isApprox(before_W, 1e-9));
  ASSERT_TRUE(setpoint_);
  EXPECT_TRUE(setpoint_->p_L.isApprox(motion_L_.p_WB + offset_L_, 1e-9)) << "the set-point has moved with it";
  EXPECT_THAT(words_, Contains("its estimator has moved its origin by [0.50, -3.00, 0.25] m, which is taken out"));
  EXPECT_EQ(pilot().phase(), FlightPhase::kFlying);
}

TEST_F(PilotTest, WhyItFollowsNoMoreIsToldIfItSaysSo) {
  ASSERT_TRUE(UntilFlying());
  report_.follows = false;
  report_.problem = "one of its failsafes is active: battery";
  Step();
  EXPECT_THAT(words_, Contains("lost: it follows no set-points any more: one of its failsafes is active: battery"));
}

TEST_F(PilotTest, StopsMotorsAtOnce) {
  ASSERT_TRUE(UntilFlying());
  pilot().StopMotors("send kill");
  Step();
  EXPECT_EQ(orders_.back(), VehicleOrder::kStopMotors);
  EXPECT_FALSE(report_.is_armed);
  EXPECT_FALSE(setpoint_);
  For(1s);
  EXPECT_THAT(words_, Contains("its motors are to stop: send kill"));
  EXPECT_EQ(words_.back(), "lost: its motors stand");
}

TEST_F(PilotTest, MotorsThatDoNotStopAreToldAndAskedAgain) {
  ASSERT_TRUE(UntilFlying());
  stops_motors_ = false;
  for (int k = 0; k < 5; ++k) pilot().StopMotors("send kill");
  For(1s);
  EXPECT_EQ(words_.back(), "its motors are to stop: send kill") << "once";
  report_.refusal = "disarming is denied";
  For(3s);
  EXPECT_EQ(words_.back(), "lost: its motors do not stop: disarming is denied");
  const auto orders = orders_.size();
  For(2s);
  EXPECT_GE(orders_.size(), orders + 3) << "it is asked again and again";
  EXPECT_EQ(orders_.back(), VehicleOrder::kStopMotors);
}

TEST_F(PilotTest, ALandingIsLeftToAPilotWhoTakesOver) {
  ASSERT_TRUE(UntilFlying());
  pilot().Land("the run is over");
  For(500ms);
  ASSERT_EQ(pilot().phase(), FlightPhase::kLanding);
  report_.is_landing = report_.follows = false;
  const auto orders = orders_.size();
  Step();
  EXPECT_EQ(pilot().phase(), FlightPhase::kLost);
  EXPECT_EQ(words_.back(), "lost: it follows no set-points any more: a pilot or its own failsafe has taken over");
  For(5s);
  EXPECT_EQ(orders_.size(), orders) << "nobody fights the pilot";
  EXPECT_FALSE(setpoint_);
}

TEST_F(PilotTest, ALandingOfItsOwnFailsafeIsALanding) {
  ASSERT_TRUE(UntilFlying());
  pilot().Land("the run is over");
  For(500ms);
  report_.is_landing = true;
  report_.follows = false;
  ASSERT_TRUE(Until(FlightPhase::kLanded));
}

TEST_F(PilotTest, AJumpOfTheEstimatorOnTheGroundIsBelieved) {
  offset_L_ = {4, 0, 0};  // it does not know yet where it is
  For(100ms);
  offset_L_.setZero();
  ++report_.resets;
  For(100ms);
  EXPECT_EQ(words_.size(), 1U) << "found";
  EXPECT_TRUE(pilot().motion_W()->p_WB.isApprox(Eigen::Vector3d(1, 2, 0), 1e-9));
  offset_L_ = {0, 4, 0};  // it was carried away, switched off and on
  ++report_.resets;
  Step();
  pilot().Start();
  For(3s);
  EXPECT_THAT(words_.back(), HasSubstr("it does not start: it is 4.00 m from its start"));
}

TEST_F(PilotTest, AHeightThatCannotBeIsNotStartedFrom) {
  struct Row {
    double z_m, start_m;
    std::string words;
  };
  for (const Row& row : {Row{0.9, 1.5, "it stands at a height of 0.90 m, and 0.5 m are allowed"},
                         Row{-0.9, 1.5, "it stands at a height of -0.90 m, and 0.5 m are allowed"},
                         Row{0.4, 0.5, "its start is 0.10 m above where it stands, and at least 0.3 m are wanted"}}) {
    pilot_.reset();
    rules_.start_W.z() = row.start_m;
    motion_L_.p_WB.z() = row.z_m;
    Step();
    pilot().Start();
    For(3s);
    EXPECT_THAT(words_.back(), HasSubstr("it does not start: " + row.words));
    EXPECT_EQ(pilot().phase(), FlightPhase::kFound);
  }
}

TEST_F(PilotTest, AWayThatLeavesTheFenceIsNotBegun) {
  rules_.fence = Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0.2), Eigen::Vector3d(2, 3, 1.6));
  rules_.takeoff_m = 2;
  Step();
  pilot().Start();
  For(3s);
  EXPECT_EQ(words_.back(), "it does not start: its way to its start (takeoff_m) leaves its fence");
  pilot_.reset();
  rules_.takeoff_m = 1;
  EXPECT_TRUE(UntilFlying()) << "it stands below its bottom";
}

TEST_F(PilotTest, LandsBeyondItsFenceBeforeItIsReady) {
  rules_.fence = Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0.2), Eigen::Vector3d(2, 3, 1.6));
  Step();
  pilot().Start();
  ASSERT_TRUE(Until(FlightPhase::kTakingOff));
  tracks_ = false;
  motion_L_.p_WB.x() += 5;
  ASSERT_TRUE(Until(FlightPhase::kLanding));
  EXPECT_THAT(words_, Contains(HasSubstr("landing: it is beyond its fence, at [6.0")));
}

TEST_F(PilotTest, LandsWhereItCannotBeSentAnyFarther) {
  rules_.farthest_m = 3;
  a_W_ = {0.5, 0, 0};
  ASSERT_TRUE(UntilFlying());
  ASSERT_TRUE(Until(FlightPhase::kLanded));
  EXPECT_THAT(words_, Contains("landing: its reference is beyond 3 m, as far as it can be sent"));
}

TEST_F(PilotTest, OneThatIsToLandBeforeItHasTakenOffIsDisarmedAndOneThatStartsNotMayStartAgain) {
  Step();
  pilot().Start();
  ASSERT_TRUE(Until(FlightPhase::kStreaming));
  pilot().Land("asked to land");
  Step();
  EXPECT_EQ(words_.back(), "found: it does not start: asked to land");
  pilot().Land("asked once more");
  pilot().Start();
  ASSERT_TRUE(Until(FlightPhase::kStreaming)) << "nothing of that is left";
  report_.is_armed = true;
  pilot().Land("asked to land");
  Step();
  EXPECT_EQ(words_.back(), "landing: it does not start: asked to land");
  ASSERT_TRUE(Until(FlightPhase::kLanded));
  EXPECT_FALSE(report_.is_armed);
}

TEST_F(PilotTest, AStartThatCameTooEarlyIsForgotten) {
  is_heard_ = false;
  pilot().Start();
  For(1s);
  is_heard_ = true;
  For(5s);
  EXPECT_EQ(pilot().phase(), FlightPhase::kFound);
  EXPECT_TRUE(orders_.empty());
}

TEST_F(PilotTest, AfterASilenceOfItsAgentTheReferenceBeginsWhereTheVehicleIs) {
  a_W_ = {0.5, 0, 0};
  ASSERT_TRUE(UntilFlying());
  For(2s);
  agent_flies_ = false;
  For(900ms);
  motion_L_.p_WB += Eigen::Vector3d(0, 0.3, 0);
  Step();
  tick_ += 46;
  agent_flies_ = true;
  const Eigen::Vector3d there_W = rules_.frame.p_WL + motion_L_.p_WB;
  Step();
  ASSERT_TRUE(setpoint_);
  EXPECT_TRUE(pilot().reference().p_W().isApprox(there_W, 1e-9));
  EXPECT_TRUE(pilot().reference().v_W().isZero(1e-9)) << "that of the vehicle";
}

TEST_F(PilotTest, SetpointsAreOfTheKindAskedFor) {
  struct Row {
    SetpointKind kind;
    bool holds_height, p, z, v, a;
  };
  for (const Row& row : {Row{SetpointKind::kReference, false, true, true, true, true},
                         Row{SetpointKind::kAcceleration, false, false, false, false, true},
                         Row{SetpointKind::kAcceleration, true, false, true, false, true},
                         Row{SetpointKind::kVelocity, true, false, true, true, false}}) {
    SetUpAnew();
    rules_.setpoint = row.kind;
    rules_.holds_height = row.holds_height;
    rules_.frame.yaw_WL = 0.3;
    rules_.frame.p_WL = rules_.start_W - Eigen::Vector3d(0, 0, 1.5);
    ASSERT_TRUE(UntilFlying());
    ASSERT_TRUE(setpoint_);
    EXPECT_EQ(setpoint_->p_L.head<2>().allFinite(), row.p);
    EXPECT_EQ(std::isfinite(setpoint_->p_L.z()), row.z);
    EXPECT_EQ(setpoint_->v_L.head<2>().allFinite(), row.v);
    EXPECT_EQ(setpoint_->a_L.head<2>().allFinite(), row.a);
    EXPECT_EQ(std::isfinite(setpoint_->v_L.z()), row.v && !row.holds_height);
    EXPECT_NEAR(setpoint_->yaw_L, -0.3, 1e-12);
  }
}

TEST_F(PilotTest, TurnsByTheYawOfItsFrame) {
  rules_.frame.yaw_WL = std::numbers::pi / 2;
  ASSERT_TRUE(UntilFlying());
  EXPECT_TRUE(pilot().motion_W()->p_WB.isApprox(rules_.start_W, 1e-9));
  a_W_ = {1, 0, 0};
  For(200ms);
  ASSERT_TRUE(setpoint_);
  EXPECT_TRUE(setpoint_->a_L.isApprox(Eigen::Vector3d(0, -1, 0), 1e-9));
}

TEST(Reference, IsTheDoubleIntegratorWithEachAccelerationHeld) {
  Reference all({1, 2, 3}, {0.5, 0, 0}, 10), some = all;
  for (int tick = 0; tick <= 20; ++tick) {
    all.Take(tick, {1, 0, -1});
    if (tick % 4 == 0) some.Take(tick, {1, 0, -1});
  }
  EXPECT_TRUE(all.p_W().isApprox(Eigen::Vector3d(1 + 0.5 * 2 + 2, 2, 3 - 2), 1e-12));
  EXPECT_TRUE(all.v_W().isApprox(Eigen::Vector3d(2.5, 0, -2), 1e-12));
  EXPECT_TRUE(some.p_W().isApprox(all.p_W(), 1e-12)) << "a tick that was missed holds the last one";
  const Eigen::Vector3d before = all.v_W();
  all.Take(3, {100, 0, 0});
  EXPECT_EQ(all.v_W(), before) << "too late";
}

}  // namespace
}  // namespace mascot
