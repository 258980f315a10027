#include "experiment/experiment.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "experiment/agents.h"

namespace mascot {
namespace {

using Names2 = std::array<std::string_view, 2>;

constexpr double kMaxDuration_s = 1e6;
constexpr double kMaxTicks = 1e9;  // recordings number their samples with 32 bits
constexpr double kMaxTimeout_s = 3600;
constexpr int kMaxDomain = 100;  // above, DDS's ports meet those that Linux hands out

bool IsNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
         c == '-' || c == ' ';
}

bool IsName(std::string_view name) {
  constexpr std::size_t kLongest = 100;
  return !name.empty() && name.size() <= kLongest && std::string_view("._- ").find(name.front()) == name.npos &&
         std::all_of(name.begin(), name.end(), IsNameCharacter);
}

/// A name made of a file's: what a name cannot hold becomes '_'.
std::string NameFrom(std::string text) {
  for (char& c : text)
    if (!IsNameCharacter(c)) c = '_';
  return IsName(text) ? text : "experiment";
}

void ReadRun(Section& section, const std::string& default_name, Experiment& experiment) {
  constexpr Names2 kModes = {"lockstep", "realtime"};
  auto& run = experiment.run;
  run.name = section.Text("name", NameFrom(default_name));
  if (!section.Wrong("name") && !IsName(run.name))
    section.Fail("name",
                 "expected a letter or digit, then letters, digits, '.', '_', '-' and spaces, got '" + run.name + "'");
  run.duration_s = section.Positive("duration_s", kMaxDuration_s);
  run.mode = section.OneOf("mode", kModes, "lockstep") == "realtime" ? Mode::kRealtime : Mode::kLockstep;
  run.seed = static_cast<std::uint64_t>(section.Integer("seed", 0, INT64_MAX, 1));
  run.agent_timeout_s = section.Positive("agent_timeout_s", kMaxTimeout_s, 5.0);
  run.start_timeout_s = section.Positive("start_timeout_s", kMaxTimeout_s, 60.0);
  run.speed = section.Positive("speed", 1000, 1.0);
  section.Done();
}

LawConfig ReadLaw(Section section, int count, const Vocabulary& vocabulary) {
  constexpr Names2 kAxes = {"xy", "xyz"};
  LawConfig law;
  law.name = section.OneOf("name", vocabulary.laws, "consensus");
  law.leader = static_cast<int>(section.Integer("leader", 0, count > 0 ? count : kMaxAgents, 0));
  const bool is_xyz = std::ranges::find(vocabulary.xyz_laws, law.name) != vocabulary.xyz_laws.end();
  law.axes = section.OneOf("axes", kAxes, is_xyz ? "xyz" : "xy") == "xyz" ? Axes::kXyz : Axes::kXy;
  law.section = section;
  return law;
}

/// Gains given for one loop, in place of the airframe's.
void ReadGains(Section& control, std::string_view key, PdGains Airframe::*loop, std::span<AgentConfig> agents) {
  if (!control.Has(key)) return;
  constexpr double kMaxGain = 1e4;
  Section section = control.Child(key);
  PdGains gains;
  gains.kp = section.Number("kp", 0, kMaxGain);
  gains.kd = section.Number("kd", 0, kMaxGain);
  section.Done();
  for (AgentConfig& agent : agents) agent.airframe.*loop = gains;
}

/// All of [control] that may differ from agent to agent.
void ReadControl(Section& section, std::span<AgentConfig> agents) {
  constexpr Names2 kInversions = {"small_angle", "exact"};
  ControlConfig control;
  ReadGains(section, "altitude", &Airframe::altitude, agents);
  ReadGains(section, "heading", &Airframe::heading, agents);
  ReadGains(section, "attitude", &Airframe::attitude, agents);
  ReadGains(section, "position", &Airframe::position, agents);
  control.heading_rad = section.Number("heading_rad", -10, 10, 0.0);
  control.max_acceleration_m_per_s2 = section.Positive("max_acceleration_m_per_s2", 1000, 3.0);
  control.max_speed_m_per_s = section.Positive("max_speed_m_per_s", 1000, 100.0);
  control.velocity_gain = section.Positive("velocity_gain", 1000, 2.0);
  control.look_ahead_m = section.Positive("look_ahead_m", 100, 0.1);
  if (section.Has("tilt_limit_rad")) {
    const double tilt_limit_rad = section.Positive("tilt_limit_rad", 1.5);
    for (AgentConfig& agent : agents) agent.airframe.tilt_limit_rad = tilt_limit_rad;
  }
  control.inversion =
      section.OneOf("inversion", kInversions, "small_angle") == "exact" ? Inversion::kExact : Inversion::kSmallAngle;
  control.drag_compensation = section.Boolean("drag_compensation", true);
  section.Done();
  for (AgentConfig& agent : agents) agent.control = control;
}

/// The parts of an override that stand in place of [control] and [law], or of some of their keys.
void FinishOverride(AgentOverride& override, Section& control, int count, const Vocabulary& vocabulary,
                    Experiment& experiment) {
  Section& section = override.section;
  AgentConfig unknown;
  AgentConfig& agent = override.id > 0 ? experiment.agents[static_cast<std::size_t>(override.id - 1)] : unknown;
  if (section.Has("control")) {
    Section own = section.Child("control");
    own.InheritFrom(control);
    ReadControl(own, {&agent, 1});
  }
  if (section.Has("law")) {
    Section own = section.Child("law");
    const bool same_law = !own.Has("name") || own.Text("name") == experiment.law.name;
    if (same_law) own.InheritFrom(experiment.law.section);
    agent.law = ReadLaw(own, count, vocabulary);
    agent.has_own_law = true;
  }
  section.Done();
}

/// Rotors that fail are those of quadrotors.
void CheckRotorFailures(Section& physics, const Experiment& experiment) {
  if (experiment.agents.empty() || physics.Wrong("rotor_failures")) return;
  const auto& failures = experiment.physics.rotor_failures;
  for (std::size_t k = 0; k < failures.size(); ++k) {
    const AgentConfig& agent = experiment.agent(failures[k].agent);
    if (agent.model != "quadrotor")
      physics.FailRow("rotor_failures", k,
                      "expected a quadrotor, got agent " + std::to_string(agent.id) + ", a " + agent.model);
  }
}

/// A tick is a whole number of physics steps, a run a whole number of ticks.
void CheckTime(Section& run, Section& physics, Section& control, const Experiment& experiment) {
  const int rate_hz = experiment.control.rate_hz;
  if (control.Wrong("rate_hz")) return;
  if (!physics.Wrong("rate_hz") && experiment.physics.rate_hz % rate_hz != 0)
    control.Fail("rate_hz", "expected a divisor of physics.rate_hz (" + std::to_string(experiment.physics.rate_hz) +
                                "), got " + std::to_string(rate_hz));
  if (run.Wrong("duration_s") || control.Wrong("rate_hz")) return;
  constexpr double kTolerance = 1e-9;  // relative: 0.1 s at 30 Hz is 3 ticks although 0.1 is not a binary fraction
  const double ticks = experiment.run.duration_s * rate_hz;
  const std::string got = ", got " + ShortestFloat(experiment.run.duration_s);
  if (ticks > kMaxTicks)
    run.Fail("duration_s", "expected at most 1000000000 periods of control.rate_hz" + got);
  else if (std::round(ticks) < 1 || std::abs(ticks - std::round(ticks)) > kTolerance * ticks)
    run.Fail("duration_s",
             "expected a whole number of periods of control.rate_hz (" + std::to_string(rate_hz) + ")" + got);
}

void ReadRecord(Section& section, Experiment& experiment) {
  auto& record = experiment.record;
  record.file = section.Text("file", "run.mcap");
  const bool plain = record.file.find('/') == std::string::npos && record.file.find('\0') == std::string::npos;
  if (!section.Wrong("file") && (!plain || !record.file.ends_with(".mcap") || record.file.size() > 200))
    section.Fail("file", "expected a file name ending in .mcap, without folders, got '" + record.file + "'");
  record.topics = section.Texts("topics", {"*"});
  section.Done();
}

void ReadOutput(Section& section, Experiment& experiment) {
  auto& output = experiment.output;
  output.position_plot = section.Boolean("position_plot", true);
  output.velocity_plot = section.Boolean("velocity_plot", true);
  output.save_plot = section.Boolean("save_plot", true);
  output.show_plot = section.Boolean("show_plot", false);
  output.save_data = section.Boolean("save_data", true);
  output.fidelity = section.Boolean("fidelity", true);
  section.Done();
}

void ReadNetwork(Section& section, std::span<const std::string_view> transports, Experiment& experiment) {
  auto& network = experiment.network;
  if (const std::string kind = section.Kind("domain"); kind.empty() || kind == "string") {
    const std::string domain = section.Text("domain", "auto");
    if (domain != "auto")
      section.Fail("domain",
                   "expected \"auto\" or an integer in [0, " + std::to_string(kMaxDomain) + "], got '" + domain + "'");
  } else {
    network.domain = static_cast<int>(section.Integer("domain", 0, kMaxDomain));
  }
  network.transport = section.OneOf("transport", transports, "auto");
  section.Done();
}

}  // namespace

