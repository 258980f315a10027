#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/flight_phase.h"
#include "experiment/experiment.h"
#include "vehicle/autopilot.h"
#include "vehicle/frames.h"
#include "vehicle/reference.h"

namespace mascot {

struct PilotRules {
  SetpointKind setpoint = SetpointKind::kReference;
  Eigen::Vector3d start_W = Eigen::Vector3d::Zero();  ///< of the agent (m)
  double start_yaw = 0;                               ///< rad
  bool holds_height = false;                          ///< the law does not command z, which stays that of the start
  double takeoff_m = 1;                               ///< it climbs so high before it flies to its start
  std::optional<Eigen::AlignedBox3d> fence = {};      ///< in W; beyond it the vehicle lands
  double max_error_m = 1;                             ///< from the reference; beyond it the vehicle lands
  double rate_hz = 100;                               ///< of the agent
  LocalFrame frame = {};                              ///< of the vehicle
  bool arms_itself = false;                           ///< as soon as it is switched on
  double farthest_m = 1e6;                            ///< as far it can be sent along an axis of its frame
};

/// What a pilot has to know of an agent with a vehicle.
PilotRules PilotRulesOf(const Experiment& experiment, int agent);

/// Why a vehicle that is at `p_W`, in W, may not start, in words for people; empty: it may.
std::vector<std::string> WhyNotToStart(const PilotRules& rules, const VehicleReport& report,
                                       const Eigen::Vector3d& p_W);

/// Flies one vehicle: arms it when told to, takes it to its agent's start, turns the agent's commands into set-points,
/// and lands it. What it believes is the vehicle's own status, never that an order was given. No clock, no DDS.
class Pilot {
 public:
  using Time = VehicleReport::Time;

  // How long is waited, and how near is there.
  static constexpr std::chrono::milliseconds kStreamFirst{1500};   ///< set-points before any order
  static constexpr std::chrono::milliseconds kAskEvery{500};       ///< an order is repeated
  static constexpr std::chrono::milliseconds kObeyWithin{10'000};  ///< else it is given up
  static constexpr std::chrono::milliseconds kMaxAge{1000};        ///< of a vehicle's motion: older ones are a loss
  static constexpr std::chrono::milliseconds kMaxStatusAge{3000};  ///< likewise, of its status
  static constexpr std::chrono::milliseconds kMaxCommandAge{500};  ///< of an agent's command: then nothing is sent
  static constexpr std::chrono::milliseconds kStopWithin{3000};  ///< motors, else the vehicle is lost, and still asked
  static constexpr std::chrono::milliseconds kSettle{1000};      ///< at the start, before it is ready
  static constexpr double kNear_m = 0.2;
  static constexpr double kTransferSpeed_m_per_s = 0.5;
  static constexpr double kBraking_m_per_s2 = 1;                         ///< before it lands
  static constexpr double kBatteryToStart = 0.3, kBatteryToLand = 0.15;  // share that is left
  static constexpr double kMaxFromStart_m = 0.5;  ///< before it takes off, in the plane; and from the ground
  static constexpr double kLowestStart_m = 0.3;   ///< above where it stands

  explicit Pilot(const PilotRules& rules);

  // What people and the run want; each holds from the next Look() on.
  /// Only of a vehicle that is found.
  void Start() { wants_start_ = phase_ == FlightPhase::kFound; }
  /// One that has not begun to start does not.
  void Land(std::string why);
  void StopMotors(std::string why);
  /// The agent's acceleration for a tick; the first one makes a vehicle that is ready fly. After a silence of more than
  /// kMaxCommandAge the reference begins anew, where the vehicle is.
  void Command(std::int64_t tick, const Eigen::Vector3d& a_W, Time now);

  /// What is to be sent now.
  struct Turn {
    std::optional<VehicleSetpoint> setpoint = {};
    std::optional<VehicleOrder> order = {};
  };
  /// Call it often, at least at twice the rate that the autopilot wants of its signs of life.
  Turn Look(const VehicleReport& report, Time now);

  FlightPhase phase() const { return phase_; }
  /// The vehicle's motion in W, after the first report that has one; a jump of its estimator is taken out, from when
  /// set-points are streamed on.
  const std::optional<Motion>& motion_W() const { return motion_W_; }
  const Reference& reference() const { return reference_; }
  /// What has happened since the last call, in words for people.
  std::vector<std::string> TakeWords() { return std::exchange(words_, {}); }

 private:
  void Enter(FlightPhase phase, Time now, std::string words);
  void Measure(const VehicleReport& report);
  /// Why the vehicle must be given up or landed, in words; empty: it need not.
  std::string WhyLost(const VehicleReport& report, Time now) const;
  std::string WhyToLand(const VehicleReport& report) const;
  Turn Stream(const VehicleReport& report, Time now);
  /// It does not start: back to where nothing is sent, by landing if it is armed already.
  Turn LeaveStart(const VehicleReport& report, const std::string& why, Time now);
  Turn StopNow(const VehicleReport& report, Time now);
  Turn TakeOff(Time now);
  Turn Fly(Time now);
  Turn LandNow(const VehicleReport& report, Time now);
  void LookAtLife(const VehicleReport& report, Time now);
  Turn Act(const VehicleReport& report, Time now);
  std::optional<VehicleOrder> Repeated(VehicleOrder order, Time now);
  VehicleSetpoint InFrame(const Eigen::Vector3d& p_W, const Eigen::Vector3d& v_W, const Eigen::Vector3d& a_W) const;

  const PilotRules rules_;
  FlightPhase phase_ = FlightPhase::kAbsent;
  Time since_ = {};  // phase_
  std::optional<Time> asked_at_ = {};
  std::optional<VehicleOrder> asked_ = {};
  LocalFrame frame_;
  int resets_ = 0;
  std::optional<Motion> motion_L_ = {}, motion_W_ = {};
  Time measured_at_ = {};
  bool wants_start_ = false, wants_stop_ = false;
  std::optional<Time> stops_since_;  // since when its motors are to stop
  bool has_obeyed_ = false;          // while it lands: it has followed set-points, or landed itself
  std::optional<std::string> wants_land_ = {};
  std::string problem_;  // the newest that was told of a vehicle that is absent
  struct Stop {
    Eigen::Vector3d p_W, v_W;
  };
  std::optional<Stop> stop_ = {};                     // the motion with which it has begun to stop for its landing
  Eigen::Vector3d rest_W_ = Eigen::Vector3d::Zero();  // where it was when set-points began
  std::optional<Time> near_since_ = {};
  Reference reference_;
  std::optional<Time> commanded_at_ = {};
  bool is_silent_ = false;  // the agent: nothing is sent
  std::vector<std::string> words_;
};

}  // namespace mascot
