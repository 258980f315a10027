// A copter with ArduPilot that is not there: its topics and services on DDS, as the bridge on its side has them. Knows
// nothing of who flies it.
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "ros_messagesPubSubTypes.h"
#include "tests/fakes/ardupilot/autopilot.h"
#include "tests/fakes/bridge.h"

namespace mascot::fakes {
namespace {

using ArmRequest = ardupilot_msgs::srv::ArmMotors_Request;
using ArmResponse = ardupilot_msgs::srv::ArmMotors_Response;
using ModeRequest = ardupilot_msgs::srv::ModeSwitch_Request;
using ModeResponse = ardupilot_msgs::srv::ModeSwitch_Response;
using TakeoffRequest = ardupilot_msgs::srv::Takeoff_Request;
using TakeoffResponse = ardupilot_msgs::srv::Takeoff_Response;
namespace geometry = geometry_msgs::msg;

struct Options {
  ArdupilotOptions autopilot;
  std::string name_space = "ap";
  OnDds on_dds;
};

geometry::Vector3 ToMessage(const Eigen::Vector3d& v) {
  geometry::Vector3 message;
  message.x(v.x());
  message.y(v.y());
  message.z(v.z());
  return message;
}

class FakeArdupilot {
 public:
  explicit FakeArdupilot(const Options& options)
      : options_(options), autopilot_(options.autopilot), bridge_(options.on_dds, "fake_ardupilot") {
    constexpr auto kReliable = dds::RELIABLE_RELIABILITY_QOS;
    constexpr auto kBestEffort = dds::BEST_EFFORT_RELIABILITY_QOS;
    velocities_ = bridge_.In<geometry::TwistStampedPubSubType>(Topic("cmd_vel"), Geometry("TwistStamped"));
    arm_ = bridge_.In<ardupilot_msgs::srv::ArmMotors_RequestPubSubType>(Request("arm_motors"),
                                                                        Ours("ArmMotors_Request"), kReliable);
    armed_ = bridge_.Out<ardupilot_msgs::srv::ArmMotors_ResponsePubSubType>(Answer("arm_motors"),
                                                                            Ours("ArmMotors_Response"), kReliable);
    switch_ = bridge_.In<ardupilot_msgs::srv::ModeSwitch_RequestPubSubType>(Request("mode_switch"),
                                                                            Ours("ModeSwitch_Request"), kReliable);
    switched_ = bridge_.Out<ardupilot_msgs::srv::ModeSwitch_ResponsePubSubType>(Answer("mode_switch"),
                                                                                Ours("ModeSwitch_Response"), kReliable);
    takeoff_ = bridge_.In<ardupilot_msgs::srv::Takeoff_RequestPubSubType>(Request("experimental/takeoff"),
                                                                          Ours("Takeoff_Request"), kReliable);
    taken_off_ = bridge_.Out<ardupilot_msgs::srv::Takeoff_ResponsePubSubType>(Answer("experimental/takeoff"),
                                                                              Ours("Takeoff_Response"), kReliable);
    poses_ = bridge_.Out<geometry::PoseStampedPubSubType>(Topic("pose/filtered"), Geometry("PoseStamped"), kBestEffort);
    twists_ =
        bridge_.Out<geometry::TwistStampedPubSubType>(Topic("twist/filtered"), Geometry("TwistStamped"), kBestEffort);
    batteries_ = bridge_.Out<sensor_msgs::msg::BatteryStatePubSubType>(
        Topic("battery"), "sensor_msgs::msg::dds_::BatteryState_", kBestEffort);
    statuses_ = bridge_.Out<ardupilot_msgs::msg::StatusPubSubType>(
        Topic("status"), "ardupilot_msgs::msg::dds_::Status_", kReliable, dds::TRANSIENT_LOCAL_DURABILITY_QOS);
  }

  void Step() {
    Take();
    autopilot_.Step();
    Say();
  }

 private:
  std::string Topic(const std::string& name) const { return "rt/" + options_.name_space + "/" + name; }
  std::string Request(const std::string& service) const {
    return "rq/" + options_.name_space + "/" + service + "Request";
  }
  std::string Answer(const std::string& service) const { return "rr/" + options_.name_space + "/" + service + "Reply"; }
  static std::string Geometry(const std::string& type) { return "geometry_msgs::msg::dds_::" + type + "_"; }
  static std::string Ours(const std::string& type) { return "ardupilot_msgs::srv::dds_::" + type + "_"; }

