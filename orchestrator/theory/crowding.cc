#include "orchestrator/theory/crowding.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "agent/laws/laws.h"

namespace mascot {
namespace {

std::vector<Eigen::Vector3d> HalfSizes(const Experiment& experiment) {
  std::vector<Eigen::Vector3d> half_m;
  for (const AgentConfig& agent : experiment.agents) half_m.push_back(agent.size_m() / 2);
  return half_m;
}

std::string Pair(int i, int j) {
  return "agents " + std::to_string(std::min(i, j)) + " and " + std::to_string(std::max(i, j));
}

std::optional<std::string> StartInGround(const Experiment& experiment, const std::vector<Eigen::Vector3d>& half_m) {
  for (std::size_t i = 0; i < half_m.size(); ++i) {
    const AgentConfig& agent = experiment.agents[i];
    if (agent.p_W.z() < half_m[i].z() && !agent.traits().rolls) {
      return "agents.position_m: agent " + std::to_string(agent.id) + " starts in the ground";
    }
  }
  return std::nullopt;
}

std::optional<std::string> MeetingPoint(const Experiment& experiment, const std::vector<Eigen::Vector3d>& half_m) {
  if (experiment.size() < 2 || !EntryOf(experiment.law).gathers) return std::nullopt;
  if (experiment.law.axes == Axes::kXyz) {
    return "physics.collisions: all agents head for the same place in x, y and z and will touch there";
  }
  std::vector<std::size_t> by_height(half_m.size());
  std::iota(by_height.begin(), by_height.end(), std::size_t{0});
  const auto height_m = [&experiment](std::size_t i) { return experiment.agents[i].p_W.z(); };
  std::stable_sort(by_height.begin(), by_height.end(), [&](auto i, auto j) { return height_m(i) < height_m(j); });
  for (std::size_t n = 1; n < by_height.size(); ++n) {
    const std::size_t i = by_height[n - 1];
    const std::size_t j = by_height[n];
    const double needed_m = half_m[i].z() + half_m[j].z();
    if (height_m(j) - height_m(i) < needed_m) {
      return "agents.position_m: " + Pair(experiment.agents[i].id, experiment.agents[j].id) + " fly less than the " +
             ShortestFloat(needed_m) + " m of their bodies apart in height and will touch where they meet";
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> CrowdingWarnings(const Experiment& experiment) {
  std::vector<std::string> warnings;
  const auto add = [&warnings](std::optional<std::string> warning) {
    if (warning) warnings.push_back(std::move(*warning));
  };
  const std::vector<Eigen::Vector3d> half_m = HalfSizes(experiment);
  if (experiment.physics.ground) add(StartInGround(experiment, half_m));
  if (!experiment.physics.collisions) return warnings;
  add(MeetingPoint(experiment, half_m));
  return warnings;
}

}  // namespace mascot
