#include "orchestrator/crazyswarm/crazyswarm_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/yaw.h"

namespace mascot {
namespace {

using crazyswarm::Setpoint;

constexpr double kP_per_s2 = 4, kD_per_s = 3;  // of the correction of position and velocity
constexpr int kPosesPerSecond = 100, kPosePerSecond = 10, kStatusPerSecond = 1;
constexpr std::string_view kAll = "all", kServer = "crazyflie_server";

std::string MessageType(std::string_view message) {
  return fmt::format("crazyflie_interfaces::msg::dds_::{}_", message);
}
std::string ServiceType(std::string_view service) {
  return fmt::format("crazyflie_interfaces::srv::dds_::{}_{{}}_", service);
}
std::string In(const std::string& name, std::string_view topic) { return fmt::format("rt/{}/{}", name, topic); }

/// Whether a topic of this rate has a sample at the tick.
bool IsDue(const Experiment& experiment, std::int64_t tick, int per_second) {
  return tick % std::max(1, experiment.control.rate_hz / per_second) == 0;
}

/// The acceleration in W that a Crazyflie with this set-point gives itself; without one, its motors stand.
std::vector<double> ActionOf(const std::optional<Setpoint>& setpoint, const Motion& motion, double gravity_m_per_s2) {
  if (!setpoint) return {0, 0, -gravity_m_per_s2};
  std::vector<double> action(3, 0.0);
  for (int k = 0; k < 3; ++k) {
    double& a = action[static_cast<std::size_t>(k)];
    if (std::isfinite(setpoint->a_W[k])) a += setpoint->a_W[k];
    if (std::isfinite(setpoint->p_W[k])) a += kP_per_s2 * (setpoint->p_W[k] - motion.p_WB[k]);
    if (std::isfinite(setpoint->v_W[k]))
      a += kD_per_s * (setpoint->v_W[k] - motion.v_WB[k]);
    else if (std::isfinite(setpoint->p_W[k]))
      a -= kD_per_s * motion.v_WB[k];
  }
  return action;
}

}  // namespace

CrazyswarmServer::CrazyswarmServer(const Experiment& experiment, std::function<void(const std::string&)> warn)
    : experiment_(experiment), warn_(std::move(warn)), actions_(experiment.agents.size()) {
  for (const AgentConfig& agent : experiment.agents)
    if (agent.takes_actions)
      crazyflies_.push_back(std::make_unique<Crazyflie>(
          Crazyflie{agent.id, fmt::format("cf{}", agent.id), crazyswarm::Commander(agent.p_W), {.p_WB = agent.p_W}}));
}

CrazyswarmServer::~CrazyswarmServer() = default;

void CrazyswarmServer::OnDomain(int domain, const std::string& address) {
  domain_.emplace(OutsideDomain::Options{.domain = domain, .name = std::string(kServer), .address = address});
  std::vector<Crazyflie*> all;
  for (const auto& crazyflie : crazyflies_) {
    all.push_back(crazyflie.get());
    OfferTopics(*crazyflie);
    Offer(crazyflie->name, {crazyflie.get()});
  }
  domain_->Announce("rt/poses", "motion_capture_tracking_interfaces::msg::dds_::NamedPoseArray_",
                    OutsideDomain::Reliability::kBestEffort);
  OfferParameters();
  Offer(std::string(kAll), all);
}

void CrazyswarmServer::OfferTopics(Crazyflie& crazyflie) {
  using Reliability = OutsideDomain::Reliability;
  const std::string& name = crazyflie.name;
  domain_->Announce(In(name, "pose"), "geometry_msgs::msg::dds_::PoseStamped_", Reliability::kReliable);
  domain_->Announce(In(name, "odom"), "nav_msgs::msg::dds_::Odometry_", Reliability::kReliable);
  domain_->Announce(In(name, "status"), MessageType("Status"), Reliability::kReliable);
  Hear(crazyflie, "cmd_full_state", "FullState", [](const Bytes& sample) { return crazyswarm::ReadFullState(sample); });
  Hear(crazyflie, "cmd_position", "Position", [](const Bytes& sample) { return crazyswarm::ReadPosition(sample); });
  Hear(crazyflie, "cmd_velocity_world", "VelocityWorld",
       [](const Bytes& sample) { return crazyswarm::ReadVelocityWorld(sample); });
  Hear(crazyflie, "cmd_hover", "Hover",
       [&crazyflie](const Bytes& sample) { return crazyswarm::ReadHover(sample, YawOf(crazyflie.motion.q_WB)); });
}

template <class Read>
void CrazyswarmServer::Hear(Crazyflie& crazyflie, const std::string& topic, const std::string& type, const Read& read) {
  domain_->Read(In(crazyflie.name, topic), MessageType(type), [this, &crazyflie, topic, read](const Bytes& sample) {
    const std::lock_guard lock(mutex_);
    if (const auto setpoint = read(sample))
      crazyflie.commander.Stream(*setpoint, now_s());
    else
      TellOfUnread(crazyflie.name + "/" + topic);
  });
}

/// With mutex_.
void CrazyswarmServer::TellOfUnread(const std::string& name) {
  if (unread_.insert(name).second)
    warn_("warning: network.crazyswarm: a message of " + name +
          " is left alone: it is too short, or says what cannot be (a number that is none, a negative duration)");
}

template <class Read, class Act>
void CrazyswarmServer::Serve(const std::string& service, const std::string& type, const std::vector<Crazyflie*>& whom,
                             const Read& read, const Act& act) {
  domain_->Serve(service, type, [this, service, whom, read, act](const Bytes& sample) {
    const std::lock_guard lock(mutex_);
    const auto request = read(sample);
    if (!request) {
      TellOfUnread(service);
      return Bytes();
    }
    for (Crazyflie* const one : whom) act(*one, *request, now_s());
    return crazyswarm::EmptyReply();
  });
}

/// The services of one Crazyflie, or of all.
void CrazyswarmServer::Offer(const std::string& name, const std::vector<Crazyflie*>& whom) {
  namespace cs = crazyswarm;
  const auto service = [&](std::string_view which) { return fmt::format("{}/{}", name, which); };
  const auto anything = [](const Bytes&) { return std::optional(true); };
  Serve(
      service("takeoff"), ServiceType("Takeoff"), whom, [](const Bytes& sample) { return cs::ReadHeight(sample); },
      [](Crazyflie& one, const cs::HeightRequest& request, double now) {
        one.commander.TakeOff(request.height_m, request.duration_s, one.motion.p_WB, now);
      });
  Serve(
      service("land"), ServiceType("Land"), whom, [](const Bytes& sample) { return cs::ReadHeight(sample); },
      [](Crazyflie& one, const cs::HeightRequest& request, double now) {
        one.commander.Land(request.height_m, request.duration_s, one.motion.p_WB, now);
      });
  Serve(
      service("go_to"), ServiceType("GoTo"), whom, [](const Bytes& sample) { return cs::ReadGoTo(sample); },
      [](Crazyflie& one, const cs::GoToRequest& request, double now) {
        one.commander.GoTo(request.goal, request.relative, request.duration_s, one.motion.p_WB, now);
      });
  Serve(
      service("arm"), ServiceType("Arm"), whom, [](const Bytes& sample) { return cs::ReadArm(sample); },
      [](Crazyflie& one, bool arm, double) { one.commander.Arm(arm); });
  Serve(service("notify_setpoints_stop"), ServiceType("NotifySetpointsStop"), whom, anything,
        [](Crazyflie& one, bool, double now) { one.commander.NotifySetpointsStop(one.motion.p_WB, now); });
  Serve(
      service("upload_trajectory"), ServiceType("UploadTrajectory"), whom,
      [](const Bytes& sample) { return cs::ReadUpload(sample); },
      [](Crazyflie& one, const cs::UploadRequest& request, double) {
        auto& pieces = one.trajectories[request.trajectory];
        pieces.resize(std::min(pieces.size(), request.offset));
        pieces.insert(pieces.end(), request.pieces.begin(), request.pieces.end());
      });
  Serve(
      service("start_trajectory"), ServiceType("StartTrajectory"), whom,
      [](const Bytes& sample) { return cs::ReadFollow(sample); },
      [](Crazyflie& one, const cs::FollowRequest& request, double now) {
        one.commander.Follow(cs::Trajectory(one.trajectories[request.trajectory]), request.timescale, request.reversed,
                             request.relative, one.motion.p_WB, now);
      });
  // The last one: a script that has found /all/emergency takes the server for complete.
  Serve(service("emergency"), "std_srvs::srv::dds_::Empty_{}_", whom, anything,
        [](Crazyflie& one, bool, double) { one.commander.Emergency(); });
}

/// Scripts ask the server for places and radio addresses of the Crazyflies, and for their parameters: there are none.
void CrazyswarmServer::OfferParameters() {
  const auto serve = [this](std::string_view service, std::string_view type, auto answer) {
    domain_->Serve(fmt::format("{}/{}", kServer, service), fmt::format("rcl_interfaces::srv::dds_::{}_{{}}_", type),
                   std::move(answer));
  };
  serve("get_parameters", "GetParameters", [this](const Bytes& request) { return Parameters(request); });
  serve("list_parameters", "ListParameters", [](const Bytes&) { return crazyswarm::NoParametersReply(); });
  serve("describe_parameters", "DescribeParameters", [](const Bytes& request) {
    const auto names = crazyswarm::ReadNames(request);
    return names ? crazyswarm::NoDescriptorsReply(names->size()) : Bytes();
  });
  serve("set_parameters", "SetParameters", [](const Bytes& request) {
    const auto count = crazyswarm::ReadCount(request);
    return count ? crazyswarm::NotSetReply(*count) : Bytes();
  });
}

CrazyswarmServer::Bytes CrazyswarmServer::Parameters(const Bytes& request) const {
  const auto names = crazyswarm::ReadNames(request);
  if (!names) return {};
  std::vector<crazyswarm::Parameter> parameters;
  for (const std::string& name : *names) {
    crazyswarm::Parameter& parameter = parameters.emplace_back();
    for (const auto& crazyflie : crazyflies_) {
      if (name == fmt::format("robots.{}.initial_position", crazyflie->name))
        parameter.position = experiment_.agent(crazyflie->agent).p_W;
      if (name == fmt::format("robots.{}.uri", crazyflie->name))  // scripts take the last two digits for its number
        parameter.text = fmt::format("radio://0/80/2M/E7E7E7E7{:02X}", crazyflie->agent);
    }
  }
  return crazyswarm::ParametersReply(parameters);
}

std::span<const std::vector<double>> CrazyswarmServer::At(std::int64_t tick) {
  const std::lock_guard lock(mutex_);
  tick_ = tick;
  for (const auto& crazyflie : crazyflies_)
    actions_[static_cast<std::size_t>(crazyflie->agent - 1)] =
        ActionOf(crazyflie->commander.At(now_s()), crazyflie->motion, experiment_.physics.gravity_m_per_s2);
  return actions_;
}

void CrazyswarmServer::Add(const FlownRow& row) {
  const double time_s = experiment_.time_s(row.tick());
  std::vector<std::pair<std::string, Motion>> poses;
  for (const auto& crazyflie : crazyflies_) {
    Motion motion;
    bool is_armed = false, is_flying = false, is_locked = false;
    {
      const std::lock_guard lock(mutex_);
      crazyflie->motion = motion = row.decoded().motions[static_cast<std::size_t>(crazyflie->agent - 1)];
      is_armed = crazyflie->commander.is_armed();
      is_flying = crazyflie->commander.is_flying();
      is_locked = crazyflie->commander.is_locked();
    }
    if (!domain_) continue;
    poses.emplace_back(crazyflie->name, motion);
    if (IsDue(experiment_, row.tick(), kPosePerSecond)) {
      domain_->Write(In(crazyflie->name, "pose"), crazyswarm::PoseSample(motion, time_s));
      domain_->Write(In(crazyflie->name, "odom"), crazyswarm::OdometrySample(motion, crazyflie->name, time_s));
    }
    if (IsDue(experiment_, row.tick(), kStatusPerSecond))
      domain_->Write(In(crazyflie->name, "status"), crazyswarm::StatusSample(is_armed, is_flying, is_locked, time_s));
  }
  if (domain_ && IsDue(experiment_, row.tick(), kPosesPerSecond))
    domain_->Write("rt/poses", crazyswarm::PosesSample(poses, time_s));
}

}  // namespace mascot
