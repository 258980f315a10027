#include "orchestrator/theory/theory.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "orchestrator/theory/minmax_time.h"
#include "orchestrator/theory/modes.h"
#include "tests/support/ideal_network.h"

namespace mascot {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kNoLimit = "[control]\nmax_acceleration_m_per_s2 = 1000.0\n";  // that would cut
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
    EXPECT_LT((motion.p_WB - *prediction.value_m).head<2>().norm(), 0.002);  // sampling shifts it by v0 h / 2
}

TEST(Theory, WeighsTheMeetingPointByTheLeftNullVectorOnADirectedGraph) {
  // 1 and 2 hear each other, 1 with weight 2; 3 and 4 are not heard by them.
  const Prediction prediction =
      Of(kFour + "[graph]\nedges = [[1, 2, 2.0], [2, 1, 1.0], [3, 1], [4, 3]]\n[law]\nname = 'consensus'\n" + kNoLimit);
  ASSERT_TRUE(prediction.value_m);
  EXPECT_LT((*prediction.value_m - Eigen::Vector3d(-1, -1.0 / 3, 2.5)).norm(), 1e-9);
}

TEST(Theory, PredictsAllThreeAxesWhereTheLawFliesThem) {
  const Prediction prediction = Of(kFour +
                                   "velocity_m_per_s = [[0, 0, 4], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n"
                                   "[law]\nname = 'consensus'\naxes = 'xyz'\n[physics]\ncollisions = false\n" +
                                   kNoLimit);
  ASSERT_TRUE(prediction.value_m);
  EXPECT_NEAR(prediction.value_m->z(), 2.5 + 1, 1e-9);
}

/// Bodies whose low-level loop does not bring them back to where the law's accelerations would have them.
const std::string kNoCorrection = "airframe = { position = { kp = 0.0, kd = 0.0 } }\n";

TEST(Theory, CountsUncompensatedDragAsDamping) {
  const std::string text =
      "[run]\nduration_s = 40.0\n[agents]\ncount = 2\nposition_m = [[0, 0, 1], [1, 0, 3]]\n"
      "velocity_m_per_s = [[2, 0, 0], [0, 0, 0]]\n" +
      kNoCorrection + "[law]\nname = 'consensus'\n" + kNoLimit + "drag_compensation = ";
  Experiment experiment = LoadExperiment(Section::FromText(text + "false\n", "test.toml"), "test");
  const Airframe& airframe = experiment.agent(1).airframe;
  const double damping = 1 + airframe.linear_drag_kg_per_s / airframe.mass_kg;
  ASSERT_GT(damping, 1);
  EXPECT_NEAR(Predict(experiment).value_m->x(), 0.5 + 1 / damping, 1e-9);
  EXPECT_NEAR(Of(text + "true\n").value_m->x(), 1.5, 1e-9);
}

TEST(Theory, WeighsAgentsThatAreDampedDifferently) {
  // The sum of b q is conserved. A double integrator has no drag, thus less damping and less weight than its neighbour.
  const std::string text =
      "[run]\nduration_s = 40.0\n[agents]\ncount = 2\nposition_m = [[0, 0, 1], [1, 0, 3]]\n"
      "override = [{ id = 2, model = 'double_integrator' }]\n" +
      kNoCorrection + kNoLimit + "drag_compensation = false\n[law]\nname = 'consensus'\nbeta = 1.5\n";
  Experiment experiment = LoadExperiment(Section::FromText(text, "test.toml"), "test");
  const Airframe& airframe = experiment.agent(1).airframe;
  const double b = 1.5 + airframe.linear_drag_kg_per_s / airframe.mass_kg;
  const Prediction prediction = Predict(experiment);
  ASSERT_TRUE(prediction.value_m);
  EXPECT_NEAR(prediction.value_m->x(), 1.5 / (b + 1.5), 1e-12);
  EXPECT_EQ(prediction.stable, true);
  EXPECT_TRUE(prediction.settling_time_s);
  EXPECT_EQ(prediction.silent, "");
}

/// Four agents on a path that start at cos((2 i - 1) step), i = 1..4, along x. `law`: lines from [law] on.
std::string FourInACosine(double step, const std::string& law) {
  std::string positions;
  for (int i = 1; i <= 4; ++i) positions += fmt::format("[{}, 0, {}], ", std::cos((2 * i - 1) * step), i);
  return "[run]\nduration_s = 40.0\n[agents]\ncount = 4\nmodel = 'double_integrator'\nposition_m = [" + positions +
         "]\n[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\n" + law;
}

TEST(Theory, PredictsWhenTheSlowestModeHasSettled) {
  // A team that starts in the shape of the slowest mode of a path settles when that mode does.
  const std::string text = FourInACosine(std::numbers::pi / 8, "beta = 2.0\n");
  const Prediction prediction = Of(text);
  ASSERT_TRUE(prediction.settling_time_s);
  const LinearMode slowest{2.0, 2 - 2 * std::cos(std::numbers::pi / 4)};
  EXPECT_NEAR(*prediction.settling_time_s, SettlingTime(slowest, 0.01), 1e-9);
  IdealNetwork network(text);
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
}

