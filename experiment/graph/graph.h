#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// The communication graph: agent i hears agent j with weight a_ij > 0. Agents are numbered 1..N. Immutable; copies
/// share its edges.
class Graph {
 public:
  struct Neighbour {
    int id = 0;
    double weight = 0;
  };

  /// `heard[i - 1]`: the agents that agent i hears, in increasing id, weights > 0, without i itself.
  explicit Graph(std::vector<std::vector<Neighbour>> heard);

  int size() const { return static_cast<int>(heard_->size()); }
  /// In-neighbours of agent `id`, in increasing id.
  const std::vector<Neighbour>& HeardBy(int id) const { return (*heard_)[static_cast<std::size_t>(id - 1)]; }
  /// True if agent `hearer` hears agent `heard`; false if one of them does not exist.
  bool Hears(int hearer, int heard) const;
  /// Number of directed edges.
  std::size_t edges() const;
  /// True if a_ij == a_ji for all pairs.
  bool IsSymmetric() const;

  /// L = D - A, N x N, where D has the row sums of A on its diagonal: row i holds what agent i hears. Dense: meant for
  /// N up to a few thousand.
  Eigen::MatrixXd Laplacian() const;
  /// Second smallest eigenvalue of L (symmetric), or second smallest real part (directed). 0 for one agent, and without
  /// a spanning tree.
  double Lambda2() const;
  /// All eigenvalues of L, sorted by real part, then by imaginary part.
  Eigen::VectorXcd Eigenvalues() const;
  /// Left null vector of L with sum 1; nullopt if there is no spanning tree (0 is not a simple eigenvalue).
  std::optional<Eigen::VectorXd> LeftNullVector() const;

  /// Strongly connected components, each sorted, ordered by their lowest id.
  std::vector<std::vector<int>> Components() const;
  /// Agents that all others hear, directly or through others; sorted; empty if there is no spanning tree.
  std::vector<int> Roots() const;
  /// Directed spanning tree by breadth-first search from `root`. Entry i - 1 is the parent of agent i: of the agents
  /// that i hears one level up, the one with the lowest id; 0 for the root. nullopt if the search does not reach an
  /// agent.
  std::optional<std::vector<int>> SpanningTree(int root) const;

 private:
  std::shared_ptr<const std::vector<std::vector<Neighbour>>> heard_;  // never null
};

/// The most edges that the graph, or all graphs of a schedule together, may have: 160 MB.
inline constexpr std::size_t kMaxEdges = 10'000'000;

// The functions that make graphs throw std::length_error for more than kMaxEdges, before they take the memory.

/// A family of graphs: a value of `graph.topology`, and its meaning.
struct Topology {
  std::string_view name;
  std::string_view meaning;
};
/// All families, from the table in families.cc.
std::vector<Topology> Topologies();
std::span<const std::string_view> TopologyNames();
/// The graph of the family `name`, one of TopologyNames(), for `count` agents; all weights are 1.
Graph MakeTopology(std::string_view name, int count);
/// Each pair of agents hears each other with probability `p` (Erdos & Renyi, Publ. Math. Debrecen 6, 1959).
Graph MakeErdosRenyi(int count, double p, std::uint64_t seed);
/// Agents that are closer than `radius_m` at `p_W` hear each other (Gilbert, J. SIAM 9, 1961).
Graph MakeGeometric(std::span<const Eigen::Vector3d> p_W, double radius_m);
/// A ring in which every agent hears its `k` nearest (k even, below `count`). Each edge is replaced with probability
/// `p` by one from the same agent to another that it does not hear yet, drawn uniformly (Watts & Strogatz, Nature 393,
/// 1998); it stays if the agent hears all others. The number of edges stays the same.
Graph MakeSmallWorld(int count, int k, double p, std::uint64_t seed);
/// The keys that describe one graph, in [graph] or in a [[graph.schedule]].
std::span<const Key> GraphKeys();
/// Reads one graph from [graph] or a [[graph.schedule]]: at most one of topology (the default), laplacian, adjacency,
/// edges, random. `p_W`: where the agents start, in W (m). `seed`: for random graphs. Mistakes are noted in `graph`.
/// With no agents (unknown because of a mistake elsewhere) sizes are not checked and the graph is empty.
Graph ReadGraph(Section& graph, std::span<const Eigen::Vector3d> p_W, std::uint64_t seed);

}  // namespace mascot
