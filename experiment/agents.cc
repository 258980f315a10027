#include "experiment/agents.h"

#include <algorithm>
#include <array>
#include <set>

#include "experiment/placement.h"

namespace mascot {
namespace {

constexpr double kFarthest_m = 1e6;
constexpr double kFastest_m_per_s = 1000;

/// One vector for each agent; notes a list of another length.
std::vector<Eigen::Vector3d> OnePerAgent(Section& agents, std::string_view key, std::size_t count, double limit) {
  std::vector<Eigen::Vector3d> points = agents.Points(key, -limit, limit);
  if (count > 0 && !agents.Wrong(key) && points.size() != count)
    agents.Fail(key, "expected " + std::to_string(count) + " points, one per agent, got a list of " +
                         std::to_string(points.size()));
  points.resize(count, Eigen::Vector3d::Zero());
  return points;
}

void ReadPositions(Section& agents, Experiment& experiment) {
  const std::vector<Eigen::Vector3d> points = OnePerAgent(agents, "position_m", experiment.agents.size(), kFarthest_m);
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
}

/// The default box grows in height with the agents, so that they have room above each other.
Box ReadBox(Section& random, const Experiment& experiment) {
  Box box;
  box.in_z_alone = experiment.law.axes == Axes::kXy;
  box.may_touch = !experiment.physics.collisions;
  box.min_m = random.Vector3("min_m", -kFarthest_m, kFarthest_m, Eigen::Vector3d(-10, -10, 1));
  box.separation_m = random.Number("min_separation_m", 0, kFarthest_m, 0.5);
  const double height_m = std::max(3.0, 1.2 * box.separation_m * (experiment.size() - 1));
  box.max_m = random.Vector3("max_m", -kFarthest_m, kFarthest_m, Eigen::Vector3d(10, 10, box.min_m.z() + height_m));
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
  agents.Fail("random", "expected room for " + std::to_string(experiment.size()) + " agents " +
                            ShortestFloat(box.separation_m) + " m apart" +
                            (box.in_z_alone ? " in z (law.axes = \"xy\")" : "") + ", got too small a box");
}

void ReadOverride(Section& section, std::span<const std::string_view> models, std::vector<AgentConfig>& agents,
                  std::set<std::int64_t>& seen) {
  constexpr std::array<std::string_view, 2> kHosts = {"local", "external"};
  const auto last = agents.empty() ? kMaxAgents : static_cast<std::int64_t>(agents.size());
  const std::int64_t id = section.Integer("id", 1, last);
  if (!section.Wrong("id") && !seen.insert(id).second)
    section.Fail("id", "expected each agent once, got " + std::to_string(id) + " again");
  AgentConfig unknown;
  AgentConfig& agent = agents.empty() ? unknown : agents[static_cast<std::size_t>(id - 1)];
  if (section.Has("model")) agent.model = section.OneOf("model", models);
  if (section.Has("airframe")) agent.airframe = ReadAirframe(section, "airframe");
  agent.external = section.OneOf("host", kHosts, "local") == "external";
  section.Done();
}

}  // namespace

void ReadAgents(Section& agents, int count, std::span<const std::string_view> models, Experiment& experiment) {
  AgentConfig common;
  common.model = agents.OneOf("model", models, "quadrotor");
  common.airframe = ReadAirframe(agents, "airframe");
  experiment.agents.assign(static_cast<std::size_t>(count), common);
  for (int id = 1; id <= count; ++id) experiment.agents[static_cast<std::size_t>(id - 1)].id = id;
  std::set<std::int64_t> seen;
  for (Section& section : agents.Children("override")) ReadOverride(section, models, experiment.agents, seen);

  if (agents.Has("position_m") && agents.Has("random"))
    agents.Fail("random", "expected one of position_m, random, got both");
  else if (agents.Has("position_m"))
    ReadPositions(agents, experiment);
  else
    ReadRandom(agents, experiment);
  if (agents.Has("velocity_m_per_s")) {
    const auto velocities = OnePerAgent(agents, "velocity_m_per_s", experiment.agents.size(), kFastest_m_per_s);
    for (std::size_t i = 0; i < velocities.size(); ++i) experiment.agents[i].v_W = velocities[i];
  }
  agents.Done();
}

}  // namespace mascot