  void Take() {
    const bool hears = autopilot_.HasRadio();
    TakeAll<geometry::TwistStamped>(velocities_, [&](const geometry::TwistStamped& message, const auto&) {
      const geometry::Vector3& v = message.twist().linear();
      if (hears && message.header().frame_id() == "map") autopilot_.SetVelocity({v.x(), v.y(), v.z()});
    });
    TakeAll<ArmRequest>(arm_, [&](const ArmRequest& request, const auto& info) {
      ArmResponse response;
      response.result(hears && autopilot_.Arm(request.arm()));
      if (hears) Reply(armed_, response, info);
    });
    TakeAll<ModeRequest>(switch_, [&](const ModeRequest& request, const auto& info) {
      ModeResponse response;
      response.status(hears && autopilot_.SetMode(request.mode()));
      response.curr_mode(autopilot_.mode());
      if (hears) Reply(switched_, response, info);
    });
    TakeAll<TakeoffRequest>(takeoff_, [&](const TakeoffRequest& request, const auto& info) {
      TakeoffResponse response;
      response.status(hears && autopilot_.TakeOff(double{request.alt()}));
      if (hears) Reply(taken_off_, response, info);
    });
  }

  void Say() {
    constexpr int kMotionEvery = 3, kBatteryEvery = 100, kStatusEvery = 1000;
    ++steps_;
    if (!autopilot_.HasRadio()) return;
    if (steps_ % kMotionEvery == 0) SayMotion();
    if (steps_ % kBatteryEvery == 0) {
      sensor_msgs::msg::BatteryState battery;
      battery.percentage(static_cast<float>(autopilot_.battery()));
      batteries_->write(&battery);
    }
    ardupilot_msgs::msg::Status status;
    status.vehicle_type(2);
    status.armed(autopilot_.is_armed());
    status.mode(autopilot_.mode());
    status.flying(autopilot_.is_flying());
    status.external_control(true);
    status.failsafe(autopilot_.failsafes());
    if (status == status_ && steps_ % kStatusEvery != 1) return;  // it says what is new, and now and then all
    status_ = status;
    statuses_->write(&status);
  }
  void SayMotion() {
    const Motion motion = autopilot_.motion();
    geometry::PoseStamped pose;
    pose.header().frame_id("base_link");
    pose.pose().position().x(motion.p_WB.x());
    pose.pose().position().y(motion.p_WB.y());
    pose.pose().position().z(motion.p_WB.z());
    pose.pose().orientation().x(motion.q_WB.x());
    pose.pose().orientation().y(motion.q_WB.y());
    pose.pose().orientation().z(motion.q_WB.z());
    pose.pose().orientation().w(motion.q_WB.w());
    poses_->write(&pose);
    geometry::TwistStamped twist;
    twist.twist().linear(ToMessage(motion.v_WB));
    twist.twist().angular(ToMessage(motion.w_WB_B));
    twists_->write(&twist);
  }

  const Options options_;
  ArdupilotAutopilot autopilot_;
  Bridge bridge_;
  dds::DataReader *velocities_ = nullptr, *arm_ = nullptr, *switch_ = nullptr, *takeoff_ = nullptr;
  dds::DataWriter *armed_ = nullptr, *switched_ = nullptr, *taken_off_ = nullptr;
  dds::DataWriter *poses_ = nullptr, *twists_ = nullptr, *batteries_ = nullptr, *statuses_ = nullptr;
  ardupilot_msgs::msg::Status status_;
  std::int64_t steps_ = 0;
};

int Main(int argc, char** argv) {
  Options options;
  std::vector<double> place = {0, 0, 0};
  ArdupilotFaults& faults = options.autopilot.faults;
  FakeApp app("A copter with ArduPilot that is not there.", "fake_ardupilot", options.on_dds, faults);
  app.add_option("--namespace", options.name_space, "Before the names of its topics");
  app.add_option("--place", place, "east,north,up of where it is switched on (m)")->delimiter(',')->expected(3);
  app.AddTime("--pilot-at-s", faults.pilot_at_s, "A pilot takes over with the remote control");
  app.AddTime("--battery-low-at-s", faults.battery_low_at_s, "Its battery is low");
  CLI11_PARSE(app, argc, argv);
  options.autopilot.place_ENU = {place[0], place[1], place[2]};
  FakeArdupilot fake(options);
  std::cout << "fake_ardupilot: ready" << std::endl;
  StepUntilAsked(std::chrono::microseconds(static_cast<int>(1e6 * ArdupilotAutopilot::kPeriod_s)),
                 [&] { fake.Step(); });
  return 0;
}

}  // namespace
}  // namespace mascot::fakes

int main(int argc, char** argv) { return mascot::fakes::Main(argc, argv); }
