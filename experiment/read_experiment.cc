#include "experiment/read_experiment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "experiment/agents.h"
#include "experiment/control.h"
#include "experiment/hosts.h"
#include "experiment/law_tables.h"
#include "experiment/live_experiment.h"
#include "experiment/toml/input.h"

namespace mascot {
namespace {

constexpr double kMaxTicks = 1e9;  // recordings number their samples with 32 bits
constexpr std::size_t kMaxPatterns = 1000;
constexpr int kMaxDomain = 100;  // above, the ports of DDS overlap those that Linux hands out

constexpr std::string_view kAutomatic[] = {"auto"};
constexpr std::string_view kTransports[] = {"auto", "udp", "shm"};  // bus/qos.cc has a row for each

constexpr Key kRunKeys[] = {
    key::Text("name", "name of the run, and of the folder with its results").Otherwise("the file's"),
    key::Number("duration_s", Above(0, 1e6), "simulated time; a whole number of ticks").Required(),
    key::OneOf("mode", kModes.names(),
               "lockstep: as fast as the machine can, deterministic; realtime: the wall clock paces the run, and if a "
               "command is late, the last one holds")
        .Default("\"lockstep\""),
    key::Integer("seed", 0, INT64_MAX, "seed of all random numbers").Default("1"),
    key::Number("agent_timeout_s", Above(0, 3600),
                "wall-clock time that the server waits for a command before the run fails")
        .Default("5.0"),
    key::Number("start_timeout_s", Above(0, 3600), "wall-clock time that the start may take before the run fails")
        .Default("60.0"),
    key::OneOf(
        "on_agent_loss", kOnAgentLoss.names(),
        "when an agent is lost, by an event or for real; abort: the run ends; hold: its actuators keep their last "
        "values; drop: they go to zero; restart: as hold, and a fresh process takes its place")
        .Default("\"abort\""),
    key::Number("restart_after_s", Above(0, 1e6), "with restart: simulated time from the loss to the fresh process")
        .Default("1.0"),
    key::Number("speed", Above(0, 1000), "in realtime: simulated seconds per second").Default("1.0"),
    key::Number("pace", {0, 1000},
                "in lockstep: simulated seconds per second, for people who watch; 0: as fast as the machine can; "
                "changes no result")
        .Otherwise("0; with --view 1")
        .Live(),
    key::OneOf("scheduler", kSchedulers.names(),
               "fifo: the server and the agents run at a real-time priority (SCHED_FIFO), if the system permits it; "
               "other: they run as ordinary processes, in lockstep as batch jobs (SCHED_BATCH)")
        .Default("\"other\""),
    key::Boolean("pin_cores", "each process of a run over DDS stays on one core").Default("false"),
    key::Boolean("lock_memory", "the memory of these processes is never swapped out, if the system permits it")
        .Default("false"),
};

constexpr Key kRecordKeys[] = {
    key::Text("file", "name of the recording in the run's folder, ending in .mcap").Default("\"run.mcap\""),
    key::Texts("topics", "topics that the recording holds; shell patterns").Default("[\"*\"]"),
    key::Boolean("ros_types",
                 "adds channels in standard types of ROS 2, made of the rows: `/tf`, `/scene`, `/agent_<id>/odom`; "
                 "`topics` selects among them, too")
        .Default("false"),
    key::Integer("rate_hz", 0, 100000,
                 "rows per simulated second in the recording and in states.npz, and the row of the last tick; divides "
                 "`control.rate_hz`; 0: every tick has a row")
        .Default("0"),
};

constexpr Key kOutputKeys[] = {
    key::Boolean("position_plot", "draws pictures of positions").Default("true"),
    key::Boolean("velocity_plot", "draws pictures of velocities and accelerations").Default("true"),
    key::Boolean("save_plot", "writes pictures as files").Default("true"),
    key::Boolean("show_plot", "shows pictures in windows, at the end").Default("false"),
    key::Boolean("save_data", "writes states.npz").Default("true"),
    key::Boolean("fidelity", "compares the run with ideal bodies; their laws run in the process of the orchestrator")
        .Default("true"),
};

Key DomainKey() {
  Key row =
      key::OneOf("domain", kAutomatic, "DDS domain; auto: a free one").Or(ValueKind::kInteger).Default("\"auto\"");
  row.max_integer = kMaxDomain;
  return row;
}

bool IsNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
         c == '-' || c == ' ';
}

bool IsRunName(std::string_view name) {
  constexpr std::size_t kLongest = 100;
  return !name.empty() && name.size() <= kLongest && std::string_view("._- ").find(name.front()) == name.npos &&
         std::all_of(name.begin(), name.end(), IsNameCharacter);
}

/// A run's name from that of its file: characters that are not allowed become '_'.
std::string NameFrom(std::string text) {
  for (char& c : text)
    if (!IsNameCharacter(c)) c = '_';
  return IsRunName(text) ? text : "experiment";
}

void ReadRun(Section& section, const std::string& default_name, Experiment& experiment) {
  auto& run = experiment.run;
  run.name = section.Text("name", NameFrom(default_name));
  if (!section.Wrong("name") && !IsRunName(run.name))
    section.Fail("name",
                 "expected a letter or digit, then letters, digits, '.', '_', '-' and spaces, got '" + run.name + "'");
  run.duration_s = section.Number("duration_s");
  run.mode = kModes.Value(section.OneOf("mode"));
  run.seed = static_cast<std::uint64_t>(section.Integer("seed"));
  run.agent_timeout_s = section.Number("agent_timeout_s");
  run.start_timeout_s = section.Number("start_timeout_s");
  run.on_agent_loss = kOnAgentLoss.Value(section.OneOf("on_agent_loss"));
  run.restart_after_s = section.Number("restart_after_s");
  run.speed = section.Number("speed");
  run.pace = ReadPace(section, run.mode);
  run.scheduler = kSchedulers.Value(section.OneOf("scheduler"));
  run.pin_cores = section.Boolean("pin_cores");
  run.lock_memory = section.Boolean("lock_memory");
  section.Done();
}

/// Reads an override's own control and law tables; what they leave out is as in [control] and [law] (`team_law`).
void FinishOverride(AgentOverride& override, Section& control, const Section& team_law, int count,
                    const LawCatalog* laws, Experiment& experiment) {
  Section& section = override.section;
  AgentConfig unknown;
  AgentConfig& agent = override.id > 0 ? experiment.agents[static_cast<std::size_t>(override.id - 1)] : unknown;
  if (section.Has("control")) {
    Section own = section.Child("control");
    own.InheritFrom(control);
    ReadControl(own, {&agent, 1});
  }
  ReadOwnLaw(override, team_law, count, laws, experiment);
  section.Done();
}

/// Checks that the rotors that fail are those of quadrotors.
void CheckRotorFailures(Section& physics, const Experiment& experiment) {
  if (experiment.agents.empty() || physics.Wrong("rotor_failures")) return;
  const auto& failures = experiment.physics.rotor_failures;
  for (std::size_t k = 0; k < failures.size(); ++k) {
    const AgentConfig& agent = experiment.agent(failures[k].agent);
    if (!agent.traits().has_airframe)
      physics.FailRow("rotor_failures", k,
                      "expected a quadrotor, got agent " + std::to_string(agent.id) + ", a " + agent.model);
  }
}

/// Checks that the targets of agents are those of agents whose laws fly to them, and that these have some.
void CheckWaypoints(Section& agents, const Section& law, const std::vector<AgentOverride>& overrides,
                    const LawCatalog& laws, const Experiment& experiment) {
  constexpr std::string_view kKey = "waypoints_m";
  if (!agents.Has(kKey) || agents.Wrong(kKey)) return;
  if (law.Has(kKey)) return agents.Fail(kKey, "expected one of agents.waypoints_m and law.waypoints_m, got both");
  for (std::size_t i = 0; i < experiment.agents.size(); ++i) {
    const AgentConfig& agent = experiment.agents[i];
    const bool flies =
        std::ranges::find(laws.Parameters(agent.law.name), kKey, &Key::name) != laws.Parameters(agent.law.name).end();
    const bool has_own = std::ranges::any_of(overrides, [&](const AgentOverride& override) {
      return override.id == agent.id && override.law && override.law->Has(kKey);
    });
    const std::string who = "because agent " + std::to_string(agent.id) + " flies the law " + agent.law.name;
    if (flies && has_own && !agent.waypoints_W.empty())
      agents.FailRow(kKey, i,
                     "expected an empty list, " + who + " with waypoints_m of its own, got " +
                         std::to_string(agent.waypoints_W.size()) + " points");
    else if (flies && !has_own && agent.waypoints_W.empty())
      agents.FailRow(kKey, i, "expected at least one point, " + who + ", got an empty list");
    else if (!flies && !agent.waypoints_W.empty())
      agents.FailRow(kKey, i,
                     "expected an empty list, " + who + ", which has no waypoints_m, got " +
                         std::to_string(agent.waypoints_W.size()) + " points");
  }
}

/// Checks that a tick is a whole number of physics steps, and a run a whole number of ticks.
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

void ReadRecord(Section& section, Section& control, Experiment& experiment) {
  auto& record = experiment.record;
  record.file = section.Text("file");
  const bool plain = record.file.find('/') == std::string::npos && record.file.find('\0') == std::string::npos;
  if (!section.Wrong("file") && (!plain || !record.file.ends_with(".mcap") || record.file.size() > 200))
    section.Fail("file", "expected a file name ending in .mcap, without folders, got '" + record.file + "'");
  record.topics = section.Texts("topics");
  if (record.topics.size() > kMaxPatterns)
    section.Fail("topics", "expected at most " + std::to_string(kMaxPatterns) + " patterns, got " +
                               std::to_string(record.topics.size()));
  record.ros_types = section.Boolean("ros_types");
  record.rate_hz = static_cast<int>(section.Integer("rate_hz"));
  const int ticks_hz = experiment.control.rate_hz;
  if (record.rate_hz != 0 && !section.Wrong("rate_hz") && !control.Wrong("rate_hz") && ticks_hz % record.rate_hz != 0)
    section.Fail("rate_hz", "expected a divisor of control.rate_hz (" + std::to_string(ticks_hz) +
                                "), or 0 for every tick, got " + std::to_string(record.rate_hz));
  section.Done();
}

void ReadOutput(Section& section, Experiment& experiment) {
  auto& output = experiment.output;
  output.position_plot = section.Boolean("position_plot");
  output.velocity_plot = section.Boolean("velocity_plot");
  output.save_plot = section.Boolean("save_plot");
  output.show_plot = section.Boolean("show_plot");
  output.save_data = section.Boolean("save_data");
  output.fidelity = section.Boolean("fidelity");
  section.Done();
}

void ReadNetwork(Section& section, Experiment& experiment) {
  auto& network = experiment.network;
  if (const std::string kind = section.Kind("domain"); kind.empty() || kind == "string") {
    const std::string domain = section.Text("domain");
    if (domain != "auto")
      section.Fail("domain",
                   "expected \"auto\" or an integer in [0, " + std::to_string(kMaxDomain) + "], got '" + domain + "'");
  } else {
    network.domain = static_cast<int>(section.Integer("domain"));
  }
  network.transport = section.OneOf("transport");
  network.agents_per_process = static_cast<int>(section.Integer("agents_per_process"));
  network.delivery = kDeliveries.Value(section.OneOf("delivery"));
  network.ros_view = section.Boolean("ros_view");
  network.crazyswarm = section.Boolean("crazyswarm");
  network.security = kSecurities.Value(section.OneOf("security"));
  network.protection = kProtections.Value(section.OneOf("protection"));
  if (!network.is_secure() && network.protection != Protection::kNone)
    section.Fail("protection", "expected \"none\" with security = \"off\", got '" +
                                   std::string(kProtections.Name(network.protection)) + "'");
  if (network.is_secure() && network.transport == "shm")
    section.Fail("transport", "expected \"auto\" or \"udp\" with security = \"graph\", got 'shm'");
  if (network.is_secure() && network.ros_view)
    section.Fail("ros_view", "expected false with security = \"graph\": RViz2 has no certificate, got true");
  if (network.is_secure() && network.crazyswarm)
    section.Fail("crazyswarm", "expected false with security = \"graph\": scripts have no certificate, got true");
  if (network.crazyswarm && experiment.run.mode != Mode::kRealtime)
    section.Fail("crazyswarm", "expected run.mode = \"realtime\" with it: scripts look at the clock, got \"lockstep\"");
  section.Done();
}

/// Flies through all events, without agents: each must be legal after those before it. Throws ConfigError.
void CheckEvents(const Experiment& experiment, const LawCatalog* laws) {
  if (experiment.events.empty()) return;
  LiveExperiment live(experiment, laws, /*checked=*/false);
  for (const Event& event : experiment.events) live.Take(event);
}

/// Reads everything. `laws` null: the parameters of laws are not read.
Experiment Read(Section document, const LawCatalog* laws, const std::string& default_name, bool checked,
                UserCode user_code) {
  document.Use(ExperimentKeys());
  CheckFormat(document);
  // Opened in the order of the resolved file; read below in the order in which one needs another.
  Section run = document.Child("run"), physics = document.Child("physics"), agents = document.Child("agents"),
          control = document.Child("control"), sensors = document.Child("sensors"), graph = document.Child("graph"),
          link = document.Child("link"), law = document.Child("law"), record = document.Child("record"),
          output = document.Child("output"), network = document.Child("network");

  Experiment experiment;
  experiment.checked = checked;
  experiment.user_code = user_code;
  ReadRun(run, default_name, experiment);
  int count = static_cast<int>(agents.Integer("count"));
  if (agents.Wrong("count")) count = 0;
  experiment.physics = ReadPhysics(physics, count);
  experiment.law = ReadLaw(law, /*team=*/{}, count, laws);
  std::vector<AgentOverride> overrides = ReadAgents(agents, count, experiment);
  CheckRotorFailures(physics, experiment);
  experiment.control.rate_hz = static_cast<int>(control.Integer("rate_hz"));
  if (control.Has("python_memory_mb"))
    experiment.control.python_memory_mb = static_cast<int>(control.Integer("python_memory_mb"));
  ReadControl(control, experiment.agents);
  for (AgentOverride& override : overrides) FinishOverride(override, control, law, count, laws, experiment);
  CheckTime(run, physics, control, experiment);
  experiment.sensors = ReadSensors(sensors);
  std::vector<Eigen::Vector3d> p_W;
  for (const AgentConfig& agent : experiment.agents) p_W.push_back(agent.p_W);
  experiment.schedule = ReadSchedule(graph, p_W, experiment.run.seed);
  graph.Done();
  experiment.graph = experiment.schedule.Union();
  experiment.links = ReadLinks(link, experiment.graph);
  ReadRecord(record, control, experiment);
  ReadOutput(output, experiment);
  ReadNetwork(network, experiment);

  experiment.hosts = ReadHosts(document, experiment.agents);
  if (!experiment.hosts.empty() && experiment.network.transport == "shm")
    network.Fail("transport", "expected \"auto\" or \"udp\", which reach other hosts, got \"shm\"");
  ReadVehicles(document, run, experiment);

  // With a wrong graph or law, the checks of law parameters would only report the same mistake again.
  if (graph.Wrong("")) {
    experiment.schedule = Schedule();
    experiment.graph = Graph({});
  }
  const bool unknown =
      std::ranges::any_of(overrides, [](const auto& override) { return override.section.Wrong("law"); });
  if (unknown || law.Wrong("name") || law.Wrong("leader")) experiment.agents.clear();
  const bool known_time = !run.Wrong("duration_s") && !control.Wrong("rate_hz");
  const int rate_hz = known_time ? experiment.control.rate_hz : 0;
  const std::int64_t ticks = known_time ? experiment.ticks() : 0;
  if (!experiment.agents.empty()) {
    if (laws != nullptr) {
      CheckWaypoints(agents, law, overrides, *laws, experiment);
      ReadLawParameters(*laws, law, overrides, experiment);
    }
    experiment.events = ReadLawSchedules(laws, law, overrides, rate_hz, ticks, experiment);
    if (laws != nullptr && experiment.network.crazyswarm && !network.Wrong("crazyswarm") && !TakesActions(experiment))
      network.Fail("crazyswarm", "expected agents whose law takes actions with it, got none");
    if (laws != nullptr) law.Done();
    for (AgentOverride& override : overrides)
      if (laws != nullptr && override.law) override.law->Done();
  }
  for (Event& event : ReadEvents(document, count, rate_hz, ticks)) experiment.events.push_back(std::move(event));
  std::ranges::stable_sort(experiment.events, {}, &Event::tick);
  document.Done();
  document.ThrowIfWrong();
  experiment.resolved = document.Resolved();
  if (experiment.resolved.size() > kLargestFile) {  // a run's own config.toml could not be read again
    document.Fail("", "expected at most 16 MiB with all that travels with the experiment, got " +
                          std::to_string(experiment.resolved.size()) +
                          " bytes (files of law.data count once for each law table)");
    document.ThrowIfWrong();
  }
  if (!checked) CheckEvents(experiment, laws);
  return experiment;
}

}  // namespace

