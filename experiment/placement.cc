#include "experiment/placement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "base/motion.h"
#include "base/random.h"

namespace mascot {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// A unit vector, uniform on the sphere (Archimedes: its height is uniform).
Eigen::Vector3d Direction(Random& random) {
  const double z = random.In(-1, 1), angle = random.In(0, kTurn), r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Eigen::Vector3d InBox(const StartRegion& region, Random& random) {
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) point[axis] = random.In(region.min_m[axis], region.max_m[axis]);
  return point;
}

/// The points of the smallest square grid that has room for so many agents, in random order.
std::vector<Eigen::Vector3d> GridPoints(std::size_t count, const StartRegion& region, Random& random) {
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count))));
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      points.emplace_back(region.center_m +
                          region.spacing_m * Eigen::Vector3d(column - (side - 1) / 2.0, row - (side - 1) / 2.0, 0));
  for (std::size_t k = points.size(); k > 1; --k) std::swap(points[k - 1], points[random.Below(k)]);
  return points;
}

/// Draws one place after another.
class Places {
 public:
  Places(std::size_t count, const StartRegion& region, Random& random) : region_(region), random_(random) {
    if (region.shape == StartShape::kGrid) grid_ = GridPoints(count, region, random);
  }
  /// Nothing: there is none left.
  std::optional<Eigen::Vector3d> Next() {
    switch (region_.shape) {
      case StartShape::kBox:
      case StartShape::kPlane:
        return InBox(region_, random_);
      case StartShape::kCircle: {
        const double angle = random_.In(0, kTurn);
        return region_.center_m + region_.radius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
      }
      case StartShape::kSphere:
        return region_.center_m + region_.radius_m * Direction(random_);
      case StartShape::kGrid:
        if (grid_.empty()) return std::nullopt;
        const Eigen::Vector3d point = grid_.back();
        grid_.pop_back();
        return point;
    }
    return std::nullopt;
  }

 private:
  const StartRegion& region_;
  Random& random_;
  std::vector<Eigen::Vector3d> grid_;  // the points that are left
};

bool Stands(const AgentConfig& agent, const StartRegion& region) { return region.has_ground && agent.traits().rolls; }

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
bool SetHeights(std::vector<AgentConfig>& agents, const StartRegion& region, Random& random) {
  std::vector<AgentConfig*> flying;
  for (AgentConfig& agent : agents) {
    if (Stands(agent, region))
      agent.p_W.z() = kBallRadius_m;
    else
      flying.push_back(&agent);
  }
  if (!region.in_z_alone) return true;
  const double clear_m = flying.size() < agents.size() ? kBallRadius_m + region.separation_m : region.min_m.z();
  const auto heights =
      Heights(flying.size(), std::max(region.min_m.z(), clear_m), region.max_m.z(), region.separation_m, random);
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
bool Apart(const AgentConfig& agent, const AgentConfig& other, const StartRegion& region) {
  const bool in_z = region.in_z_alone && !(Stands(agent, region) && Stands(other, region));
  return (in_z || (agent.p_W - other.p_W).norm() >= region.separation_m) && (region.may_touch || !Touch(agent, other));
}

/// Agents that have their places, along the longest axis of their box, so that another one is compared with few.
class PlacedAgents {
 public:
  PlacedAgents(const std::vector<AgentConfig>& agents, const StartRegion& region) : region_(region) {
    (region.max_m - region.min_m).maxCoeff(&axis_);
    for (const AgentConfig& agent : agents) reach_m_ = std::max(reach_m_, agent.size_m().norm());
    reach_m_ = std::max(reach_m_, region.separation_m) * (1 + 1e-9);  // however a difference is rounded
  }
  void Add(const AgentConfig& agent) { along_axis_.emplace(agent.p_W[axis_], &agent); }
  /// True if `agent` is far enough from all of them.
  bool AreApartFrom(const AgentConfig& agent) const {
    const auto end = along_axis_.upper_bound(agent.p_W[axis_] + reach_m_);
    for (auto other = along_axis_.lower_bound(agent.p_W[axis_] - reach_m_); other != end; ++other)
      if (!Apart(agent, *other->second, region_)) return false;
    return true;
  }

 private:
  const StartRegion& region_;
  Eigen::Index axis_ = 0;
  double reach_m_ = 0;
  std::multimap<double, const AgentConfig*> along_axis_;
};

}  // namespace

bool Place(std::vector<AgentConfig>& agents, const StartRegion& region, std::uint64_t seed) {
  std::size_t tries = 10000 + 20 * agents.size();  // for all agents together: ten thousand give up in seconds
  Random random(seed, Random::Stream::kPositions);
  if (!SetHeights(agents, region, random)) return false;
  PlacedAgents placed(agents, region);
  Places places(agents.size(), region, random);
  for (AgentConfig& agent : agents) {
    const auto is_free = [&] {
      return (region.may_touch || !TouchesAny(agent, region.obstacles)) && placed.AreApartFrom(agent);
    };
    do {
      if (tries == 0) return false;
      --tries;
      const std::optional<Eigen::Vector3d> point = places.Next();
      if (!point) return false;
      agent.p_W.head<2>() = point->head<2>();
      if (!region.in_z_alone && !Stands(agent, region)) agent.p_W.z() = point->z();
    } while (!is_free());
    placed.Add(agent);
  }
  return true;
}

void DrawVelocities(std::vector<AgentConfig>& agents, double max_speed_m_per_s, bool level, std::uint64_t seed) {
  Random random(seed, Random::Stream::kVelocities);
  for (AgentConfig& agent : agents) {
    const Eigen::Vector3d direction = Direction(random);
    const double share = random.Unit(), angle = agent.heading_rad;
    if (agent.traits().rolls)
      agent.v_W = max_speed_m_per_s * (2 * share - 1) * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    else if (level)
      agent.v_W = max_speed_m_per_s * std::sqrt(share) *
                  Eigen::Vector3d(direction.x(), direction.y(), 0).normalized();  // area grows as radius squared
    else
      agent.v_W = max_speed_m_per_s * std::cbrt(share) * direction;
  }
}

void DrawHeadings(std::vector<AgentConfig>& agents, std::uint64_t seed) {
  Random random(seed, Random::Stream::kHeadings);
  for (AgentConfig& agent : agents) agent.heading_rad = random.In(-std::numbers::pi, std::numbers::pi);
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
