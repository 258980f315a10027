// A Crazyswarm2 server and its Crazyflies that are not there: their topics and services on DDS. Knows nothing of who
// flies them.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "ros_messagesPubSubTypes.h"
#include "tests/fakes/bridge.h"
#include "tests/fakes/crazyswarm/crazyflie.h"

namespace mascot::fakes {
namespace {

namespace msg = crazyflie_interfaces::msg;
namespace srv = crazyflie_interfaces::srv;
namespace geometry = geometry_msgs::msg;
namespace tracking = motion_capture_tracking_interfaces::msg;

constexpr double kLargest = 32.767;  // of what travels as int16 of a thousandth
constexpr double kFree = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector3d OnRadio(const Eigen::Vector3d& v) {
  return v.unaryExpr([](double x) { return std::round(1000 * std::clamp(x, -kLargest, kLargest)) / 1000; });
}

geometry::Pose PoseOf(const Motion& motion) {
  geometry::Pose pose;
  pose.position().x(motion.p_WB.x());
  pose.position().y(motion.p_WB.y());
  pose.position().z(motion.p_WB.z());
  pose.orientation().x(motion.q_WB.x());
  pose.orientation().y(motion.q_WB.y());
  pose.orientation().z(motion.q_WB.z());
  pose.orientation().w(motion.q_WB.w());
  return pose;
}

/// One Crazyflie with its part of the server.
class Link {
 public:
  Link(Bridge& bridge, const std::string& name, const CrazyflieOptions& options) : name_(name), crazyflie_(options) {
    constexpr auto kReliable = dds::RELIABLE_RELIABILITY_QOS;
    states_ = bridge.In<msg::FullStatePubSubType>(Topic("cmd_full_state"), Message("FullState"), kReliable);
    velocities_ =
        bridge.In<msg::VelocityWorldPubSubType>(Topic("cmd_velocity_world"), Message("VelocityWorld"), kReliable);
    arm_ = bridge.In<srv::Arm_RequestPubSubType>(Request("arm"), Service("Arm_Request"), kReliable);
    emergency_ = bridge.In<std_srvs::srv::Empty_RequestPubSubType>(Request("emergency"),
                                                                   "std_srvs::srv::dds_::Empty_Request_", kReliable);
    stop_ = bridge.In<srv::NotifySetpointsStop_RequestPubSubType>(Request("notify_setpoints_stop"),
                                                                  Service("NotifySetpointsStop_Request"), kReliable);
    armed_ = bridge.Out<srv::Arm_ResponsePubSubType>(Answer("arm"), Service("Arm_Response"), kReliable);
    pose_ =
        bridge.Out<geometry::PoseStampedPubSubType>(Topic("pose"), "geometry_msgs::msg::dds_::PoseStamped_", kReliable);
    status_ = bridge.Out<msg::StatusPubSubType>(Topic("status"), Message("Status"), kReliable);
  }

  const std::string& name() const { return name_; }
  const Crazyflie& crazyflie() const { return crazyflie_; }

  void Step() {
    Take();
    crazyflie_.Step();
    Say();
  }

 private:
  std::string Topic(const std::string& topic) const { return "rt/" + name_ + "/" + topic; }
  std::string Request(const std::string& service) const { return "rq/" + name_ + "/" + service + "Request"; }
  std::string Answer(const std::string& service) const { return "rr/" + name_ + "/" + service + "Reply"; }
  static std::string Message(const std::string& type) { return "crazyflie_interfaces::msg::dds_::" + type + "_"; }
  static std::string Service(const std::string& type) { return "crazyflie_interfaces::srv::dds_::" + type + "_"; }

