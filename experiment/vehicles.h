#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/enum_names.h"
#include "experiment/toml/section.h"

namespace mascot {

struct AgentConfig;
struct Experiment;

/// What is on the other end: an autopilot's interface on DDS. Each has a file in vehicle/.
enum class VehicleKind { kPx4, kCrazyswarm, kArdupilot };
inline constexpr EnumNames<VehicleKind, 3> kVehicleKinds({{VehicleKind::kPx4, "px4"},
                                                          {VehicleKind::kCrazyswarm, "crazyswarm"},
                                                          {VehicleKind::kArdupilot, "ardupilot"}});

/// What a vehicle is sent of its agent's reference.
enum class SetpointKind {
  kReference,     ///< position, velocity and acceleration
  kAcceleration,  ///< the law's
  kVelocity
};
inline constexpr EnumNames<SetpointKind, 3> kSetpointKinds({{SetpointKind::kReference, "reference"},
                                                            {SetpointKind::kAcceleration, "acceleration"},
                                                            {SetpointKind::kVelocity, "velocity"}});

/// What a vehicle does when another one is lost.
enum class OnVehicleLoss { kLand, kHold };
inline constexpr EnumNames<OnVehicleLoss, 2> kOnVehicleLoss({{OnVehicleLoss::kLand, "land"},
                                                             {OnVehicleLoss::kHold, "hold"}});

/// The vehicle that an agent has for a body.
struct VehicleConfig {
  VehicleKind kind = VehicleKind::kPx4;
  std::string name_space;  ///< before the names of its topics, "px4_1"; empty: none
  int system_id = 1;       ///< as which it takes commands
  int domain = 0;          ///< DDS domain of the vehicles
  std::string address;     ///< IPv4 address of the interface on which they are; empty: all interfaces
  SetpointKind setpoint = SetpointKind::kReference;
  Eigen::Vector3d origin_W = Eigen::Vector3d::Zero();  ///< of its local frame (m)
  double yaw_rad = 0;                                  ///< of its local frame's x axis from W's
  double takeoff_m = 1;
  std::optional<Eigen::AlignedBox3d> fence_W = {};
  double max_error_m = 1;
  OnVehicleLoss on_loss = OnVehicleLoss::kLand;
  // What its kind implies:
  bool arms_itself = false;  ///< as soon as it is switched on
  double farthest_m = 1e6;   ///< as far it can be sent along an axis of its local frame
};

/// The agents with a vehicle, in increasing id.
std::vector<int> AgentsWithVehicles(const Experiment& experiment);

/// The rows of a table of `vehicles`.
std::span<const Key> VehicleKeys();
/// Reads `vehicles` of an experiment file, and sets AgentConfig::vehicle of each agent. Mistakes are noted in
/// `document`. `run` is the section of that name.
void ReadVehicles(Section& document, Section& run, Experiment& experiment);

}  // namespace mascot
