#include "experiment/graph/graph.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <numbers>

#include "experiment/graph/schedule.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kExact = 1e-12;  // rounding of a few sums
constexpr double kEigen = 1e-9;   // eigenvalues of small matrices

std::vector<int> Ids(const std::vector<Graph::Neighbour>& heard) {
  std::vector<int> ids;
  for (const Graph::Neighbour& neighbour : heard) ids.push_back(neighbour.id);
  return ids;
}

/// Reads [graph] with the lines `text`, for `count` agents.
Graph Read(const std::string& text, int count, std::uint64_t seed = 1) {
  Section graph = Section::FromText("[graph]\n" + text, "g.toml").Child("graph");
  graph.Use(GraphKeys());
  const std::vector<Eigen::Vector3d> p_W(static_cast<std::size_t>(count), Eigen::Vector3d::Zero());
  Graph read = ReadGraph(graph, p_W, seed);
  graph.Done();
  graph.ThrowIfWrong();
  return read;
}

std::vector<std::string> Mistakes(const std::string& text, int count) {
  try {
    Read(text, count);
  } catch (const ConfigError& error) {
    return error.mistakes();
  }
  return {};
}

// --- families: eigenvalues from textbooks -----------------------------------------------------------

TEST(GraphFamilies, AreConnectedAndOfTheRightSizeWhateverTheirNumber) {
  for (const std::string_view name : TopologyNames()) {
    for (const int count : {1, 2, 3, 4, 5, 8, 13}) {
      const Graph graph = MakeTopology(name, count);
      EXPECT_EQ(graph.size(), count) << name;
      EXPECT_THAT(graph.Roots(), testing::Not(IsEmpty())) << name << " of " << count;
      EXPECT_EQ(graph.Roots().front(), 1) << name << " of " << count;
    }
  }
}

TEST(GraphFamilies, CompleteHasLambda2EqualToN) {
  EXPECT_EQ(MakeTopology("complete", 7).edges(), 42u);
  EXPECT_NEAR(MakeTopology("complete", 7).Lambda2(), 7, kEigen);
}

TEST(GraphFamilies, PathHasTheEigenvaluesOfThePath) {
  const Eigen::VectorXcd values = MakeTopology("path", 5).Eigenvalues();
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(values(k).real(), 2 - 2 * std::cos(std::numbers::pi * k / 5), kEigen);
  EXPECT_NEAR(MakeTopology("path", 5).Lambda2(), 0.381966, 1e-6);
}

TEST(GraphFamilies, RingHasLambda2OfTheRing) {
  for (const int count : {3, 4, 9})
    EXPECT_NEAR(MakeTopology("ring", count).Lambda2(), 2 - 2 * std::cos(2 * std::numbers::pi / count), kEigen);
}

TEST(GraphFamilies, RingOfTwoIsOnePair) { EXPECT_EQ(MakeTopology("ring", 2).edges(), 2u); }

TEST(GraphFamilies, StarHasAgentOneInTheMiddleAndLambda2One) {
  const Graph star = MakeTopology("star", 6);
  EXPECT_THAT(Ids(star.HeardBy(1)), ElementsAre(2, 3, 4, 5, 6));
  EXPECT_THAT(Ids(star.HeardBy(4)), ElementsAre(1));
  EXPECT_NEAR(star.Lambda2(), 1, kEigen);
}

TEST(GraphFamilies, WheelHasTheLambda2OfItsRimPlusOne) {
  EXPECT_NEAR(MakeTopology("wheel", 7).Lambda2(), 3 - 2 * std::cos(2 * std::numbers::pi / 6), kEigen);
}

TEST(GraphFamilies, DirectedRingHasItsEigenvaluesOnTheUnitCircleAroundOne) {
  const Graph ring = MakeTopology("directed_ring", 10);
  EXPECT_THAT(Ids(ring.HeardBy(1)), ElementsAre(10));
  EXPECT_THAT(Ids(ring.HeardBy(4)), ElementsAre(3));
  const Eigen::VectorXcd values = ring.Eigenvalues();
  for (int k = 0; k < 10; ++k) EXPECT_NEAR(std::abs(values(k) - 1.0), 1, kEigen);
  EXPECT_NEAR(ring.Lambda2(), 1 - std::cos(2 * std::numbers::pi / 10), kEigen);
}