std::optional<double> ReadPace(Section& run, Mode mode) {
  if (!run.Has("pace")) return std::nullopt;
  const double pace = run.Number("pace");
  if (!run.Wrong("pace") && mode == Mode::kRealtime)
    run.Fail("pace", "expected run.mode = \"lockstep\" with it (run.speed paces real time), got \"realtime\"");
  return pace;
}

void CheckFormat(Section& document) {
  const std::int64_t format = document.Integer("format", 1, INT64_MAX, 1);
  if (!document.Wrong("format") && format > kFormat)
    document.Fail("format", "expected at most " + std::to_string(kFormat) + ", got " + std::to_string(format) +
                                ": the file is of a newer version of MASCOT");
}

std::span<const Key> ExperimentKeys() {
  static const Key network_keys[] = {
      DomainKey(),
      key::OneOf(
          "transport", kTransports,
          "auto: shared memory on one host, UDP between hosts, and in runs that outlive agents (run.on_agent_loss)")
          .Default("\"auto\""),
      key::Integer("agents_per_process", 1, kMaxAgents, "how many agents share a process").Default("1"),
      key::OneOf(
          "delivery", kDeliveries.names(),
          "bundled: the server sends each process one sample a tick, with what its agents may hear, and gets one "
          "back; topics: each state, command and message has a topic of its own, for tools that listen; auto: "
          "bundled")
          .Default("\"auto\""),
      key::Boolean("crazyswarm", "scripts for Crazyswarm2 fly the agents whose laws take actions").Default("false"),
      key::Boolean("ros_view", "publishes `/tf` and `/scene`, for RViz2").Default("false"),
      key::OneOf(
          "security", kSecurities.names(),
          "graph: certificates of DDS Security, made for the run, let no process hear or say what the graph does "
          "not allow; see [security.md](security.md)")
          .Default("\"off\""),
      key::OneOf("protection", kProtections.names(),
                 "of `security = \"graph\"`: whether samples are also signed, or encrypted as well")
          .Default("\"none\""),
  };
  static const Key keys[] = {
      key::Integer("format", 1, kFormat, "version of the file's format; the config.toml of a run has it").Default("1"),
      key::Table("run", kRunKeys, "duration, pace, seed and scheduling of the run"),
      key::Table("physics", PhysicsKeys(), "the world"),
      key::Table("agents", AgentsKeys(), "the agents of the team"),
      key::Table("control", ControlKeys(), "the low-level stack under the law"),
      key::Table("sensors", SensorKeys(), "what agents measure; standard deviations are of zero-mean Gaussian errors"),
      key::Table("graph", ScheduleKeys(),
                 "which agent hears which: one of `topology`, `laplacian`, `adjacency`, `edges`, `random`"),
      key::Table("link", LinkKeys(),
                 "the links between agents: random by `run.seed`, in simulated time, each directed edge by itself"),
      key::Table("law", LawKeys(), "the control law: what the agents want"),
      key::Table("record", kRecordKeys, "the recording"),
      key::Table("output", kOutputKeys, "other files that a run leaves"),
      key::Table("network", network_keys, "the network between the processes of a run (DDS)"),
      key::Tables(
          "hosts", HostKeys(),
          "machines on which some of the agents run, besides the one where `up` runs; see [hosts.md](hosts.md)"),
      key::Tables("vehicles", VehicleKeys(),
                  "agents whose bodies are real vehicles, flown in real time; see [vehicles.md](vehicles.md)"),
      key::Tables("events", EventKeys(), "what changes while the run goes on; at most 100000"),
  };
  return keys;
}

Experiment ReadExperiment(Section document, const LawCatalog& laws, const std::string& default_name, bool checked,
                          UserCode user_code) {
  return Read(std::move(document), &laws, default_name, checked, user_code);
}

Experiment ReadWithoutLaws(Section document, const std::string& default_name) {
  return Read(std::move(document), nullptr, default_name, /*checked=*/true, UserCode::kNeverRuns);
}

}  // namespace mascot
