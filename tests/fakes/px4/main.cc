// A PX4 autopilot that is not there: its topics on DDS, as the bridge on a vehicle's side publishes them. Knows nothing
// of who flies it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "px4_msgsPubSubTypes.h"
#include "tests/fakes/bridge.h"
#include "tests/fakes/px4/autopilot.h"

namespace mascot::fakes {
namespace {

namespace msg = px4_msgs::msg;

struct Release {
  const char* name;
  const char* status_topic;
  const char* ack_topic;
};
constexpr Release kReleases[] = {{"1.14", "vehicle_status", "vehicle_command_ack"},
                                 {"1.15", "vehicle_status", "vehicle_command_ack"},
                                 {"1.16", "vehicle_status_v1", "vehicle_command_ack"},
                                 {"1.17", "vehicle_status_v1", "vehicle_command_ack"},
                                 {"1.18", "vehicle_status_v4", "vehicle_command_ack_v1"},
                                 {"strange", "vehicle_status_v4", "vehicle_command_ack_v1"}};  // of no release

struct Options {
  Px4Options autopilot;
  std::string release = "1.16", name_space = "";
  OnDds on_dds;
  double clock_s = 1000;  ///< its clock when it is switched on
  double loss = 0;        ///< share of samples that the radio loses, both ways
};

Eigen::Vector3d Vector(const std::array<float, 3>& numbers) {
  return {double{numbers[0]}, double{numbers[1]}, double{numbers[2]}};
}
std::array<float, 3> Floats(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

template <class Status>
void WriteStatus(const Px4Autopilot& autopilot, std::uint64_t now_us, dds::DataWriter* writer) {
  Status status;
  status.timestamp(now_us);
  status.arming_state(autopilot.is_armed() ? 2 : 1);
  status.nav_state(autopilot.nav_state());
  status.nav_state_user_intention(autopilot.nav_state());
  writer->write(&status);
}

class FakePx4 {
 public:
  explicit FakePx4(const Options& options)
      : options_(options),
        release_(*std::ranges::find(kReleases, options.release, &Release::name)),
        autopilot_(options.autopilot),
        bridge_(options.on_dds, "fake_px4_" + std::to_string(options.autopilot.system_id)) {
    is_14_ = options_.release == "1.14";
    signs_ = is_14_ ? In<msg::OffboardControlModeOf14PubSubType>("offboard_control_mode", "OffboardControlMode")
                    : In<msg::OffboardControlModePubSubType>("offboard_control_mode", "OffboardControlMode");
    setpoints_ = In<msg::TrajectorySetpointPubSubType>("trajectory_setpoint", "TrajectorySetpoint");
    commands_ = is_14_ ? In<msg::VehicleCommandOf14PubSubType>("vehicle_command", "VehicleCommand")
                       : In<msg::VehicleCommandPubSubType>("vehicle_command", "VehicleCommand");
    acks_ = is_14_ ? Out<msg::VehicleCommandAckOf14PubSubType>(release_.ack_topic, "VehicleCommandAck")
                   : Out<msg::VehicleCommandAckPubSubType>(release_.ack_topic, "VehicleCommandAck");
    odometry_ = Out<msg::VehicleOdometryPubSubType>("vehicle_odometry", "VehicleOdometry");
    land_ = Out<msg::VehicleLandDetectedPubSubType>("vehicle_land_detected", "VehicleLandDetected");
    status_ = MakeStatusWriter();
  }

  /// One step of the autopilot: what has arrived, then what it says.
  void Step() {
    Take();
    autopilot_.Step();
    for (const std::string& words : autopilot_.TakeWords()) std::cerr << words << std::endl;
    Say();
  }

 private:
  /// `type`: the name of the message, which is that of its first release.
  template <class PubSub>
  dds::DataWriter* Out(const std::string& topic, const std::string& type) {
    return bridge_.Out<PubSub>(TopicName("out", topic), TypeName(type), dds::BEST_EFFORT_RELIABILITY_QOS,
                               dds::TRANSIENT_LOCAL_DURABILITY_QOS);
  }
  template <class PubSub>
  dds::DataReader* In(const std::string& topic, const std::string& type) {
    return bridge_.In<PubSub>(TopicName("in", topic), TypeName(type));
  }
  std::string TopicName(const std::string& way, const std::string& topic) const {
    return "rt/" + options_.name_space + (options_.name_space.empty() ? "" : "/") + "fmu/" + way + "/" + topic;
  }
  static std::string TypeName(const std::string& message) { return "px4_msgs::msg::dds_::" + message + "_"; }
  dds::DataWriter* MakeStatusWriter() {
    const std::string topic = release_.status_topic, type = "VehicleStatus";
    if (is_14_) return Out<msg::VehicleStatusOf14PubSubType>(topic, type);
    if (options_.release == "1.15") return Out<msg::VehicleStatusOf15PubSubType>(topic, type);
    if (options_.release == "1.18") return Out<msg::VehicleStatusOf18PubSubType>(topic, type);
    return Out<msg::VehicleStatusOf16PubSubType>(topic, type);
  }
  std::uint64_t NowUs() const { return static_cast<std::uint64_t>((options_.clock_s + autopilot_.t_s()) * 1e6); }
  /// Whether the radio carries the next sample.
  bool Arrives() { return autopilot_.HasRadio() && chance_(random_) >= options_.loss; }

  void Take() {
    const auto on_sign = [&](const auto& sign, const auto&) {
      if (Arrives())
        autopilot_.OnSignOfLife(sign.position() ? "position" : sign.velocity() ? "velocity" : "acceleration");
    };
    const auto on_command = [&](const auto& command, const auto&) {
      if (Arrives()) Obey(command);
    };
    if (is_14_) {
      TakeAll<msg::OffboardControlModeOf14>(signs_, on_sign);
      TakeAll<msg::VehicleCommandOf14>(commands_, on_command);
    } else {
      TakeAll<msg::OffboardControlMode>(signs_, on_sign);
      TakeAll<msg::VehicleCommand>(commands_, on_command);
    }
    TakeAll<msg::TrajectorySetpoint>(setpoints_, [&](const msg::TrajectorySetpoint& setpoint, const auto&) {
      if (!Arrives()) return;
      autopilot_.OnSetpoint({.p_NED = Vector(setpoint.position()),
                             .v_NED = Vector(setpoint.velocity()),
                             .a_NED = Vector(setpoint.acceleration()),
                             .yaw_rad = double{setpoint.yaw()}});
    });
  }

  template <class Command>
  void Obey(const Command& command) {
    if (!command.from_external()) return;
    const auto result = autopilot_.OnCommand({.command = command.command(),
                                              .param1 = command.param1(),
                                              .param2 = command.param2(),
                                              .target_system = command.target_system()});
    if (!result || !Arrives()) return;
    if (is_14_)
      Acknowledge<msg::VehicleCommandAckOf14>(command.command(), *result);
    else
      Acknowledge<msg::VehicleCommandAck>(command.command(), *result);
  }
  template <class Ack>
  void Acknowledge(std::uint32_t command, std::uint8_t result) {
    Ack ack;
    ack.timestamp(NowUs());
    ack.command(command);
    ack.result(result);
    acks_->write(&ack);
  }

  void Say() {
    constexpr int kStatusEvery = 20;  // 5 Hz
    if (Arrives()) SayOdometry();
    if (++steps_ % kStatusEvery != 0) return;
    if (Arrives()) SayStatus();
    msg::VehicleLandDetected land;
    land.timestamp(NowUs());
    land.landed(autopilot_.is_landed());
    if (Arrives()) land_->write(&land);
  }
  void SayOdometry() {
    const Px4Odometry now = autopilot_.odometry();
    msg::VehicleOdometry odometry;
    odometry.timestamp(NowUs());
    odometry.timestamp_sample(NowUs());
    odometry.pose_frame(now.is_in_ned ? 1 : 2);
    odometry.position(Floats(now.p_NED));
    odometry.q({static_cast<float>(now.q_NED_FRD.w()), static_cast<float>(now.q_NED_FRD.x()),
                static_cast<float>(now.q_NED_FRD.y()), static_cast<float>(now.q_NED_FRD.z())});
    odometry.velocity_frame(1);
    odometry.velocity(Floats(now.v_NED));
    odometry.angular_velocity(Floats(now.w_FRD));
    odometry.reset_counter(now.reset_counter);
    odometry_->write(&odometry);
  }
  void SayStatus() {
    if (is_14_)
      WriteStatus<msg::VehicleStatusOf14>(autopilot_, NowUs(), status_);
    else if (options_.release == "1.15")
      WriteStatus<msg::VehicleStatusOf15>(autopilot_, NowUs(), status_);
    else if (options_.release == "1.18")
      WriteStatus<msg::VehicleStatusOf18>(autopilot_, NowUs(), status_);
    else
      WriteStatus<msg::VehicleStatusOf16>(autopilot_, NowUs(), status_);
  }

  const Options options_;
  const Release& release_;
  Px4Autopilot autopilot_;
  Bridge bridge_;
  bool is_14_ = false;
  dds::DataReader *signs_ = nullptr, *setpoints_ = nullptr, *commands_ = nullptr;
  dds::DataWriter *acks_ = nullptr, *odometry_ = nullptr, *land_ = nullptr, *status_ = nullptr;
  std::minstd_rand random_;
  std::uniform_real_distribution<double> chance_{0, 1};
  std::int64_t steps_ = 0;
};

int Main(int argc, char** argv) {
  Options options;
  std::vector<double> place = {0, 0, 0};
  Px4Faults& faults = options.autopilot.faults;
  FakeApp app("A PX4 autopilot that is not there.", "fake_px4", options.on_dds, faults);
  std::vector<std::string> releases;
  for (const Release& release : kReleases) releases.emplace_back(release.name);
  app.add_option("--release", options.release, "Whose messages it has")->check(CLI::IsMember(releases));
  app.add_option("--namespace", options.name_space, "Before the names of its topics");
  app.add_option("--system-id", options.autopilot.system_id, "As which it takes commands")->check(CLI::Range(1, 255));
  app.add_option("--place", place, "east,north,up of where it is switched on (m)")->delimiter(',')->expected(3);
  app.add_option("--clock-s", options.clock_s, "Its clock when it is switched on (s)");
  app.add_option("--loss", options.loss, "Share of samples that the radio loses, both ways")
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--no-heading", faults.has_no_heading, "Its odometry is in a frame of unknown heading");
  app.add_flag("--no-signs-of-life", faults.hears_no_signs_of_life, "It hears set-points, but no signs of life");
  app.AddTime("--reset-at-s", faults.reset_at_s, "Its estimator moves its origin");
  app.AddTime("--pilot-at-s", faults.pilot_at_s, "A pilot takes over with the remote control");
  CLI11_PARSE(app, argc, argv);
  options.autopilot.place_ENU = {place[0], place[1], place[2]};
  FakePx4 fake(options);
  std::cout << "fake_px4: ready" << std::endl;
  StepUntilAsked(std::chrono::microseconds(static_cast<int>(1e6 * Px4Autopilot::kPeriod_s)), [&] { fake.Step(); });
  return 0;
}

}  // namespace
}  // namespace mascot::fakes

int main(int argc, char** argv) { return mascot::fakes::Main(argc, argv); }
