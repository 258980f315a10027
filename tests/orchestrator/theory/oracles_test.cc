// Known results of the literature, tested with full simulations as in the engines. Unless noted otherwise, the graph is
// a path of five agents with unit weights and x0 = (3, -1, 4, 1, -5); its Laplacian has lambda_2 = 0.381966 and
// lambda_5 = 3.618034.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "tests/orchestrator/theory/flown_network.h"

namespace mascot {
namespace {

const Eigen::VectorXd kStart = (Eigen::VectorXd(5) << 3, -1, 4, 1, -5).finished();
constexpr double kMean = 0.4;

/// Five agents that start at kStart; `rest`: lines from [control] on. Collisions are off: agents pass each other.
std::string Five(const std::string& model, int rate_hz, const std::string& rest) {
  return "[run]\nduration_s = 1000.0\n[physics]\nrate_hz = " + std::to_string(rate_hz) +
         "\ncollisions = false\n[agents]\ncount = 5\nmodel = '" + model +
         "'\nposition_m = [[3, 0, 1], [-1, 0, 1], [4, 0, 1], [1, 0, 1], [-5, 0, 1]]\n[control]\nrate_hz = " +
         std::to_string(rate_hz) + "\nmax_speed_m_per_s = 1000.0\nmax_acceleration_m_per_s2 = 1000.0\n" + rest;
}

std::string Singles(int rate_hz, const std::string& rest) { return Five("single_integrator", rate_hz, rest); }

const std::string kPath = "[graph]\ntopology = 'path'\n";
const std::string kMeet = "[law]\nname = 'velocity_consensus'\n";

double Spread(const Eigen::VectorXd& x) { return x.maxCoeff() - x.minCoeff(); }

Eigen::MatrixXd SampledMap(const Graph& graph, double t) {
  return Eigen::MatrixXd::Identity(graph.size(), graph.size()) - t * graph.Laplacian();
}

// --- single integrators: Olfati-Saber & Murray (2004) -------------------------------------------------

TEST(SingleIntegrators, FollowTheSampledMapExactlyAndKeepTheirMean) {
  FlownNetwork network(Singles(10, kPath + kMeet));
  const Eigen::MatrixXd map = SampledMap(network.experiment.graph, 0.1);
  Eigen::VectorXd x = kStart;
  for (int k = 0; k < 300; ++k) {
    network.Step();
    x = map * x;
    ASSERT_LT((network.x() - x).norm(), 1e-11) << k;
  }
  EXPECT_NEAR(network.x().mean(), kMean, 1e-12);
  EXPECT_LT(Spread(network.x()), 1e-4);
}

TEST(SingleIntegrators, DivergeIffThePeriodIsAboveTwoOverTheLargestEigenvalue) {
  // The bound is T p_gain < 0.55279; here T = 0.1.
  for (const auto& [p_gain, converges] : {std::pair(5.50, true), {5.56, false}}) {
    FlownNetwork network(Singles(10, kPath + kMeet + "p_gain = " + ShortestFloat(p_gain) + "\n"));
    network.RunUntil(60);
    EXPECT_EQ(Spread(network.x()) < 9, converges) << p_gain << ": " << Spread(network.x());
  }
}

TEST(SingleIntegrators, MeetOnADigraphAtTheMeanWeightedByTheLeftNullVector) {
  FlownNetwork network(
      Singles(20, "[graph]\nedges = [[1, 2], [2, 3, 0.5], [3, 1, 2.0], [3, 4], [4, 5], [5, 3, 0.7]]\n" + kMeet));
  const double meeting = network.experiment.graph.LeftNullVector()->dot(kStart);
  network.RunUntil(60);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(network.x()[i], meeting, 1e-9);
}

// --- a law that is off (docs/laws.md, different agents) -------------------------------------------------

/// How far an agent whose law is off goes from a speed of `v`.
double Coasts(const std::string& model, double v) {
  FlownNetwork network("[run]\nduration_s = 10.0\n[agents]\ncount = 1\nmodel = '" + model +
                       "'\nposition_m = [[0, 0, 1]]\nvelocity_m_per_s = [[" + ShortestFloat(v) +
                       ", 0, 0]]\n[[agents.override]]\nid = 1\nstart_s = 10.0\n[law]\nname = 'consensus'\n");
  network.RunUntil(10);
  EXPECT_NEAR(network.agent(1).v_WB.x(), 0, 1e-4);
  return network.agent(1).p_WB.x();
}

TEST(Off, CoastsToRestFromAVelocityThatCannotBeTakenAway) {
  const double k = 2, h = 0.01, most = 3;
  EXPECT_EQ(Coasts("single_integrator", 1), 0);
  EXPECT_NEAR(Coasts("double_integrator", 1), 1 / k - h / 2, 1e-6) << "h / 2: the acceleration is held over a tick";
  EXPECT_NEAR(Coasts("quadrotor", 1), 1 / k - h / 2, 0.02);
  const double cut = most / k;  // the speed below which the acceleration limit does not cut
  EXPECT_NEAR(Coasts("double_integrator", 4), (4 * 4 - cut * cut) / (2 * most) + cut / k, 0.02);
}

// --- delay ------------------------------------------------------------------------------------------

TEST(Delay, OfNeighboursMovesTheMeetingPointByTheDegrees) {
  // Limit: sum x0 (1 + d m T) / sum (1 + d m T), with the degrees d and a delay of m ticks.
  for (const int m : {1, 3}) {
    FlownNetwork network(Singles(10, kPath + "[link]\ndelay_s = " + ShortestFloat(0.1 * m) + "\n" + kMeet));
    const Eigen::VectorXd weight =
        (1 + 0.1 * m * Eigen::VectorXd(network.experiment.graph.Laplacian().diagonal()).array());
    const double limit = weight.dot(kStart) / weight.sum();
    if (m == 1) {
      EXPECT_NEAR(limit, 0.448275862, 1e-9);
    }
    network.RunUntil(120);
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(network.x()[i], limit, 1e-9) << m;
  }
}

TEST(Delay, OfSelfAndNeighboursIsToleratedUpToPiOverTwiceTheLargestEigenvalue) {
  // 0.43416 s in continuous time; sampling at 200 Hz adds half a period.
  for (const auto& [delay_s, converges] : {std::pair(0.42, true), {0.445, false}}) {
    const std::string delay = "delay_s = " + ShortestFloat(delay_s) + "\n";
    FlownNetwork network(Singles(200, "[sensors.own]\n" + delay + kPath + "[link]\n" + delay + kMeet));
    network.RunUntil(40);
    const double early = Spread(network.x());
    network.RunUntil(80);
    EXPECT_EQ(Spread(network.x()) < early, converges) << delay_s;
  }
}

// --- loss -------------------------------------------------------------------------------------------

std::string Lossy(int seed) {
  std::string text = Singles(10, kPath + "[link]\nloss = 0.4\nsymmetric = true\n" + kMeet);
  return text.replace(text.find("[run]\n"), 6, "[run]\nseed = " + std::to_string(seed) + "\n");
}

TEST(SymmetricLoss, KeepsTheMeanInEveryRun) {
  for (int seed = 1; seed <= 5; ++seed) {
    FlownNetwork network(Lossy(seed));
    network.RunUntil(100);
    EXPECT_NEAR(network.x().mean(), kMean, 1e-10);
    EXPECT_LT(Spread(network.x()), 1e-6);
  }
}

TEST(SymmetricLoss, SlowsTheMeanOfManyRunsAsIfTheGraphWereWeaker) {
  // E x_k = (I - (1 - p) T L)^k x0
  constexpr int kRuns = 400, kTicks = 15;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(5), squares = sum;
  Eigen::MatrixXd map;
  for (int seed = 1; seed <= kRuns; ++seed) {
    FlownNetwork network(Lossy(seed));
    map = SampledMap(network.experiment.graph, 0.6 * 0.1);
    for (int k = 0; k < kTicks; ++k) network.Step();
    sum += network.x();
    squares += network.x().cwiseAbs2();
  }
  Eigen::VectorXd expected = kStart;
  for (int k = 0; k < kTicks; ++k) expected = map * expected;
  const Eigen::VectorXd mean = sum / kRuns;
  for (int i = 0; i < 5; ++i) {
    const double sigma = std::sqrt((squares[i] / kRuns - mean[i] * mean[i]) / kRuns);
    EXPECT_NEAR(mean[i], expected[i], 4.5 * sigma) << i;
  }
}

// --- noise ------------------------------------------------------------------------------------------

TEST(Noise, OfPositionsSpreadsARingAsTheSumOverItsModesSays) {
  // On a ring (degree 2) an error n in its own position moves an agent by 2 T n: state noise with sigma = 2 T std(n),
  // and E|delta|^2 = sum over lambda > 0 of sigma^2 / (1 - (1 - T lambda)^2).
  constexpr double kStd = 0.05, kT = 0.1;
  FlownNetwork network(
      Singles(10, "[sensors.own]\nposition_std_m = " + ShortestFloat(kStd) + "\n[graph]\ntopology = 'ring'\n" + kMeet));
  double expected = 0;
  for (int mode = 1; mode < 5; ++mode) {
    const double lambda = 2 - 2 * std::cos(2 * std::numbers::pi * mode / 5);
    expected += std::pow(2 * kT * kStd, 2) / (1 - std::pow(1 - kT * lambda, 2));
  }
  network.RunUntil(30);  // until the effect of the start is gone
  constexpr int kTicks = 20000;
  double measured = 0;
  for (int k = 0; k < kTicks; ++k) {
    network.Step();
    measured += (network.x().array() - network.x().mean()).matrix().squaredNorm() / kTicks;
  }
  EXPECT_NEAR(measured, expected, 0.05 * expected);
}

// --- double integrators -----------------------------------------------------------------------------

TEST(DoubleIntegrators, MeetAtTheMeanStartPlusTheMeanVelocityOverBeta) {
  std::string text = Five("double_integrator", 100, kPath + "[law]\nname = 'consensus'\nbeta = 1.5\n");
  text.replace(text.find("[control]"), 0,
               "velocity_m_per_s = [[1, 0, 0], [0, 0, 0], [0.5, 0, 0], [0, 0, 0], [2, 0, 0]]\n");
  FlownNetwork network(text);
  network.RunUntil(80);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(network.x()[i], kMean + 0.7 * (1 / 1.5 - 0.005), 1e-9);
}

TEST(RelativeDamping, IsEnoughOnADirectedCycleOfTenIffItsGainIsAboveItsBound) {
  // Ren & Atkins (2007): a = -L (p + g v), stable iff g^2 > max Im^2 / (Re |lambda|^2): g > 2.1763.
  for (const auto& [gain, converges] : {std::pair(2.35, true), {2.0, false}}) {
    FlownNetwork network(
        "[run]\nduration_s = 1000.0\n[physics]\ncollisions = false\nrate_hz = 200\n[agents]\ncount = 10\n"
        "model = 'double_integrator'\n[control]\nrate_hz = 200\nmax_acceleration_m_per_s2 = 1000.0\n"
        "[graph]\ntopology = 'directed_ring'\n[law]\nname = 'consensus'\nbeta = 0.0\nv_gain = " +
        ShortestFloat(gain) + "\n");
    network.RunUntil(150);
    const double early = Spread(network.x());
    network.RunUntil(300);
    EXPECT_EQ(Spread(network.x()) < early, converges) << gain;
  }
}

TEST(Chain, LagsBehindALeaderAtConstantSpeedInProportionToPlaceAndSpeed) {
  // Without feed-forward, agent i of the chain lags by i v0 as single integrator, and by i beta v0 under the paper's
  // law.
  constexpr double kSpeed = 0.5, kBeta = 1.5;
  const std::string chain = "[graph]\ntopology = 'directed_path'\n";
  std::string singles = Singles(100, chain + kMeet);
  singles.replace(singles.find("[control]"), 0,
                  "[[agents.override]]\nid = 1\nlaw = { name = 'custom', output = 'velocity', python = "
                  "'def control(t, me, neighbours): return 0.5, 0.0' }\n");
  std::string doubles = Five("double_integrator", 100, chain + "[law]\nname = 'consensus'\nleader = 1\nbeta = 1.5\n");
  doubles.replace(doubles.find("[control]"), 0,
                  "velocity_m_per_s = [[0.5, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n");
  FlownNetwork first(singles), second(doubles);
  first.RunUntil(60);
  second.RunUntil(120);
  for (int i = 1; i < 5; ++i) {
    EXPECT_NEAR(first.x()[0] - first.x()[i], i * kSpeed, 1e-6);
    EXPECT_NEAR(second.x()[0] - second.x()[i], i * kBeta * kSpeed, 1e-6);
  }
}

TEST(Formation, IsCentredOnTheMeanOfStartsMinusPlaces) {
  FlownNetwork network(Five("double_integrator", 100,
                            kPath + "[law]\nname = 'formation'\nshape = 'circle'\nspacing_m = 3.0\nbeta = 1.5\n"));
  const double radius = 1.5 / std::sin(std::numbers::pi / 5);
  Eigen::VectorXd d(5);
  for (int i = 0; i < 5; ++i) d[i] = radius * std::cos(2 * std::numbers::pi * i / 5);
  network.RunUntil(80);
  const double c = (kStart - d).mean();
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(network.x()[i], c + d[i], 1e-9);
}

// --- graphs that change -----------------------------------------------------------------------------

TEST(Switching, BetweenJointlyConnectedGraphsIsTheProductOfTheSampledMaps) {
  FlownNetwork network(Singles(10,
                               "[graph]\nedges = [[1, 2], [2, 1], [4, 5], [5, 4]]\nrepeat_s = 1.0\n"
                               "[[graph.schedule]]\nat_s = 0.5\nedges = [[2, 3], [3, 2], [3, 4], [4, 3]]\n" +
                                   kMeet));
  const auto phases = network.experiment.schedule.phases();
  ASSERT_EQ(phases.size(), 2u);
  Eigen::VectorXd x = kStart;
  for (int k = 0; k < 600; ++k) {
    network.Step();
    x = SampledMap(phases[k % 10 < 5 ? 0 : 1].graph, 0.1) * x;
    ASSERT_LT((network.x() - x).norm(), 1e-11) << k;
  }
  EXPECT_LT(Spread(network.x()), 1e-3);
  EXPECT_NEAR(network.x().mean(), kMean, 1e-11);
}

TEST(Range, KeepsGroupsApartThatNeverComeCloseAndJoinsThoseThatDo) {
  const auto after = [](double range_m) {
    FlownNetwork network(Singles(10, "[graph]\nrange_m = " + ShortestFloat(range_m) + "\n" + kMeet));
    network.RunUntil(60);
    return network.x();
  };
  // Within 2.5 m, agents 3, 1, 4 (at 4, 3, 1) hear their neighbours, and so do 4 and 2 (at 1, -1); agent 5 (at -5) is
  // alone.
  const Eigen::VectorXd apart = after(2.5);
  EXPECT_EQ(apart[4], -5);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(apart[i], 7.0 / 4, 1e-6);
  const Eigen::VectorXd all = after(20);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(all[i], kMean, 1e-9);
}

// --- laws in Python ---------------------------------------------------------------------------------

TEST(EventTriggered, BroadcastsAreFewAndLeaveNoMoreThanTheBoundOfDisagreement) {
  // Seyboth, Dimarogonas & Johansson (2013): send when |x - x_sent| > c0; |delta| <= |L| sqrt(N) c0 / lambda_2.
  FlownNetwork network(Singles(100, kPath + R"([law]
name = 'custom'
output = 'velocity'
params = { c0 = 0.05 }
python = '''
def start(me, params):
    me.c0, me.sent, me.now, me.known, me.count = params["c0"], None, None, {}, 0

def control(t, me, neighbours):
    me.sent = me.now  # what others know of us by now
    for j in neighbours:
        if j.message is not None:
            me.known[j.id] = j.message[0]
    if me.sent is None:
        return 0, 0
    return sum(x - me.sent for x in me.known.values()), 0

def message(me):
    if me.sent is not None and abs(me.position[0] - me.sent) <= me.c0:
        return None
    me.now = me.position[0]
    return [me.now]
'''
)"));
  int sent = 0;
  for (int k = 0; k < 3000; ++k) {
    network.Step();
    for (int id = 1; id <= 5; ++id) sent += !network.team.message(id).empty();
  }
  const Eigen::VectorXd delta = network.x().array() - network.x().mean();
  EXPECT_NEAR(network.x().mean(), kMean, 1e-9);
  EXPECT_LE(delta.norm(), 3.618034 * std::sqrt(5) * 0.05 / 0.381966);
  EXPECT_LT(sent, 5 * 3000 / 20);
  EXPECT_GT(sent, 5);
}

TEST(CyclicPursuit, KeepsTheCircleWhenTheAngleIsPiOverN) {
  // v_i = k R (x_{i+1} - x_i), where R rotates outwards by pi / N: a regular N-gon rotates on its circle at the rate
  // 2 k sin(pi / N).
  constexpr int kN = 6;
  std::string positions;
  for (int i = 0; i < kN; ++i) {  // each agent hears the previous id, which is ahead of it
    const double angle = -2 * std::numbers::pi * i / kN;
    positions += (i > 0 ? ", [" : "[") + ShortestFloat(3 * std::cos(angle)) + ", " +
                 ShortestFloat(3 * std::sin(angle)) + ", 1.0]";
  }
  FlownNetwork network("[run]\nduration_s = 1000.0\n[agents]\ncount = 6\nmodel = 'single_integrator'\nposition_m = [" +
                       positions +
                       R"(]
[graph]
topology = 'directed_ring'
[law]
name = 'custom'
output = 'velocity'
python = '''
import numpy as np
a = -np.pi / 6  # outwards
R = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 0]])
def control(t, me, neighbours):
    return 0.5 * R @ (neighbours[0].position - me.position)
'''
)");
  network.RunUntil(10);
  for (const Motion& motion : network.motions) EXPECT_NEAR(motion.p_WB.head<2>().norm(), 3, 3 * 0.02);
  const double turned = std::atan2(network.agent(1).p_WB.y(), network.agent(1).p_WB.x());
  const double expected = std::remainder(2 * 0.5 * std::sin(std::numbers::pi / kN) * 10, 2 * std::numbers::pi);
  EXPECT_NEAR(std::abs(turned), std::abs(expected), 0.02);
}

}  // namespace
}  // namespace mascot
