// What is told of vehicles whose samples make no sense: on DDS, as they send them.
#include <gmock/gmock.h>

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>

#include "orchestrator/engines/dds/machine/domain_lock.h"
#include "tests/support/cdr_sample.h"
#include "tests/support/waits.h"
#include "vehicle/kinds.h"

namespace mascot {
namespace {

using test::Sample;
using test::Until;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Topic {
  std::string name, type;
};

/// A vehicle that sends what the test says.
class Autopilots : public ::testing::Test {
 protected:
  void Listen(VehicleKind kind, const std::string& name_space) {
    autopilot_ = MakeAutopilot({.domain = lock_.domain(), .name = "listener", .address = "127.0.0.1"},
                               {.kind = kind, .name_space = name_space, .address = "127.0.0.1"}, [] {});
  }
  /// Sends this until the report is as it should be, and returns that.
  VehicleReport Send(const Topic& topic, const Sample& sample, const std::function<bool(const VehicleReport&)>& is_so) {
    if (announced_.insert(topic.name).second)
      vehicle_.Announce(topic.name, topic.type, OutsideDomain::Reliability::kReliable);
    EXPECT_TRUE(Until([&] {
      vehicle_.Write(topic.name, sample.bytes());
      return is_so(autopilot_->Report());
    })) << topic.name
        << ": " << autopilot_->Report().problem;
    return autopilot_->Report();
  }
  VehicleReport ExpectProblem(const Topic& topic, const Sample& sample, const std::string& problem) {
    return Send(topic, sample, [&](const VehicleReport& report) { return report.problem == problem; });
  }

 private:
  const DomainLock lock_{-1};
  OutsideDomain vehicle_{{.domain = lock_.domain(), .name = "vehicle", .address = "127.0.0.1"}};
  std::set<std::string> announced_;

