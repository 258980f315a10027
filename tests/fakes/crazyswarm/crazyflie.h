#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "base/motion.h"
#include "tests/fakes/options.h"
#include "tests/fakes/quadrotor.h"

namespace mascot::fakes {

// A Crazyflie as its firmware's supervisor and commander are published: it flies set-points that are streamed, levels
// 500 ms after the last one, and stops its motors after 2 s. World: that of the motion capture. Time is that since it
// was switched on (s).

struct CrazyflieFaults : Faults {
  double tumbles_at_s = kNever_s;
  double battery_low_at_s = kNever_s;
};

struct CrazyflieOptions {
  Eigen::Vector3d place_W = Eigen::Vector3d::Zero();  ///< of the ground on which it stands (m)
  CrazyflieFaults faults = {};
};

struct CrazyflieSetpoint {
  Eigen::Vector3d p_W, v_W, a_W;  ///< NaN: not controlled
};

class Crazyflie {
 public:
  enum Supervisor : std::uint16_t {
    kCanBeArmed = 1,
    kIsArmed = 2,
    kCanFly = 8,
    kIsFlying = 16,
    kIsTumbled = 32,
    kIsLocked = 64
  };

  explicit Crazyflie(const CrazyflieOptions& options);

  // From its server, over the radio.
  void Arm(bool arm);
  void Emergency() { is_locked_ = true; }
  void StopStreaming() { streamed_.reset(); }
  void Stream(const CrazyflieSetpoint& setpoint);

  /// Flies for Quadrotor::kPeriod_s.
  void Step();

  double t_s() const { return static_cast<double>(steps_) * Quadrotor::kPeriod_s; }
  bool HasRadio() const { return !options_.faults.IsSilent(body_); }
  std::uint16_t supervisor() const;
  double battery_V() const { return body_.flown_s() < options_.faults.battery_low_at_s ? 4.0 : 3.1; }
  Motion motion() const { return body_.motion(); }

 private:
  std::optional<Eigen::Vector3d> WantedAcceleration_W();

  const CrazyflieOptions options_;
  Quadrotor body_;
  std::int64_t steps_ = 0;
  bool is_armed_ = false, is_tumbled_ = false, is_locked_ = false, motors_run_ = false;
  std::optional<CrazyflieSetpoint> streamed_;
  double streamed_at_s_ = 0;
};

}  // namespace mascot::fakes
