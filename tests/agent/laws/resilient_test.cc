// Agents that lie, consensus in spite of them (W-MSR), and the robustness of graphs that it takes.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "agent/neighbours.h"
#include "experiment/graph/robustness.h"
#include "tests/support/law_run.h"

namespace mascot {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// --- robustness of graphs ---------------------------------------------------------------------------------

/// The robustness of a graph by its definition: all pairs of disjoint groups are tried.
int RobustnessByPairs(const Graph& graph) {
  const unsigned all = 1u << graph.size();
  const auto reach = [&](unsigned group) {
    int most = 0;
    for (int id = 1; id <= graph.size(); ++id) {
      int outside = 0;
      for (const Graph::Neighbour& j : graph.HeardBy(id)) outside += (group >> (j.id - 1) & 1u) == 0 ? 1 : 0;
      if ((group >> (id - 1) & 1u) != 0) most = std::max(most, outside);
    }
    return most;
  };
  int robustness = graph.size();
  for (unsigned a = 1; a < all; ++a)
    for (unsigned b = 1; b < all; ++b)
      if ((a & b) == 0) robustness = std::min(robustness, std::max(reach(a), reach(b)));
  return robustness;
}

TEST(Robustness, OfKnownGraphsIsAsPublished) {
  for (int count = 2; count <= 12; ++count)
    EXPECT_EQ(RobustnessOf(MakeTopology("complete", count)), (count + 1) / 2) << count;
  for (int count = 3; count <= 12; ++count) {
    EXPECT_EQ(RobustnessOf(MakeTopology("path", count)), 1) << count;
    EXPECT_EQ(RobustnessOf(MakeTopology("star", count)), 1) << count;
    EXPECT_EQ(RobustnessOf(MakeTopology("directed_ring", count)), 1) << "it has a spanning tree";
  }
  EXPECT_EQ(RobustnessOf(MakeTopology("path", 1)), 1);
  EXPECT_EQ(RobustnessOf(Graph({{}, {}})), 0) << "two that do not hear each other";
  EXPECT_EQ(RobustnessOf(MakeTopology("complete", kMaxRobustness)), kMaxRobustness / 2);
  EXPECT_EQ(RobustnessOf(MakeTopology("complete", kMaxRobustness + 1)), std::nullopt);
}

TEST(Robustness, IsWhatAllPairsOfGroupsSay) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed)
    for (const double p : {0.3, 0.6, 0.9}) {
      const Graph graph = MakeErdosRenyi(6, p, seed);
      EXPECT_EQ(RobustnessOf(graph), RobustnessByPairs(graph)) << seed << " " << p;
    }
}

TEST(Robustness, OfDirectedGraphsIsAtLeastOneIfThereIsASpanningTree) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Graph both = MakeErdosRenyi(6, 0.3, seed);
    std::vector<std::vector<Graph::Neighbour>> heard(6);
    for (int id = 1; id <= 6; ++id)
      for (const Graph::Neighbour& j : both.HeardBy(id))
        if ((id + j.id + static_cast<int>(seed)) % 3 != 0 || j.id < id)
          heard[static_cast<std::size_t>(id - 1)].push_back(j);
    const Graph graph(heard);
    EXPECT_EQ(*RobustnessOf(graph) >= 1, !graph.Roots().empty()) << seed;
    EXPECT_EQ(RobustnessOf(graph), RobustnessByPairs(graph)) << seed;
  }
}

// --- agents that lie --------------------------------------------------------------------------------------

/// Seven single integrators of which all hear each other; agent 7 lies as `lie` says.
std::string Seven(const std::string& law, const std::string& lie, double duration_s = 10,
                  const std::string& model = "single_integrator", const std::string& topology = "complete") {
  return "[run]\nduration_s = " + ShortestFloat(duration_s) +
         "\n[physics]\ncollisions = false\n[output]\nfidelity = false\n[agents]\ncount = 7\nmodel = '" + model +
         "'\nposition_m = [[3, 0, 1], [-1, 1, 2], [4, 2, 3], [1, 3, 4], [-5, 4, 5], [0, 5, 6], [2, 1, 7]]\n"
         "[[agents.override]]\nid = 7\nlie = { " +
         lie + " }\n[graph]\ntopology = '" + topology + "'\n[law]\nname = '" + law + "'\n";
}

/// What agent 1 hears of agents 2 and 7 at `tick`, where all are at the origin.
std::vector<Heard> HeardAt(Neighbours& neighbours, std::int64_t tick, const Motion& still,
                           std::span<const double> said) {
  const std::vector<Sample> samples(6, Sample{&still, said});
  const std::span<const Heard> heard = neighbours.Hear(tick, still, samples);
  return {heard.front(), heard.back()};
}