 protected:
  std::unique_ptr<Autopilot> autopilot_;
};

Sample Px4Odometry(float x, float q_w, float v) {
  Sample sample;
  sample.Add(std::uint64_t{1}).Add(std::uint64_t{1}).Add(std::uint8_t{1});
  for (const float number : {x, 0.0F, 0.0F, q_w, 0.0F, 0.0F, 0.0F}) sample.Add(number);
  sample.Add(std::uint8_t{1});
  for (const float number : {v, 0.0F, 0.0F}) sample.Add(number);
  for (int k = 0; k < 3 + 9; ++k) sample.Add(0.0F);
  return sample.Add(std::uint8_t{0}).Add(std::uint8_t{0});
}

TEST_F(Autopilots, OfAPx4ThatMakesNoSenseAreToldWhat) {
  const Topic odometry{"rt/a/fmu/out/vehicle_odometry", "px4_msgs::msg::dds_::VehicleOdometry_"};
  const Topic landed{"rt/a/fmu/out/vehicle_land_detected", "px4_msgs::msg::dds_::VehicleLandDetected_"};
  const Topic ack{"rt/a/fmu/out/vehicle_command_ack", "px4_msgs::msg::dds_::VehicleCommandAck_"};
  Listen(VehicleKind::kPx4, "a");
  ExpectProblem(odometry, Px4Odometry(kNan, 1, 0), "its position is unknown");
  ExpectProblem(odometry, Px4Odometry(1, 1, kNan), "its velocity is unknown");
  EXPECT_FALSE(ExpectProblem(odometry, Px4Odometry(1, 0, 0), "its orientation is unknown").motion_L);
  EXPECT_EQ(ExpectProblem(odometry, Px4Odometry(1, 1, 0), "").motion_L->p_WB.y(), 1) << "north";
  ExpectProblem(landed, Sample().Add(std::uint32_t{0}),
                "4 bytes of vehicle_land_detected: the known lengths are 20 (1.14)");
  ExpectProblem(landed, Sample().Doubles({0, 0}).Add(std::uint32_t{0}), "");
  ExpectProblem(ack, Sample().Add(std::uint32_t{0}),
                "4 bytes of vehicle_command_ack: the known lengths are 23 (1.14), 25 (1.15)");
}

Sample RosPose(double x, double q_w) { return Sample().Header("map").Doubles({x, 2, 3, 0, 0, 0, q_w}); }

TEST_F(Autopilots, OfACrazyflieThatMakesNoSenseAreToldWhat) {
  const Topic pose{"rt/cf1/pose", "geometry_msgs::msg::dds_::PoseStamped_"};
  const Topic status{"rt/cf1/status", "crazyflie_interfaces::msg::dds_::Status_"};
  Listen(VehicleKind::kCrazyswarm, "cf1");
  ExpectProblem(pose, RosPose(kNan, 1), "its position is unknown");
  EXPECT_FALSE(ExpectProblem(pose, RosPose(1, 0), "its orientation is unknown").motion_L);
  EXPECT_EQ(ExpectProblem(pose, RosPose(1, 1), "").motion_L->p_WB.x(), 1);
  ExpectProblem(pose, Sample().Header("map"), "20 bytes of pose are no such message");
  const auto volts = [&](float battery_V) {
    return Send(status, Sample().Header("").Add(std::uint16_t{2 + 8}).Add(battery_V),
                [&](const VehicleReport& report) { return report.battery.has_value() == (battery_V > 0); });
  };
  EXPECT_NEAR(*volts(3.6F).battery, 0.5, 1e-6);
  volts(kNan);
  ExpectProblem(status, Sample().Header("").Add(std::uint16_t{32}).Add(3.6F), "it has tumbled");  // first of all
}

TEST_F(Autopilots, ACrazyflieStandsWhereSetpointsBeginNotWhereItWasFirstHeardOf) {
  const Topic pose{"rt/cf1/pose", "geometry_msgs::msg::dds_::PoseStamped_"};
  Listen(VehicleKind::kCrazyswarm, "cf1");
  const auto is_at = [&](double z_m) {
    Send(pose, Sample().Header("map").Doubles({0, 0, z_m, 0, 0, 0, 1}),
         [&](const VehicleReport& report) { return report.motion_L && report.motion_L->p_WB.z() == z_m; });
  };
  const VehicleSetpoint still{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0};
  is_at(0.9);  // in a hand
  is_at(0.05);
  autopilot_->Stream(still);
  is_at(0.06);
  const auto lies_for = [&](std::chrono::milliseconds time, double z_m) {
    const auto end = std::chrono::steady_clock::now() + time;
    Send(pose, Sample().Header("map").Doubles({0, 0, z_m, 0, 0, 0, 1}),
         [&](const VehicleReport&) { return std::chrono::steady_clock::now() > end; });
    return autopilot_->Report().is_on_ground;
  };
  EXPECT_TRUE(lies_for(std::chrono::milliseconds(800), 0.06));
  EXPECT_FALSE(lies_for(std::chrono::milliseconds(800), 0.8)) << "lower than the hand, but in the air";
}

TEST_F(Autopilots, OfAnArdupilotThatMakesNoSenseAreToldWhat) {
  const Topic pose{"rt/ap/pose/filtered", "geometry_msgs::msg::dds_::PoseStamped_"};
  const Topic twist{"rt/ap/twist/filtered", "geometry_msgs::msg::dds_::TwistStamped_"};
  Listen(VehicleKind::kArdupilot, "ap");
  ExpectProblem(pose, RosPose(kNan, 1), "its position is unknown");
  EXPECT_FALSE(ExpectProblem(pose, RosPose(1, 0), "its orientation is unknown").motion_L);
  EXPECT_EQ(ExpectProblem(pose, RosPose(1, 1), "").motion_L->p_WB.x(), 1);
  const auto wrong =
      ExpectProblem(twist, Sample().Header("").Doubles({kNan, 0, 0, 0, 0, 0}), "its velocity is unknown");
  EXPECT_EQ(wrong.motion_L->v_WB, Eigen::Vector3d(0, 0, 0)) << "the last one that was good";
  const auto good = ExpectProblem(twist, Sample().Header("").Doubles({4, 0, 0, 0, 0, 0}), "");
  EXPECT_EQ(good.motion_L->v_WB, Eigen::Vector3d(4, 0, 0));
  ExpectProblem(twist, Sample().Add(std::uint8_t{0}), "8 bytes of twist/filtered are no such message");
}

}  // namespace
}  // namespace mascot
