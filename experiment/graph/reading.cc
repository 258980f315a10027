#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include "experiment/graph/edge.h"
#include "experiment/graph/graph.h"

namespace mascot {
namespace {

using Heard = std::vector<std::vector<Graph::Neighbour>>;
using Rows = std::vector<std::vector<double>>;

constexpr Range kWeight = {0, 1e6};
constexpr std::string_view kRandomGraphKinds[] = {"erdos_renyi", "geometric", "small_world"};

constexpr Key kRandomGraphKeys[] = {
    key::OneOf("kind", kRandomGraphKinds,
               "Erdos & Renyi: each pair of agents with probability p; geometric: pairs closer than "
               "radius_m at their starts; Watts & Strogatz: a ring with rewired edges")
        .Required(),
    key::Number("p", {0, 1}, "erdos_renyi: probability of an edge; small_world: probability that an edge is rewired")
        .Otherwise("needed there"),
    key::Number("radius_m", Above(0, 1e6), "geometric: distance below which two agents hear each other")
        .Otherwise("needed there"),
    key::Integer("k", 2, 10000, "small_world: how many nearest neighbours each agent has on the ring; even")
        .Otherwise("needed there"),
};

std::string Number(double value) {
  const std::string text = ShortestFloat(value);
  return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
}

/// Notes mistakes if `rows` is not a count x count matrix. Returns true if it is one.
bool IsSquare(Section& graph, std::string_view key, const Rows& rows, int count) {
  const auto size = static_cast<std::size_t>(count);
  if (graph.Wrong(key) || count == 0) return false;
  if (rows.size() != size)
    graph.Fail(key, "expected " + std::to_string(count) + " rows, one per agent, got a list of " +
                        std::to_string(rows.size()));
  for (std::size_t i = 0; i < rows.size() && rows.size() == size; ++i)
    if (rows[i].size() != size)
      graph.FailRow(key, i,
                    "expected " + std::to_string(count) + " numbers, got a list of " + std::to_string(rows[i].size()));
  return !graph.Wrong(key);
}

Heard FromAdjacency(Section& graph, int count) {
  const Rows rows = graph.Rows("adjacency");
  Heard heard(static_cast<std::size_t>(count));
  if (!IsSquare(graph, "adjacency", rows, count)) return heard;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i][i] != 0) graph.FailRow("adjacency", i, "expected 0 on the diagonal, got " + Number(rows[i][i]));
    for (std::size_t j = 0; j < rows.size(); ++j)
      if (i != j && rows[i][j] > 0) heard[i].push_back({static_cast<int>(j) + 1, rows[i][j]});
  }
  return heard;
}

Heard FromLaplacian(Section& graph, int count) {
  const Rows rows = graph.Rows("laplacian");
  Heard heard(static_cast<std::size_t>(count));
  if (!IsSquare(graph, "laplacian", rows, count)) return heard;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    double sum = 0, size = 1;
    for (std::size_t j = 0; j < rows.size(); ++j) {
      sum += rows[i][j];
      size = std::max(size, std::abs(rows[i][j]));
      if (i != j && rows[i][j] < 0) heard[i].push_back({static_cast<int>(j) + 1, -rows[i][j]});
      if (i != j && rows[i][j] > 0)
        graph.FailRow("laplacian", i,
                      "expected no positive number off the diagonal, got " + Number(rows[i][j]) + " for agent " +
                          std::to_string(j + 1));
    }
    constexpr double kTolerance = 1e-9;
    if (std::abs(sum) > kTolerance * size)
      graph.FailRow("laplacian", i, "expected a row that sums to 0, got a sum of " + Number(sum));
  }
  return heard;
}

/// Text of the mistake in the edge `row`; empty: none.
std::string EdgeMistake(const std::vector<double>& row, int count) {
  if (row.size() != 2 && row.size() != 3)
    return "expected [i, j] or [i, j, weight], got a list of " + std::to_string(row.size());
  for (const double id : {row[0], row[1]})
    if (id < 1 || (count > 0 && id > count) || id != std::floor(id))
      return "expected agents' numbers from 1" + (count > 0 ? " to " + std::to_string(count) : "") + ", got " +
             Number(id);
  if (row[0] == row[1]) return "expected two different agents, got " + Number(row[0]) + " twice";
  if (row.size() == 3 && row[2] <= 0) return "expected a weight in (0, 1e+06], got " + Number(row[2]);
  return "";
}

