#include "experiment/agents.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "experiment/control.h"
#include "experiment/placement.h"
#include "experiment/read_experiment.h"
#include "experiment/toml/few_tables.h"

namespace mascot {
namespace {

constexpr Range kPlace_m = {-1e6, 1e6};
constexpr Range kTime_s = {0, 1e6};
constexpr std::string_view kHosts[] = {"local", "external"};

constexpr Key kRandomKeys[] = {
    key::Vector3("min_m", kPlace_m, "a corner of the box in which the agents start").Default("[-10, -10, 1]"),
    key::Vector3("max_m", kPlace_m, "the opposite corner").Otherwise("[10, 10, 4], larger for many agents"),
    key::Number("min_separation_m", {0, 1e6},
                "smallest distance between any two starts; with `law.axes = \"xy\"` in z alone")
        .Default("0.5"),
};

Key AirframeKey() {
  Key row = key::OneOf("airframe", AirframeNames(), "a built-in airframe, or a table that describes one")
                .Or(ValueKind::kTable);
  row.keys = AirframeKeys();
  return row;
}

/// The vectors of `key`, one per agent; notes a mistake if there are too many or too few.
std::vector<Eigen::Vector3d> OnePerAgent(Section& agents, std::string_view key, std::size_t count) {
  std::vector<Eigen::Vector3d> points = agents.Points(key);
  if (count > 0 && !agents.Wrong(key) && points.size() != count)
    agents.Fail(key, "expected " + std::to_string(count) + " points, one per agent, got a list of " +
                         std::to_string(points.size()));
  points.resize(count, Eigen::Vector3d::Zero());
  return points;
}

void ReadPositions(Section& agents, Experiment& experiment) {
  const std::vector<Eigen::Vector3d> points = OnePerAgent(agents, "position_m", experiment.agents.size());
  if (agents.Wrong("position_m")) return;
  for (std::size_t i = 0; i < points.size(); ++i) {
    experiment.agents[i].p_W = points[i];
    if (experiment.physics.ground && points[i].z() < 0)
      agents.FailRow("position_m", i, "expected z >= 0 (physics.ground), got " + ShortestFloat(points[i].z()));
  }
  const auto pair = experiment.physics.collisions ? FirstTouching(experiment.agents) : std::nullopt;
  if (pair)
    agents.FailRow("position_m", static_cast<std::size_t>(pair->second - 1),
                   "expected agents apart (physics.collisions), got agent " + std::to_string(pair->second) +
                       " touching agent " + std::to_string(pair->first));
  const auto hit =
      experiment.physics.collisions ? FirstInObstacle(experiment.agents, experiment.physics.obstacles) : std::nullopt;
  if (hit)
    agents.FailRow("position_m", static_cast<std::size_t>(hit->first - 1),
                   "expected agents apart from obstacles (physics.obstacles), got agent " + std::to_string(hit->first) +
                       " inside obstacle " + std::to_string(hit->second));
}

/// Number of agents that stand on the ground.
double Standing(const Experiment& experiment) {
  if (!experiment.physics.ground) return 0;
  return static_cast<double>(
      std::ranges::count_if(experiment.agents, [](const AgentConfig& agent) { return agent.traits().rolls; }));
}

/// Reads [agents.random]. The default box grows with the number of agents: in height, so that flying agents have room
/// above each other, and in length and width, so that standing agents leave four fifths of it free.
Box ReadBox(Section& random, const Experiment& experiment) {
  Box box;
  box.in_z_alone = experiment.law.axes == Axes::kXy;
  box.may_touch = !experiment.physics.collisions;
  box.has_ground = experiment.physics.ground;
  box.obstacles = experiment.physics.obstacles;
  box.min_m = random.Vector3("min_m");
  box.separation_m = random.Number("min_separation_m");
  const double height_m = std::max(3.0, 1.2 * box.separation_m * (experiment.size() - 1));
  const double side_m = 2 * box.separation_m * std::sqrt(Standing(experiment));
  box.max_m =
      random.Vector3("max_m", Eigen::Vector3d(std::max(10.0, box.min_m.x() + side_m),
                                              std::max(10.0, box.min_m.y() + side_m), box.min_m.z() + height_m));
  random.Done();
  if (random.Wrong("")) return box;
  if (experiment.physics.ground && box.min_m.z() < 0)
    random.Fail("min_m", "expected z >= 0 (physics.ground), got " + ShortestFloat(box.min_m.z()));
  for (int axis = 0; axis < 3; ++axis)
    if (box.max_m[axis] < box.min_m[axis])
      random.Fail("max_m", "expected at least min_m, got " + std::string(1, "xyz"[axis]) + " = " +
                               ShortestFloat(box.max_m[axis]) + " below " + ShortestFloat(box.min_m[axis]));
  return box;
}

void ReadRandom(Section& agents, Experiment& experiment) {
  Section random = agents.Child("random");
  const Box box = ReadBox(random, experiment);
  if (random.Wrong("") || Place(experiment.agents, box, experiment.run.seed)) return;
  const std::string in_z =
      Standing(experiment) > 0 ? " in z (law.axes = \"xy\"; unicycles in x, y)" : " in z (law.axes = \"xy\")";
  agents.Fail("random", "expected room for " + std::to_string(experiment.size()) + " agents " +
                            ShortestFloat(box.separation_m) + " m apart" + (box.in_z_alone ? in_z : "") +
                            (box.obstacles.empty() ? "" : ", clear of obstacles (physics.obstacles)") +
                            ", got too small a box");
}

AgentOverride ReadOverride(Section& section, std::vector<AgentConfig>& agents, std::set<std::int64_t>& seen) {
  const auto last = agents.empty() ? kMaxAgents : static_cast<std::int64_t>(agents.size());
  const std::int64_t id = section.Integer("id", 1, last);
  if (!section.Wrong("id") && !seen.insert(id).second) section.Fail("id", EachOnce("agent", std::to_string(id)));
  AgentConfig unknown;
  AgentConfig& agent = agents.empty() ? unknown : agents[static_cast<std::size_t>(id - 1)];
  if (section.Has("model")) agent.model = section.OneOf("model");
  if (section.Has("airframe")) agent.airframe = ReadAirframe(section, "airframe");
  agent.start_s = section.Number("start_s");
  if (section.Has("stop_s")) {
    agent.stop_s = section.Number("stop_s");
    if (!section.Wrong("stop_s") && !section.Wrong("start_s") && agent.stop_s <= agent.start_s)
      section.Fail("stop_s", "expected a time after start_s (" + ShortestFloat(agent.start_s) + "), got " +
                                 ShortestFloat(agent.stop_s));
  }
  agent.external = section.OneOf("host") == "external";
  if (section.Has("lie")) {
    Section lie = section.Child("lie");
    agent.lie = ReadFalseData(lie);
  }
  return {.id = agents.empty() || section.Wrong("id") ? 0 : static_cast<int>(id), .section = section};
}

/// Reads the initial yaws, one per agent.
void ReadHeadings(Section& agents, std::vector<AgentConfig>& team) {
  if (!agents.Has("heading_rad")) return;
  const std::vector<double> headings = agents.Numbers("heading_rad");
  if (!team.empty() && !agents.Wrong("heading_rad") && headings.size() != team.size())
    agents.Fail("heading_rad", "expected " + std::to_string(team.size()) + " numbers, one per agent, got a list of " +
                                   std::to_string(headings.size()));
  for (std::size_t i = 0; i < std::min(headings.size(), team.size()); ++i) team[i].heading_rad = headings[i];
}

}  // namespace

std::span<const Key> AgentsKeys() {
  static const Key override_keys[] = {
      key::Integer("id", 1, kMaxAgents, "number of the agent that this table is about").Required(),
      key::OneOf("model", ModelNames(), "the agent's model").Otherwise("the team's"),
      AirframeKey().Otherwise("the team's"),
      key::Table("control", AgentControlKeys(),
                 "`[control]` for this agent; keys that are left out are as in `[control]`"),
      key::Table("law", LawKeys(),
                 "a law of the agent's own; if its name is that of `[law]`, or left out, keys that are left out are as "
                 "in `[law]`"),
      key::Number("start_s", kTime_s,
                  "before this time the agent's law is off: the agent comes to rest, and no other agent hears it")
          .Default("0.0"),
      key::Number("stop_s", kTime_s,
                  "from this time on the agent's law is off again; a model driven by acceleration coasts about v / "
                  "`control.velocity_gain` from the speed v")
          .Otherwise("never"),
      key::OneOf("host", kHosts,
                 "external: the agent is started by hand, on this host or another, and the run waits for it")
          .Default("\"local\""),
      key::Table("lie", FalseDataKeys(), "the agent lies: the state and the messages that others hear of it are false"),
  };
  static const Key keys[] = {
      key::Integer("count", 1, kMaxAgents, "number of agents; they are numbered from 1").Required(),
      key::OneOf("model", ModelNames(), "kind of body; `orchestrator models` describes each").Default(DefaultModel()),
      AirframeKey().Default("\"mascot\""),
      key::Points("position_m", kPlace_m, "where each agent starts, in W"),
      key::Table("random", kRandomKeys, "places drawn by `run.seed`; used without `position_m`"),
      key::Points("velocity_m_per_s", {-1000, 1000}, "velocity with which each agent starts, in W")
          .Otherwise("all zero"),
      key::Numbers("heading_rad", {-10, 10}, "yaw with which each agent starts").Otherwise("all zero"),
      key::Tables("override", override_keys, "what is different about one agent"),
  };
  return keys;
}

std::vector<AgentOverride> ReadAgents(Section& agents, int count, Experiment& experiment) {
  AgentConfig common;
  common.model = agents.OneOf("model");
  common.airframe = ReadAirframe(agents, "airframe");
  common.law = experiment.law;
  experiment.agents.assign(static_cast<std::size_t>(count), common);
  for (int id = 1; id <= count; ++id) experiment.agents[static_cast<std::size_t>(id - 1)].id = id;
  std::set<std::int64_t> seen;
  std::vector<AgentOverride> overrides;
  for (Section& section : FewTables(agents, "override", kMaxAgents))
    overrides.push_back(ReadOverride(section, experiment.agents, seen));

  ReadHeadings(agents, experiment.agents);
  agents.TakeOneOf({"position_m", "random"});
  if (agents.Has("position_m") && agents.Has("random"))
    agents.Fail("random", "expected one of position_m, random, got both");
  else if (agents.Has("position_m"))
    ReadPositions(agents, experiment);
  else
    ReadRandom(agents, experiment);
  if (agents.Has("velocity_m_per_s")) {
    const auto velocities = OnePerAgent(agents, "velocity_m_per_s", experiment.agents.size());
    for (std::size_t i = 0; i < velocities.size(); ++i) experiment.agents[i].v_W = velocities[i];
  }
  agents.Done();
  return overrides;
}

}  // namespace mascot
