#include "experiment/placement.h"

#include <algorithm>
#include <numeric>

#include "experiment/random.h"

namespace mascot {
namespace {

Eigen::Vector3d PointIn(const Box& box, Random& random) {
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) point[axis] = random.In(box.min_m[axis], box.max_m[axis]);
  return point;
}

/// Heights at least `separation_m` apart, in random order: sorted offsets share what the separations leave over.
std::optional<std::vector<double>> Heights(int count, const Box& box, Random& random) {
  constexpr double kRounding_m = 1e-9;  // [1, 1.3] has room for four agents 0.1 m apart
  const double min_m = box.min_m.z(), max_m = box.max_m.z();
  const double spare_m = max_m - min_m - (count - 1) * box.separation_m;
  if (spare_m < -kRounding_m) return std::nullopt;
  std::vector<double> heights(static_cast<std::size_t>(count));
  for (double& height : heights) height = random.In(0, std::max(spare_m, 0.0));
  std::sort(heights.begin(), heights.end());
  for (std::size_t k = 0; k < heights.size(); ++k)
    heights[k] = std::min(min_m + heights[k] + static_cast<double>(k) * box.separation_m, max_m);
  for (std::size_t k = heights.size(); k > 1; --k) std::swap(heights[k - 1], heights[random.Below(k)]);
  return heights;
}

/// What a body takes up along x, y, z: the airframe's box, or the sphere of 0.1 m of the other models.
Eigen::Vector3d Size_m(const AgentConfig& agent) {
  return agent.model == "quadrotor" ? agent.airframe.size_m : Eigen::Vector3d::Constant(0.2);
}

bool Touch(const AgentConfig& a, const AgentConfig& b) {
  return ((a.p_W - b.p_W).cwiseAbs().array() < (Size_m(a) + Size_m(b)).array() / 2).all();
}

}  // namespace

bool Place(std::vector<AgentConfig>& agents, const Box& box, std::uint64_t seed) {
  std::size_t tries = 10000 + 20 * agents.size();  // for all of them: ten thousand agents give up in seconds
  Random random(seed, Random::Stream::kPositions);
  std::optional<std::vector<double>> heights;
  if (box.in_z_alone) {
    heights = Heights(static_cast<int>(agents.size()), box, random);
    if (!heights) return false;
  }
  for (std::size_t i = 0; i < agents.size(); ++i) {
    const auto is_free = [&] {
      return std::all_of(agents.begin(), agents.begin() + static_cast<std::ptrdiff_t>(i),
                         [&](const AgentConfig& other) {
                           const bool apart = heights || (agents[i].p_W - other.p_W).norm() >= box.separation_m;
                           return apart && (box.may_touch || !Touch(agents[i], other));
                         });
    };
    do {
      if (tries-- == 0) return false;
      agents[i].p_W = PointIn(box, random);
      if (heights) agents[i].p_W.z() = (*heights)[i];
    } while (!is_free());
  }
  return true;
}

std::optional<std::pair<int, int>> FirstTouching(const std::vector<AgentConfig>& agents) {
  std::vector<const AgentConfig*> by_x;  // so that each is compared with few
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

}  // namespace mascot