TEST(GraphFamilies, DirectedPathHearsItsPredecessor) {
  const Graph path = MakeTopology("directed_path", 4);
  EXPECT_THAT(Ids(path.HeardBy(1)), IsEmpty());
  EXPECT_THAT(Ids(path.HeardBy(4)), ElementsAre(3));
  EXPECT_THAT(path.Roots(), ElementsAre(1));
}

TEST(GraphFamilies, DirectedPathHasAllItsEigenvaluesButZeroExactlyAtOne) {
  // The eigenvalue 1 forty times: a solver for the whole matrix would scatter them by 0.1 and more.
  std::vector<std::vector<Graph::Neighbour>> chain(41);  // ids not in the order of the chain
  for (int i = 1; i < 41; ++i) chain[static_cast<std::size_t>(i * 5 % 41)] = {{(i - 1) * 5 % 41 + 1, 1.0}};
  const Eigen::VectorXcd values = Graph(chain).Eigenvalues();
  EXPECT_EQ(values(0), 0.0);
  for (int i = 1; i < 41; ++i) EXPECT_EQ(values(i), 1.0);
}

TEST(GraphFamilies, TreeParentsHaveHalfTheNumber) {
  EXPECT_THAT(Ids(MakeTopology("directed_tree", 7).HeardBy(7)), ElementsAre(3));
  EXPECT_THAT(Ids(MakeTopology("binary_tree", 7).HeardBy(3)), ElementsAre(1, 6, 7));
}

TEST(GraphFamilies, ErdosRenyiIsSymmetricSeededAndAsDenseAsAsked) {
  const Graph graph = MakeErdosRenyi(60, 0.4, 5);
  EXPECT_TRUE(graph.IsSymmetric());
  EXPECT_EQ(graph.Laplacian(), MakeErdosRenyi(60, 0.4, 5).Laplacian());
  EXPECT_NE(graph.Laplacian(), MakeErdosRenyi(60, 0.4, 6).Laplacian());
  const double pairs = 60 * 59 / 2.0, deviation = std::sqrt(pairs * 0.4 * 0.6);
  EXPECT_NEAR(static_cast<double>(graph.edges()) / 2, pairs * 0.4, 5 * deviation);
  EXPECT_EQ(MakeErdosRenyi(9, 0, 1).edges(), 0u);
  EXPECT_EQ(MakeErdosRenyi(9, 1, 1).edges(), 72u);
}

TEST(GraphFamilies, SmallWorldRewiresEveryEdgeThatItShould) {
  // With p = 1, four agents and k = 2 there are three graphs. 1 hears 2 and 4, and must take 3 in place of 2. 2 then
  // hears only 3, and takes 1 or 4. 3 takes 2 in place of 4 in both cases. 4 hears only 1: it takes 2 or 3 in the first
  // case, 3 in the second.
  std::map<std::vector<std::vector<int>>, int> seen;
  constexpr int kDraws = 4000;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const Graph graph = MakeSmallWorld(4, 2, 1, seed);
    std::vector<std::vector<int>> heard;
    for (int i = 1; i <= 4; ++i) heard.push_back(Ids(graph.HeardBy(i)));
    ++seen[heard];
  }
  const auto share = [&seen](const std::vector<std::vector<int>>& heard) { return seen[heard] / double{kDraws}; };
  constexpr double kFiveDeviations = 0.04;
  EXPECT_NEAR(share({{2, 3}, {1, 3, 4}, {1, 2}, {2}}), 0.25, kFiveDeviations);
  EXPECT_NEAR(share({{2, 3}, {1, 3}, {1, 2, 4}, {3}}), 0.25, kFiveDeviations);
  EXPECT_NEAR(share({{3}, {3, 4}, {1, 2, 4}, {2, 3}}), 0.5, kFiveDeviations);
  EXPECT_THAT(seen, SizeIs(3));
}

TEST(GraphFamilies, SmallWorldRewiresAFractionPOfItsRing) {
  constexpr int kCount = 200, kNearest = 6;
  const Graph graph = MakeSmallWorld(kCount, kNearest, 0.3, 1);
  EXPECT_EQ(graph.edges(), std::size_t{kCount * kNearest});
  EXPECT_TRUE(graph.IsSymmetric());
  int rewired = 0;
  for (int i = 1; i <= kCount; ++i)
    for (const Graph::Neighbour& j : graph.HeardBy(i)) {
      const int apart = std::abs(i - j.id);
      rewired += i < j.id && std::min(apart, kCount - apart) > kNearest / 2;
    }
  const double edges = kCount * kNearest / 2.0;
  EXPECT_NEAR(rewired, 0.3 * edges, 5 * std::sqrt(edges * 0.3 * 0.7));
  EXPECT_EQ(MakeSmallWorld(8, 2, 0, 1).Laplacian(), MakeTopology("ring", 8).Laplacian());
  EXPECT_EQ(MakeSmallWorld(5, 4, 1, 1).Laplacian(), MakeTopology("complete", 5).Laplacian()) << "nobody else to hear";
}

