#pragma once

#include "experiment/toml/section.h"

namespace mascot {

/// Errors of a measured motion: white noise at every tick, and a bias drawn once; per axis, zero-mean, Gaussian.
struct NoiseConfig {
  double position_std_m = 0;
  double velocity_std_m_per_s = 0;
  double position_bias_std_m = 0;
  double velocity_bias_std_m_per_s = 0;

  bool IsNone() const {
    return position_std_m == 0 && velocity_std_m_per_s == 0 && position_bias_std_m == 0 &&
           velocity_bias_std_m_per_s == 0;
  }
};

/// [sensors]: how an agent measures its own motion, and those of the agents that it hears.
struct SensorConfig {
  NoiseConfig own;  ///< errors of an agent's measurement of itself, with one bias per agent; law and low-level stack
                    ///< both get the measured motion
  double own_delay_s = 0;  ///< delay of position, velocity and acceleration; attitude has none
  NoiseConfig heard;       ///< errors of the measurement of an agent that is heard, with one bias per directed edge
  double range_m = 0;      ///< how far an agent sees obstacles (m); 0: it sees none
};

/// The keys of [sensors].
std::span<const Key> SensorKeys();
SensorConfig ReadSensors(Section& sensors);

}  // namespace mascot
