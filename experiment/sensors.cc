#include "experiment/sensors.h"

#include <array>

#include "experiment/link.h"

namespace mascot {
namespace {

constexpr Range kNoise = {0, 1000};
constexpr std::array kHeardKeys = {
    key::Number("position_std_m", kNoise, "white noise on the position, per axis and tick").Default("0.0"),
    key::Number("velocity_std_m_per_s", kNoise, "white noise on the velocity, per axis and tick").Default("0.0"),
    key::Number("position_bias_std_m", kNoise, "standard deviation of a constant error of the position, drawn once")
        .Default("0.0"),
    key::Number("velocity_bias_std_m_per_s", kNoise,
                "standard deviation of a constant error of the velocity, drawn once")
        .Default("0.0"),
};
constexpr auto kOwnKeys =
    Joined(kHeardKeys, std::array{key::Number("delay_s", {0, kLongestDelay_s},
                                              "delay with which an agent knows its own position and velocity, rounded "
                                              "up to whole ticks; it knows its attitude at once")
                                      .Default("0.0")});
constexpr Key kSensorKeys[] = {
    key::Number("range_m", {0, 1e6},
                "how far from its measured position an agent sees the nearest point of each obstacle, for laws that "
                "use it; 0: the agent has no such sensor")
        .Default("0.0"),
    key::Table("own", kOwnKeys, "what an agent measures of itself: law and low-level stack both get this"),
    key::Table("heard", kHeardKeys, "what an agent measures of each agent that it hears"),
};

NoiseConfig ReadNoise(Section& section) {
  NoiseConfig noise;
  noise.position_std_m = section.Number("position_std_m");
  noise.velocity_std_m_per_s = section.Number("velocity_std_m_per_s");
  noise.position_bias_std_m = section.Number("position_bias_std_m");
  noise.velocity_bias_std_m_per_s = section.Number("velocity_bias_std_m_per_s");
  return noise;
}

}  // namespace

std::span<const Key> SensorKeys() { return kSensorKeys; }

SensorConfig ReadSensors(Section& sensors) {
  SensorConfig config;
  Section own = sensors.Child("own"), heard = sensors.Child("heard");
  config.own = ReadNoise(own);
  config.own_delay_s = own.Number("delay_s");
  own.Done();
  config.heard = ReadNoise(heard);
  heard.Done();
  config.range_m = sensors.Number("range_m");
  sensors.Done();
  return config;
}

}  // namespace mascot