// --- properties of a graph --------------------------------------------------------------------------

// A directed cycle of 1, 2, 3 (1 hears 3, 2 hears 1 with weight 2, 3 hears 2 with weight 4); 4 hears 3,
// 5 hears 4 with weight 0.5.
Graph CircleWithTail() { return Graph({{{3, 1}}, {{1, 2}}, {{2, 4}}, {{3, 1}}, {{4, 0.5}}}); }

TEST(Graph, LaplacianRowHasTheWeightsOfTheAgent) {
  const Eigen::MatrixXd laplacian = Graph({{}, {{1, 2}, {3, 0.5}}, {{2, 1}}}).Laplacian();
  EXPECT_EQ(laplacian, (Eigen::Matrix3d() << 0, 0, 0, -2, 2.5, -0.5, 0, -1, 1).finished());
}

TEST(Graph, IsSymmetricOnlyWithEqualWeightsBothWays) {
  EXPECT_TRUE(Graph({{{2, 1}}, {{1, 1}}}).IsSymmetric());
  EXPECT_FALSE(Graph({{{2, 1}}, {{1, 2}}}).IsSymmetric());
  EXPECT_FALSE(Graph({{{2, 1}}, {}}).IsSymmetric());
}

TEST(Graph, OneAgentIsAGraph) {
  const Graph alone = MakeTopology("complete", 1);
  EXPECT_EQ(alone.edges(), 0u);
  EXPECT_TRUE(alone.IsSymmetric());
  EXPECT_EQ(alone.Lambda2(), 0);
  EXPECT_THAT(alone.Roots(), ElementsAre(1));
  EXPECT_THAT(alone.Components(), ElementsAre(ElementsAre(1)));
  EXPECT_EQ(alone.LeftNullVector()->sum(), 1);
  EXPECT_THAT(*alone.SpanningTree(1), ElementsAre(0));
}

TEST(Graph, ComponentsAreStronglyConnected) {
  EXPECT_THAT(CircleWithTail().Components(), ElementsAre(ElementsAre(1, 2, 3), ElementsAre(4), ElementsAre(5)));
}

TEST(Graph, RootsAreHeardByEveryone) {
  EXPECT_THAT(CircleWithTail().Roots(), ElementsAre(1, 2, 3));
  EXPECT_THAT(Graph({{}, {}}).Roots(), IsEmpty());
  EXPECT_THAT(Graph({{}, {{1, 1}, {3, 1}}, {}}).Roots(), IsEmpty());
}

TEST(Graph, Lambda2VanishesExactlyWithoutASpanningTree) {
  EXPECT_GT(CircleWithTail().Lambda2(), 0.1);
  EXPECT_EQ(Graph({{}, {{1, 1}, {3, 1}}, {}}).Lambda2(), 0);
  EXPECT_EQ(Graph({{{2, 1}}, {{1, 1}}, {{4, 1}}, {{3, 1}}}).Lambda2(), 0);
}

TEST(Graph, LeftNullVectorHasTheWeightsOfTheStarts) {
  const Graph graph = CircleWithTail();
  const Eigen::VectorXd gamma = *graph.LeftNullVector();
  EXPECT_NEAR(gamma.sum(), 1, kExact);
  EXPECT_NEAR((gamma.transpose() * graph.Laplacian()).norm(), 0, kExact);
  EXPECT_EQ(gamma(3), 0);
  EXPECT_EQ(gamma(4), 0);
  // In a directed cycle, gamma_i is proportional to the inverse of the weight with which i hears: 1, 1/2, 1/4.
  EXPECT_NEAR(gamma(0), 4.0 / 7, kExact);
  EXPECT_NEAR(gamma(2), 1.0 / 7, kExact);
}

TEST(Graph, LeftNullVectorOfASymmetricGraphIsTheMean) {
  const Eigen::VectorXd gamma = *MakeTopology("path", 6).LeftNullVector();
  EXPECT_NEAR((gamma - Eigen::VectorXd::Constant(6, 1.0 / 6)).norm(), 0, kExact);
  EXPECT_FALSE(Graph({{}, {}}).LeftNullVector().has_value());
}

