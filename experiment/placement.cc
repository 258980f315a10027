#include "experiment/placement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/motion.h"
#include "base/random.h"

namespace mascot {
namespace {

Eigen::Vector3d PointIn(const Box& box, Random& random) {
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) point[axis] = random.In(box.min_m[axis], box.max_m[axis]);
  return point;
}

bool Stands(const AgentConfig& agent, const Box& box) { return box.has_ground && agent.traits().rolls; }

/// Heights from `min_m` to `max_m`, at least `separation_m` apart, in random order; nullopt: there is no room. Random
/// offsets, sorted, share the height that the separations leave over.
std::optional<std::vector<double>> Heights(std::size_t count, double min_m, double max_m, double separation_m,
                                           Random& random) {
  constexpr double kRounding_m = 1e-9;  // [1, 1.3] has room for four agents 0.1 m apart
  std::vector<double> heights(count);
  if (count == 0) return heights;
  const double spare_m = max_m - min_m - static_cast<double>(count - 1) * separation_m;
  if (spare_m < -kRounding_m) return std::nullopt;
  for (double& height : heights) height = random.In(0, std::max(spare_m, 0.0));
  std::sort(heights.begin(), heights.end());
  for (std::size_t k = 0; k < heights.size(); ++k)
    heights[k] = std::min(min_m + heights[k] + static_cast<double>(k) * separation_m, max_m);
  for (std::size_t k = heights.size(); k > 1; --k) std::swap(heights[k - 1], heights[random.Below(k)]);
  return heights;
}

/// Sets the heights that are not drawn together with x and y: those of standing agents and, with separation in z alone,
/// those of all agents. Flying agents then also keep the separation above standing ones. Returns false if there is no
/// room.
bool SetHeights(std::vector<AgentConfig>& agents, const Box& box, Random& random) {
  std::vector<AgentConfig*> flying;
  for (AgentConfig& agent : agents) {
    if (Stands(agent, box))
      agent.p_W.z() = kBallRadius_m;
    else
      flying.push_back(&agent);
  }
  if (!box.in_z_alone) return true;
  const double clear_m = flying.size() < agents.size() ? kBallRadius_m + box.separation_m : box.min_m.z();
  const auto heights =
      Heights(flying.size(), std::max(box.min_m.z(), clear_m), box.max_m.z(), box.separation_m, random);
  if (!heights) return false;
  for (std::size_t k = 0; k < flying.size(); ++k) flying[k]->p_W.z() = (*heights)[k];
  return true;
}

/// Extent of a body along x, y, z (m) if it is turned by `yaw_rad`: of the airframe's box, or of the sphere of other
/// models.
Eigen::Vector3d Size_m(const AgentConfig& agent, double yaw_rad) {
  const Eigen::Vector3d size_m = agent.size_m();
  if (!agent.traits().has_airframe) return size_m;  // a sphere
  const double c = std::abs(std::cos(yaw_rad)), s = std::abs(std::sin(yaw_rad));
  return {c * size_m.x() + s * size_m.y(), s * size_m.x() + c * size_m.y(), size_m.z()};
}

Eigen::Vector3d Size_m(const AgentConfig& agent) { return Size_m(agent, agent.heading_rad); }

bool Touch(const AgentConfig& a, const AgentConfig& b) {
  if (std::abs(a.p_W.z() - b.p_W.z()) >= (a.size_m().z() + b.size_m().z()) / 2) return false;  // spares sines
  return ((a.p_W - b.p_W).cwiseAbs().array() < (Size_m(a) + Size_m(b)).array() / 2).all();
}

/// Computed along the obstacle's own axes.
bool Touch(const AgentConfig& agent, const Obstacle& obstacle) {
  const Eigen::AngleAxisd from_W(-obstacle.heading_rad, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d offset = from_W * (agent.p_W - obstacle.p_W);
  const Eigen::Vector3d agent_half_m = Size_m(agent, agent.heading_rad - obstacle.heading_rad) / 2;
  const Eigen::Vector3d nearest = (offset.cwiseAbs() - agent_half_m).cwiseMax(0);  // nearest point of the agent's box
  const Eigen::Vector3d half_m = obstacle.size_m / 2;
  switch (obstacle.shape) {
    case Shape::kBox:
      return (nearest.array() < half_m.array()).all();
    case Shape::kSphere:
      return nearest.norm() < half_m.x();
    case Shape::kCylinder:
      return nearest.head<2>().norm() < half_m.x() && nearest.z() < half_m.z();
  }
  return false;
}

bool TouchesAny(const AgentConfig& agent, const std::vector<Obstacle>& obstacles) {
  return std::ranges::any_of(obstacles, [&](const Obstacle& obstacle) { return Touch(agent, obstacle); });
}

/// True if `agent` is far enough from `other`, which has its place already.
bool Apart(const AgentConfig& agent, const AgentConfig& other, const Box& box) {
  const bool in_z = box.in_z_alone && !(Stands(agent, box) && Stands(other, box));
  return (in_z || (agent.p_W - other.p_W).norm() >= box.separation_m) && (box.may_touch || !Touch(agent, other));
}

/// Agents that have their places, along the longest axis of their box, so that another one is compared with few.
class PlacedAgents {
 public:
  PlacedAgents(const std::vector<AgentConfig>& agents, const Box& box) : box_(box) {
    (box.max_m - box.min_m).maxCoeff(&axis_);
    for (const AgentConfig& agent : agents) reach_m_ = std::max(reach_m_, agent.size_m().norm());
    reach_m_ = std::max(reach_m_, box.separation_m) * (1 + 1e-9);  // however a difference is rounded
  }
  void Add(const AgentConfig& agent) { along_axis_.emplace(agent.p_W[axis_], &agent); }
  /// True if `agent` is far enough from all of them.
  bool AreApartFrom(const AgentConfig& agent) const {
    const auto end = along_axis_.upper_bound(agent.p_W[axis_] + reach_m_);
    for (auto other = along_axis_.lower_bound(agent.p_W[axis_] - reach_m_); other != end; ++other)
      if (!Apart(agent, *other->second, box_)) return false;
    return true;
  }

 private:
  const Box& box_;
  Eigen::Index axis_ = 0;
  double reach_m_ = 0;
  std::multimap<double, const AgentConfig*> along_axis_;
};

}  // namespace

bool Place(std::vector<AgentConfig>& agents, const Box& box, std::uint64_t seed) {
  std::size_t tries = 10000 + 20 * agents.size();  // for all agents together: ten thousand give up in seconds
  Random random(seed, Random::Stream::kPositions);
  if (!SetHeights(agents, box, random)) return false;
  PlacedAgents placed(agents, box);
  for (AgentConfig& agent : agents) {
    const auto is_free = [&] {
      return (box.may_touch || !TouchesAny(agent, box.obstacles)) && placed.AreApartFrom(agent);
    };
    do {
      if (tries == 0) return false;
      --tries;
      const Eigen::Vector3d point = PointIn(box, random);
      agent.p_W.head<2>() = point.head<2>();
      if (!box.in_z_alone && !Stands(agent, box)) agent.p_W.z() = point.z();
    } while (!is_free());
    placed.Add(agent);
  }
  return true;
}

std::optional<std::pair<int, int>> FirstTouching(const std::vector<AgentConfig>& agents) {
  std::vector<const AgentConfig*> by_x;  // sorted by x, so that each is compared with few
  double longest_m = 0;
  for (const AgentConfig& agent : agents) {
    by_x.push_back(&agent);
    longest_m = std::max(longest_m, Size_m(agent).x());
  }
  std::sort(by_x.begin(), by_x.end(), [](const auto* a, const auto* b) { return a->p_W.x() < b->p_W.x(); });
  std::optional<std::pair<int, int>> first;  // {later id, earlier id}
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    for (std::size_t j = i + 1; j < by_x.size() && by_x[j]->p_W.x() - by_x[i]->p_W.x() < longest_m; ++j) {
      if (!Touch(*by_x[i], *by_x[j])) continue;
      const auto [earlier, later] = std::minmax(by_x[i]->id, by_x[j]->id);
      first = std::min(first.value_or(std::pair(later, earlier)), std::pair(later, earlier));
    }
  }
  if (first) std::swap(first->first, first->second);
  return first;
}

std::optional<std::pair<int, int>> FirstInObstacle(const std::vector<AgentConfig>& agents,
                                                   const std::vector<Obstacle>& obstacles) {
  for (const AgentConfig& agent : agents)
    for (std::size_t k = 0; k < obstacles.size(); ++k)
      if (Touch(agent, obstacles[k])) return std::pair(agent.id, static_cast<int>(k) + 1);
  return std::nullopt;
}

}  // namespace mascot
