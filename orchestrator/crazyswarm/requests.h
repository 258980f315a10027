#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/motion.h"
#include "orchestrator/crazyswarm/commander.h"
#include "orchestrator/crazyswarm/trajectory.h"

namespace mascot::crazyswarm {

// What scripts send to a Crazyswarm2 server, and what it answers and publishes, as samples of DDS: four bytes of
// encapsulation, then CDR. Metres, seconds, radians; the world is W. Source: crazyflie_interfaces, rcl_interfaces and
// standard messages of ROS 2, as of July 2026.

using Bytes = std::vector<std::uint8_t>;

/// A request of the services `takeoff` and `land`.
struct HeightRequest {
  double height_m = 0, duration_s = 0;
};
struct GoToRequest {
  bool relative = false;
  Eigen::Vector3d goal = Eigen::Vector3d::Zero();
  double duration_s = 0;
};
struct UploadRequest {
  int trajectory = 0;
  std::size_t offset = 0;  ///< of the first of `pieces` among those of the trajectory
  std::vector<Trajectory::Piece> pieces = {};
};
struct FollowRequest {
  int trajectory = 0;
  double timescale = 1;
  bool reversed = false, relative = false;
};

// What a sample says; nothing if it is too short or no such message, or if it asks for what cannot be: a number that is
// none or beyond all reason, a negative duration, a timescale of 0 or less.
std::optional<bool> ReadArm(std::span<const std::uint8_t> sample);
std::optional<HeightRequest> ReadHeight(std::span<const std::uint8_t> sample);
std::optional<GoToRequest> ReadGoTo(std::span<const std::uint8_t> sample);
std::optional<UploadRequest> ReadUpload(std::span<const std::uint8_t> sample);
std::optional<FollowRequest> ReadFollow(std::span<const std::uint8_t> sample);
std::optional<Setpoint> ReadFullState(std::span<const std::uint8_t> sample);
std::optional<Setpoint> ReadPosition(std::span<const std::uint8_t> sample);
std::optional<Setpoint> ReadVelocityWorld(std::span<const std::uint8_t> sample);
/// `yaw_rad`: of the vehicle, from whose heading its velocities are counted.
std::optional<Setpoint> ReadHover(std::span<const std::uint8_t> sample, double yaw_rad);
/// Names, of `get_parameters` and `describe_parameters`.
std::optional<std::vector<std::string>> ReadNames(std::span<const std::uint8_t> sample);
/// How many parameters are to be set.
std::optional<std::size_t> ReadCount(std::span<const std::uint8_t> sample);

// Answers.
Bytes EmptyReply();
/// A parameter of the server: an initial position, a text, or none that there is.
struct Parameter {
  std::optional<Eigen::Vector3d> position = {};
  std::optional<std::string> text = {};
};
Bytes ParametersReply(const std::vector<Parameter>& parameters);
Bytes NoParametersReply();                    ///< of `list_parameters`
Bytes NoDescriptorsReply(std::size_t names);  ///< of `describe_parameters`: none of these is known
Bytes NotSetReply(std::size_t parameters);    ///< of `set_parameters`: none of these was

// Topics. `time_s`: of the run, for the header.
Bytes PoseSample(const Motion& motion, double time_s);
Bytes OdometrySample(const Motion& motion, const std::string& name, double time_s);
Bytes PosesSample(const std::vector<std::pair<std::string, Motion>>& motions, double time_s);
Bytes StatusSample(bool is_armed, bool is_flying, bool is_locked, double time_s);

}  // namespace mascot::crazyswarm
