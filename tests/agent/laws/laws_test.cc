#include "agent/laws/laws.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/ideal_network.h"

namespace mascot {
namespace {

using ::testing::IsEmpty;

// --- experiments as text ----------------------------------------------------------------------------

const std::string kPath5 =
    "[run]\nduration_s = 1.0\n"
    "[agents]\ncount = 5\nmodel = 'double_integrator'\n"
    "position_m = [[3, 0, 1], [-1, 2, 2], [4, 1, 3], [1, -3, 4], [-5, 5, 5]]\n";

/// Two agents at a distance of `z_m` in x; 2 hears 1.
std::string Pair(double z_m, const std::string& law, const std::string& velocity = "[[0, 0, 0], [0, 0, 0]]") {
  return "[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], [" +
         ShortestFloat(z_m) + ", 0, 2]]\nvelocity_m_per_s = " + velocity + "\n[graph]\nedges = [[2, 1]]\n[law]\n" + law;
}

std::vector<std::string> MistakesIn(const std::string& toml) {
  try {
    LoadExperiment(Section::FromText(toml, "test.toml"), "test");
  } catch (const ConfigError& error) {
    return error.mistakes();
  }
  return {};
}

// --- consensus --------------------------------------------------------------------------------------

TEST(Consensus, MeetsAtTheMeanStartPlusTheMeanVelocityOverBeta) {
  IdealNetwork network(kPath5 +
                       "velocity_m_per_s = [[1, 0, 0], [0, -2, 0], [0.5, 0, 0], [0, 0, 0], [2, 1, 0]]\n"
                       "[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\np_gain = 2.0\nbeta = 1.5\n");
  network.RunUntil(120);
  // With sampling, the velocity contributes v0 (1 / beta - h / 2), which tends to v0 / beta for h -> 0.
  const double reach_s = 1 / 1.5 - network.h() / 2;
  for (const Motion& motion : network.motions) {
    EXPECT_NEAR(motion.p_WB.x(), 0.4 + 0.7 * reach_s, 1e-9);
    EXPECT_NEAR(motion.p_WB.y(), 1.0 - 0.2 * reach_s, 1e-9);
    EXPECT_NEAR(motion.p_WB.x(), 0.4 + 0.7 / 1.5, network.h());
    EXPECT_LT(motion.v_WB.norm(), 1e-9);
  }
}

TEST(Consensus, MeetsOnADirectedGraphAtTheMeanWeightedByTheLeftNullVector) {
  IdealNetwork network(kPath5 +
                       "velocity_m_per_s = [[1, 0, 0], [0, -2, 0], [0.5, 0, 0], [0, 0, 0], [2, 1, 0]]\n"
                       "[graph]\nedges = [[1, 2], [2, 3, 0.5], [3, 1, 2.0], [3, 4], [4, 5], [5, 3, 0.7]]\n"
                       "[law]\nname = 'consensus'\np_gain = 1.0\nbeta = 3.0\n");
  const Eigen::MatrixXd kernel = network.experiment.graph.Laplacian().transpose().fullPivLu().kernel();
  ASSERT_EQ(kernel.cols(), 1);
  const Eigen::VectorXd gamma = kernel.col(0) / kernel.sum();
  Eigen::Vector3d meeting = Eigen::Vector3d::Zero();
  for (int i = 0; i < 5; ++i)
    meeting += gamma(i) * (network.motions[i].p_WB + network.motions[i].v_WB * (1 / 3.0 - network.h() / 2));
  network.RunUntil(200);
  for (const Motion& motion : network.motions) EXPECT_LT((motion.p_WB - meeting).head<2>().norm(), 1e-9);
}

TEST(Consensus, DecouplesTheModesOfTheGraph) {
  // Agents that start in an eigenvector of L stay in it; its coordinate obeys s^2 + beta s + p_gain lambda.
  for (int mode = 1; mode < 5; ++mode) {
    IdealNetwork network(kPath5 +
                         "[control]\nrate_hz = 1000\n[graph]\ntopology = 'path'\n"
                         "[law]\nname = 'consensus'\np_gain = 2.0\nbeta = 1.0\n");
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(network.experiment.graph.Laplacian());
    const Eigen::VectorXd shape = solver.eigenvectors().col(mode);
    EXPECT_NEAR(solver.eigenvalues()(mode), 2 - 2 * std::cos(mode * std::numbers::pi / 5), 1e-12);
    for (int i = 0; i < 5; ++i) network.motions[i].p_WB = {shape(i), 0, 0};
    network.RunUntil(3);
    Eigen::VectorXd now(5);
    for (int i = 0; i < 5; ++i) now(i) = network.motions[i].p_WB.x();
    const double coordinate = shape.dot(now);
    EXPECT_LT((now - coordinate * shape).norm(), 1e-12);
    const double omega = std::sqrt(2 * solver.eigenvalues()(mode) - 0.25);  // all underdamped
    const double expected = std::exp(-1.5) * (std::cos(omega * 3) + 0.5 / omega * std::sin(omega * 3));
    EXPECT_NEAR(coordinate, expected, 5e-3);
  }
}

TEST(Consensus, SampledTooSlowlyDivergesExactlyFromTheTheoreticalPeriodOn) {
  // p_gain lambda h < 2 beta and beta h < 2 for every mode; lambda_n = 4 on the complete graph of four.
  const auto spread = [](int rate_hz) {
    IdealNetwork network(
        "[run]\nduration_s = 1.0\n[agents]\ncount = 4\nmodel = 'double_integrator'\n"
        "position_m = [[0, 0, 1], [1, 0, 2], [0, 1, 3], [2, 2, 4]]\n[graph]\ntopology = 'complete'\n"
        "[law]\nname = 'consensus'\np_gain = 5.0\nbeta = 1.0\n[control]\nrate_hz = " +
        std::to_string(rate_hz) + "\n");
    for (int k = 0; k < 2000; ++k) network.Step();
    return (network.agent(1).p_WB - network.agent(2).p_WB).head<2>().norm();
  };
  EXPECT_GT(spread(8), 1e3);    // 20 / 8 > 2
  EXPECT_LT(spread(20), 1e-3);  // 20 / 20 < 2
}

TEST(Consensus, GathersEveryoneAtALeaderThatRestsWhateverItsId) {
  for (int leader = 1; leader <= 5; ++leader) {
    IdealNetwork network(kPath5 +
                         "[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\np_gain = 2.0\nbeta = 2.0\nleader = " +
                         std::to_string(leader) + "\n");
    const Eigen::Vector3d start = network.agent(leader).p_WB;
    network.RunUntil(300);
    EXPECT_EQ(network.agent(leader).p_WB, start);
    for (const Motion& motion : network.motions) EXPECT_LT((motion.p_WB - start).head<2>().norm(), 1e-6);
  }
}

TEST(Consensus, LeavesALeaderWithoutWaypointsItsVelocity) {
  IdealNetwork network(kPath5 +
                       "velocity_m_per_s = [[0, 0, 0], [1, -0.5, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n"
                       "[graph]\ntopology = 'complete'\n[law]\nname = 'consensus'\nleader = 2\n");
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(network.Wants()[1], Eigen::Vector3d::Zero());
    network.Step();
  }
  EXPECT_EQ(network.agent(2).v_WB, Eigen::Vector3d(1, -0.5, 0));
}

TEST(Consensus, FollowsAMovingLeaderAlongAChainWithALagOfBetaV0OverPGainEach) {
  IdealNetwork network(kPath5 +
                       "velocity_m_per_s = [[0.5, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n"
                       "[graph]\nedges = [[2, 1], [3, 2], [4, 3], [5, 4]]\n"
                       "[law]\nname = 'consensus'\nleader = 1\np_gain = 2.0\nbeta = 3.0\n");
  network.RunUntil(100);
  for (int id = 2; id <= 5; ++id) {
    const double lag = network.agent(1).p_WB.x() - network.agent(id).p_WB.x();
    EXPECT_NEAR(lag, (id - 1) * 3.0 * 0.5 / 2.0, 1e-9);
    EXPECT_NEAR(network.agent(id).v_WB.x(), 0.5, 1e-9);
  }
}

TEST(Consensus, FollowsALeaderThroughItsWaypoints) {
  IdealNetwork network(kPath5 +
                       "[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\nleader = 3\np_gain = 2.0\nbeta = 2.0\n"
                       "leader_waypoints_m = [[0, 10, 9], [-7, 4, 9]]\nleader_d_gain = 2.0\n");
  network.RunUntil(150);
  for (const Motion& motion : network.motions) EXPECT_LT((motion.p_WB.head<2>() - Eigen::Vector2d(-7, 4)).norm(), 1e-6);
}

TEST(Consensus, DoesNotDependOnWhereTheOriginIs) {
  const std::string law = "[graph]\ntopology = 'ring'\n[law]\nname = 'consensus'\naxes = 'xyz'\n";
  IdealNetwork here(kPath5 + law);
  IdealNetwork there(kPath5 + law);
  const Eigen::Vector3d shift(16, -32, 8);
  for (Motion& motion : there.motions) motion.p_WB += shift;
  here.RunUntil(5);
  there.RunUntil(5);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_LT((there.motions[i].p_WB - here.motions[i].p_WB - shift).norm(), 1e-12);
}

TEST(Consensus, DoesNotDependOnHowAgentsAreNumbered) {
  const std::string law = "[graph]\ntopology = 'ring'\n[law]\nname = 'consensus'\n";
  IdealNetwork network(kPath5 + law);
  IdealNetwork turned(kPath5 + law);  // renumbering by one leaves the ring unchanged
  for (std::size_t i = 0; i < 5; ++i) turned.motions[(i + 1) % 5] = network.motions[i];
  network.RunUntil(5);
  turned.RunUntil(5);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_LT((turned.motions[(i + 1) % 5].p_WB - network.motions[i].p_WB).norm(), 1e-12);
}

TEST(Consensus, OnlyDampsAnAgentThatHearsNobody) {
  IdealNetwork network(Pair(5, "name = 'consensus'\nbeta = 2.0\n", "[[1, 0, 0], [0, 0, 0]]"));
  EXPECT_EQ(network.laws[0]->Want_W(0, network.agent(1), {}), Eigen::Vector3d(-2, 0, 0));
}

// --- waypoint ---------------------------------------------------------------------------------------

std::string Waypoint(const std::string& law) {
  return "[run]\nduration_s = 1.0\n[agents]\ncount = 1\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1]]\n"
         "[law]\nname = 'waypoint'\n" +
         law;
}

Motion At(const Eigen::Vector3d& p_WB, const Eigen::Vector3d& v_WB = Eigen::Vector3d::Zero()) {
  Motion motion;
  motion.p_WB = p_WB;
  motion.v_WB = v_WB;
  return motion;
}

/// The target of the waypoint law, from its output at rest at `p_WB` (p_gain = 1).
Eigen::Vector3d Target(IdealNetwork& network, double t_s, const Eigen::Vector3d& p_WB) {
  return p_WB + network.laws[0]->Want_W(t_s, At(p_WB), {});
}

TEST(WaypointLaw, IsProportionalToTheDistanceAndDampedInAllThreeAxes) {
  IdealNetwork network(Waypoint("waypoints_m = [[1, 2, 3]]\np_gain = 2.0\nd_gain = 0.5\n"));
  EXPECT_EQ(network.experiment.law.axes, Axes::kXyz);
  const Eigen::Vector3d a_W = network.laws[0]->Want_W(0, At({0, 0, 1}, {1, 0, -2}), {});
  EXPECT_LT((a_W - Eigen::Vector3d(2 - 0.5, 4, 4 + 1)).norm(), 1e-15);
}

TEST(WaypointLaw, DwellsBeforeItGoesOnAndHoldsTheLastWaypoint) {
  IdealNetwork network(Waypoint("waypoints_m = [[5, 0, 1], [0, 5, 1]]\narrival_radius_m = 0.5\ndwell_s = 0.3\n"));
  const Eigen::Vector3d first(5, 0, 1), last(0, 5, 1), close(4.6, 0, 1), away(4, 0, 1);
  EXPECT_LT((Target(network, 0.0, away) - first).norm(), 1e-12);
  EXPECT_LT((Target(network, 0.1, close) - first).norm(), 1e-12);  // arrived: dwells until 0.4
  EXPECT_LT((Target(network, 0.39, close) - first).norm(), 1e-12);
  EXPECT_LT((Target(network, 0.4, close) - last).norm(), 1e-12);
  EXPECT_LT((Target(network, 5, last) - last).norm(), 1e-12);
  EXPECT_LT((Target(network, 9, away) - last).norm(), 1e-12);
}

TEST(WaypointLaw, StartsToDwellAnewWhenItWasPushedOut) {
  IdealNetwork network(Waypoint("waypoints_m = [[5, 0, 1], [0, 5, 1]]\narrival_radius_m = 0.5\ndwell_s = 0.3\n"));
  const Eigen::Vector3d first(5, 0, 1), last(0, 5, 1), close(4.6, 0, 1), away(4, 0, 1);
  Target(network, 0.0, close);
  Target(network, 0.2, away);
  EXPECT_LT((Target(network, 0.3, close) - first).norm(), 1e-12);
  EXPECT_LT((Target(network, 0.5, close) - first).norm(), 1e-12);
  EXPECT_LT((Target(network, 0.6, close) - last).norm(), 1e-12);
}

TEST(WaypointLaw, PassesSeveralWaypointsAtOnceWithoutDwell) {
  IdealNetwork network(
      Waypoint("waypoints_m = [[0, 0, 1], [0.1, 0, 1], [3, 0, 1]]\narrival_radius_m = 0.5\ndwell_s = 0.0\n"));
  EXPECT_LT((Target(network, 0.0, {0, 0, 1}) - Eigen::Vector3d(3, 0, 1)).norm(), 1e-12);
}

TEST(WaypointLaw, MeasuresArrivalOverTheAxesThatItFlies) {
  const std::string law = "waypoints_m = [[5, 0, 9], [0, 5, 9]]\ndwell_s = 0.0\naxes = ";
  IdealNetwork flat(Waypoint(law + "'xy'\n"));
  IdealNetwork full(Waypoint(law + "'xyz'\n"));
  EXPECT_LT((Target(flat, 0, {5, 0, 1}) - Eigen::Vector3d(0, 5, 9)).norm(), 1e-12);
  EXPECT_LT((Target(full, 0, {5, 0, 1}) - Eigen::Vector3d(5, 0, 9)).norm(), 1e-12);
}

TEST(WaypointLaw, HoldsItsStartUntilTheFirstTimeAndThenKeepsToTheTimes) {
  IdealNetwork network(Waypoint("waypoints_m = [[5, 0, 1], [0, 5, 1]]\ntimes_s = [0.3, 2.0]\n"));
  const Eigen::Vector3d anywhere(1, 1, 1);
  EXPECT_LT((Target(network, 0.29, anywhere) - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((Target(network, 30 / 100.0, anywhere) - Eigen::Vector3d(5, 0, 1)).norm(), 1e-12);
  EXPECT_LT((Target(network, 1.99, anywhere) - Eigen::Vector3d(5, 0, 1)).norm(), 1e-12);
  EXPECT_LT((Target(network, 2.0, anywhere) - Eigen::Vector3d(0, 5, 1)).norm(), 1e-12);
  EXPECT_LT((Target(network, 99, anywhere) - Eigen::Vector3d(0, 5, 1)).norm(), 1e-12);
}

TEST(WaypointLaw, ArrivesWithoutOvershootOrErrorWhenCriticallyDamped) {
  IdealNetwork network(Waypoint("waypoints_m = [[20, 0, 1]]\np_gain = 1.0\nd_gain = 2.0\n"));
  double farthest = 0;
  while (network.time_s() < 40) {
    network.Step();
    farthest = std::max(farthest, network.agent(1).p_WB.x());
  }
  EXPECT_LT(farthest, 20 + 1e-6);
  EXPECT_LT((network.agent(1).p_WB - Eigen::Vector3d(20, 0, 1)).norm(), 1e-9);
}

// --- min-max ----------------------------------------------------------------------------------------

std::string Beta(double parent, double child) {
  return "name = 'minmax'\nleader = 1\nbeta = [" + ShortestFloat(parent) + ", " + ShortestFloat(child) + "]\n";
}

/// Time of the last tick at which child and parent had not met: farther apart than 1e-3 of the initial distance, or
/// with a relative velocity above the chatter of a sampled sign function, about two ticks of acceleration.
double MeetingTime(IdealNetwork& network, int child, int parent, double beta, double end_s) {
  const double start_m = (network.agent(child).p_WB - network.agent(parent).p_WB).head<2>().norm();
  double last_s = 0;
  while (network.time_s() < end_s) {
    const double z = (network.agent(child).p_WB - network.agent(parent).p_WB).head<2>().cwiseAbs().maxCoeff();
    const double w = (network.agent(child).v_WB - network.agent(parent).v_WB).head<2>().cwiseAbs().maxCoeff();
    if (z > 1e-3 * start_m || w > 2.5 * beta * network.h()) last_s = network.time_s();
    network.Step();
  }
  return last_s;
}

struct Case {
  double z0, beta_c, beta_p;
};
constexpr Case kCases[] = {{10, 1, 0.5}, {-20, 1, 0.8}, {5, 2, 0.5}, {40, 3, 0.1}};

TEST(Minmax, MeetsAParentThatRestsAfterTheClosedFormTime) {
  for (const auto& [z0, beta_c, beta_p] : kCases) {
    IdealNetwork network(Pair(z0, Beta(beta_p, beta_c)));
    const double expected_s = std::sqrt(2 * std::abs(z0) * (1 / (beta_c - beta_p) + 1 / beta_c));
    EXPECT_NEAR(MeetingTime(network, 2, 1, beta_c, 2 * expected_s), expected_s, 0.03 * expected_s) << z0;
  }
  EXPECT_NEAR(std::sqrt(2 * 10 * (1 / 0.5 + 1)), 7.746, 1e-3);
}

TEST(Minmax, MeetsAParentThatMovesAtConstantVelocityAfterTheSameTime) {
  for (const auto& [z0, beta_c, beta_p] : kCases) {
    IdealNetwork network(Pair(z0, Beta(beta_p, beta_c), "[[0.7, 0, 0], [0.7, 0, 0]]"));
    const double expected_s = std::sqrt(2 * std::abs(z0) * (1 / (beta_c - beta_p) + 1 / beta_c));
    EXPECT_NEAR(MeetingTime(network, 2, 1, beta_c, 2 * expected_s), expected_s, 0.03 * expected_s) << z0;
  }
}

TEST(Minmax, MeetsTheWorstParentAfterTheMinMaxTime) {
  for (const auto& [z0, beta_c, beta_p] : kCases) {
    IdealNetwork network(Pair(z0, Beta(beta_p, beta_c)) + "[control]\nrate_hz = 1000\n");
    const double worst_s = 2 * std::sqrt(std::abs(z0) / (beta_c - beta_p));
    // The worst parent accelerates away from the child in the first half, and towards it in the second.
    const double flight = z0 > 0 ? -beta_p : beta_p;
    double last_s = 0;
    while (network.time_s() < 1.5 * worst_s) {
      const double t_s = network.time_s();
      const double parent_a = t_s < worst_s / 2 ? flight : t_s < worst_s ? -flight : 0;
      network.Step();
      network.agent(1).p_WB.x() += network.h() * network.h() / 2 * parent_a;
      network.agent(1).v_WB.x() += network.h() * parent_a;
      if (std::abs(network.agent(2).p_WB.x() - network.agent(1).p_WB.x()) > 1e-3 * std::abs(z0)) last_s = t_s;
    }
    EXPECT_NEAR(last_s, worst_s, 0.03 * worst_s) << z0;
  }
  EXPECT_NEAR(2 * std::sqrt(10 / 0.5), 8.944, 1e-3);
}

/// Uniform double. The distributions of the standard library differ between implementations.
double Uniform(std::mt19937_64& bits, double min, double max) {
  return min + (max - min) * static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

TEST(Minmax, MeetsAlongAChainOnNoEdgeLaterThanItsOwnBound) {
  std::mt19937_64 bits(7);
  for (int trial = 0; trial < 20; ++trial) {
    IdealNetwork network(
        "[run]\nduration_s = 1.0\n[agents]\ncount = 4\nmodel = 'double_integrator'\n"
        "position_m = [[0, 0, 1], [1, 0, 2], [0, 1, 3], [2, 2, 4]]\n[graph]\ntopology = 'path'\n"
        "[law]\nname = 'minmax'\nleader = 1\nbeta = [0.5, 1.0, 1.6, 2.5]\n");
    const double beta[] = {0.5, 1.0, 1.6, 2.5};
    std::vector<double> bound_s(4, 0.0);
    for (Motion& motion : network.motions) motion.p_WB.head<2>() << Uniform(bits, -9, 9), Uniform(bits, -9, 9);
    for (int child = 2; child <= 4; ++child) {
      const double alpha = beta[child - 1] - beta[child - 2];
      const Eigen::Vector3d z = network.agent(child).p_WB - network.agent(child - 1).p_WB;
      bound_s[child - 1] = 2 * std::sqrt(z.head<2>().cwiseAbs().maxCoeff() / alpha);
    }
    std::vector<double> last_s(4, 0.0);
    while (network.time_s() < 40) {
      for (int child = 2; child <= 4; ++child) {
        const Eigen::Vector3d z = network.agent(child).p_WB - network.agent(child - 1).p_WB;
        if (z.head<2>().cwiseAbs().maxCoeff() > 0.02) last_s[child - 1] = network.time_s();
      }
      network.Step();
    }
    for (int child = 2; child <= 4; ++child) EXPECT_LE(last_s[child - 1], bound_s[child - 1]) << trial << " " << child;
  }
}

TEST(Minmax, ReproducesThePublishedRunsTheoreticalTime) {
  IdealNetwork network(Pair(20, Beta(0.95, 1)));
  EXPECT_NEAR(MeetingTime(network, 2, 1, 1, 60), 28.98, 0.03 * 28.98);
}

TEST(Minmax, SwitchesAsItsEquationSaysWithSignOfZeroZero) {
  IdealNetwork network(Pair(4, Beta(1, 3)));
  const auto accel = [&network](double z, double w) {
    const std::vector<Heard> heard = {{1, 1.0, At({0, 0, 1})}};
    return network.laws[1]->Want_W(0, At({z, 0, 1}, {w, 0, 0}), heard).x();
  };
  EXPECT_EQ(accel(1, 0), -3);
  EXPECT_EQ(accel(-1, 0), 3);
  EXPECT_EQ(accel(0, 1), -3);
  EXPECT_EQ(accel(0, -1), 3);
  EXPECT_EQ(accel(0, 0), 0);
  EXPECT_EQ(accel(1, -2), 0);  // on the curve: 2 (3 - 1) 1 - 2 * 2 = 0
  EXPECT_EQ(accel(1, -1.99), -3);
  EXPECT_EQ(accel(1, -2.01), 3);
}

TEST(Minmax, HoldsStillWhenItsParentWasNotHeard) {
  IdealNetwork network(Pair(4, Beta(1, 3)));
  EXPECT_EQ(network.laws[1]->Want_W(0, At({4, 0, 1}, {1, 0, 0}), {}), Eigen::Vector3d::Zero());
  const std::vector<Heard> stranger = {{7, 1.0, At({0, 0, 1})}};
  EXPECT_EQ(network.laws[1]->Want_W(0, At({4, 0, 1}), stranger), Eigen::Vector3d::Zero());
}

TEST(Minmax, FollowsTheParentAloneHoweverManyItHears) {
  IdealNetwork network(kPath5 +
                       "[graph]\ntopology = 'complete'\n[law]\nname = 'minmax'\nleader = 2\n"
                       "beta = [2.0, 1.0, 2.0, 2.0, 2.0]\n");
  std::vector<Heard> heard = {{2, 1.0, At({0, 0, 1})}, {3, 1.0, At({-50, 0, 1})}};
  EXPECT_EQ(network.laws[0]->Want_W(0, At({3, 0, 1}), heard).x(), -2);
  heard[1].motion.p_WB.x() = 50;
  EXPECT_EQ(network.laws[0]->Want_W(0, At({3, 0, 1}), heard).x(), -2);
}

TEST(Minmax, LeavesARootWithoutWaypointsItsVelocityAndBoundsOneThatHasThem) {
  IdealNetwork idle(Pair(4, Beta(1, 3), "[[1, 0, 0], [0, 0, 0]]"));
  EXPECT_EQ(idle.Wants()[0], Eigen::Vector3d::Zero());
  IdealNetwork flying(Pair(4, Beta(1, 3) + "leader_waypoints_m = [[100, -0.5, 1]]\n"));
  EXPECT_LT((flying.Wants()[0] - Eigen::Vector3d(1, -0.5, 0)).norm(), 1e-12);
}

TEST(Minmax, TakesTheRootsBoundForEveryParentIfToldTo) {
  const std::string law =
      "[graph]\ntopology = 'path'\n[law]\nname = 'minmax'\nleader = 1\nbeta = [0.5, 1.0, 1.0, 1.0, 1.0]\n"
      "weak_edges = 'root'\n";
  IdealNetwork network(kPath5 + law);
  const std::vector<Heard> heard = {{2, 1.0, At({0, 0, 1})}};
  // On the switching curve for alpha = 1.0 - 0.5, not for 1.0 - 1.0.
  EXPECT_EQ(network.laws[2]->Want_W(0, At({1, 0, 1}, {-1, 0, 0}), heard).x(), 0);
  EXPECT_EQ(network.laws[2]->Want_W(0, At({1, 0, 1}, {-0.99, 0, 0}), heard).x(), -1);
}

TEST(MinmaxBoundaryLayer, EndsTheSwitchingOfTheSign) {
  IdealNetwork sharp(Pair(10, Beta(0.5, 1)));
  IdealNetwork smooth(Pair(10, Beta(0.5, 1) + "boundary_layer = 0.1\n"));
  sharp.RunUntil(30);
  smooth.RunUntil(30);
  double sharp_effort = 0, smooth_effort = 0;
  for (int k = 0; k < 100; ++k) {
    sharp_effort += std::abs(sharp.Wants()[1].x());
    smooth_effort += std::abs(smooth.Wants()[1].x());
    sharp.Step();
    smooth.Step();
  }
  EXPECT_GT(sharp_effort, 50);
  EXPECT_LT(smooth_effort, 1e-6);
  EXPECT_NEAR(smooth.agent(2).p_WB.x(), 0, 1e-6);
}

TEST(MinmaxBoundaryLayer, TendsToTheSignAsItShrinks) {
  std::mt19937_64 bits(3);
  IdealNetwork sharp(Pair(10, Beta(0.5, 1)));
  IdealNetwork thin(Pair(10, Beta(0.5, 1) + "boundary_layer = 1e-9\n"));
  for (int trial = 0; trial < 1000; ++trial) {
    const std::vector<Heard> heard = {{1, 1.0, At({0, 0, 1})}};
    const Motion self = At({Uniform(bits, -5, 5), 0, 1}, {Uniform(bits, -3, 3), 0, 0});
    EXPECT_EQ(sharp.laws[1]->Want_W(0, self, heard).x(), thin.laws[1]->Want_W(0, self, heard).x());
  }
}

TEST(MinmaxBoundaryLayer, CostsLittleTimeAndDoesNotOvershoot) {
  IdealNetwork network(Pair(10, Beta(0.5, 1) + "boundary_layer = 0.1\n"));
  double lowest = 10, last_s = 0;
  while (network.time_s() < 30) {
    network.Step();
    lowest = std::min(lowest, network.agent(2).p_WB.x());
    if (network.agent(2).p_WB.x() > 0.1) last_s = network.time_s();
  }
  EXPECT_GT(lowest, -0.01);
  EXPECT_LT(last_s, 1.1 * std::sqrt(2 * 10 * (1 / 0.5 + 1)));
}

TEST(MinmaxBoundaryLayer, FollowsAParentThatAcceleratesAtItsBoundFromWithinTheLayer) {
  IdealNetwork network(Pair(0.05, Beta(0.5, 1) + "boundary_layer = 0.2\n"));
  for (int k = 0; k < 3000; ++k) {
    network.Step();
    network.agent(1).p_WB.x() += network.h() * network.h() / 2 * 0.5;
    network.agent(1).v_WB.x() += network.h() * 0.5;
  }
  // z = -(beta_p / beta_c) l, except that the child's acceleration is one tick late.
  EXPECT_NEAR(network.agent(2).p_WB.x() - network.agent(1).p_WB.x(), -0.5 * 0.2, 0.01);
}

// --- error texts ------------------------------------------------------------------------------------

/// The mistake, without its place, in an experiment of five agents on a path with these lines of [law].
std::string Mistake(std::string_view law, const std::string& lines, const std::string& graph = "topology = 'path'") {
  const auto mistakes =
      MistakesIn(kPath5 + "[graph]\n" + graph + "\n[law]\nname = '" + std::string(law) + "'\n" + lines);
  if (mistakes.size() != 1) return std::to_string(mistakes.size()) + " mistakes";
  const auto key = mistakes[0].find(" law.");
  return key == std::string::npos ? mistakes[0] : mistakes[0].substr(key + 1);
}

TEST(LawErrors, OfConsensus) {
  EXPECT_EQ(Mistake("consensus", "p_gain = -1.0"), "law.p_gain: expected a number in [0, 1000], got -1.0");
  EXPECT_EQ(Mistake("consensus", "beta = 'strong'"), "law.beta: expected a number in [0, 1000], got 'strong'");
  EXPECT_EQ(Mistake("consensus", "pgain = 1.0"), "law.pgain: unknown key (did you mean \"p_gain\"?)");
  EXPECT_EQ(Mistake("consensus", "leader_waypoints_m = [[1, 2, 3]]"),
            "law.leader_waypoints_m: expected law.leader to name the agent that this is for, got no leader");
  EXPECT_EQ(Mistake("consensus", "leader = 9\nleader_waypoints_m = [[1, 2, 3]]"),
            "law.leader: expected an integer in [0, 5], got 9");
  EXPECT_EQ(Mistake("consensus", "leader = 2\nleader_dwell_s = 1.0"),
            "law.leader_dwell_s: expected leader_waypoints_m beside it, got none");
  EXPECT_EQ(Mistake("consensus", "leader = 2\nleader_waypoints_m = [[1, 2, 3]]\nleader_times_s = [1.0, 2.0]"),
            "law.leader_times_s: expected 1 times, one per waypoint, got 2");
}

TEST(LawErrors, OfWaypoint) {
  const std::string way = "waypoints_m = [[1, 2, 3], [4, 5, 6]]\n";
  EXPECT_EQ(Mistake("waypoint", ""),
            "law.waypoints_m: expected targets of all agents here, or of each in agents.waypoints_m, got none");
  EXPECT_EQ(Mistake("waypoint", "waypoints_m = []"),
            "law.waypoints_m: expected a list of points [x, y, z], got nothing");
  EXPECT_EQ(Mistake("waypoint", "waypoints_m = 3"), "law.waypoints_m: expected a list of points [x, y, z], got 3");
  EXPECT_EQ(Mistake("waypoint", way + "times_s = [1.0]"), "law.times_s: expected 2 times, one per waypoint, got 1");
  EXPECT_EQ(Mistake("waypoint", way + "times_s = [1.0, 1.0]"), "law.times_s[1]: expected a time after 1.0, got 1.0");
  EXPECT_EQ(Mistake("waypoint", way + "times_s = [1.0, 2.0]\ndwell_s = 1.0"),
            "law.dwell_s: expected only one of times_s and dwell_s, got both");
  EXPECT_EQ(Mistake("waypoint", way + "times_s = [1.0, 2.0]\narrival_radius_m = 1.0"),
            "law.arrival_radius_m: expected only one of times_s and arrival_radius_m, got both");
  EXPECT_EQ(Mistake("waypoint", way + "arrival_radius_m = 0.0"),
            "law.arrival_radius_m: expected a number in (0, 1000], got 0.0");
  EXPECT_EQ(Mistake("waypoint", way + "leader = 3"),
            "law.leader: expected 0 (every agent flies the waypoints itself), got 3");
}

TEST(LawErrors, OfMinmax) {
  const std::string beta = "beta = [0.5, 1.0, 1.5, 2.0, 2.5]\n";
  EXPECT_EQ(Mistake("minmax", beta), "law.leader: expected the root of the tree in 1..N, got 0");
  EXPECT_EQ(Mistake("minmax", "leader = 1\nbeta = [0.5, 1.0]"), "law.beta: expected 5 numbers, one per agent, got 2");
  EXPECT_EQ(Mistake("minmax", "leader = 1\nbeta = [0.0, 1.0, 2.0, 3.0, 4.0]"),
            "law.beta[0]: expected a number in (0, 1000], got 0.0");
  EXPECT_EQ(Mistake("minmax", "leader = 1\nbeta = -1.0"), "law.beta: expected a number in (0, 1000], got -1.0");
  EXPECT_EQ(Mistake("minmax", "leader = 1\n" + beta + "weak_edges = 'refuze'"),
            "law.weak_edges: expected one of refuse, root, got 'refuze' (did you mean \"refuse\"?)");
  EXPECT_EQ(Mistake("minmax", "leader = 1\n" + beta + "boundary_layer = -0.1"),
            "law.boundary_layer: expected a number in [0, 1000], got -0.1");
}

TEST(LawErrors, OfMinmaxNameTheEdge) {
  EXPECT_EQ(Mistake("minmax", "leader = 1\nbeta = [1.0, 1.0, 1.5, 2.0, 2.5]"),
            "law.beta: expected beta of agent 2 above that of its parent 1 (edge 2 -> 1), got 1.0 and 1.0");
  EXPECT_EQ(Mistake("minmax", "leader = 5\nbeta = [2.5, 2.0, 1.5, 1.6, 1.0]"),
            "law.beta: expected beta of agent 3 above that of its parent 4 (edge 3 -> 4), got 1.5 and 1.6");
  EXPECT_EQ(Mistake("minmax", "leader = 1\nbeta = 1.0"),
            "law.beta: expected beta of agent 2 above that of its parent 1 (edge 2 -> 1), got 1.0 and 1.0 (and 3 more "
            "edges)");
  EXPECT_EQ(Mistake("minmax", "leader = 1\nweak_edges = 'root'\nbeta = [0.95, 1.0, 0.9, 1.0, 1.0]"),
            "law.beta: expected beta of agent 3 above that of the root 1 (edge 3 -> 2), got 0.9 and 0.95");
}

TEST(LawErrors, OfMinmaxNameAgentsThatTheRootDoesNotReach) {
  const std::string beta = "leader = 1\nbeta = [0.5, 1.0, 1.5, 2.0, 2.5]";
  EXPECT_EQ(Mistake("minmax", beta, "edges = [[2, 1], [3, 2], [4, 5], [5, 4]]"),
            "law.leader: expected a root that every agent hears, directly or not, got 1, which does not reach agents 4 "
            "and 5");
  EXPECT_EQ(Mistake("minmax", beta, "edges = [[2, 1], [3, 2], [4, 3], [1, 5]]"),
            "law.leader: expected a root that every agent hears, directly or not, got 1, which does not reach agent 5");
}

TEST(LawErrors, AreNotedOnceHoweverManyAgentsThereAre) {
  const std::string law = kPath5 + "[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\n";
  EXPECT_THAT(MistakesIn(law + "p_gain = -1.0"), ::testing::SizeIs(1));
  EXPECT_THAT(MistakesIn(law), IsEmpty());
}

}  // namespace
}  // namespace mascot