TEST(Graph, SpanningTreeIsBreadthFirstWithTheLowestParentOneLevelUp) {
  EXPECT_THAT(*MakeTopology("complete", 4).SpanningTree(3), ElementsAre(3, 3, 0, 3));
  EXPECT_THAT(*MakeTopology("ring", 6).SpanningTree(1), ElementsAre(0, 1, 2, 3, 6, 1));
  // 6 hears 4 and 5, both two steps from the root. The search reaches 5 first, through 2; the parent is still 4.
  EXPECT_THAT(*Graph({{}, {{1, 1}}, {{1, 1}}, {{3, 1}}, {{2, 1}}, {{4, 1}, {5, 1}}}).SpanningTree(1),
              ElementsAre(0, 1, 1, 3, 2, 4));
  EXPECT_THAT(*CircleWithTail().SpanningTree(2), ElementsAre(3, 0, 2, 3, 4));
  EXPECT_EQ(CircleWithTail().SpanningTree(4), std::nullopt);
}

TEST(Graph, TenThousandAgentsInARowAreWalkedWithoutRecursion) {
  const Graph path = MakeTopology("directed_path", 10000);
  EXPECT_THAT(path.Components(), SizeIs(10000));
  EXPECT_THAT(path.Roots(), ElementsAre(1));
  EXPECT_EQ(path.SpanningTree(1)->back(), 9999);
  EXPECT_THAT(MakeTopology("ring", 10000).Components(), SizeIs(1));
}

// --- [graph] ----------------------------------------------------------------------------------------

TEST(ReadGraph, IsCompleteByDefault) { EXPECT_EQ(Read("", 4).Laplacian(), MakeTopology("complete", 4).Laplacian()); }

TEST(ReadGraph, GivesTheSameGraphWhicheverWayItIsWritten) {
  const Eigen::MatrixXd path = MakeTopology("path", 3).Laplacian();
  EXPECT_EQ(Read("topology = 'path'", 3).Laplacian(), path);
  EXPECT_EQ(Read("laplacian = [[1, -1, 0], [-1, 2, -1], [0, -1, 1]]", 3).Laplacian(), path);
  EXPECT_EQ(Read("adjacency = [[0, 1, 0], [1, 0, 1], [0, 1, 0]]", 3).Laplacian(), path);
  EXPECT_EQ(Read("edges = [[2, 1], [3, 2], [1, 2], [2, 3, 1.0]]", 3).Laplacian(), path);
}

TEST(ReadGraph, RowsOfAMatrixAreWhatTheAgentHears) {
  const Graph graph = Read("adjacency = [[0, 0, 0], [0.5, 0, 0], [0, 2, 0]]", 3);
  EXPECT_THAT(Ids(graph.HeardBy(1)), IsEmpty());
  EXPECT_THAT(Ids(graph.HeardBy(2)), ElementsAre(1));
  EXPECT_EQ(graph.HeardBy(2)[0].weight, 0.5);
  EXPECT_EQ(Read("edges = [[3, 2, 2.5]]", 3).HeardBy(3)[0].weight, 2.5);
}

TEST(ReadGraph, AcceptsAnEmptyListOfEdges) { EXPECT_EQ(Read("edges = []", 3).edges(), 0u); }

TEST(ReadGraph, ForgivesRoundingInRowSums) {
  EXPECT_THAT(Mistakes("laplacian = [[0.3, -0.1, -0.2], [0, 0, 0], [0, 0, 0]]", 3), IsEmpty());
  EXPECT_THAT(Mistakes("laplacian = [[1, -0.99999999], [-1, 1]]", 2), SizeIs(1));
}

TEST(ReadGraph, SeedsRandomGraphs) {
  const std::string text = "random = { kind = 'erdos_renyi', p = 0.5 }";
  EXPECT_EQ(Read(text, 9, 3).Laplacian(), MakeErdosRenyi(9, 0.5, 3).Laplacian());
}

