// What a Crazyswarm2 server and ArduPilot say on DDS, byte by byte.
#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "tests/support/cdr_sample.h"
#include "vehicle/ardupilot/messages.h"
#include "vehicle/crazyswarm/messages.h"

namespace mascot {
namespace {

using test::ExpectNoneOfTheCut;
using test::Sample;
using ::testing::ElementsAre;

TEST(CrazyswarmMessages, PosesAreReadByName) {
  Sample sample;
  sample.Header("world").Add(std::uint32_t{2});
  sample.Text("cf1").Doubles({1, 2, 3, 0, 0, 0, 1}).Text("cf231").Doubles({4, 5, 6, 0, 0, 1, 0});
  const auto poses = crazyswarm::ReadPoses(sample.bytes());
  ASSERT_TRUE(poses);
  ASSERT_EQ(poses->size(), 2u);
  EXPECT_EQ((*poses)[1].name, "cf231");
  EXPECT_EQ((*poses)[1].p, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ((*poses)[1].q.z(), 1);
  ExpectNoneOfTheCut(sample, [](const auto& bytes) { return crazyswarm::ReadPoses(bytes).has_value(); });
}

TEST(CrazyswarmMessages, AStatusIsBitsAndVolts) {
  Sample sample;
  sample.Header("").Add(std::uint16_t{2 + 8 + 16}).Add(3.9F).Add(std::uint8_t{0}).Add(std::uint8_t{70});
  const auto status = crazyswarm::ReadStatus(sample.bytes());
  ASSERT_TRUE(status);
  EXPECT_TRUE(status->Is(crazyswarm::Status::kIsArmed));
  EXPECT_TRUE(status->Is(crazyswarm::Status::kCanFly));
  EXPECT_FALSE(status->Is(crazyswarm::Status::kIsTumbled));
  EXPECT_NEAR(status->battery_V, 3.9, 1e-6);
}

TEST(CrazyswarmMessages, AFullStateHasTheLayoutOfItsMessage) {
  Sample expected;
  expected.Add(std::int32_t{0}).Add(std::uint32_t{0}).Text("world");
  expected.Doubles({1, 2, 3, 0, 0, std::sin(0.25), std::cos(0.25)});
  expected.Doubles({4, 5, 6, 0, 0, 0}).Doubles({7, 8, 9});
  EXPECT_EQ(crazyswarm::FullState({1, 2, 3}, {4, 5, 6}, {7, 8, 9}, 0.5), expected.bytes());
}

TEST(CrazyswarmMessages, RequestsHaveTheLayoutsOfTheirServices) {
  EXPECT_THAT(crazyswarm::ArmRequest(true), ElementsAre(0, 1, 0, 0, 1));
  EXPECT_THAT(crazyswarm::EmptyRequest(), ElementsAre(0, 1, 0, 0, 0));
  EXPECT_THAT(crazyswarm::SetpointsStopRequest(), ElementsAre(0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0));
}

TEST(ArdupilotMessages, AStatusSaysModeAndFailsafes) {
  Sample sample;
  sample.Header("").Add(std::uint8_t{2}).Add(std::uint8_t{1}).Add(std::uint8_t{9}).Add(std::uint8_t{1});
  sample.Add(std::uint8_t{1}).Add(std::uint32_t{2}).Add(std::uint8_t{22}).Add(std::uint8_t{24});
  const auto status = ardupilot::ReadStatus(sample.bytes());
  ASSERT_TRUE(status);
  EXPECT_EQ(status->vehicle, ardupilot::Status::kCopter);
  EXPECT_TRUE(status->is_armed);
  EXPECT_EQ(status->mode, ardupilot::Status::kLand);
  EXPECT_TRUE(status->is_flying);
  EXPECT_THAT(status->failsafes, ElementsAre(22, 24));
  ExpectNoneOfTheCut(sample, [](const auto& bytes) { return ardupilot::ReadStatus(bytes).has_value(); });
}

TEST(ArdupilotMessages, MotionIsAPoseAndATwist) {
  const auto pose = ardupilot::ReadPose(Sample().Header("base_link").Doubles({1, 2, 3, 0.6, 0, 0, 0.8}).bytes());
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->p, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(pose->q.x(), 0.6);
  EXPECT_EQ(pose->q.w(), 0.8);
  const auto twist = ardupilot::ReadTwist(Sample().Header("base_link").Doubles({1, 2, 3, 4, 5, 6}).bytes());
  ASSERT_TRUE(twist);
  EXPECT_EQ(twist->v, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(twist->w_B, Eigen::Vector3d(4, 5, 6));
}

TEST(ArdupilotMessages, ABatterySaysWhatIsLeft) {
  Sample sample;
  sample.Header("0");
  for (const float value : {12.0F, 20.0F, -1.0F, 2.0F, 3.0F, 3.0F, 0.25F}) sample.Add(value);
  EXPECT_EQ(ardupilot::ReadBattery(sample.bytes()), 0.25);
}

TEST(ArdupilotMessages, WhatItIsSentHasTheLayoutOfItsMessages) {
  const Sample expected = Sample().Add(std::int32_t{0}).Add(std::uint32_t{0}).Text("map").Doubles({1, 2, 3, 0, 0, 0});
  EXPECT_EQ(ardupilot::VelocityCommand({1, 2, 3}), expected.bytes());
  EXPECT_THAT(ardupilot::ArmMotorsRequest(false), ElementsAre(0, 1, 0, 0, 0));
  EXPECT_THAT(ardupilot::ModeSwitchRequest(ardupilot::Status::kGuided), ElementsAre(0, 1, 0, 0, 4));
  EXPECT_EQ(ardupilot::TakeoffRequest(1.5), Sample().Add(1.5F).bytes());
  EXPECT_EQ(ardupilot::ReadReply(Sample().Add(std::uint8_t{1}).bytes()), true);
  EXPECT_EQ(ardupilot::ReadReply(Sample().bytes()), std::nullopt);
}

}  // namespace
}  // namespace mascot
