#pragma once

#include <cstdint>
#include <vector>

#include "experiment/motion.h"
#include "experiment/random.h"
#include "experiment/sensors.h"

namespace mascot {

/// What measuring does to a motion: adds a bias and white noise to position and velocity. The error at a tick depends
/// on the dice and the tick alone.
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

/// What an agent knows of itself.
class OwnSensor {
 public:
  OwnSensor(const SensorConfig& config, int rate_hz, std::uint64_t seed, int id);
  /// The motion `self` at `tick` (increasing from call to call) as measured.
  Motion Measure(std::int64_t tick, const Motion& self);

 private:
  /// Position and velocity of an earlier tick, or the first there was.
  void Delay(std::int64_t tick, Motion& motion);

  Noise noise_;
  bool exact_;
  std::int64_t delay_ticks_;
  std::int64_t last_tick_ = -1;
  std::vector<Motion> past_;  // the motion at tick t in place t modulo its size
};

}  // namespace mascot