TEST(ReadSchedule, SeedsEveryRandomGraphAnew) {
  const auto phases = [](std::uint64_t seed) {
    const std::string random = "random = { kind = 'erdos_renyi', p = 0.5 }\n";
    std::string text = "[graph]\n" + random;
    for (const char* at_s : {"1.0", "2.0"}) text += "[[graph.schedule]]\nat_s = " + std::string(at_s) + "\n" + random;
    Section graph = Section::FromText(text, "g.toml").Child("graph");
    graph.Use(ScheduleKeys());
    const std::vector<Eigen::Vector3d> p_W(20, Eigen::Vector3d::Zero());
    std::vector<Eigen::MatrixXd> laplacians;
    const Schedule schedule = ReadSchedule(graph, p_W, seed);
    for (const Schedule::Phase& phase : schedule.phases()) laplacians.push_back(phase.graph.Laplacian());
    return laplacians;
  };
  std::vector<Eigen::MatrixXd> all;
  for (const std::uint64_t seed : {1, 2, 3})
    for (const Eigen::MatrixXd& laplacian : phases(seed)) {
      EXPECT_THAT(all, ::testing::Not(::testing::Contains(laplacian))) << "seed " << seed;
      all.push_back(laplacian);
    }
  EXPECT_THAT(all, SizeIs(9));
  EXPECT_EQ(phases(2), phases(2));
}

TEST(ReadGraph, NamesTheOffendingRow) {
  EXPECT_THAT(Mistakes("laplacian = [\n[1, -1],\n[-1, 2]]", 2),
              ElementsAre("g.toml:4:1: graph.laplacian[1]: expected a row that sums to 0, got a sum of 1"));
  EXPECT_THAT(Mistakes("laplacian = [\n[-1, 1],\n[-1, 1]]", 2),
              ElementsAre("g.toml:3:1: graph.laplacian[0]: expected no positive number off the diagonal, "
                          "got 1 for agent 2"));
  EXPECT_THAT(Mistakes("laplacian = [\n[1, -1],\n[-1]]", 2),
              ElementsAre("g.toml:4:1: graph.laplacian[1]: expected 2 numbers, got a list of 1"));
  EXPECT_THAT(Mistakes("adjacency = [\n[0, 1],\n[1, 0.5]]", 2),
              ElementsAre("g.toml:4:1: graph.adjacency[1]: expected 0 on the diagonal, got 0.5"));
}

TEST(ReadGraph, RefusesMatricesOfAnotherSize) {
  EXPECT_THAT(Mistakes("adjacency = [[0, 1], [1, 0]]", 3),
              ElementsAre("g.toml:2:13: graph.adjacency: expected 3 rows, one per agent, got a list of 2"));
}

TEST(ReadGraph, RefusesInvalidEdges) {
  EXPECT_THAT(Mistakes("edges = [[1, 3]]", 2),
              ElementsAre("g.toml:2:10: graph.edges[0]: expected agents' numbers from 1 to 2, got 3"));
  EXPECT_THAT(Mistakes("edges = [[0, 1]]", 2),
              ElementsAre("g.toml:2:10: graph.edges[0]: expected agents' numbers from 1 to 2, got 0"));
  EXPECT_THAT(Mistakes("edges = [[1, 1.5]]", 2),
              ElementsAre("g.toml:2:10: graph.edges[0]: expected agents' numbers from 1 to 2, got 1.5"));
  EXPECT_THAT(Mistakes("edges = [[2, 2]]", 2),
              ElementsAre("g.toml:2:10: graph.edges[0]: expected two different agents, got 2 twice"));
  EXPECT_THAT(Mistakes("edges = [[1, 2], [1, 2, 0.5]]", 2),
              ElementsAre("g.toml:2:18: graph.edges[1]: expected each edge once, got [1, 2] again"));
  EXPECT_THAT(Mistakes("edges = [[1, 2, 0]]", 2),
              ElementsAre("g.toml:2:10: graph.edges[0]: expected a weight in (0, 1e+06], got 0"));
  EXPECT_THAT(Mistakes("edges = [[1, 2, 1, 1]]", 2),
              ElementsAre("g.toml:2:10: graph.edges[0]: expected [i, j] or [i, j, weight], got a list of 4"));
}

TEST(ReadGraph, RefusesTwoSourcesOfTheGraph) {
  EXPECT_THAT(Mistakes("edges = [[1, 2]]\ntopology = 'ring'", 2),
              ElementsAre("g.toml:2:9: graph.edges: expected one of topology, laplacian, adjacency, edges, random, "
                          "got topology and edges"));
}

TEST(ReadGraph, ChecksNoSizesWhileTheCountIsUnknown) {
  EXPECT_THAT(Mistakes("adjacency = [[0, 1], [1, 0]]", 0), IsEmpty());
  EXPECT_THAT(Mistakes("edges = [[7, 9]]", 0), IsEmpty());
  EXPECT_THAT(Mistakes("edges = [[0, 9]]", 0), SizeIs(1));
}

}  // namespace
}  // namespace mascot
