#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/fakes/options.h"
#include "tests/fakes/quadrotor.h"

namespace mascot::fakes {

// A PX4 autopilot and its quadrotor, as the published rules of its offboard mode have them. World NED, body FRD. The
// origin of its local frame is where it was switched on. Time is that of its own clock: seconds since that.

struct Px4Faults : Faults {
  bool has_no_heading = false;  ///< its odometry is in a frame of unknown heading
  bool hears_no_signs_of_life = false;
  double reset_at_s = kNever_s;  ///< its estimator moves the origin of its frame by `reset_NED`
  Eigen::Vector3d reset_NED = {1, -2, 0.5};
  double pilot_at_s = kNever_s;  ///< a switch on the remote control: position mode
};

struct Px4Options {
  int system_id = 1;
  Eigen::Vector3d place_ENU = Eigen::Vector3d::Zero();  ///< where it was switched on, on the ground of the true world
  double offboard_loss_s = 1.0;                         ///< COM_OF_LOSS_T
  Px4Faults faults = {};
};

struct Px4Setpoint {
  Eigen::Vector3d p_NED, v_NED, a_NED;  ///< NaN: not controlled
  double yaw_rad = 0;                   ///< from north, towards east
};

struct Px4Command {
  std::uint32_t command = 0;
  float param1 = 0, param2 = 0;
  int target_system = 0;
};

struct Px4Odometry {
  Eigen::Vector3d p_NED, v_NED, w_FRD;
  Eigen::Quaterniond q_NED_FRD;
  bool is_in_ned = true;
  std::uint8_t reset_counter = 0;
};

class Px4Autopilot {
 public:
  enum NavState : std::uint8_t { kPosition = 2, kHold = 4, kOffboard = 14, kLand = 18 };
  enum Result : std::uint8_t { kAccepted = 0, kTemporarilyRejected = 1, kDenied = 2, kUnsupported = 3 };
  static constexpr double kPeriod_s = Quadrotor::kPeriod_s;

  explicit Px4Autopilot(const Px4Options& options);

  // From the companion computer. A sign of life says what the set-points control: "position".
  void OnSignOfLife(const std::string& controlled);
  void OnSetpoint(const Px4Setpoint& setpoint) { setpoint_ = setpoint; }
  /// What it acknowledges; nothing: the command is for another system.
  std::optional<Result> OnCommand(const Px4Command& command);

  /// Flies for kPeriod_s.
  void Step();

  double t_s() const { return static_cast<double>(steps_) * kPeriod_s; }
  bool is_armed() const { return is_armed_; }
  NavState nav_state() const { return nav_state_; }
  bool is_landed() const { return is_landed_; }
  bool HasRadio() const { return !options_.faults.IsSilent(body_); }
  Px4Odometry odometry() const;
  /// What it has done since the last call, in words.
  std::vector<std::string> TakeWords() { return std::exchange(words_, {}); }

 private:
  bool MayFollow() const;
  Result SetMode(const Px4Command& command);
  Result Arm(const Px4Command& command);
  void Enter(NavState state, const std::string& words);
  void Disarm();
  void LookAtFailsafes();
  void LookAtGround();
  Eigen::Vector3d WantedAcceleration_ENU();

  const Px4Options options_;
  Quadrotor body_;
  std::int64_t steps_ = 0;
  NavState nav_state_ = kHold;
  bool is_armed_ = false, is_landed_ = true, has_flown_ = false;
  double armed_at_s_ = 0, highest_m_ = 0;
  std::string controlled_;
  double sign_of_life_s_ = -1e9, signs_since_s_ = 0;
  std::optional<Px4Setpoint> setpoint_;
  Eigen::Vector3d hold_ENU_;                             // where it holds, or above which it lands
  bool is_braking_ = false;                              // before it descends
  Eigen::Vector3d shift_NED_ = Eigen::Vector3d::Zero();  // of the origin of its frame
  std::uint8_t resets_ = 0;
  std::vector<std::string> words_;
};

}  // namespace mascot::fakes
