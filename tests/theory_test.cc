#include "orchestrator/theory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <complex>

#include "orchestrator/minmax_time.h"
#include "orchestrator/modes.h"
#include "tests/ideal_network.h"

namespace mascot {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

// --- modes ------------------------------------------------------------------------------------------

TEST(Modes, OfRealStiffnessDecayWithAnyDamping) {
  EXPECT_TRUE(Decays({0.1, 4.0}));
  EXPECT_FALSE(Decays({0.0, 4.0}));
  EXPECT_FALSE(Decays({1.0, 0.0}));
  EXPECT_FALSE(Decays({1.0, -1.0}));
}

TEST(Modes, OfComplexStiffnessNeedDampingAboveItsImaginaryPartOverTheRootOfItsRealPart) {
  EXPECT_DOUBLE_EQ(LeastDamping({4.0, 3.0}), 1.5);
  EXPECT_TRUE(Decays({1.51, {4.0, 3.0}}));
  EXPECT_FALSE(Decays({1.49, {4.0, 3.0}}));
}

TEST(Modes, SampledDecayExactlyWhileStiffnessTimesPeriodIsBelowTwiceTheDamping) {
  // And damping times period below 2, both from the Jury test.
  EXPECT_TRUE(DecaysSampled({1.0, 20.0}, 0.0999));
  EXPECT_FALSE(DecaysSampled({1.0, 20.0}, 0.1001));
  EXPECT_TRUE(DecaysSampled({10.0, 1.0}, 0.1999));
  EXPECT_FALSE(DecaysSampled({10.0, 1.0}, 0.2001));
  const std::array<LinearMode, 2> modes = {{{1.0, 2.0}, {1.0, 20.0}}};
  EXPECT_NEAR(LongestPeriod(modes, 1.0), 0.1, 1e-9);
  EXPECT_EQ(LongestPeriod(modes, 0.05), 0.05);
}

/// |x| of a mode from rest, integrated in small steps: an independent witness.
double SettlingByIntegration(const LinearMode& mode, double end_s) {
  std::complex<double> x = 1, v = 0;
  const double h = 1e-5;
  double last_s = 0;
  for (double t = 0; t < end_s; t += h) {
    v += h * (-mode.stiffness * x - mode.damping * v);
    x += h * v;
    if (std::abs(x) > 0.02) last_s = t;
  }
  return last_s;
}

TEST(Modes, SettleWhenTheirFreeResponseFromRestStaysWithinTwoPercent) {
  for (const LinearMode& mode : {LinearMode{2.0, 1.0}, {1.0, 4.0}, {5.0, 1.0}, {0.6, 3.0}, {2.0, {2.0, 1.5}}}) {
    const double witness_s = SettlingByIntegration(mode, 60);
    EXPECT_NEAR(SettlingTime(mode), witness_s, 2e-3 * witness_s) << mode.damping << " " << mode.stiffness;
  }
  EXPECT_NEAR(SettlingTime({2.0, 1.0}), 5.834, 0.01);                              // (1 + t) e^-t = 0.02
  EXPECT_NEAR(SettlingTime({1000.0, 1.0}), 1000 * std::log(50), 0.01 * 1000 * 4);  // stiff: one slow root
}

TEST(Modes, SettleTogetherWithTheLastOfThem) {
  const std::array<LinearMode, 3> modes = {{{1.0, 9.0}, {1.0, 0.1}, {1.0, 1.0}}};
  EXPECT_EQ(SettlingTime(modes), SettlingTime(modes[1]));
}

// --- min-max times ----------------------------------------------------------------------------------

TEST(MinmaxTimes, FromRestAreThePublishedClosedForms) {
  EXPECT_NEAR(MinmaxTime(10, 0, 0.5, 1), 7.746, 1e-3);
  EXPECT_NEAR(MinmaxTime(-10, 0, 0.5, 1), 7.746, 1e-3);
  EXPECT_NEAR(MinmaxBound(10, 0, 0.5), 8.944, 1e-3);
  EXPECT_NEAR(MinmaxTime(20, 0, 0.05, 1), 28.98, 5e-3);
  EXPECT_NEAR(MinmaxTime(20, 0, 0.05, 0.6), 29.44, 5e-3);  // what the published force limit leaves
  EXPECT_EQ(MinmaxTime(0, 0, 0.5, 1), 0);
  EXPECT_EQ(MinmaxBound(0, 0, 0.5), 0);
}

TEST(MinmaxTimes, HoldFromAnyRelativeSpeed) {
  const double alpha = 0.5, beta = 2, h = 1e-5;
  for (const double z0 : {-6.0, -1.0, 0.0, 3.0}) {
    for (const double w0 : {-3.0, -1.0, 0.0, 0.5, 2.0, 4.0}) {
      double z = z0, w = w0, t = 0;
      while (std::abs(z) > 1e-4 || std::abs(w) > 0.01) {
        const double side = 2 * alpha * z + w * std::abs(w);
        w -= h * beta * ((side > 0) - (side < 0));
        z += h * w;
        t += h;
      }
      EXPECT_NEAR(MinmaxTime(z0, w0, alpha, beta), t, 0.03) << z0 << " " << w0;
      EXPECT_LE(MinmaxTime(z0, w0, alpha, beta), MinmaxBound(z0, w0, alpha) + 1e-9) << z0 << " " << w0;
    }
  }
}

// --- whole experiments ------------------------------------------------------------------------------

const std::string kFour =
    "[run]\nduration_s = 40.0\n[agents]\ncount = 4\nmodel = 'double_integrator'\n"
    "position_m = [[-1, 1, 1], [-1, -1, 2], [1, -1, 3], [1, 2, 4]]\n";

Prediction Of(const std::string& toml) {
  Experiment experiment = LoadExperiment(Section::FromText(toml, "test.toml"), "test");
  return Predict(experiment);
}

TEST(Theory, PredictsWhereALeaderlessGroupMeets) {
  const std::string text = kFour +
                           "velocity_m_per_s = [[0.4, 0, 0], [0, 0, 0], [0, 0.8, 0], [0, 0, 0]]\n"
                           "[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\nbeta = 2.0\n";
  const Prediction prediction = Of(text);
  ASSERT_TRUE(prediction.value_m);
  EXPECT_LT((*prediction.value_m - Eigen::Vector3d(0.1 / 2, 0.25 + 0.2 / 2, 2.5)).norm(), 1e-9);
  EXPECT_EQ(prediction.stable, true);
  EXPECT_THAT(prediction.warnings, IsEmpty());
  IdealNetwork network(text);
  network.RunUntil(100);
  for (const Motion& motion : network.motions)
    EXPECT_LT((motion.p_WB - *prediction.value_m).head<2>().norm(), 0.002);  // sampled: off by v0 h / 2
}

TEST(Theory, WeighsTheMeetingPointByTheLeftNullVectorOnADirectedGraph) {
  // 1 and 2 hear each other, 1 twice as strongly; 3 and 4 only listen.
  const Prediction prediction =
      Of(kFour + "[graph]\nedges = [[1, 2, 2.0], [2, 1, 1.0], [3, 1], [4, 3]]\n[law]\nname = 'consensus'\n");
  ASSERT_TRUE(prediction.value_m);
  EXPECT_LT((*prediction.value_m - Eigen::Vector3d(-1, -1.0 / 3, 2.5)).norm(), 1e-9);
}

TEST(Theory, PredictsAllThreeAxesWhereTheLawFliesThem) {
  const Prediction prediction = Of(kFour +
                                   "velocity_m_per_s = [[0, 0, 4], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n"
                                   "[law]\nname = 'consensus'\naxes = 'xyz'\n[physics]\ncollisions = false\n");
  ASSERT_TRUE(prediction.value_m);
  EXPECT_NEAR(prediction.value_m->z(), 2.5 + 1, 1e-9);
}

TEST(Theory, CountsDragAsDampingWhereNobodyCompensatesIt) {
  const std::string text =
      "[run]\nduration_s = 40.0\n[agents]\ncount = 2\nposition_m = [[0, 0, 1], [1, 0, 3]]\n"
      "velocity_m_per_s = [[2, 0, 0], [0, 0, 0]]\n[law]\nname = 'consensus'\n[control]\ndrag_compensation = ";
  Experiment experiment = LoadExperiment(Section::FromText(text + "false\n", "test.toml"), "test");
  const Airframe& airframe = experiment.agent(1).airframe;
  const double damping = 1 + airframe.linear_drag_kg_per_s / airframe.mass_kg;
  ASSERT_GT(damping, 1);
  EXPECT_NEAR(Predict(experiment).value_m->x(), 0.5 + 1 / damping, 1e-9);
  EXPECT_NEAR(Of(text + "true\n").value_m->x(), 1.5, 1e-9);
}

TEST(Theory, IsSilentWhereAgentsAreDampedDifferently) {
  const Prediction prediction =
      Of("[run]\nduration_s = 40.0\n[agents]\ncount = 2\nposition_m = [[0, 0, 1], [1, 0, 3]]\n"
         "override = [{ id = 2, model = 'double_integrator' }]\n[control]\ndrag_compensation = false\n"
         "[law]\nname = 'consensus'\n");
  EXPECT_FALSE(prediction.value_m);
  EXPECT_FALSE(prediction.settling_time_s);
}

TEST(Theory, PredictsWhenTheSlowestModeHasSettled) {
  const std::string text = kFour + "[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\nbeta = 2.0\n";
  const Prediction prediction = Of(text);
  ASSERT_TRUE(prediction.settling_time_s);
  IdealNetwork network(text);
  // Started in the slowest mode's shape, the network settles when that mode does.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(network.experiment.graph.Laplacian());
  for (int i = 0; i < 4; ++i) network.motions[i].p_WB = {solver.eigenvectors()(i, 1), 0, 0};
  const double start_m = std::abs(network.agent(1).p_WB.x());
  double last_s = 0;
  while (network.time_s() < 40) {
    if (std::abs(network.agent(1).p_WB.x()) > 0.02 * start_m) last_s = network.time_s();
    network.Step();
  }
  EXPECT_NEAR(*prediction.settling_time_s, last_s, 0.01 * last_s);
}

TEST(Theory, PredictsThatFollowersGatherAtALeaderThatRests) {
  const Prediction prediction = Of(kFour + "[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\nleader = 4\n");
  ASSERT_TRUE(prediction.value_m);
  EXPECT_EQ(*prediction.value_m, Eigen::Vector3d(1, 2, 2.5));
  ASSERT_TRUE(prediction.settling_time_s);
  // Grounded path of three: eigenvalues 2 - 2 cos((2 k - 1) pi / 7).
  const LinearMode slowest{1.0, 2 - 2 * std::cos(std::acos(-1.0) / 7)};
  EXPECT_NEAR(*prediction.settling_time_s, SettlingTime(slowest), 0.01);
}

TEST(Theory, PredictsHowFarFollowersOfAMovingLeaderStayBehind) {
  const Prediction prediction = Of(kFour +
                                   "velocity_m_per_s = [[0.5, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n"
                                   "[graph]\nedges = [[2, 1], [3, 2], [4, 3]]\n"
                                   "[law]\nname = 'consensus'\nleader = 1\nbeta = 2.0\n");
  EXPECT_FALSE(prediction.value_m);
  EXPECT_FALSE(prediction.settling_time_s);
  EXPECT_THAT(prediction.warnings,
              ElementsAre("law.leader: the leader keeps its 0.5 m/s, so followers stay up to 3 m behind"));
}

TEST(Theory, WarnsOfGraphsOnWhichNotEverybodyHears) {
  const Prediction leaderless = Of(kFour + "[graph]\nedges = [[1, 2], [2, 1], [3, 4], [4, 3]]\n");
  EXPECT_FALSE(leaderless.value_m);
  EXPECT_FALSE(leaderless.stable);
  EXPECT_THAT(
      leaderless.warnings,
      ElementsAre(
          "graph: nobody is heard by everyone, directly or not (no spanning tree), so agents will not all meet"));
  const Prediction led = Of(kFour + "[graph]\nedges = [[1, 2], [2, 1], [3, 4], [4, 3]]\n[law]\nleader = 2\n");
  EXPECT_THAT(led.warnings, ElementsAre("law.leader: leader 2 is not heard, directly or not, by agents 3 and 4, who "
                                        "will not follow"));
}

TEST(Theory, WarnsOfGainsThatAreUnstable) {
  // Directed ring of 4: eigenvalues 1 - i, 1 + i, 2: beta must be above 1.
  const std::string ring = kFour + "[graph]\ntopology = 'directed_ring'\n[law]\nname = 'consensus'\n";
  EXPECT_EQ(Of(ring + "beta = 1.05\n").stable, true);
  const Prediction unstable = Of(ring + "beta = 0.9\n");
  EXPECT_EQ(unstable.stable, false);
  EXPECT_FALSE(unstable.value_m);
  EXPECT_THAT(unstable.warnings, Contains("law.beta: unstable, it must be above 1, got 0.9"));
  EXPECT_THAT(Of(kFour + "[law]\nbeta = 0.0\n").warnings, Contains("law.beta: unstable, it must be above 0, got 0"));
  EXPECT_THAT(Of(kFour + "[law]\np_gain = 0.0\n").warnings,
              Contains("law.p_gain: 0 means that nothing pulls an agent anywhere"));
}

TEST(Theory, WarnsOfControlRatesThatAreUnstable) {
  // Complete graph of 4: p_gain lambda / (2 beta) = 5 * 4 / 2 = 10 Hz.
  const std::string law = kFour + "[law]\nname = 'consensus'\np_gain = 5.0\n[control]\nrate_hz = ";
  const Prediction slow = Of(law + "8\n");
  EXPECT_EQ(slow.stable, false);
  EXPECT_THAT(slow.warnings, Contains("control.rate_hz: unstable at this rate, it must be above 10, got 8"));
  EXPECT_EQ(Of(law + "20\n").stable, true);
}

TEST(Theory, WarnsWhenTheFirstCommandWouldAlreadySaturate) {
  const std::string law = kFour + "[law]\nname = 'consensus'\np_gain = 2.0\n[control]\nmax_acceleration_m_per_s2 = ";
  // Agent 4 at (1, 2): 2 * ((1 - 2) + (-1 - 2) + (-1 - 2)) = -14 in y.
  const Prediction cut = Of(law + "3.0\n");
  EXPECT_NEAR(*cut.first_command_m_per_s2, 14, 1e-12);
  EXPECT_THAT(cut.warnings,
              ElementsAre("control.max_acceleration_m_per_s2: the first command would already saturate: agent 4 asks "
                          "for 14 m/s^2, the limit is 3"));
  EXPECT_THAT(Of(law + "14.0\n").warnings, IsEmpty());
}

TEST(Theory, JudgesTheWaypointLawByItsTwoGains) {
  const std::string text =
      "[run]\nduration_s = 1.0\n[agents]\ncount = 1\nposition_m = [[0, 0, 1]]\n"
      "[law]\nname = 'waypoint'\nwaypoints_m = [[1, 0, 1]]\nd_gain = ";
  EXPECT_EQ(Of(text + "2.0\n").stable, true);
  EXPECT_NEAR(*Of(text + "2.0\n").settling_time_s, 5.834, 0.01);
  EXPECT_THAT(Of(text + "0.0\n").warnings, ElementsAre("law.d_gain: unstable, it must be above 0, got 0"));
}

TEST(Theory, TimesEveryEdgeOfTheMinMaxTree) {
  const Prediction prediction =
      Of(kFour +
         "velocity_m_per_s = [[0, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0]]\n"
         "[graph]\ntopology = 'path'\n[law]\nname = 'minmax'\nleader = 1\nbeta = [0.5, 1.0, 1.5, 2.0]\n");
  ASSERT_EQ(prediction.minmax_edges.size(), 3u);
  EXPECT_TRUE(prediction.minmax_edges[0].exact);
  EXPECT_DOUBLE_EQ(prediction.minmax_edges[0].time_s, MinmaxTime(-2, 1, 0.5, 1.0));
  EXPECT_FALSE(prediction.minmax_edges[1].exact);
  EXPECT_DOUBLE_EQ(prediction.minmax_edges[1].time_s, std::max(MinmaxBound(2, 0, 0.5), MinmaxBound(0, -1, 0.5)));
  EXPECT_DOUBLE_EQ(prediction.minmax_edges[2].time_s, MinmaxBound(3, 0, 0.5));
  EXPECT_EQ(prediction.minmax_edges[2].child, 4);
  EXPECT_EQ(prediction.minmax_edges[2].parent, 3);
  EXPECT_EQ(prediction.minmax_time_s, prediction.minmax_edges[2].time_s);
  EXPECT_EQ(*prediction.value_m, Eigen::Vector3d(-1, 1, 2.5));
  EXPECT_EQ(*prediction.first_command_m_per_s2, 2.0);
  EXPECT_THAT(prediction.warnings, IsEmpty());
}

TEST(Theory, KnowsOnlyABoundWhereTheRootFliesWaypoints) {
  const Prediction prediction =
      Of(kFour +
         "[graph]\ntopology = 'path'\n[law]\nname = 'minmax'\nleader = 1\nbeta = [0.5, 1.0, 1.5, 2.0]\n"
         "leader_waypoints_m = [[5, 5, 5]]\n");
  EXPECT_FALSE(prediction.value_m);
  EXPECT_FALSE(prediction.minmax_edges[0].exact);
  EXPECT_DOUBLE_EQ(prediction.minmax_edges[0].time_s, MinmaxBound(2, 0, 0.5));
}

TEST(Theory, ForeseesThePublishedMinMaxRun) {
  const Prediction prediction =
      Of("[run]\nduration_s = 80.0\n[agents]\ncount = 4\nairframe = 'mascot_published'\n"
         "position_m = [[-10, 10, 1], [-10, -10, 2], [10, -10, 3], [10, 10, 4]]\n"
         "[control]\nmax_acceleration_m_per_s2 = 0.6\n[graph]\ntopology = 'path'\n"
         "[law]\nname = 'minmax'\nleader = 1\nbeta = [0.95, 1.0, 1.0, 1.0]\nweak_edges = 'root'\n");
  ASSERT_EQ(prediction.minmax_edges.size(), 1u);  // limited agents promise nothing to a parent that moves
  EXPECT_TRUE(prediction.minmax_edges[0].exact);
  EXPECT_NEAR(*prediction.minmax_time_s, 29.44, 5e-3);
  EXPECT_THAT(
      prediction.warnings,
      ElementsAre("law.beta: beta of agents 2, 3 and 4 is above control.max_acceleration_m_per_s2 = 0.6, which cuts it",
                  "law.weak_edges: agents 3 and 4 are no stronger than the parent, who must keep within the root's "
                  "bound"));
}

TEST(Theory, WarnsOfBodiesThatWillTouch) {
  const auto agents = [](const std::string& positions, const std::string& rest) {
    return "[run]\nduration_s = 40.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = " + positions +
           "\n[control]\nmax_acceleration_m_per_s2 = 100.0\n" + rest;
  };
  EXPECT_THAT(Of(agents("[[0, 0, 0.05], [5, 0, 1]]", "")).warnings,
              ElementsAre("agents.position_m: agent 1 starts in the ground"));
  EXPECT_THAT(Of(agents("[[0, 0, 0.05], [5, 0, 1]]", "[[agents.override]]\nid = 1\nmodel = 'unicycle'")).warnings,
              IsEmpty())
      << "a unicycle stands on the ground at any height";
  EXPECT_THAT(Of(agents("[[0, 0, 1.1], [5, 0, 1]]", "")).warnings,
              ElementsAre("agents.position_m: agents 1 and 2 fly less than the 0.2 m of their bodies apart in height "
                          "and will touch where they meet"));
  EXPECT_THAT(Of(agents("[[0, 0, 1], [5, 0, 2]]", "[law]\naxes = 'xyz'")).warnings,
              ElementsAre("physics.collisions: all agents head for the same place in x, y and z and will touch there"));
  EXPECT_THAT(Of(agents("[[0, 0, 0.05], [0.1, 0, 0.05]]", "[physics]\ncollisions = false\nground = false")).warnings,
              IsEmpty());
}

TEST(Theory, SaysOneAgentAloneIsStable) {
  const Prediction prediction =
      Of("[run]\nduration_s = 1.0\n[agents]\ncount = 1\nposition_m = [[1, 2, 3]]\n[law]\nname = 'consensus'\n");
  EXPECT_EQ(prediction.stable, true);
  EXPECT_EQ(*prediction.value_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(prediction.settling_time_s);
}

}  // namespace
}  // namespace mascot
