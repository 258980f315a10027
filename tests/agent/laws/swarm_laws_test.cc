// Laws of agents that hear all others that are near: their properties, on the law alone and in whole runs.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/ideal_network.h"
#include "tests/support/law_run.h"

namespace mascot {
namespace {

/// Single integrators at these places along x, which hear each other within 4 m. `more`: lines from [law] on.
std::string Within4m(const std::vector<double>& x, const std::string& more, double duration_s = 12,
                     const std::string& graph = "") {
  std::string places;
  for (const double x_m : x) places += "[" + ShortestFloat(x_m) + ", 0, 1], ";
  return "[run]\nduration_s = " + ShortestFloat(duration_s) +
         "\n[physics]\ncollisions = false\n[agents]\ncount = " + std::to_string(x.size()) +
         "\nmodel = 'single_integrator'\nposition_m = [" + places + "]\n[graph]\nrange_m = 4.0\n" + graph + "[law]\n" +
         more;
}

// --- rendezvous -------------------------------------------------------------------------------------------

const std::string kRendezvous = "name = 'rendezvous'\ngain = 0.5\nmargin_m = 0.5\n";
const std::vector<double> kDumbbell = {-0.5, -0.3, 0, 0.2, 0.4, 3.4, 6.8, 10.2};

/// The longest edge between agents that follow each other in the list from the sixth on.
double LongestOfTheChain(const IdealNetwork& network) {
  double longest_m = 0;
  for (std::size_t i = 5; i + 1 < network.motions.size(); ++i)
    longest_m = std::max(longest_m, (network.motions[i + 1].p_WB - network.motions[i].p_WB).norm());
  return longest_m;
}

TEST(Rendezvous, LosesNoEdgeAndKeepsTheMeanWhereALinearPullFallsApart) {
  IdealNetwork network(Within4m(kDumbbell, kRendezvous));
  double mean = 0;
  for (const double x : kDumbbell) mean += x / 8;
  while (network.time_s() < 12) {
    network.Step();
    ASSERT_LT(LongestOfTheChain(network), 4) << "at " << network.time_s() << " s";
    double now = 0;
    for (const Motion& motion : network.motions) now += motion.p_WB.x() / 8;
    ASSERT_NEAR(now, mean, 1e-12) << "at " << network.time_s() << " s";
  }
  for (const Motion& motion : network.motions) EXPECT_NEAR(motion.p_WB.x(), mean, 1e-3);
  const LawRun linear(Within4m(kDumbbell, "name = 'velocity_consensus'\n"));
  EXPECT_GT(linear.summary["consensus"]["final_disagreement_m"].get<double>(), 4) << "this team fell apart";
}

TEST(Rendezvous, IsPredictedAndMeasured) {
  const LawRun run(Within4m(kDumbbell, kRendezvous));
  EXPECT_EQ(run.prediction.silent, "");
  EXPECT_EQ(run.Predicted("edges_lost"), 0);
  EXPECT_EQ(run.Measured("edges_lost"), 0);
  EXPECT_EQ(run.Law()["bounds"]["edges_lost"], "equal");
  EXPECT_NEAR(run.summary["consensus"]["predicted"]["value_m"][0].get<double>(), 20.2 / 8, 1e-12);
  EXPECT_NEAR(run.summary["consensus"]["value_m"][0].get<double>(), 20.2 / 8, 1e-9);
}

TEST(Rendezvous, CountsTheEdgesThatAreTorn) {
  // Agent 3 is as good as held in its place by its speed limit, while 30 agents pull agent 2 away from it.
  std::vector<double> x(30, 0);
  x.insert(x.end(), {3.4, 6.8});
  const LawRun run(Within4m(x, kRendezvous, 1) +
                   "[[agents.override]]\nid = 32\ncontrol = { max_speed_m_per_s = 0.01 }\n");
  EXPECT_EQ(run.Measured("edges_lost"), 1);
}

TEST(Rendezvous, ANewNeighbourCountsFromTheMarginOnAndThenUpToTheRange) {
  Experiment experiment = LoadExperiment(Section::FromText(Within4m({0, 3}, kRendezvous), "test.toml"), "test");
  const auto law = MakeLaw(experiment, 1);
  const auto pull = [&](double l) {
    Heard heard{.id = 2, .weight = 1};
    heard.motion.p_WB = {l, 0, 0};
    return law->Want_W(0, Motion{}, std::span(&heard, 1)).x();
  };
  const auto tension = [](double l) { return 0.5 * (8 - l) / ((4 - l) * (4 - l)) * l; };
  EXPECT_EQ(pull(3.7), 0);
  EXPECT_DOUBLE_EQ(pull(3.4), tension(3.4));
  EXPECT_DOUBLE_EQ(pull(3.7), tension(3.7)) << "it counts by now";
  EXPECT_EQ(pull(4), 0) << "lost";
  EXPECT_EQ(pull(3.7), 0) << "and new again";
}

TEST(Rendezvous, TheoryIsSilentWhereItPromisesNothing) {
  const auto silent = [](const std::vector<double>& x, const std::string& law, const std::string& graph = "") {
    return LawRun(Within4m(x, law, 0.1, graph)).prediction.silent;
  };
  EXPECT_EQ(silent({0, 3}, kRendezvous), "");
  EXPECT_EQ(silent({0, 3.6}, kRendezvous),
            "the agents within graph.range_m less law.margin_m at the start are not connected");
  EXPECT_EQ(silent({0, 3.45}, "name = 'rendezvous'\ngain = 10.0\nmargin_m = 0.5\n"),
            "the tension at the start is too high for the control period");
  EXPECT_EQ(silent({0, 3}, kRendezvous + "[link]\nloss = 0.1\n"), "samples are lost or late");
  EXPECT_EQ(silent({0, 3}, kRendezvous, "edges = [[1, 2]]\n"), "the closed forms are of undirected graphs");
}

TEST(Rendezvous, PromisesNothingWhereATeamIsTornOnTheWay) {
  const std::string kMargin = "name = 'rendezvous'\nmargin_m = 0.4\n";
  const LawRun torn(Within4m({0, 3.4, 6.8, 10.2, 13.6, 17, 20.4, 23.8}, kMargin + "gain = 2.0\n"));
  EXPECT_GT(torn.Measured("edges_lost"), 0) << "though the tension is low enough at the start";
  EXPECT_EQ(torn.prediction.silent, "an edge is lost on the way: the tension becomes too high for the control period");
  const LawRun kept(Within4m({0, 3.4, 6.8, 10.2, 13.6, 17, 20.4, 23.8}, kMargin + "gain = 0.2\n", 40));
  EXPECT_EQ(kept.prediction.silent, "");
  EXPECT_EQ(kept.Measured("edges_lost"), 0);
}

TEST(Rendezvous, FliesDoubleIntegratorsAndQuadrotorsToo) {
  for (const std::string model : {"double_integrator", "quadrotor"}) {
    std::string toml = Within4m({0, 2, 4}, "name = 'rendezvous'\ngain = 0.2\n", 30);
    toml.replace(toml.find("single_integrator"), 17, model);
    const LawRun run(toml);
    EXPECT_EQ(run.Measured("edges_lost"), 0) << model;
    EXPECT_LT(run.summary["consensus"]["final_disagreement_m"].get<double>(), 0.1) << model;
    EXPECT_EQ(run.prediction.silent, "");
    EXPECT_EQ(run.Law()["bounds"]["edges_lost"], "within");
  }
}

}  // namespace
}  // namespace mascot
