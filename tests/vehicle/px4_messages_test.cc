#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "vehicle/px4/messages.h"

namespace mascot::px4 {
namespace {

using testing::HasSubstr;

/// A sample of so many bytes after the encapsulation, padded if `padded`, whose byte k is k.
Bytes Sample(std::size_t message, bool padded = true) {
  Bytes bytes{0, 1, 0, 0};
  for (std::size_t k = 0; k < message; ++k) bytes.push_back(static_cast<std::uint8_t>(k));
  while (padded && bytes.size() % 4 != 0) bytes.push_back(0);
  return bytes;
}

template <class T>
void Put(Bytes& sample, std::size_t place, T value) {
  std::memcpy(&sample.at(4 + place), &value, sizeof value);
}
template <class T>
T Get(const Bytes& sample, std::size_t place) {
  T value;
  std::memcpy(&value, &sample.at(4 + place), sizeof value);
  return value;
}

TEST(Px4Messages, StatusTellsTheReleaseByTopicAndLength) {
  struct Row {
    std::string_view topic;
    std::size_t bytes;
    std::string_view release;
  };
  for (const Row& row : {Row{"vehicle_status", 71, "1.14"}, Row{"vehicle_status", 82, "1.15"},
                         Row{"vehicle_status_v1", 80, "1.16 or 1.17"}, Row{"vehicle_status_v4", 83, "1.18"}})
    for (const bool padded : {false, true}) {
      UnknownSample unknown;
      const auto status = ReadStatus(row.topic, Sample(row.bytes, padded), unknown);
      ASSERT_TRUE(status) << row.release << " " << unknown.words;
      EXPECT_EQ(Name(status->release), row.release);
      EXPECT_EQ(status->arming_state, 24);
      EXPECT_EQ(status->nav_state, 41);
    }
}

TEST(Px4Messages, UnknownLengthsAreToldWithTheKnownOnes) {
  UnknownSample unknown;
  EXPECT_FALSE(ReadStatus("vehicle_status", Sample(90), unknown));
  EXPECT_EQ(unknown.words, "92 bytes of vehicle_status: the known lengths are 71 (1.14), 82 (1.15)");
  EXPECT_FALSE(ReadStatus("vehicle_status_v7", Sample(82), unknown));
  EXPECT_EQ(unknown.words, "vehicle_status_v7: no release that is known has this topic");
  EXPECT_FALSE(ReadOdometry(Sample(113, false), unknown));
  EXPECT_THAT(unknown.words, HasSubstr("113 bytes of vehicle_odometry: the known lengths are 114"));
  for (std::size_t size = 0; size < 30; ++size) {
    const Bytes sample(size, 0);
    EXPECT_FALSE(ReadStatus("vehicle_status", sample, unknown));
    EXPECT_FALSE(ReadOdometry(sample, unknown));
    EXPECT_FALSE(ReadAck("vehicle_command_ack", sample, unknown));
    EXPECT_FALSE(ReadLandDetected(sample, unknown));
  }
  Bytes big_endian = Sample(82);
  big_endian[1] = 0;
  EXPECT_FALSE(ReadStatus("vehicle_status", big_endian, unknown));
  EXPECT_EQ(unknown.words, "vehicle_status: an encoding other than little-endian CDR");
}

TEST(Px4Messages, OdometryIsRead) {
  Bytes sample = Sample(114);
  Put<std::uint64_t>(sample, 0, 123456);
  Put<std::uint8_t>(sample, 16, 1);
  Put<std::uint8_t>(sample, 48, 3);
  const float numbers[] = {1, 2, 3, 0.5F, -0.5F, 0.5F, -0.5F};
  for (std::size_t k = 0; k < 7; ++k) Put(sample, 20 + 4 * k, numbers[k]);
  for (std::size_t k = 0; k < 3; ++k) Put(sample, 52 + 4 * k, static_cast<float>(k) + 10);
  for (std::size_t k = 0; k < 3; ++k) Put(sample, 64 + 4 * k, static_cast<float>(k) + 20);
  Put<std::uint8_t>(sample, 112, 7);
  UnknownSample unknown;
  const auto odometry = ReadOdometry(sample, unknown);
  ASSERT_TRUE(odometry) << unknown.words;
  EXPECT_EQ(odometry->timestamp_us, 123456u);
  EXPECT_EQ(odometry->pose_frame, Odometry::PoseFrame::kNed);
  EXPECT_EQ(odometry->velocity_frame, Odometry::VelocityFrame::kBody);
  EXPECT_EQ(odometry->p_N, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(odometry->q_NF.w(), 0.5);
  EXPECT_EQ(odometry->q_NF.vec(), Eigen::Vector3d(-0.5, 0.5, -0.5));
  EXPECT_EQ(odometry->v, Eigen::Vector3d(10, 11, 12));
  EXPECT_EQ(odometry->w_F, Eigen::Vector3d(20, 21, 22));
  EXPECT_EQ(odometry->reset_counter, 7);
}

TEST(Px4Messages, AcknowledgementsAndLandingAreRead) {
  for (const auto& [topic, bytes] : {std::pair{"vehicle_command_ack", 23}, std::pair{"vehicle_command_ack", 25},
                                     std::pair{"vehicle_command_ack_v1", 25}}) {
    Bytes sample = Sample(static_cast<std::size_t>(bytes));
    Put<std::uint32_t>(sample, 8, 400);
    Put<std::uint8_t>(sample, 12, Ack::kDenied);
    UnknownSample unknown;
    const auto ack = ReadAck(topic, sample, unknown);
    ASSERT_TRUE(ack) << unknown.words;
    EXPECT_EQ(ack->command, 400u);
    EXPECT_EQ(ack->result, Ack::kDenied);
  }
  Bytes sample(24, 0);
  sample[1] = 1;
  UnknownSample unknown;
  ASSERT_TRUE(ReadLandDetected(sample, unknown)) << unknown.words;
  EXPECT_FALSE(ReadLandDetected(sample, unknown)->landed);
  Put<std::uint8_t>(sample, 11, 1);
  EXPECT_TRUE(ReadLandDetected(sample, unknown)->landed);
}

TEST(Px4Messages, HeartbeatsHaveTheFlagsOfTheRelease) {
  for (const Release release : {Release::k1_14, Release::k1_15, Release::k1_16_or_1_17, Release::k1_18}) {
    const std::size_t flags = release == Release::k1_14 ? 6 : 7;
    std::size_t place = 8;
    for (const Controlled controlled : {Controlled::kPosition, Controlled::kVelocity, Controlled::kAcceleration}) {
      const Bytes sample = OffboardControlMode(release, controlled);
      EXPECT_EQ(sample.size(), 4 + (8 + flags + 3) / 4 * 4);
      for (std::size_t k = 8; k < 8 + flags; ++k) EXPECT_EQ(sample.at(4 + k), k == place) << k;
      ++place;
    }
  }
}

TEST(Px4Messages, SetpointsAreFloatsAndWhatIsNotControlledIsNan) {
  const double nan = std::nan("");
  const Bytes sample =
      TrajectorySetpoint({.p_N = {1, 2, -3}, .v_N = {4, 5, 6}, .a_N = {nan, nan, nan}, .yaw_rad = 0.5});
  ASSERT_EQ(sample.size(), 4u + 64u);
  EXPECT_EQ(Get<std::uint64_t>(sample, 0), 0u) << "now, on arrival";
  EXPECT_EQ(Get<float>(sample, 8), 1);
  EXPECT_EQ(Get<float>(sample, 16), -3);
  EXPECT_EQ(Get<float>(sample, 20), 4);
  for (std::size_t place = 32; place < 56; place += 4) EXPECT_TRUE(std::isnan(Get<float>(sample, place))) << place;
  EXPECT_EQ(Get<float>(sample, 56), 0.5F);
  EXPECT_TRUE(std::isnan(Get<float>(sample, 60)));
}

TEST(Px4Messages, CommandsNameTheVehicleAndComeFromOutside) {
  for (const Release release : {Release::k1_14, Release::k1_15, Release::k1_18}) {
    const Bytes sample = VehicleCommand(release, {.order = Order::kArmOrDisarm, .param1 = kArm, .target_system = 9});
    EXPECT_EQ(sample.size(), 4u + 56u);  // 54 in 1.14, padded
    EXPECT_EQ(Get<float>(sample, 8), 1);
    EXPECT_EQ(Get<std::uint32_t>(sample, 44), 400u);
    EXPECT_EQ(Get<std::uint8_t>(sample, 48), 9);
    EXPECT_EQ(Get<std::uint8_t>(sample, 49), 1);
    const std::size_t from_external = release == Release::k1_14 ? 53 : 55;
    EXPECT_EQ(Get<std::uint8_t>(sample, from_external), 1);
    EXPECT_EQ(Get<std::uint8_t>(sample, from_external - 1), 0);
  }
}

}  // namespace
}  // namespace mascot::px4