Heard FromEdges(Section& graph, int count) {
  const Rows rows = graph.Rows("edges");
  Heard heard(static_cast<std::size_t>(count));
  if (graph.Wrong("edges")) return heard;
  std::set<std::pair<double, double>> seen;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::vector<double>& row = rows[k];
    std::string mistake = EdgeMistake(row, count);
    if (mistake.empty() && !seen.insert({row[0], row[1]}).second)
      mistake = EachOnce("edge", EdgeText({static_cast<int>(row[0]), static_cast<int>(row[1])}));
    if (!mistake.empty())
      graph.FailRow("edges", k, mistake);
    else if (count > 0)
      heard[static_cast<std::size_t>(row[0]) - 1].push_back({static_cast<int>(row[1]), row.size() == 3 ? row[2] : 1});
  }
  for (auto& list : heard)
    std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return heard;
}

Graph FromRandom(Section& graph, std::span<const Eigen::Vector3d> p_W, std::uint64_t seed) {
  const int count = static_cast<int>(p_W.size());
  Section random = graph.Child("random");
  const std::string kind = random.OneOf("kind");
  if (kind == "geometric") {
    const double radius_m = random.Number("radius_m");
    random.Done();
    return MakeGeometric(p_W, radius_m);
  }
  const double p = random.Number("p");
  if (kind == "erdos_renyi") {
    random.Done();
    return MakeErdosRenyi(count, p, seed);
  }
  const auto k = static_cast<int>(random.Integer("k", 2, std::max(2, count > 0 ? count - 1 : 10000)));
  random.Done();
  if (!random.Wrong("k") && k % 2 != 0) random.Fail("k", "expected an even number, got " + std::to_string(k));
  return random.Wrong("") ? Graph(Heard(p_W.size())) : MakeSmallWorld(count, k, p, seed);
}

}  // namespace

std::span<const Key> GraphKeys() {
  static const Key keys[] = {
      key::OneOf("topology", TopologyNames(), "a family of graphs, in the table below").Default("\"complete\""),
      key::Rows("laplacian", {-1e10, 1e10}, "N x N: row i has what agent i hears; rows sum to 0 (the paper's L-mat)"),
      key::Rows("adjacency", kWeight, "N x N: a_ij, the weight with which agent i hears agent j"),
      key::Rows("edges", kWeight, "`[i, j]` or `[i, j, weight]`, ...: i hears j"),
      key::Table("random", kRandomGraphKeys, "a random undirected graph, drawn by `run.seed`"),
  };
  return keys;
}

Graph ReadGraph(Section& graph, std::span<const Eigen::Vector3d> p_W, std::uint64_t seed) {
  const int count = static_cast<int>(p_W.size());
  graph.TakeOneOf({"topology", "laplacian", "adjacency", "edges", "random"});
  std::string given, last;
  for (const std::string_view source : {"topology", "laplacian", "adjacency", "edges", "random"}) {
    if (!graph.Has(source)) continue;
    given += (given.empty() ? "" : " and ") + std::string(source);
    last = source;
  }
  if (given.find(' ') != std::string::npos) {
    graph.Fail(last, "expected one of topology, laplacian, adjacency, edges, random, got " + given);
    return Graph(Heard(static_cast<std::size_t>(count)));
  }
  if (last == "laplacian") return Graph(FromLaplacian(graph, count));
  if (last == "adjacency") return Graph(FromAdjacency(graph, count));
  if (last == "edges") return Graph(FromEdges(graph, count));
  try {
    if (last == "random") return FromRandom(graph, p_W, seed);
    const std::string topology = graph.OneOf("topology");
    return count > 0 ? MakeTopology(topology, count) : Graph(Heard{});  // 0: the count was wrong, which is noted
  } catch (const std::length_error&) {
    const std::string got = last == "random" ? "more" : "\"" + graph.OneOf("topology") + "\", which has more";
    graph.Fail(last == "random" ? "random" : "topology", "expected a graph with at most " + std::to_string(kMaxEdges) +
                                                             " edges for " + std::to_string(count) + " agents, got " +
                                                             got);
    return Graph(Heard(static_cast<std::size_t>(count)));
  }
}

}  // namespace mascot