TEST(FalseData, IsHeardFromItsTimeOnOfTheLiarAlone) {
  const Experiment experiment = LoadExperiment(
      Section::FromText(Seven("velocity_consensus", "offset_m = [1.0, 2.0, 3.0], from_s = 0.05"), "test.toml"), "test");
  Neighbours neighbours(experiment, 1);
  const Motion still;
  const std::vector<double> said = {10, 20, 30, 40};
  for (std::int64_t tick = 0; tick < 10; ++tick) {
    const std::vector<Heard> heard = HeardAt(neighbours, tick, still, said);
    const bool lies = tick >= 5;
    EXPECT_EQ(heard[0].motion.p_WB, Eigen::Vector3d::Zero()) << tick;
    EXPECT_EQ(heard[1].motion.p_WB, lies ? Eigen::Vector3d(1, 2, 3) : Eigen::Vector3d::Zero()) << tick;
    EXPECT_THAT(heard[0].message, testing::ElementsAre(10, 20, 30, 40));
    EXPECT_EQ(heard[1].message[3], lies ? 41 : 40) << "number 3 is off by component 0";
    EXPECT_EQ(heard[1].message[2], lies ? 33 : 30);
  }
}

TEST(FalseData, OscillatesWithItsVelocity) {
  const Experiment experiment = LoadExperiment(
      Section::FromText(Seven("velocity_consensus", "kind = 'oscillating', offset_m = [2.0, 0.0, 0.0], period_s = 1.0"),
                        "test.toml"),
      "test");
  Neighbours neighbours(experiment, 1);
  const Motion still;
  EXPECT_NEAR(HeardAt(neighbours, 0, still, {})[1].motion.v_WB.x(), 2 * 2 * M_PI, 1e-12);
  EXPECT_NEAR(HeardAt(neighbours, 25, still, {})[1].motion.p_WB.x(), 2, 1e-12);
  EXPECT_NEAR(HeardAt(neighbours, 75, still, {})[1].motion.p_WB.x(), -2, 1e-12);
}

TEST(FalseData, AtRandomIsTheSameForAllWhoHearItAndAnotherWithAnotherSeed) {
  const auto heard_by = [](int id, int seed) {
    std::string toml = Seven("velocity_consensus", "kind = 'random', offset_m = [2.0, 2.0, 0.0]");
    toml.insert(6, "seed = " + std::to_string(seed) + "\n");
    const Experiment experiment = LoadExperiment(Section::FromText(toml, "test.toml"), "test");
    Neighbours neighbours(experiment, id);
    const Motion still;
    std::vector<double> x;
    for (std::int64_t tick = 0; tick < 200; ++tick) {
      x.push_back(HeardAt(neighbours, tick, still, {})[1].motion.p_WB.x());
      EXPECT_LE(std::abs(x.back()), 2);
    }
    return x;
  };
  const std::vector<double> x = heard_by(1, 1);
  EXPECT_EQ(x, heard_by(2, 1));
  EXPECT_NE(x, heard_by(1, 2));
  EXPECT_GT(*std::ranges::max_element(x), 1.5);
  EXPECT_LT(*std::ranges::min_element(x), -1.5);
}

TEST(FalseData, SilencesTheoryOfWhatAgentsHear) {
  EXPECT_EQ(LawRun(Seven("velocity_consensus", "offset_m = [1.0, 0.0, 0.0]", 0.1)).prediction.silent, "agent 7 lies");
  EXPECT_EQ(LawRun(Seven("finite_time", "offset_m = [1.0, 0.0, 0.0]", 0.1)).prediction.silent, "an agent lies");
}

// --- W-MSR ------------------------------------------------------------------------------------------------

const char* const kLies[] = {"offset_m = [50.0, -30.0, 0.0]",
                             "kind = 'oscillating', offset_m = [20.0, 20.0, 0.0], period_s = 3.0",
                             "kind = 'random', offset_m = [9.0, 9.0, 0.0], from_s = 0.5"};

TEST(Resilient, HonestAgentsAgreeInTheHullOfTheirStartsWhateverOneSays) {
  for (const char* lie : kLies) {
    const LawRun run(Seven("resilient", lie));
    EXPECT_EQ(run.Measured("outside_m"), 0) << lie;
    EXPECT_GE(run.Predicted("outside_m"), 0) << lie;
    EXPECT_LT(run.Predicted("outside_m"), 1e-9) << "0, but for rounding: " << lie;
    EXPECT_EQ(run.Law()["bounds"]["outside_m"], "at_most");
    EXPECT_LT(run.Measured("apart_m"), 1e-3) << lie;
    EXPECT_EQ(run.Measured("robustness"), 4);
    EXPECT_EQ(run.Predicted("robustness"), 4);
    EXPECT_THAT(run.prediction.warnings, IsEmpty());
    EXPECT_LT(run.meter.aim().final_disagreement_m, 1e-3) << "of honest agents";
  }
}

