#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/motion.h"
#include "tests/fakes/options.h"
#include "tests/fakes/quadrotor.h"

namespace mascot::fakes {

// A copter with ArduPilot, as its published rules have mode GUIDED: velocities are taken in the air alone, after a
// take-off that it does itself. World east, north, up from where it was switched on, which is its home. Time is that
// since then (s).

struct ArdupilotFaults : Faults {
  double pilot_at_s = kNever_s;  ///< a switch on the remote control: mode LOITER
  double battery_low_at_s = kNever_s;
};

struct ArdupilotOptions {
  Eigen::Vector3d place_ENU = Eigen::Vector3d::Zero();  ///< where it was switched on, on the ground of the true world
  ArdupilotFaults faults = {};
};

class ArdupilotAutopilot {
 public:
  enum Mode : std::uint8_t { kStabilize = 0, kGuided = 4, kLoiter = 5, kLand = 9 };
  static constexpr std::uint8_t kBatteryFailsafe = 22;
  static constexpr double kPeriod_s = Quadrotor::kPeriod_s;

  explicit ArdupilotAutopilot(const ArdupilotOptions& options);

  // From others; each returns whether it does it.
  bool SetMode(int mode);
  bool Arm(bool arm);
  bool TakeOff(double height_m);
  void SetVelocity(const Eigen::Vector3d& v_ENU);

  /// Flies for kPeriod_s.
  void Step();

  double t_s() const { return static_cast<double>(steps_) * kPeriod_s; }
  bool is_armed() const { return is_armed_; }
  Mode mode() const { return mode_; }
  bool is_flying() const { return is_armed_ && body_.resting_s() == 0 && body_.height_m() > 0.05; }
  double battery() const {
    return body_.flown_s() < options_.faults.battery_low_at_s ? 0.9 : 0.1;
  }  ///< share that is left
  std::vector<std::uint8_t> failsafes() const;
  bool HasRadio() const { return !options_.faults.IsSilent(body_); }
  Motion motion() const;  ///< as its filter has it, from its home

 private:
  void Enter(Mode mode);
  Eigen::Vector3d WantedAcceleration_ENU();

  const ArdupilotOptions options_;
  Quadrotor body_;
  std::int64_t steps_ = 0;
  Mode mode_ = kStabilize;
  bool is_armed_ = false, has_flown_ = false;
  double armed_at_s_ = 0;
  std::optional<double> takeoff_m_;
  Eigen::Vector3d velocity_ENU_ = Eigen::Vector3d::Zero();
  double velocity_at_s_ = 0;
  Eigen::Vector3d hold_ENU_;
  bool is_braking_ = false;  // before it descends
};

}  // namespace mascot::fakes
