#include "orchestrator/theory/obstacle_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "agent/laws/laws.h"
#include "experiment/obstacles.h"

namespace mascot {
namespace {

/// An agent whose body would meet an obstacle.
struct Blocked {
  int agent = 0;
  std::size_t target = 0;    ///< on the way to this waypoint, or there; from 1
  std::size_t obstacle = 0;  ///< from 1
  int others = 0;            ///< so many more agents would meet one, too
};

/// Whether the straight way leads past the ball around the obstacle, at more than `clear_m`: most do, and this is
/// quick.
bool PassesFarOff(const Obstacle& obstacle, const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W,
                  double clear_m) {
  const Eigen::Vector3d way = to_W - from_W;
  const double part = way.isZero() ? 0 : std::clamp((obstacle.p_W - from_W).dot(way) / way.squaredNorm(), 0.0, 1.0);
  const double radius_m = obstacle.size_m.norm() / 2;  // of a box; other shapes are inside theirs
  return (from_W + part * way - obstacle.p_W).norm() > radius_m + clear_m + 1e-6 * (radius_m + way.norm());
}

/// Where the agent's body first meets an obstacle: at its targets if its law keeps clear of obstacles, else along the
/// straight ways from its start to its targets.
std::optional<Blocked> FirstBlocked(const AgentConfig& agent, const std::vector<Obstacle>& obstacles) {
  Eigen::Vector3d from_W = agent.p_W;
  std::size_t target = 0;
  for (Eigen::Vector3d to_W : WaypointsOf(agent)) {
    ++target;
    if (agent.law.axes == Axes::kXy) to_W.z() = agent.p_W.z();
    if (EntryOf(agent.law).sees_obstacles) from_W = to_W;
    for (std::size_t k = 0; k < obstacles.size(); ++k)
      if (!PassesFarOff(obstacles[k], from_W, to_W, agent.radius_m()) &&
          DistanceOfWay_m(obstacles[k], from_W, to_W) < agent.radius_m())
        return Blocked{.agent = agent.id, .target = target, .obstacle = k + 1};
    from_W = to_W;
  }
  return std::nullopt;
}

/// The first agent that is blocked, of those whose laws see obstacles or of the others.
std::optional<Blocked> FirstBlocked(const Experiment& experiment, bool sees_obstacles) {
  std::optional<Blocked> first;
  for (const AgentConfig& agent : experiment.agents) {
    if (EntryOf(agent.law).sees_obstacles != sees_obstacles) continue;
    const std::optional<Blocked> blocked = FirstBlocked(agent, experiment.physics.obstacles);
    if (!blocked) continue;
    if (first)
      ++first->others;
    else
      first = blocked;
  }
  return first;
}

std::string AndOthers(const Blocked& first, std::string_view what) {
  if (first.others == 0) return "";
  return fmt::format(" (and {} of {} more {})", what, first.others, first.others == 1 ? "agent" : "agents");
}

std::string OfWay(const Blocked& way) {
  const std::string from = way.target == 1 ? "its start" : fmt::format("waypoint {}", way.target - 1);
  return fmt::format(
      "physics.obstacles: the straight way of agent {} from {} to waypoint {} passes through obstacle {}, or closer "
      "than its body{}",
      way.agent, from, way.target, way.obstacle, AndOthers(way, "ways"));
}

std::string OfTarget(const Blocked& target) {
  return fmt::format("physics.obstacles: waypoint {} of agent {} is in obstacle {}, or closer than its body{}",
                     target.target, target.agent, target.obstacle, AndOthers(target, "waypoints"));
}

bool AnyLawSees(const Experiment& experiment) {
  return std::ranges::any_of(experiment.agents,
                             [](const AgentConfig& agent) { return EntryOf(agent.law).sees_obstacles; });
}

}  // namespace

std::vector<std::string> ObstacleWarnings(const Experiment& experiment) {
  std::vector<std::string> warnings;
  if (experiment.physics.collisions) {
    if (const auto way = FirstBlocked(experiment, /*sees_obstacles=*/false)) warnings.push_back(OfWay(*way));
    if (const auto target = FirstBlocked(experiment, /*sees_obstacles=*/true)) warnings.push_back(OfTarget(*target));
  }
  if (experiment.sensors.range_m > 0 && !AnyLawSees(experiment))
    warnings.emplace_back("sensors.range_m: no law of this experiment asks what obstacles are near");
  return warnings;
}

}  // namespace mascot