TEST(Theory, PredictsWhenFollowersOfALeaderThatRestsHaveSettled) {
  // Grounded Laplacian of a path with three followers: eigenvalues 2 - 2 cos((2 k - 1) pi / 7); the team starts in the
  // shape of the slowest mode.
  const Prediction prediction = Of(FourInACosine(std::numbers::pi / 14, "leader = 4\n"));
  ASSERT_TRUE(prediction.settling_time_s);
  const LinearMode slowest{1.0, 2 - 2 * std::cos(std::numbers::pi / 7)};
  EXPECT_NEAR(*prediction.settling_time_s, SettlingTime(slowest, 0.01), 1e-9);
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

TEST(Theory, WarnsOfGraphsWithoutASpanningTree) {
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

TEST(Theory, CallsGainsAndPeriodsAtTheirBoundUnstableHoweverTheyRound) {
  for (const int agents : {4, 6, 10, 12}) {
    // Directed ring: beta must be above |Im| / sqrt(Re) of 1 - e^(i theta), sqrt(2) cos(theta / 2); theta = 2 pi / N.
    const double least = std::sqrt(2.0) * std::cos(std::numbers::pi / agents);
    const std::string ring = fmt::format(
        "[run]\nduration_s = 9.0\n[agents]\ncount = {}\nmodel = 'double_integrator'\n[graph]\ntopology = "
        "'directed_ring'\n[law]\nbeta = {:.17g}\n",
        agents, least);
    EXPECT_THAT(Of(ring).warnings,
                Contains(fmt::format("law.beta: unstable, it must be above {:.5g}, got {:.5g}", least, least)));
  }
  // Ring of 4, lambda <= 4: h < 2 / (4 p_gain) for order 1.
  for (const int rate_hz : {10, 20, 50, 100, 200, 500}) {
    const Prediction prediction =
        Of(fmt::format("[run]\nduration_s = 9.0\n[agents]\ncount = 4\nmodel = 'single_integrator'\n[graph]\ntopology = "
                       "'ring'\n[law]\nname = 'velocity_consensus'\np_gain = {}\n[control]\nrate_hz = {}\n",
                       rate_hz / 2.0, rate_hz));
    EXPECT_THAT(prediction.warnings, Contains(fmt::format("control.rate_hz: unstable at this rate, it must be above "
                                                          "{}, got {}",
                                                          rate_hz, rate_hz)));
    EXPECT_EQ(prediction.stable, false);
    EXPECT_FALSE(prediction.settling_time_s);
  }
}

const std::string kQuadrotors =
    "[run]\nduration_s = 100.0\n[agents]\ncount = 2\nposition_m = [[0, 0, 1], [20, 0, 3]]\n[law]\nname = 'consensus'\n"
    "p_gain = 0.1\nbeta = 0.9\n";

TEST(Theory, WarnsOfAFirstCommandForWhichAQuadrotorLeansTooFar) {
  EXPECT_THAT(Of(kQuadrotors).warnings, IsEmpty());  // asks for 0.1 * 20 m/s^2; a tilt of 0.35 rad gives 3.58
  EXPECT_THAT(Of(kQuadrotors + "[agents.airframe]\nbase = 'mascot'\ntilt_limit_rad = 0.1\n").warnings,
              ElementsAre("agents.airframe: the first command is more than leaning by tilt_limit_rad gives: agent 1 is "
                          "to accelerate sideways by 2 m/s^2, and can by 0.981"));  // 9.81 * 0.1
  EXPECT_THAT(Of(kQuadrotors + "[control]\ninversion = 'exact'\n[agents.airframe]\ntilt_limit_rad = 0.1\n").warnings,
              ElementsAre(HasSubstr("and can by 0.9843")));
  EXPECT_THAT(Of(kQuadrotors + "[physics]\ngravity_m_per_s2 = 0.0\n").warnings,
              Contains(HasSubstr("and can by 0.7109")));  // 3 N of least thrust / 1.477 kg * 0.35
}

TEST(Theory, WarnsOfRotorsThatCannotLiftTheirQuadrotor) {
  EXPECT_THAT(
      Of(kQuadrotors + "[agents.airframe]\nmax_thrust_n = 16.0\n").warnings,
      ElementsAre("agents.airframe: agent 1 cannot lift itself: its rotors are driven to 14.4 N at most (90 % of "
                  "max_thrust_n), its weight is 14.49 N (mass_kg, physics.gravity_m_per_s2)"));
  EXPECT_THAT(Of(kQuadrotors + "[[agents.override]]\nid = 2\nairframe = { mass_kg = 50.0 }\n").warnings,
              Contains(StartsWith("agents.airframe: agent 2 cannot lift itself")));
  EXPECT_THAT(Of(kFour + "[law]\nname = 'consensus'\nbeta = 2.0\n[agents.airframe]\nmax_thrust_n = 14.0\n").warnings,
              Not(Contains(HasSubstr("lift"))))
      << "a double integrator has no rotors";
}

TEST(Theory, WarnsOfBodiesThatAStepOfThePhysicsTakesFartherThanTheyAreThick) {
  const std::string thrown =
      "[run]\nduration_s = 1.0\n[agents]\ncount = 1\nmodel = 'double_integrator'\nposition_m = [[0, 0, 5]]\n"
      "velocity_m_per_s = [[30, 0, 0]]\n[law]\nname = 'consensus'\n[control]\nrate_hz = 100\n[physics]\n";
  EXPECT_THAT(
      Of(thrown + "rate_hz = 100\n").warnings,
      Contains("physics.rate_hz: agent 1 goes 0.3 m in a step of the physics, at 30 m/s, and is 0.2 m thick: it "
               "may pass through what is in its way; above 150 Hz it does not"));
  EXPECT_THAT(Of(thrown + "rate_hz = 200\n").warnings, Not(Contains(HasSubstr("physics.rate_hz"))));
  EXPECT_THAT(Of(thrown + "rate_hz = 100\nground = false\ncollisions = false\n").warnings,
              Not(Contains(HasSubstr("physics.rate_hz"))))
      << "there is nothing to touch";
  const std::string driven =
      "[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'single_integrator'\nposition_m = [[0, 0, 5], [50, 0, "
      "6]]\n"
      "[law]\nname = 'velocity_consensus'\n[physics]\nrate_hz = 100\n[control]\nrate_hz = 100\n";
  EXPECT_THAT(Of(driven + "max_speed_m_per_s = 40\n").warnings, Contains(HasSubstr("agent 1 goes 0.4 m in a step")));
  EXPECT_THAT(Of(driven + "max_speed_m_per_s = 20\n").warnings, Not(Contains(HasSubstr("in a step of the physics"))));
}

TEST(Theory, WarnsOfRotorsWhoseLeastThrustIsMoreThanTheWeight) {
  EXPECT_THAT(Of(kQuadrotors + "[physics]\ngravity_m_per_s2 = 2.0\n").warnings,
              Contains("agents.airframe: agent 1 climbs away: its rotors are driven to 3 N at least (10 % of "
                       "max_thrust_n), its weight is 2.954 N (mass_kg, physics.gravity_m_per_s2)"));
  EXPECT_THAT(Of(kQuadrotors + "[physics]\ngravity_m_per_s2 = 2.1\n").warnings, Not(Contains(HasSubstr("climbs"))));
}

TEST(Theory, WarnsWhenTheFirstCommandWouldAlreadySaturate) {
  const std::string law = kFour + "[law]\nname = 'consensus'\np_gain = 2.0\n[control]\nmax_acceleration_m_per_s2 = ";
  // Agent 4 at (1, 2): 2 * ((1 - 2) + (-1 - 2) + (-1 - 2)) = -14 in y.
  const Prediction cut = Of(law + "3.0\n");
  EXPECT_NEAR(cut.first_acceleration->asked, 14, 1e-12);
  EXPECT_THAT(cut.warnings,
              ElementsAre("control.max_acceleration_m_per_s2: the first command would already saturate: agent 4 asks "
                          "for 14 m/s^2, the limit is 3"));
  EXPECT_THAT(Of(law + "14.0\n").warnings, IsEmpty());
  // Other agents ask for more, but agent 2 at (-1, -1) has the lowest limit: 2 (2 + 2 + 0) = 8 in x, 2 (2 + 0 + 3) = 10
  // in y.
  EXPECT_THAT(Of(law + "14.0\n[[agents.override]]\nid = 2\ncontrol = { max_acceleration_m_per_s2 = 0.5 }\n").warnings,
              ElementsAre("control.max_acceleration_m_per_s2: the first command would already saturate: agent 2 asks "
                          "for 10 m/s^2, the limit is 0.5"));
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
  EXPECT_EQ(prediction.first_acceleration->asked, 2.0);
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

TEST(Theory, PredictsThePublishedMinMaxRun) {
  const Prediction prediction =
      Of("[run]\nduration_s = 80.0\n[agents]\ncount = 4\nairframe = 'mascot_published'\n"
         "position_m = [[-10, 10, 1], [-10, -10, 2], [10, -10, 3], [10, 10, 4]]\n"
         "[control]\nmax_acceleration_m_per_s2 = 0.6\n[graph]\ntopology = 'path'\n"
         "[law]\nname = 'minmax'\nleader = 1\nbeta = [0.95, 1.0, 1.0, 1.0]\nweak_edges = 'root'\n");
  ASSERT_EQ(prediction.minmax_edges.size(), 1u);  // no bound for limited agents whose parent moves
  EXPECT_TRUE(prediction.minmax_edges[0].exact);
  EXPECT_NEAR(*prediction.minmax_time_s, 29.44, 5e-3);
  EXPECT_THAT(
      prediction.warnings,
      ElementsAre(
          "law.beta: beta of agents 2, 3 and 4 is above control.max_acceleration_m_per_s2 = 0.6, which cuts it",
          "law.beta: agent 2 will tremble around the root by about 0.039 m, and may never stay within 0.05 m of "
          "it: accelerations come 0.26 s late, because the body turns first (agents.airframe); a smaller beta "
          "trembles less",
          "law.weak_edges: agents 3 and 4 are no stronger than the parent, who must keep within the root's "
          "bound"));
}

TEST(Theory, SaysHowAQuadrotorTremblesOnlyWhereItKnows) {
  const std::string pair =
      "[run]\nduration_s = 80.0\n[agents]\ncount = 2\nposition_m = [[0, 0, 1], [4, -2, 3]]\n[law]\nname = 'minmax'\n"
      "leader = 1\nbeta = [0.1, 0.3]\n";
  const std::optional<Trembling> trembling = Of(pair).minmax_edges.at(0).trembling;
  ASSERT_TRUE(trembling);
  EXPECT_NEAR(trembling->lag_s, 30.0 / 625 + 0.01, 1e-12) << "the PD law of the attitude and the control period";
  EXPECT_NEAR(*trembling->time_s, MinmaxTime(4, 0, 0.2, 0.3), 1);
  EXPECT_THAT(Of(pair).warnings, IsEmpty());
  EXPECT_FALSE(Of(pair + "boundary_layer = 0.1\n").minmax_edges.at(0).trembling) << "does not switch to the end";
  EXPECT_FALSE(Of(pair + "leader_waypoints_m = [[1, 1, 1]]\n").minmax_edges.at(0).trembling) << "the root accelerates";
  const std::string points = "[[agents.override]]\nid = 2\nmodel = 'double_integrator'\n";
  EXPECT_FALSE(Of(pair + points).minmax_edges.at(0).trembling) << "has no attitude";
}

TEST(Theory, LeansNoFurtherInMinMaxThanItsTiltLimit) {
  const Prediction prediction =
      Of("[run]\nduration_s = 80.0\n[agents]\ncount = 2\nairframe = 'mascot_published'\n"
         "position_m = [[0, 0, 1], [4, 0, 3]]\n[law]\nname = 'minmax'\nleader = 1\nbeta = [1.7, 2.0]\n");
  EXPECT_NEAR(*prediction.minmax_time_s, MinmaxTime(4, 0, 2.0 - 1.7, 0.1 * 9.81), 1e-9) << "0.1 rad of tilt";
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

/// What theory says of the ways of two agents that fly `law` past a pillar of 1 m and a ball.
std::vector<std::string> WarningsOfWays(const std::string& law, const std::string& more = "") {
  return Predict(LoadExperiment(
                     Section::FromText("[run]\nduration_s = 200\n[agents]\ncount = 2\nmodel = 'double_integrator'\n"
                                       "position_m = [[0, 0, 1], [0, 3, 2]]\n"
                                       "[[physics.obstacles]]\nshape = 'cylinder'\nposition_m = [5, 0, 1]\n"
                                       "size_m = [1, 1, 2]\n"
                                       "[[physics.obstacles]]\nshape = 'sphere'\nposition_m = [5, 3, 2]\n"
                                       "size_m = [1, 1, 1]\n[law]\nname = 'waypoint'\n" +
                                           law + more,
                                       "test.toml"),
                     "test"))
      .warnings;
}

TEST(ObstacleWarnings, NameTheFirstWayThatPassesThroughAnObstacle) {
  const std::string through = "physics.obstacles: the straight way of agent ";
  const std::string body = ", or closer than its body";
  EXPECT_THAT(WarningsOfWays("waypoints_m = [[0, -9, 1], [0, 0, 1], [9, 0, 1]]\n"),
              Contains(through + "1 from waypoint 2 to waypoint 3 passes through obstacle 1" + body +
                       " (and ways of 1 more agent)"));
  EXPECT_THAT(WarningsOfWays("axes = 'xy'\nwaypoints_m = [[0, 3, 9], [9, 3, 9]]\n"),
              Contains(through + "2 from waypoint 1 to waypoint 2 passes through obstacle 2" + body))
      << "with axes xy agents keep their heights: 1 flies below the ball";
  EXPECT_THAT(WarningsOfWays("waypoints_m = [[0, 0.59, 1], [9, 0.59, 1]]\n"),
              Contains(through + "1 from waypoint 1 to waypoint 2 passes through obstacle 1" + body +
                       " (and ways of 1 more agent)"))
      << "the pillar's radius is 0.5 m, that of the body 0.1 m";
}

TEST(ObstacleWarnings, AreNotGivenWhereNobodyMeetsAnObstacle) {
  const auto none = testing::Not(Contains(HasSubstr("obstacle")));
  EXPECT_THAT(WarningsOfWays("waypoints_m = [[0, 1.5, 1], [9, 1.5, 1]]\n"), none) << "the way lies between them";
  EXPECT_THAT(WarningsOfWays("waypoints_m = [[0, 0.61, 0.8], [9, 0.61, 0.8]]\n"), none) << "just past the body";
  EXPECT_THAT(WarningsOfWays("waypoints_m = [[0, 0, 1], [9, 0, 1]]\n", "[physics]\ncollisions = false\n"), none);
}

/// What is said of a quadrotor of 1.477 kg and 30 N whose rotor 2 keeps this part of its thrust from 4 s on.
std::vector<std::string> WarningsOfFailure(const std::string& remaining) {
  return Of("[run]\nduration_s = 9.0\n[agents]\ncount = 1\nposition_m = [[0, 0, 1]]\n"
            "[[physics.rotor_failures]]\nagent = 1\nrotor = 2\nat_s = 4.0\nremaining = " +
            remaining + "\n[law]\nname = 'waypoint'\nwaypoints_m = [[0, 0, 1]]\n")
      .warnings;
}

TEST(RotorFailureWarnings, NameTheFirstThatLeavesTooLittleToHover) {
  const double part = 1.477 * 9.81 / 30;  // of its 7.5 N, to carry a quarter of the weight
  EXPECT_THAT(WarningsOfFailure(std::to_string(part - 1e-3)),
              Contains("physics.rotor_failures: agent 1 will fall: from 4 s on, rotor 2 gives 3.615 N at most, and "
                       "3.622 N, a quarter of its weight, is needed to hover level"));
  EXPECT_THAT(WarningsOfFailure("0.0"), Contains(HasSubstr("rotor 2 gives 0 N at most")));
  EXPECT_THAT(WarningsOfFailure(std::to_string(part + 1e-3)), testing::Not(Contains(HasSubstr("rotor_failures"))));
}

TEST(ObstacleWarnings, NameARangeSensorThatNoLawAsks) {
  EXPECT_THAT(WarningsOfWays("waypoints_m = [[0, 1.5, 1]]\n", "[sensors]\nrange_m = 3.0\n"),
              Contains("sensors.range_m: no law of this experiment asks what obstacles are near"));
}

TEST(Theory, SaysThatAFormationDoesNotGather) {
  // Its places keep agents apart, so that equal heights are no problem.
  EXPECT_THAT(Of("[run]\nduration_s = 40.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], "
                 "[2, 0, 1]]\n[law]\nname = 'formation'\nshape = 'line'\n")
                  .warnings,
              IsEmpty());
}

TEST(Theory, SaysOneAgentAloneIsStable) {
  const Prediction prediction =
      Of("[run]\nduration_s = 1.0\n[agents]\ncount = 1\nposition_m = [[1, 2, 3]]\n[law]\nname = 'consensus'\n");
  EXPECT_EQ(prediction.stable, true);
  EXPECT_EQ(*prediction.value_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(prediction.settling_time_s);
}

// --- gains, delays, periods ----------------------------------------------------------------------------

/// A team of ten on a directed cycle.
std::string Cycle(const std::string& rest) {
  return "[run]\nduration_s = 400.0\n[physics]\ncollisions = false\n[agents]\ncount = 10\nmodel = "
         "'double_integrator'\n[graph]\ntopology = 'directed_ring'\n" +
         rest;
}

TEST(Theory, NamesTheLeastRelativeDampingOfADirectedCycle) {
  const std::string law = "[law]\nname = 'consensus'\nbeta = 0.0\nv_gain = ";
  EXPECT_THAT(Of(Cycle(law + "2.0\n")).warnings, Contains("law.v_gain: unstable, it must be above 2.1763, got 2"));
  EXPECT_EQ(Of(Cycle(law + "2.2\n[control]\nrate_hz = 1000\n")).stable, true);  // at lower rates it would be unstable
}

TEST(Theory, NamesTheLeastVelocityGainWhereItMakesAVelocityAnAcceleration) {
  // k_v > p_gain (Im lambda)^2 / Re lambda = 1 + cos(2 pi / 10) for the eigenvalue of the cycle that is nearest to 0.
  const std::string law = "[law]\nname = 'velocity_consensus'\n[control]\nvelocity_gain = ";
  EXPECT_THAT(Of(Cycle(law + "1.8\n")).warnings,
              Contains("control.velocity_gain: unstable, it must be above 1.809, got 1.8"));
  EXPECT_EQ(Of(Cycle(law + "1.82\n")).stable, true);
}

const std::string kFive =
    "[run]\nduration_s = 100.0\n[physics]\ncollisions = false\n[agents]\ncount = 5\nposition_m = [[3, 0, 1], [-1, 0, "
    "1], [4, 0, 1], [1, 0, 1], [-5, 0, 1]]\n";
const std::string kSingles = "model = 'single_integrator'\n";
const std::string kPath = "[graph]\ntopology = 'path'\n";

TEST(Theory, KnowsTheLongestPeriodOfSingleIntegrators) {
  const std::string law = kFive + kSingles + kPath + "[law]\nname = 'velocity_consensus'\np_gain = 4.0\n[control]\n";
  EXPECT_NEAR(*Of(law).control_period_bound_s, 0.55279 / 4, 1e-5);
  EXPECT_THAT(Of(law + "rate_hz = 5\n").warnings,
              Contains("control.rate_hz: unstable at this rate, it must be above 7.236, got 5"));
}

TEST(Theory, KnowsBothMarginsOfDelayOfSingleIntegrators) {
  const Prediction prediction = Of(kFive + kSingles + kPath + "[law]\nname = 'velocity_consensus'\n");
  ASSERT_TRUE(prediction.delay_margin);
  EXPECT_TRUE(prediction.delay_margin->independent);
  // pi / (2 lambda_5) = 0.43416 s less half a period, up to the next tick; continuous time is approached at high rates.
  EXPECT_NEAR(*prediction.own_delay_margin_s, 0.43, 1e-12);
  const Prediction fast =
      Of(kFive + kSingles + "[control]\nrate_hz = 1000\n" + kPath + "[law]\nname = 'velocity_consensus'\n");
  EXPECT_NEAR(*fast.own_delay_margin_s, 0.43416, 1e-3);
}

TEST(Theory, WarnsOfDelaysAboveTheMargin) {
  const std::string law = kFive + kSingles + kPath + "[law]\nname = 'velocity_consensus'\n";
  EXPECT_THAT(Of(law + "[link]\ndelay_s = 0.45\n[sensors.own]\ndelay_s = 0.45\n").warnings,
              Contains("sensors.own.delay_s: unstable, it must be below 0.43, got 0.45"));
  EXPECT_THAT(
      Of(law + "[link]\ndelay_s = 0.43\n[sensors.own]\ndelay_s = 0.425\n").warnings,
      Contains("sensors.own.delay_s: unstable, it must be below 0.43, got 0.425, which whole control periods make "
               "as long"));
  EXPECT_EQ(Of(law + "[link]\ndelay_s = 0.42\n[sensors.own]\ndelay_s = 0.42\n").stable, true);
  EXPECT_EQ(Of(law + "[link]\ndelay_s = 0.1\n[sensors.own]\ndelay_s = 0.1\n").stable, true);
  // Delay of own state only: there is no closed form, but eigenvalues decide.
  EXPECT_THAT(Of(law + "[control]\nrate_hz = 10\n[sensors.own]\ndelay_s = 1.2\n").warnings,
              Contains("sensors.own.delay_s: unstable with this delay, got 1.2"));

  const std::string doubles =
      kFive + "model = 'double_integrator'\n" + kPath + "[law]\nname = 'consensus'\nbeta = 0.5\np_gain = 2.0\n[link]\n";
  const double margin_s = *Of(doubles).delay_margin->margin_s;
  const Prediction late = Of(doubles + "delay_s = 1.0\n");
  EXPECT_THAT(late.warnings, Contains(fmt::format("link.delay_s: unstable, it must be below {:.4g}, got 1", margin_s)));
  EXPECT_EQ(late.stable, false);
}

TEST(Theory, DoesNotCallATeamUnstableForDelaysOfSomeSamples) {
  const std::string doubles = kFour + "[graph]\ntopology = 'ring'\n[law]\nname = 'consensus'\nbeta = 0.8\n[link]\n";
  const std::string one = "[[link.override]]\nedges = [[1, 2]]\ndelay_s = 1.0\n";
  for (const std::string& some : {one, std::string("delay_s = 0.9\njitter_s = 0.1\n")}) {
    const Prediction prediction = Of(doubles + some);
    EXPECT_FALSE(prediction.stable) << "nobody knows";
    EXPECT_NE(prediction.silent, "");
    EXPECT_THAT(
        prediction.warnings,
        Contains(fmt::format("link.delay_s: perhaps unstable, samples come up to 1 s late; if all did, it would "
                             "have to be below {:.4g}",
                             *prediction.delay_margin->margin_s)));
  }
  // If eigenvalues can be computed they decide: here one edge with this delay does no harm, and there is no warning.
  const Prediction known = Of(doubles + one + "[control]\nrate_hz = 20\n");
  EXPECT_EQ(known.stable, true);
  EXPECT_THAT(known.warnings, Not(Contains(HasSubstr("delay_s"))));

  const Prediction own = Of(doubles + "[sensors.own]\ndelay_s = 0.8\n");
  EXPECT_THAT(own.warnings,
              Contains(fmt::format("sensors.own.delay_s: perhaps unstable, got 0.8; if neighbours' samples were as "
                                   "late, it would have to be below {:.4g}",
                                   *own.own_delay_margin_s)));
}

TEST(Theory, MovesTheMeetingPointWithTheDelay) {
  const std::string delay = kPath + "[link]\ndelay_s = 0.1\n";
  const Prediction prediction = Of(kFive + kSingles + delay + "[law]\nname = 'velocity_consensus'\n");
  EXPECT_NEAR(prediction.value_m->x(), 0.448275862, 1e-9);
  // Double integrators: sum q (b + p d tau) / sum (b + p d tau), with tau in whole ticks: 0.095 s are 10 ticks.
  const Prediction doubles =
      Of(kFive + "model = 'double_integrator'\n" + kPath +
         "[link]\ndelay_s = 0.095\n[law]\nname = 'consensus'\np_gain = 3.0\nbeta = 4.0\n" + kNoLimit);
  const double weights[] = {4.3, 4.6, 4.6, 4.6, 4.3}, starts[] = {3, -1, 4, 1, -5};
  double sum = 0, total = 0;
  for (int i = 0; i < 5; ++i) sum += weights[i] * starts[i], total += weights[i];
  EXPECT_NEAR(doubles.value_m->x(), sum / total, 1e-12);
  EXPECT_EQ(doubles.stable, true);
}

TEST(Theory, KnowsThatAnAgentWithoutDampingWhichHearsNobodyStaysWhereItIs) {
  const std::string chain =
      "model = 'double_integrator'\n[graph]\nedges = [[2, 1], [2, 3], [3, 2], [4, 3], [5, 4]]\n"
      "[law]\nname = 'consensus'\nbeta = 0.0\nv_gain = 2.0\n";
  for (const char* link : {"", "[link]\ndelay_s = 0.01\n", "[link]\ndelay_s = 0.1\n"}) {
    const Prediction prediction = Of(kFive + chain + link);
    EXPECT_EQ(prediction.stable, true) << link;
    ASSERT_TRUE(prediction.value_m) << link;
    EXPECT_NEAR(prediction.value_m->x(), 3, 1e-12) << link;
    EXPECT_TRUE(prediction.rate_per_s) << link;
    EXPECT_THAT(prediction.warnings, Not(Contains(HasSubstr("unstable")))) << link;
  }
  // Agents that differ
  const Prediction mixed = Of(kFive + chain + "[[agents.override]]\nid = 4\nlaw = { beta = 1.0 }\n");
  EXPECT_EQ(mixed.stable, true);
  EXPECT_NEAR(mixed.value_m->x(), 3, 1e-12);
  // It moves: its followers would stay behind by what it flies during the delay.
  std::string moving = kFive + chain + "[link]\ndelay_s = 0.1\n";
  moving.insert(moving.find("model ="), "velocity_m_per_s = [[1, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n");
  EXPECT_EQ(Of(moving).silent, "law.beta is 0: agents who have met may go on together");
  EXPECT_FALSE(Of(moving).value_m);
}

TEST(Theory, PredictsFromTheExperimentsOwnStartWhereSamplesAreLate) {
  // Three agents on a path, the outer two placed around the middle: the slow mode, in which they go opposite ways,
  // takes no part if both start on the same side.
  const auto settles = [](const std::string& third, const std::string& link) {
    return Of(
        "[run]\nduration_s = 100.0\n[physics]\ncollisions = false\n[agents]\ncount = 3\nmodel = "
        "'single_integrator'\nposition_m = [[1, 0, 1], [0, 0, 2], [" +
        third + ", 0, 3]]\n[graph]\ntopology = 'path'\n" + link + "[law]\nname = 'velocity_consensus'\n");
  };
  const std::string late = "[link]\ndelay_s = 0.05\n";
  const Prediction opposite = settles("-1", late), same = settles("1", late);
  EXPECT_TRUE(opposite.from_start && same.from_start);
  EXPECT_NEAR(*same.slowest_rate_per_s, *opposite.slowest_rate_per_s, 1e-12);
  EXPECT_NEAR(*opposite.rate_per_s, *opposite.slowest_rate_per_s, 0.01 * *opposite.rate_per_s);
  EXPECT_GT(*same.rate_per_s, 2 * *opposite.rate_per_s);
  EXPECT_LT(*same.settling_time_s, 0.5 * *opposite.settling_time_s);
  // Without delays each start excites one mode: lambda = 1 or 3.
  EXPECT_NEAR(*settles("-1", "").rate_per_s, *settles("-1", "").slowest_rate_per_s, 1e-6);
  EXPECT_NEAR(*settles("1", "").rate_per_s, -100 * std::log(1 - 0.03), 1e-6);
  EXPECT_NEAR(*settles("1", "").slowest_rate_per_s, -100 * std::log(1 - 0.01), 1e-6);
}

TEST(Theory, PredictsTheSettlingTimeFromTheExperimentsOwnStart) {
  // Single integrators on a path, held for a period h of 0.01 s, start in one mode: lambda = 1 if the outer two start
  // opposite each other, lambda = 3 if they start together. It decays by 1 - h lambda per tick.
  const auto settles = [](const std::string& third) {
    return Of(
        "[run]\nduration_s = 100.0\n[physics]\ncollisions = false\n[agents]\ncount = 3\nmodel = "
        "'single_integrator'\nposition_m = [[1, 0, 1], [0, 0, 2], [" +
        third + ", 0, 3]]\n[graph]\ntopology = 'path'\n[law]\nname = 'velocity_consensus'\n");
  };
  const auto settled_s = [](double lambda) { return 0.01 * std::ceil(std::log(0.02) / std::log(1 - 0.01 * lambda)); };
  EXPECT_TRUE(settles("-1").from_start);
  EXPECT_NEAR(*settles("-1").settling_time_s, settled_s(1), 1e-9);
  EXPECT_NEAR(*settles("1").settling_time_s, settled_s(3), 1e-9);
  // Agents that begin together have nothing to settle: the slowest mode is all that can be said.
  EXPECT_FALSE(Of("[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'single_integrator'\nposition_m = [[0, 0, 1], "
                  "[0, 0, 2]]\n"
                  "[graph]\ntopology = 'path'\n[law]\nname = 'velocity_consensus'\n")
                   .from_start);
}

TEST(Theory, WarnsThatALostSampleIsSilenceAndOfWhatThatCosts) {
  // Single integrators on a path of two: lambda = 2 without loss, and 1.5 on average if a quarter is lost; held for a
  // period of 0.01 s it decays at -ln(1 - 0.01 lambda) / 0.01.
  const std::string two =
      "[run]\nduration_s = 5.0\n[agents]\ncount = 2\nmodel = 'single_integrator'\nposition_m = [[0, 0, 1], [1, 0, "
      "2]]\n[graph]\ntopology = 'path'\n[law]\nname = 'velocity_consensus'\n[link]\n";
  const std::string silence =
      "link.hold_s: below one control period, 0.01 s, it lets a lost sample be silence for that tick: on average what "
      "is "
      "heard counts for 0.75 of its weight, and the slowest mode decays at 1.511 instead of 2.02 1/s; a longer one "
      "keeps "
      "the last sample instead";
  EXPECT_THAT(Of(two + "loss = 0.25\n").warnings, ElementsAre(silence));
  EXPECT_THAT(Of(two + "loss = 0.25\nhold_s = 0.005\n").warnings, ElementsAre(silence));
  EXPECT_THAT(Of(two + "loss = 0.25\nhold_s = 0.01\n").warnings, IsEmpty());
  EXPECT_THAT(Of(two + "loss = 0.0\n").warnings, IsEmpty());
  EXPECT_THAT(
      Of(two + "loss = 0.25\ndelay_s = 0.05\n").warnings,
      ElementsAre("link.hold_s: below one control period, 0.01 s, it lets a lost sample be silence for that tick: "
                  "on average what is heard counts for 0.75 of its weight; a longer one keeps the last sample "
                  "instead"))
      << "a delay changes the rate, too";
}

TEST(Theory, PredictsTeamsWithDelaysThatAreTooLongForEigenvalues) {
  const Prediction prediction =
      Of(kFive + kSingles + kPath + "[link]\ndelay_s = 0.5\n[law]\nname = 'velocity_consensus'\n");
  EXPECT_EQ(prediction.stable, true);
  EXPECT_EQ(prediction.silent, "");
  EXPECT_FALSE(prediction.slowest_rate_per_s);
  EXPECT_TRUE(prediction.from_start && prediction.settling_time_s && prediction.rate_per_s && prediction.value_m);
}

TEST(Theory, PredictsAFormationWithoutItsPlaces) {
  const Prediction prediction = Of(
      kFive + "model = 'double_integrator'\n" + kPath +
      "[law]\nname = 'formation'\nbeta = 4.0\noffsets_m = [[0, 0, 0], [1, 1, 0], [2, 0, 0], [3, -1, 0], [4, 5, 0]]\n" +
      kNoLimit);
  EXPECT_NEAR(prediction.value_m->x(), 0.4 - 2, 1e-12);
  EXPECT_NEAR(prediction.value_m->y(), -1, 1e-12);
}

TEST(Theory, PredictsWhereALeaderStopsThatWantsZeroVelocity) {
  const Prediction prediction =
      Of("[run]\nduration_s = 60.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], [1, 0, "
         "3]]\nvelocity_m_per_s = [[1, 0, 0], [0, 0, 0]]\n[control]\nvelocity_gain = 4.0\n"
         "[law]\nname = 'velocity_consensus'\nleader = 1\n");
  EXPECT_NEAR(prediction.value_m->x(), 0.25, 1e-12);
  EXPECT_FALSE(prediction.settling_time_s) << "they settle after it";
}

TEST(Theory, ScaledGainsScaleTheRateAndRenamedAgentsChangeNothing) {
  const std::string law = "[law]\nname = 'velocity_consensus'\np_gain = ";
  const Prediction one = Of(kFive + kSingles + kPath + law + "0.001\n");
  EXPECT_NEAR(*Of(kFive + kSingles + kPath + law + "0.003\n").slowest_rate_per_s, 3 * *one.slowest_rate_per_s, 1e-8);
  const Prediction renamed = Of(
      "[run]\nduration_s = 100.0\n[physics]\ncollisions = false\n[agents]\ncount = 5\nposition_m = [[-1, 0, 1], [4, 0, "
      "1], [-5, 0, 1], [3, 0, 1], [1, 0, 1]]\n" +
      kSingles + "[graph]\nedges = [[4, 1], [1, 4], [1, 2], [2, 1], [2, 5], [5, 2], [5, 3], [3, 5]]\n" + law +
      "0.001\n");
  EXPECT_NEAR(*renamed.slowest_rate_per_s, *one.slowest_rate_per_s, 1e-12);
  EXPECT_LT((*renamed.value_m - *one.value_m).norm(), 1e-12);
}

TEST(Theory, HoldsOnAverageWhereSamplesAreLost) {
  const std::string law = kFive + kSingles + kPath + "[law]\nname = 'velocity_consensus'\n[link]\nloss = ";
  EXPECT_FALSE(Of(law + "0.0\n").on_average);
  EXPECT_TRUE(Of(law + "0.5\n").on_average);
  // With half the samples, the Laplacian is halved.
  EXPECT_NEAR(*Of(law + "0.5\n").slowest_rate_per_s, -100 * std::log(1 - 0.01 * 0.5 * 0.381966), 1e-6);
}

// --- where theory is silent ----------------------------------------------------------------------------

TEST(Theory, SaysWhyItIsSilent) {
  const std::string consensus = kFive + kSingles + kPath + "[law]\nname = 'velocity_consensus'\n";
  EXPECT_EQ(Of(consensus).silent, "");
  EXPECT_EQ(Of(consensus + "[link]\ndelay_s = 0.2\njitter_s = 0.1\n").silent, "link.jitter_s: delays are random");
  EXPECT_EQ(Of(consensus + "[link]\ndelay_s = 0.2\nreordering = 0.1\n").silent, "link.reordering: delays are random");
  EXPECT_EQ(Of(consensus + "[link]\nloss = 0.2\nhold_s = 0.1\n").silent,
            "link.hold_s: what is heard in place of a lost sample is of a random age");
  EXPECT_EQ(Of(consensus + "[link]\ndelay_s = 0.5\n[[link.override]]\nedges = [[1, 2]]\ndelay_s = 0.4\n").silent,
            "so many agents, different or with so long delays, are more than its eigenvalues are computed for");
  EXPECT_EQ(Of(kFive + "[graph]\ntopology = 'path'\nrange_m = 10.0\n[law]\nname = 'consensus'\n").silent,
            "graph.range_m: which agents hear which depends on where they go");
  EXPECT_EQ(Of(consensus + "[[agents.override]]\nid = 5\nstop_s = 3.0\n").silent,
            "agents.override.stop_s: agent 5 stays behind");
  EXPECT_EQ(Of(kFive + "[law]\nname = 'custom'\npython = 'def control(t, me, neighbours): return 0, 0'\n").silent,
            "the law custom is code of a user, of which theory has no model");
  EXPECT_EQ(Of(kFive + "[graph]\nedges = [[1, 2]]\nrepeat_s = 0.1234567\n[[graph.schedule]]\nat_s = 0.1\n"
                       "topology = 'path'\n[law]\nname = 'consensus'\n")
                .silent,
            "graph.repeat_s: the schedule is not back at the same tick soon, or changes more than 1000 times");
  EXPECT_EQ(
      Of(kFive + "[[agents.override]]\nid = 1\nlaw = { leader = 1 }\n[[agents.override]]\nid = 5\nlaw = { leader = "
                 "5 }\n[law]\nname = 'consensus'\n")
          .silent,
      "agents 1 and 5 all lead");
}

TEST(Theory, PromisesNoMinMaxTimeWhereChildrenMayMissTheirParents) {
  const std::string law = kFour +
                          "[graph]\ntopology = 'path'\n[law]\nname = 'minmax'\nleader = 1\nbeta = [0.5, 1.0, 1.5, "
                          "2.0]\n";
  const Prediction lossy = Of(law + "[link]\nloss = 0.1\n");
  EXPECT_EQ(lossy.silent, "link: children see their parents late, or not always");
  EXPECT_FALSE(lossy.minmax_time_s);
  EXPECT_FALSE(lossy.value_m);
  EXPECT_THAT(lossy.minmax_edges, IsEmpty());
  EXPECT_EQ(Of(law + "[sensors.own]\ndelay_s = 0.1\n").silent, "sensors.own.delay_s: agents know late where they are");
  EXPECT_EQ(Of(law + "[[agents.override]]\nid = 2\nstart_s = 1.0\n").silent,
            "the graph changes, and a child that does not hear its parent drifts");
  EXPECT_EQ(Of(law + "[[agents.override]]\nid = 2\nmodel = 'unicycle'\n").silent,
            "agent 2 is a unicycle, which turns before it goes");
  EXPECT_EQ(Of(law + "[[agents.override]]\nid = 2\nlaw = { boundary_layer = 0.1 }\n").silent,
            "agents.override: agent 2 has a law of its own");
}

// --- teams of different agents, graphs that change -----------------------------------------------------

TEST(Theory, PredictsAgentsWithDifferentGainsTogether) {
  const std::string text =
      kFive + "model = 'double_integrator'\n" + kPath +
      "[[agents.override]]\nid = 2\nlaw = { p_gain = 2.0, beta = 3.0 }\n"
      "[[agents.override]]\nid = 4\nlaw = { p_gain = 0.5 }\n[law]\nname = 'consensus'\nbeta = 1.5\n" +
      kNoLimit;
  const Prediction prediction = Of(text);
  EXPECT_EQ(prediction.stable, true);
  IdealNetwork network(text);
  network.RunUntil(100);
  for (const Motion& motion : network.motions) EXPECT_NEAR(motion.p_WB.x(), prediction.value_m->x(), 1e-6);
  // The sum of b q / p is conserved; share = b / p.
  const double share[] = {1.5, 1.5, 1.5, 3.0, 1.5}, starts[] = {3, -1, 4, 1, -5};
  double sum = 0, total = 0;
  for (int i = 0; i < 5; ++i) sum += share[i] * starts[i], total += share[i];
  EXPECT_NEAR(prediction.value_m->x(), sum / total, 1e-9);
  EXPECT_THAT(Of(text + "rate_hz = 1\n").warnings,
              Contains(StartsWith("control.rate_hz: unstable at this rate, it must be above ")));
}

TEST(Theory, KnowsTheLongestPeriodOfAgentsThatDiffer) {
  const std::string text =
      kFive + "model = 'double_integrator'\n" + kPath +
      "[[agents.override]]\nid = 2\nlaw = { p_gain = 2.0 }\n[law]\nname = 'consensus'\nbeta = 1.5\n";
  const double bound_s = *Of(text).control_period_bound_s;
  for (const auto& [part, decays] : {std::pair(0.97, true), {1.03, false}}) {
    const double h = part * bound_s;
    Eigen::VectorXd q(5), v = Eigen::VectorXd::Zero(5), p = Eigen::VectorXd::Ones(5);
    q << 3, -1, 4, 1, -5;
    p(1) = 2;
    const Eigen::MatrixXd l = LoadExperiment(Section::FromText(text, "test.toml"), "test").graph.Laplacian();
    for (int k = 0; k < 4000; ++k) {
      const Eigen::VectorXd u = -p.cwiseProduct(l * q) - 1.5 * v;
      q += h * v + h * h / 2 * u;
      v += h * u;
    }
    EXPECT_EQ(q.maxCoeff() - q.minCoeff() < 1, decays) << part;
  }
}

TEST(Theory, WarnsOfGainsThatAreUnstableTogether) {
  EXPECT_THAT(
      Of(Cycle("[[agents.override]]\nid = 2\nlaw = { beta = 0.3 }\n[law]\nname = 'consensus'\nbeta = 0.2\n")).warnings,
      Contains("law: the gains of these agents are unstable together"));
  EXPECT_THAT(Of(Cycle("[[agents.override]]\nid = 2\nlaw = { p_gain = 0.0 }\n[law]\nname = 'consensus'\n")).warnings,
              Contains("law.p_gain: 0 means that nothing pulls agent 2 anywhere"));
}

TEST(Theory, PredictsWhatASwitchingGraphDoesPerRepetition) {
  const std::string text = kFive + kSingles +
                           "[graph]\nedges = [[1, 2], [2, 1], [4, 5], [5, 4]]\nrepeat_s = 1.0\n"
                           "[[graph.schedule]]\nat_s = 0.5\nedges = [[2, 3], [3, 2], [3, 4], [4, 3]]\n"
                           "[law]\nname = 'velocity_consensus'\n";
  const Prediction prediction = Of(text);
  EXPECT_EQ(prediction.stable, true);
  EXPECT_NEAR(prediction.value_m->x(), 0.4, 1e-12);
  EXPECT_TRUE(prediction.from_start);
  EXPECT_NEAR(*prediction.rate_per_s, *prediction.slowest_rate_per_s, 1e-2 * *prediction.rate_per_s);
  EXPECT_FALSE(prediction.control_period_bound_s);
  EXPECT_FALSE(prediction.delay_margin);
  EXPECT_TRUE(prediction.persistence->joint);
}

TEST(Theory, PredictsWhenATeamSettlesThatWaitsForOneAgent) {
  const Prediction prediction = Of(kFive + kSingles + "[[agents.override]]\nid = 5\nstart_s = 7.0\n" + kPath +
                                   "[law]\nname = 'velocity_consensus'\n");
  EXPECT_EQ(prediction.stable, true);
  EXPECT_NEAR(*prediction.slowest_rate_per_s, -100 * std::log(1 - 0.01 * 0.381966), 1e-6);
  EXPECT_TRUE(prediction.value_m);
  EXPECT_GT(*prediction.settling_time_s, 7.0);
  EXPECT_EQ(prediction.persistence->from_s, 7.0);
}

TEST(Theory, IsSilentAboutAgentsThatMayKeepMoving) {
  EXPECT_EQ(Of(kFive + "model = 'double_integrator'\n[[agents.override]]\nid = 2\nlaw = { v_gain = 3.0 }\n" + kPath +
               "[law]\nname = 'consensus'\nbeta = 0.0\nv_gain = 2.0\n")
                .silent,
            "law.beta is 0: agents who have met may go on together");
  // Agents that are alike and start from rest meet at the mean and stay there.
  const Prediction alike = Of(kFive + "model = 'double_integrator'\n" + kPath +
                              "[law]\nname = 'consensus'\nbeta = 0.0\nv_gain = 2.0\n" + kNoLimit);
  EXPECT_EQ(alike.stable, true);
  EXPECT_NEAR(alike.value_m->x(), 0.4, 1e-12);
}

TEST(Theory, WarnsWhenTheFirstVelocityWouldAlreadySaturate) {
  const Prediction prediction =
      Of(kFive + kSingles + kPath + "[law]\nname = 'velocity_consensus'\n[control]\nmax_speed_m_per_s = 5.0\n");
  EXPECT_EQ(prediction.first_speed->asked, 9);  // agent 2: 3 + 4 - 2 (-1)
  EXPECT_FALSE(prediction.first_acceleration);
  EXPECT_THAT(prediction.warnings,
              Contains("control.max_speed_m_per_s: the first command would already saturate: agent 2 asks for 9 m/s, "
                       "the limit is 5"));
}

TEST(Theory, ComputesTheFirstCommandWithoutDelaysAndLosses) {
  const std::string law = kFour + "[law]\nname = 'consensus'\n[link]\n";
  EXPECT_GT(Of(law).first_acceleration->asked, 0);
  EXPECT_EQ(Of(law + "delay_s = 0.1\nloss = 0.5\n").first_acceleration->asked, Of(law).first_acceleration->asked);
}

}  // namespace
}  // namespace mascot
