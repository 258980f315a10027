#include "orchestrator/theory/obstacle_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "agent/laws.h"
#include "experiment/obstacles.h"

namespace mascot {
namespace {

/// A part of an agent's way that passes through an obstacle.
struct BlockedWay {
  int agent = 0;
  std::size_t target = 0;    ///< the waypoint that it leads to, from 1
  std::size_t obstacle = 0;  ///< from 1
};

/// The first part of the agent's way, from its start along its targets, on which its body would meet an obstacle.
std::optional<BlockedWay> FirstBlocked(const AgentConfig& agent, const std::vector<Obstacle>& obstacles) {
  Eigen::Vector3d from_W = agent.p_W;
  std::size_t target = 0;
  for (Eigen::Vector3d to_W : WaypointsOf(agent)) {
    ++target;
    if (agent.law.axes == Axes::kXy) to_W.z() = agent.p_W.z();
    for (std::size_t k = 0; k < obstacles.size(); ++k)
      if (DistanceOfWay_m(obstacles[k], from_W, to_W) < agent.radius_m())
        return BlockedWay{.agent = agent.id, .target = target, .obstacle = k + 1};
    from_W = to_W;
  }
  return std::nullopt;
}

std::optional<std::string> WaysThroughObstacles(const Experiment& experiment) {
  std::optional<BlockedWay> first;
  int others = 0;
  for (const AgentConfig& agent : experiment.agents) {
    if (EntryOf(agent.law).sees_obstacles) continue;
    const std::optional<BlockedWay> blocked = FirstBlocked(agent, experiment.physics.obstacles);
    if (blocked && first) ++others;
    if (blocked && !first) first = blocked;
  }
  if (!first) return std::nullopt;
  const std::string from = first->target == 1 ? "its start" : fmt::format("waypoint {}", first->target - 1);
  return fmt::format(
      "physics.obstacles: the straight way of agent {} from {} to waypoint {} passes through obstacle {}, or closer "
      "than its body{}",
      first->agent, from, first->target, first->obstacle,
      others > 0 ? fmt::format(" (and ways of {} more {})", others, others == 1 ? "agent" : "agents") : "");
}

bool AnyLawSees(const Experiment& experiment) {
  return std::ranges::any_of(experiment.agents,
                             [](const AgentConfig& agent) { return EntryOf(agent.law).sees_obstacles; });
}

}  // namespace

std::vector<std::string> ObstacleWarnings(const Experiment& experiment) {
  std::vector<std::string> warnings;
  if (experiment.physics.collisions)
    if (std::optional<std::string> blocked = WaysThroughObstacles(experiment)) warnings.push_back(std::move(*blocked));
  if (experiment.sensors.range_m > 0 && !AnyLawSees(experiment))
    warnings.emplace_back("sensors.range_m: no law of this experiment asks what obstacles are near");
  return warnings;
}

}  // namespace mascot