std::int64_t Experiment::ticks() const { return std::llround(run.duration_s * control.rate_hz); }

Experiment ReadExperiment(Section document, const Vocabulary& vocabulary, const std::string& default_name) {
  // In the order of the resolved file; read below in the order in which one needs the other.
  Section run = document.Child("run"), physics = document.Child("physics"), agents = document.Child("agents"),
          control = document.Child("control"), sensors = document.Child("sensors"), graph = document.Child("graph"),
          link = document.Child("link"), law = document.Child("law"), record = document.Child("record"),
          output = document.Child("output"), network = document.Child("network");
  document.Done();

  Experiment experiment;
  experiment.document = document;
  ReadRun(run, default_name, experiment);
  int count = static_cast<int>(agents.Integer("count", 1, kMaxAgents));
  if (agents.Wrong("count")) count = 0;
  experiment.physics = ReadPhysics(physics, count);
  experiment.law = ReadLaw(law, count, vocabulary);
  std::vector<AgentOverride> overrides = ReadAgents(agents, count, vocabulary.models, experiment);
  CheckRotorFailures(physics, experiment);
  experiment.control.rate_hz = static_cast<int>(control.Integer("rate_hz", 1, 100000, 100));
  ReadControl(control, experiment.agents);
  for (AgentOverride& override : overrides) FinishOverride(override, control, count, vocabulary, experiment);
  CheckTime(run, physics, control, experiment);
  experiment.sensors = ReadSensors(sensors);
  std::vector<Eigen::Vector3d> p_W;
  for (const AgentConfig& agent : experiment.agents) p_W.push_back(agent.p_W);
  experiment.schedule = ReadSchedule(graph, p_W, experiment.run.seed);
  graph.Done();
  experiment.graph = experiment.schedule.Union();
  experiment.links = ReadLinks(link, experiment.graph);
  ReadRecord(record, experiment);
  ReadOutput(output, experiment);
  ReadNetwork(network, vocabulary.transports, experiment);

  // What a law would say of these would only follow from the mistake.
  if (graph.Wrong("")) {
    experiment.schedule = Schedule();
    experiment.graph = Graph({});
  }
  const bool unknown =
      std::ranges::any_of(overrides, [](const auto& override) { return override.section.Wrong("law"); });
  if (unknown || law.Wrong("name") || law.Wrong("leader")) experiment.agents.clear();
  return experiment;
}

void Finish(Experiment& experiment) {
  if (!experiment.agents.empty()) experiment.law.section.Done();
  for (AgentConfig& agent : experiment.agents)
    if (agent.has_own_law) agent.law.section.Done();
  experiment.law.section.ThrowIfWrong();
}

}  // namespace mascot
