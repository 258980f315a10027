#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "base/motion.h"
#include "base/random.h"
#include "experiment/physics.h"
#include "experiment/sensors.h"

namespace mascot {

/// Measurement errors of a motion: a constant bias and white noise on position and velocity, both Gaussian. The error
/// at a tick depends only on the dice and the tick.
class Noise {
 public:
  Noise(const NoiseConfig& config, Dice dice);
  void AddTo(Motion& motion, std::int64_t tick) const;

 private:
  enum Draw : std::uint64_t { kPosition = 0, kVelocity = 3 };

  NoiseConfig config_;
  Dice dice_;
  Eigen::Vector3d bias_p_W_, bias_v_W_;
};

/// An agent's sensor for its own motion: adds delay and noise ([sensors.own]).
class OwnSensor {
 public:
  OwnSensor(const SensorConfig& config, int rate_hz, std::uint64_t seed, int id);
  /// The true motion `self` at `tick` (increasing from call to call) as measured.
  Motion Measure(std::int64_t tick, const Motion& self);

 private:
  /// Replaces position, velocity and acceleration by those of delay_ticks_ ago; before the first tick they were those
  /// of the first tick.
  void Delay(std::int64_t tick, Motion& motion);

  Noise noise_;
  bool exact_;
  std::int64_t delay_ticks_;
  std::int64_t last_tick_ = -1;
  std::vector<Motion> past_;  // the motion at tick t is at index t modulo the size
};

/// An agent's sensor for obstacles (sensors.range_m): knows where they stand, and sees them from where the agent
/// measures itself to be. Other agents and the ground are not obstacles; an agent knows of other agents only what it
/// hears.
class RangeSensor {
 public:
  RangeSensor(double range_m, std::vector<Obstacle> obstacles);
  bool is_on() const { return range_m_ > 0; }
  /// The nearest point, in W (m), of each obstacle within the range of `p_W`, as Law::See() gets them. Valid until the
  /// next call; allocates nothing.
  std::span<const Eigen::Vector3d> Sense(const Eigen::Vector3d& p_W);

 private:
  double range_m_;
  std::vector<Obstacle> obstacles_;
  std::vector<Eigen::Vector3d> nearest_W_;  // room for all obstacles
};

}  // namespace mascot