/// Nine agents that all hear each other, and four more, each of which hears five of those before it: 5-robust, with 92
/// of 156 edges (LeBlanc et al., theorem on preferential attachment). Agents 3 and 8 lie.
std::string Thirteen(int f) {
  std::string edges, places;
  for (int i = 1; i <= 13; ++i) {
    for (int j = 1; j < (i <= 9 ? 10 : i); ++j)
      if (i != j && (i <= 9 || 7 * j % (i - 1) < 5))
        edges += (edges.empty() ? "[" : ", [") + std::to_string(i) + ", " + std::to_string(j) + "]";
    places += (places.empty() ? "[" : ", [") + std::to_string(i * 5 % 13) + ", " + std::to_string(i) + ", 1]";
  }
  return "[run]\nduration_s = 30.0\n[physics]\ncollisions = false\n[control]\nrate_hz = 20\n[output]\nfidelity = "
         "false\n[agents]\ncount = 13\nmodel = 'single_integrator'\nposition_m = [" +
         places +
         "]\n[[agents.override]]\nid = 3\nlie = { offset_m = [50, 0, 0] }\n[[agents.override]]\nid = 8\nlie = { "
         "offset_m = [60, -40, 0] }\n[graph]\nedges = [" +
         edges + "]\n[law]\nname = 'resilient'\ngain = 0.4\nf = " + std::to_string(f) + "\n";
}

TEST(Resilient, TwoLiarsDragNobodyOffOnASparseGraphThatIsFiveRobust) {
  const LawRun run(Thirteen(2));
  EXPECT_EQ(run.Measured("robustness"), 5);
  EXPECT_EQ(run.Measured("outside_m"), 0);
  EXPECT_NEAR(run.Predicted("outside_m"), 0, 1e-8) << "but for rounding";
  EXPECT_LT(run.Measured("apart_m"), 1e-3);
  EXPECT_THAT(run.prediction.warnings, IsEmpty());
  const LawRun one(Thirteen(1));
  EXPECT_GT(one.Measured("outside_m"), 10) << "one of the two is believed";
  EXPECT_THAT(one.prediction.warnings, Contains("law.f: agent 1 hears 2 that lie: more than F = 1 are not left out"));
}

TEST(Resilient, ConsensusIsDraggedOffByTheSameLie) {
  const LawRun run(Seven("velocity_consensus", kLies[0]));
  EXPECT_GT(run.meter.aim().value_m.x(), 4 + 20) << "far outside of the starts";
}

TEST(Resilient, WithoutLiarsAndWithFOfZeroItIsConsensus) {
  std::string toml = Seven("resilient", "offset_m = [0.0, 0.0, 0.0]") + "f = 0\n";
  std::string plain = Seven("velocity_consensus", "offset_m = [0.0, 0.0, 0.0]");
  const LawRun a(toml), b(plain);
  EXPECT_LT((a.meter.aim().value_m - b.meter.aim().value_m).norm(), 1e-12);
}

TEST(Resilient, BodiesThatFollowWithALagAreNotDraggedOffEither) {
  for (const char* model : {"double_integrator", "quadrotor"}) {
    const LawRun run(Seven("resilient", kLies[0], 25, model) + "gain = 0.2\n");
    EXPECT_LT(run.Measured("outside_m"), 0.1) << model << ": but for an overshoot";
    EXPECT_LT(run.Measured("apart_m"), 0.1) << model;
  }
}

TEST(Resilient, SaysWhatTheGraphOrFDoesNotGrant) {
  const std::string lie = "offset_m = [9.0, 0.0, 0.0]";
  const auto warnings = [&](const std::string& topology, const std::string& more) {
    return LawRun(Seven("resilient", lie, 0.1, "single_integrator", topology) + more).prediction.warnings;
  };
  EXPECT_THAT(warnings("path", ""), Contains("graph: 1-robust: 1 that lie can keep honest agents apart; they agree on "
                                             "every 3-robust graph"));
  EXPECT_THAT(warnings("complete", "f = 2\n"),
              Contains("graph: 4-robust: that honest agents agree is proved for every 5-robust graph only"));
  EXPECT_THAT(warnings("complete", "f = 0\n"),
              Contains("law.f: agent 1 hears 1 that lie: more than F = 0 are not left out"));
  EXPECT_THAT(warnings("complete", "gain = 20.0\n"),
              Contains("law.gain: expected at most 16.67 1/s at this control period and graph: agents overshoot"));
  EXPECT_THAT(LawRun("[run]\nduration_s = 0.1\n[agents]\ncount = 20\nmodel = 'single_integrator'\n[graph]\ntopology = "
                     "'complete'\n[law]\nname = 'resilient'\n")
                  .prediction.warnings,
              Contains(HasSubstr("graph: its robustness is not checked: beyond 16 agents")));
}

}  // namespace
}  // namespace mascot
