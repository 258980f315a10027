#include "experiment/control.h"

#include <array>

namespace mascot {
namespace {

constexpr std::string_view kOfAirframe = "the airframe's";

constexpr Range kLoopGain = {0, 1e4};
constexpr Key kLoopGainKeys[] = {
    key::Number("kp", kLoopGain, "proportional").Required(),
    key::Number("kd", kLoopGain, "derivative").Required(),
};

constexpr std::array kAgentKeys = {
    key::Table("altitude", kLoopGainKeys, "gains of the altitude loop: m/s^2 per m and per m/s").Otherwise(kOfAirframe),
    key::Table("heading", kLoopGainKeys, "gains of the heading loop: rad/s^2 per rad and per rad/s")
        .Otherwise(kOfAirframe),
    key::Table("attitude", kLoopGainKeys, "gains of the roll and pitch loops: rad/s^2 per rad and per rad/s")
        .Otherwise(kOfAirframe),
    key::Table("position", kLoopGainKeys, "gains of the position loop in x and y: m/s^2 per m and per m/s")
        .Otherwise(kOfAirframe),
    key::Number("heading_rad", {-10, 10}, "wanted yaw").Default("0.0"),
    key::Number("max_acceleration_m_per_s2", Above(0, 1000),
                "limit on the acceleration that the law wants, per axis; the run counts how often it cuts")
        .Default("3.0")
        .Live(),
    key::Number("max_speed_m_per_s", Above(0, 1000),
                "limit on the velocity that the law wants, per axis; the run counts how often it cuts")
        .Default("100.0")
        .Live(),
    key::Number("velocity_gain", Above(0, 1000),
                "k_v: to reach a wanted velocity v*, a model driven by acceleration is commanded k_v (v* - v)")
        .Default("2.0")
        .Unit("1/s")
        .Live(),
    key::Number("look_ahead_m", Above(0, 100),
                "unicycle: distance from its centre to the point ahead of it that moves with the wanted velocity")
        .Default("0.1"),
    key::Number("tilt_limit_rad", Above(0, 1.5), "limit on roll and on pitch").Otherwise(kOfAirframe),
    key::OneOf("inversion", kInversions.names(),
               "how a wanted acceleration becomes roll, pitch and thrust; the paper has small_angle")
        .Default("\"small_angle\""),
    key::Boolean("drag_compensation", "adds the known drag to the wanted acceleration").Default("true"),
};

constexpr auto kControlKeys = Joined(
    std::array{
        key::Integer("rate_hz", 1, 100000, "ticks per simulated second; divides `physics.rate_hz`").Default("100"),
        key::Integer("python_memory_mb", 100, 1'000'000,
                     "how much memory a process may take while it runs a law in Python, and an Octave that runs a law; "
                     "a law that exceeds it fails")
            .Otherwise("2000")},
    kAgentKeys);

/// Reads the gains of one loop, if given, in place of the airframe's.
void ReadGains(Section& control, std::string_view key, PdGains Airframe::*loop, std::span<AgentConfig> agents) {
  if (!control.Has(key)) return;
  Section section = control.Child(key);
  PdGains gains;
  gains.kp = section.Number("kp");
  gains.kd = section.Number("kd");
  section.Done();
  for (AgentConfig& agent : agents) agent.airframe.*loop = gains;
}

}  // namespace

std::span<const Key> ControlKeys() { return kControlKeys; }

std::span<const Key> AgentControlKeys() { return kAgentKeys; }

void ReadControl(Section& section, std::span<AgentConfig> agents) {
  ControlConfig control;
  ReadGains(section, "altitude", &Airframe::altitude, agents);
  ReadGains(section, "heading", &Airframe::heading, agents);
  ReadGains(section, "attitude", &Airframe::attitude, agents);
  ReadGains(section, "position", &Airframe::position, agents);
  control.heading_rad = section.Number("heading_rad");
  control.max_acceleration_m_per_s2 = section.Number("max_acceleration_m_per_s2");
  control.max_speed_m_per_s = section.Number("max_speed_m_per_s");
  control.velocity_gain = section.Number("velocity_gain");
  control.look_ahead_m = section.Number("look_ahead_m");
  if (section.Has("tilt_limit_rad")) {
    const double tilt_limit_rad = section.Number("tilt_limit_rad");
    for (AgentConfig& agent : agents) agent.airframe.tilt_limit_rad = tilt_limit_rad;
  }
  control.inversion = kInversions.Value(section.OneOf("inversion"));
  control.drag_compensation = section.Boolean("drag_compensation");
  section.Done();
  for (AgentConfig& agent : agents) agent.control = control;
}

}  // namespace mascot