  void Take() {
    const bool hears = crazyflie_.HasRadio();
    TakeAll<msg::FullState>(states_, [&](const msg::FullState& state, const auto&) {
      const auto& p = state.pose().position();
      const auto &v = state.twist().linear(), &a = state.acc();
      if (!hears) return;
      crazyflie_.Stream({.p_W = OnRadio({p.x(), p.y(), p.z()}),
                         .v_W = OnRadio({v.x(), v.y(), v.z()}),
                         .a_W = OnRadio({a.x(), a.y(), a.z()})});
    });
    TakeAll<msg::VelocityWorld>(velocities_, [&](const msg::VelocityWorld& velocity, const auto&) {
      const auto& v = velocity.vel();
      const Eigen::Vector3d free = Eigen::Vector3d::Constant(kFree);
      if (hears) crazyflie_.Stream({.p_W = free, .v_W = {v.x(), v.y(), v.z()}, .a_W = free});
    });
    TakeAll<srv::Arm_Request>(arm_, [&](const srv::Arm_Request& request, const auto& info) {
      if (hears) crazyflie_.Arm(request.arm());
      Reply(armed_, srv::Arm_Response{}, info);  // of the server: it says nothing of the Crazyflie
    });
    TakeAll<std_srvs::srv::Empty_Request>(emergency_, [&](const auto&, const auto&) {
      if (hears) crazyflie_.Emergency();
    });
    TakeAll<srv::NotifySetpointsStop_Request>(stop_, [&](const auto&, const auto&) {
      if (hears) crazyflie_.StopStreaming();
    });
  }

  void Say() {
    constexpr int kPoseEvery = 10, kStatusEvery = 100;
    ++steps_;
    if (!crazyflie_.HasRadio()) return;
    if (steps_ % kPoseEvery == 0) {
      geometry::PoseStamped pose;
      pose.header().frame_id("world");
      pose.pose(PoseOf(crazyflie_.motion()));
      pose_->write(&pose);
    }
    const bool is_new = crazyflie_.supervisor() != supervisor_;
    if (!is_new && steps_ % kStatusEvery != 1) return;
    supervisor_ = crazyflie_.supervisor();
    msg::Status status;
    status.supervisor_info(supervisor_);
    status.battery_voltage(static_cast<float>(crazyflie_.battery_V()));
    status_->write(&status);
  }

  const std::string name_;
  Crazyflie crazyflie_;
  dds::DataReader *states_, *velocities_, *arm_, *emergency_, *stop_;
  dds::DataWriter *armed_, *pose_, *status_;
  std::uint16_t supervisor_ = 0;
  std::int64_t steps_ = 0;
};

int Main(int argc, char** argv) {
  OnDds on_dds;
  bool has_poses = true;
  std::vector<std::string> places;
  CrazyflieOptions options;
  CrazyflieFaults& faults = options.faults;
  FakeApp app("A Crazyswarm2 server with Crazyflies that are not there; the first one does wrong.", "fake_crazyswarm",
              on_dds, faults);
  app.add_option("--crazyflie", places, "name:x,y,z: where it stands (m)")
      ->required()
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_flag("!--no-poses", has_poses, "Without the topic /poses of the motion capture");
  app.AddTime("--tumbles-at-s", faults.tumbles_at_s, "It tumbles");
  app.AddTime("--battery-low-at-s", faults.battery_low_at_s, "Its battery is low");
  CLI11_PARSE(app, argc, argv);
  Bridge bridge(on_dds, "fake_crazyswarm");
  auto* const poses_out = bridge.Out<tracking::NamedPoseArrayPubSubType>(
      "rt/poses", "motion_capture_tracking_interfaces::msg::dds_::NamedPoseArray_", dds::BEST_EFFORT_RELIABILITY_QOS);
  std::vector<std::unique_ptr<Link>> links;
  for (const std::string& place : places) {
    std::istringstream text(place.substr(std::min(place.find(':') + 1, place.size())));
    char comma = 0;
    text >> options.place_W.x() >> comma >> options.place_W.y() >> comma >> options.place_W.z();
    if (!text || place.find(':') == place.npos) {
      std::cerr << "error: --crazyflie: expected name:x,y,z, got " << place << std::endl;
      return 2;
    }
    links.push_back(std::make_unique<Link>(bridge, place.substr(0, place.find(':')), options));
    faults = {};
  }
  std::cout << "fake_crazyswarm: ready" << std::endl;
  StepUntilAsked(std::chrono::microseconds(static_cast<int>(1e6 * Quadrotor::kPeriod_s)), [&] {
    tracking::NamedPoseArray poses;
    poses.header().frame_id("world");
    for (const auto& link : links) {
      link->Step();
      tracking::NamedPose pose;
      pose.name(link->name());
      pose.pose(PoseOf(link->crazyflie().motion()));
      poses.poses().push_back(pose);
    }
    if (has_poses) poses_out->write(&poses);
  });
  return 0;
}

}  // namespace
}  // namespace mascot::fakes

int main(int argc, char** argv) { return mascot::fakes::Main(argc, argv); }
