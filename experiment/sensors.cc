#include "experiment/sensors.h"

#include "experiment/link.h"

namespace mascot {
namespace {

NoiseConfig ReadNoise(Section& section) {
  constexpr double kLargest = 1000;
  NoiseConfig noise;
  noise.position_std_m = section.Number("position_std_m", 0, kLargest, 0.0);
  noise.velocity_std_m_per_s = section.Number("velocity_std_m_per_s", 0, kLargest, 0.0);
  noise.position_bias_std_m = section.Number("position_bias_std_m", 0, kLargest, 0.0);
  noise.velocity_bias_std_m_per_s = section.Number("velocity_bias_std_m_per_s", 0, kLargest, 0.0);
  return noise;
}

}  // namespace

SensorConfig ReadSensors(Section& sensors) {
  SensorConfig config;
  Section own = sensors.Child("own"), heard = sensors.Child("heard");
  config.own = ReadNoise(own);
  config.own_delay_s = own.Number("delay_s", 0, kLongestDelay_s, 0.0);
  own.Done();
  config.heard = ReadNoise(heard);
  heard.Done();
  sensors.Done();
  return config;
}

}  // namespace mascot
