#include <algorithm>
#include <array>
#include <cassert>
#include <set>
#include <stdexcept>
#include <string>

#include "base/random.h"
#include "experiment/graph/graph.h"

namespace mascot {
namespace {

void RequireFewEdges(std::size_t edges) {
  if (edges > kMaxEdges) throw std::length_error("more than " + std::to_string(kMaxEdges) + " edges");
}

/// Edges of weight 1, added in any order.
class Edges {
 public:
  explicit Edges(int count) : heard_(static_cast<std::size_t>(count)) {}

  void Hears(int i, int j) {
    if (i == j) return;
    RequireFewEdges(++edges_);
    heard_[static_cast<std::size_t>(i - 1)].push_back({j, 1});
  }
  void Both(int i, int j) {
    Hears(i, j);
    Hears(j, i);
  }
  /// Sorts the edges and drops repeated ones (a ring of two agents adds each twice).
  Graph Build() && {
    for (auto& row : heard_) {
      std::sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
      row.erase(std::unique(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.id == b.id; }),
                row.end());
    }
    return Graph(std::move(heard_));
  }

 private:
  std::size_t edges_ = 0;
  std::vector<std::vector<Graph::Neighbour>> heard_;
};

// --- families: `count` agents, numbered 1..count ------------------------------------------------------

void Complete(int count, Edges& edges) {
  for (int i = 1; i <= count; ++i)
    for (int j = 1; j <= count; ++j) edges.Hears(i, j);
}

void Path(int count, Edges& edges) {
  for (int i = 2; i <= count; ++i) edges.Both(i, i - 1);
}

void Ring(int count, Edges& edges) {
  Path(count, edges);
  edges.Both(count, 1);
}

void DirectedPath(int count, Edges& edges) {
  for (int i = 2; i <= count; ++i) edges.Hears(i, i - 1);
}

void DirectedRing(int count, Edges& edges) {
  DirectedPath(count, edges);
  edges.Hears(1, count);
}

void Star(int count, Edges& edges) {
  for (int i = 2; i <= count; ++i) edges.Both(1, i);
}

void DirectedStar(int count, Edges& edges) {
  for (int i = 2; i <= count; ++i) edges.Hears(i, 1);
}

void BinaryTree(int count, Edges& edges) {
  for (int i = 2; i <= count; ++i) edges.Both(i, i / 2);
}

void DirectedTree(int count, Edges& edges) {
  for (int i = 2; i <= count; ++i) edges.Hears(i, i / 2);
}

void Wheel(int count, Edges& edges) {
  Star(count, edges);
  for (int i = 3; i <= count; ++i) edges.Both(i, i - 1);
  if (count > 3) edges.Both(2, count);
}

struct Family : Topology {
  void (*add)(int count, Edges& edges);
};

constexpr std::array kFamilies = {
    Family{{"complete", "each agent hears all others"}, Complete},
    Family{{"ring", "i hears i - 1 and i + 1, 1 and N hear each other"}, Ring},
    Family{{"path", "i hears i - 1 and i + 1"}, Path},
    Family{{"star", "1 hears all others, and all others hear 1"}, Star},
    Family{{"wheel", "a star whose rim 2..N is a ring"}, Wheel},
    Family{{"binary_tree", "i and i / 2 (rounded down) hear each other"}, BinaryTree},
    Family{{"directed_ring", "i hears i - 1, 1 hears N"}, DirectedRing},
    Family{{"directed_path", "i hears i - 1"}, DirectedPath},
    Family{{"directed_star", "all others hear 1"}, DirectedStar},
    Family{{"directed_tree", "i hears i / 2 (rounded down)"}, DirectedTree},
};

constexpr auto kTopologyNames = [] {
  std::array<std::string_view, kFamilies.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kFamilies[i].name;
  return names;
}();

}  // namespace

std::span<const std::string_view> TopologyNames() { return kTopologyNames; }

std::vector<Topology> Topologies() { return {kFamilies.begin(), kFamilies.end()}; }

Graph MakeTopology(std::string_view name, int count) {
  const auto family = std::find_if(kFamilies.begin(), kFamilies.end(), [&](const Family& f) { return f.name == name; });
  assert(family != kFamilies.end());
  Edges edges(count);
  family->add(count, edges);
  return std::move(edges).Build();
}

Graph MakeErdosRenyi(int count, double p, std::uint64_t seed) {
  Random random(seed, Random::Stream::kGraph);
  Edges edges(count);
  for (int i = 1; i <= count; ++i)
    for (int j = i + 1; j <= count; ++j)
      if (random.Unit() < p) edges.Both(i, j);
  return std::move(edges).Build();
}

Graph MakeGeometric(std::span<const Eigen::Vector3d> p_W, double radius_m) {
  const int count = static_cast<int>(p_W.size());
  Edges edges(count);
  for (int i = 1; i <= count; ++i)
    for (int j = i + 1; j <= count; ++j)
      if ((p_W[static_cast<std::size_t>(i - 1)] - p_W[static_cast<std::size_t>(j - 1)]).norm() < radius_m)
        edges.Both(i, j);
  return std::move(edges).Build();
}

// Watts & Strogatz, "Collective dynamics of 'small-world' networks", Nature 393 (1998): each edge of the ring, in turn,
// gets with probability p another far end, drawn uniformly from all agents that its near end i does not hear yet.
Graph MakeSmallWorld(int count, int k, double p, std::uint64_t seed) {
  RequireFewEdges(static_cast<std::size_t>(count) * static_cast<std::size_t>(k));
  Random random(seed, Random::Stream::kGraph);
  std::set<std::pair<int, int>> pairs;  // lower id first
  std::vector<int> degree(static_cast<std::size_t>(count));
  const auto hear = [&](int i, int j) {
    const bool is_new = i != j && pairs.emplace(std::minmax(i, j)).second;
    for (const int end : {i, j}) degree[static_cast<std::size_t>(end - 1)] += is_new;
    return is_new;
  };
  const auto hears_all = [&](int i) { return degree[static_cast<std::size_t>(i - 1)] == count - 1; };
  const auto ahead = [count](int i, int steps) { return (i - 1 + steps) % count + 1; };
  for (int steps = 1; steps <= k / 2; ++steps)
    for (int i = 1; i <= count; ++i) hear(i, ahead(i, steps));
  for (int steps = 1; steps <= k / 2; ++steps)
    for (int i = 1; i <= count; ++i) {
      if (random.Unit() >= p || hears_all(i)) continue;
      while (!hear(i, static_cast<int>(random.Below(static_cast<std::size_t>(count))) + 1)) {
      }
      const int far = ahead(i, steps);
      pairs.erase(std::minmax(i, far));
      for (const int end : {i, far}) --degree[static_cast<std::size_t>(end - 1)];
    }
  Edges edges(count);
  for (const auto& [i, j] : pairs) edges.Both(i, j);
  return std::move(edges).Build();
}

}  // namespace mascot
