#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// Who hears whom: agent i hears j with weight a_ij > 0. Agents are numbered 1..N. Immutable.
class Graph {
 public:
  struct Neighbour {
    int id = 0;
    double weight = 0;
  };

  /// `heard[i-1]`: those whom agent i hears, in increasing id, weights > 0, not itself.
  explicit Graph(std::vector<std::vector<Neighbour>> heard);

  int size() const { return static_cast<int>(heard_.size()); }
  /// In-neighbours of agent `id`, in increasing id.
  const std::vector<Neighbour>& HeardBy(int id) const { return heard_[static_cast<std::size_t>(id - 1)]; }
  /// Number of directed edges.
  std::size_t edges() const;
  /// a_ij == a_ji for all pairs.
  bool IsSymmetric() const;

  /// L = D - A, N x N; row i is what agent i needs (dense: meant for N up to a few thousand).
  Eigen::MatrixXd Laplacian() const;
  /// Second smallest eigenvalue (symmetric), or second smallest real part (directed). 0 for one agent.
  double Lambda2() const;
  /// All eigenvalues of L, sorted by real part.
  Eigen::VectorXcd Eigenvalues() const;
  /// Left null vector of L with sum 1, if L has a simple zero eigenvalue (a spanning tree exists).
  std::optional<Eigen::VectorXd> LeftNullVector() const;

  /// Strongly connected components, each sorted, ordered by their lowest id.
  std::vector<std::vector<int>> Components() const;
  /// Agents from whom everyone hears, directly or not; sorted; empty if there is no spanning tree.
  std::vector<int> Roots() const;
  /// Directed spanning tree by breadth-first search from `root` along "hears": parent[i-1] is the agent
  /// that i follows, the lowest id one level up; 0 for the root. nullopt if somebody is not reached.
  std::optional<std::vector<int>> SpanningTree(int root) const;

 private:
  std::vector<std::vector<Neighbour>> heard_;
};

/// A family that `graph.topology` knows.
struct Topology {
  std::string_view name;
  std::string_view meaning;
};
/// Every one, from the table in families.cc.
std::vector<Topology> Topologies();
std::span<const std::string_view> TopologyNames();
/// A family of that table for `count` agents, all weights 1.
Graph MakeTopology(std::string_view name, int count);
/// Each pair of agents hears each other with probability `p` (Erdos & Renyi, Publ. Math. Debrecen 6, 1959).
Graph MakeErdosRenyi(int count, double p, std::uint64_t seed);
/// Agents hear each other that are closer than `radius_m` at `p_W` (Gilbert, J. SIAM 9, 1961).
Graph MakeGeometric(std::span<const Eigen::Vector3d> p_W, double radius_m);
/// A ring in which everybody hears its `k` nearest (k even, below `count`), each edge of which is replaced with
/// probability `p` by one to an agent drawn at random (Watts & Strogatz, Nature 393, 1998).
Graph MakeSmallWorld(int count, int k, double p, std::uint64_t seed);
/// The keys that say what one graph is, of [graph] or of one of its schedule.
std::span<const Key> GraphKeys();
/// Reads exactly one of topology, laplacian, adjacency, edges, random of [graph], or of one of its schedule, for agents
/// that start at `p_W`. `seed` feeds random graphs. With no agents, not known for a mistake elsewhere, sizes are not
/// checked and the graph is empty.
Graph ReadGraph(Section& graph, std::span<const Eigen::Vector3d> p_W, std::uint64_t seed);

}  // namespace mascot
