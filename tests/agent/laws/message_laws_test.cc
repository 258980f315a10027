// Laws whose agents send each other messages of their own: closed forms and bounds, on the law alone and in whole runs.
#include <gmock/gmock.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "tests/agent/laws/five_on_a_path.h"
#include "tests/support/law_run.h"

namespace mascot {
namespace {

using ::testing::Contains;

/// The same experiment with other bodies, which the law does not know.
std::string With(const std::string& model, std::string toml) {
  toml.replace(toml.find("single_integrator"), 17, model);
  return toml;
}

// --- event-triggered consensus ----------------------------------------------------------------------------

const std::string kStatic = "name = 'event_triggered'\n";
const std::string kDynamic = "name = 'event_triggered'\ntrigger = 'dynamic'\n";

/// Flies to `end_s`, and counts messages; checks at each tick that the mean is kept.
int CountMessages(IdealNetwork& network, double end_s) {
  int messages = 0;
  const double mean = MeanX(network);
  while (network.time_s() < end_s) {
    network.Step();
    for (const auto& message : network.messages) messages += !message.empty();
    EXPECT_NEAR(MeanX(network), mean, 1e-13) << network.time_s();
  }
  return messages;
}

double DisagreementX(const IdealNetwork& network) {
  double sum = 0;
  for (const Motion& motion : network.motions) sum += std::pow(motion.p_WB.x() - MeanX(network), 2);
  return std::sqrt(sum);
}

TEST(EventTriggered, TheDisagreementEndsWithinItsBoundWithFewMessages) {
  for (const double c0_m : {0.001, 0.01, 0.1}) {
    for (const double c1_m : {0.0, 0.5}) {
      IdealNetwork network(Five(
          100, 60, kStatic + "c0_m = " + ShortestFloat(c0_m) + "\nc1_m = " + ShortestFloat(c1_m) + "\nalpha = 0.3\n"));
      const int messages = CountMessages(network, 60);
      EXPECT_LT(DisagreementX(network), 3.618034 * std::sqrt(5) * c0_m / 0.381966) << c0_m;
      EXPECT_GT(DisagreementX(network), 0.1 * c0_m) << "the threshold shows";
      EXPECT_LT(messages, c0_m < 0.01 ? 6000 : 1500) << "of 30000 ticks, with c0 = " << c0_m << ", c1 = " << c1_m;
      EXPECT_GE(messages, 10);
    }
  }
}

TEST(EventTriggered, NobodyIsFartherFromWhatItSaidThanTheThreshold) {
  IdealNetwork network(Five(100, 20, kStatic + "c0_m = 0.02\nc1_m = 0.3\nalpha = 0.3\n"));
  std::vector<Eigen::Vector3d> said_W(5, Eigen::Vector3d::Zero());
  network.Step();  // all speak at tick 0
  while (network.time_s() < 20) {
    for (std::size_t i = 0; i < 5; ++i) {
      if (!network.messages[i].empty()) said_W[i] = Eigen::Map<const Eigen::Vector3d>(network.messages[i].data());
      EXPECT_LE((said_W[i] - network.motions[i].p_WB).norm(), 0.02 + 0.3 * std::exp(-0.3 * network.time_s()) + 1e-12);
    }
    network.Step();
  }
}

TEST(EventTriggered, WithAThresholdOfZeroItIsConsensusOneTickLate) {
  // x(k) = p(k): v = -L p, but for tick 0, at which no agent has heard anything.
  IdealNetwork network(Five(100, 5, kStatic + "c0_m = 0.0\nc1_m = 0.0\n"));
  const Eigen::MatrixXd m = Eigen::MatrixXd::Identity(5, 5) - 0.01 * network.experiment.graph.Laplacian();
  Eigen::VectorXd x(5);
  x << 3, -1, 4, 1, -5;
  network.Step();
  while (network.time_s() < 5) {
    for (int i = 0; i < 5; ++i) ASSERT_NEAR(network.motions[static_cast<std::size_t>(i)].p_WB.x(), x(i), 1e-12);
    network.Step();
    x = m * x;
  }
}

TEST(EventTriggered, TheDynamicTriggerEndsInAgreementWithFewerMessagesThanTicks) {
  for (const double sigma : {0.0, 0.5, 0.9}) {
    IdealNetwork network(Five(100, 40, kDynamic + "sigma = " + ShortestFloat(sigma) + "\n"));
    const int messages = CountMessages(network, 40);
    EXPECT_LT(DisagreementX(network), 1e-3) << sigma;
    EXPECT_LT(messages, 4000) << "of 20000 ticks, with sigma = " << sigma;
  }
}

TEST(EventTriggered, IsPredictedAndMeasured) {
  const LawRun run(Five(100, 30, kStatic + "c0_m = 0.01\nc1_m = 0.2\nalpha = 0.3\n"));
  EXPECT_LE(run.Measured("disagreement_m"), run.Predicted("disagreement_m"));
  EXPECT_NEAR(run.Predicted("disagreement_m"), 3.618034 * std::sqrt(5) * 0.01 / 0.381966, 0.02)
      << "the start and c1 have decayed";
  EXPECT_EQ(run.Law()["bounds"]["disagreement_m"], "at_most");
  EXPECT_EQ(run.Law()["messages"].size(), 5u);
  for (const auto& messages : run.Law()["messages"]) EXPECT_LT(messages.get<double>(), 300) << "of 3001 ticks";
  EXPECT_NEAR(run.summary["consensus"]["predicted"]["value_m"][0].get<double>(), 0.4, 1e-12);
  const LawRun dynamic(Five(100, 30, kDynamic));
  EXPECT_LT(dynamic.Measured("disagreement_m"), 0.01);
  EXPECT_TRUE(dynamic.Law()["predicted"]["disagreement_m"].is_null());
}

TEST(EventTriggered, WarnsOfAGainThatIsUnstable) {
  EXPECT_THAT(LawRun(Five(10, 1, kStatic + "gain = 6.0\n")).prediction.warnings,
              Contains("law.gain: unstable: expected below 5.528 1/s at this control period and graph"));
}

TEST(EventTriggered, ADynamicTriggerIsPromisedAMeetingAsFarAsThatIsProved) {
  // h gain lambda_n < 1 - sigma / 2, lambda_n = 3.618
  const auto silent = [](const std::string& keys) { return LawRun(Five(10, 1, kDynamic + keys)).prediction.silent; };
  EXPECT_EQ(silent("gain = 2.07\n"), "");
  EXPECT_EQ(silent("gain = 2.08\n"), "law.gain or law.sigma is too large for a proof");
  EXPECT_EQ(silent("gain = 2.07\nsigma = 0.6\n"), "law.gain or law.sigma is too large for a proof");
}

TEST(EventTriggered, BodiesThatFollowWithALagAgreeToo) {
  for (const char* model : {"double_integrator", "quadrotor"}) {
    for (const std::string& trigger : {kStatic, kDynamic}) {
      const LawRun run(With(model, Five(100, 30, "gain = 0.5\n" + trigger + "[output]\nfidelity = false\n")));
      EXPECT_LT(run.meter.aim().final_disagreement_m, 0.3) << model;
      for (const auto& messages : run.Law()["messages"]) EXPECT_LT(messages.get<double>(), 1000) << model;
    }
  }
}

// --- dynamic average consensus ----------------------------------------------------------------------------

/// Inputs of five agents: a constant, a ramp, and swings of one frequency or of several.
std::string Tracking(const std::string& frequencies, const std::string& more = "") {
  return "name = 'average_tracking'\ninputs_m = [[3, 0, 0], [-1, 2, 0], [4, 0, 1], [1, 0, 0], [-5, 1, 0]]\n"
         "ramps_m_per_s = [[0.1, 0, 0], [0, 0, 0], [0, -0.2, 0], [0, 0, 0], [0, 0, 0]]\n"
         "amplitudes_m = [[2, 0, 0], [0, 1, 0], [0, 0, 0], [1, 1, 0], [0.5, 0, 0]]\n"
         "phases_rad = [0.0, 1.0, 2.0, 3.0, -1.0]\nfrequencies_hz = " +
         frequencies + "\n" + more;
}
const std::string kOneFrequency = "[0.2, 0.2, 0.2, 0.2, 0.2]", kSeveral = "[0.1, 0.2, 0.3, 0.45, 0.7]";

/// r_i(t) of Tracking().
Eigen::Vector3d InputOf(std::size_t i, const std::vector<double>& hz, double t_s) {
  const Eigen::Vector3d constant[] = {{3, 0, 0}, {-1, 2, 0}, {4, 0, 1}, {1, 0, 0}, {-5, 1, 0}};
  const Eigen::Vector3d ramp[] = {{0.1, 0, 0}, {0, 0, 0}, {0, -0.2, 0}, {0, 0, 0}, {0, 0, 0}};
  const Eigen::Vector3d swing[] = {{2, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0.5, 0, 0}};
  const double phase[] = {0, 1, 2, 3, -1};
  return constant[i] + t_s * ramp[i] + std::sin(2 * std::numbers::pi * hz[i] * t_s + phase[i]) * swing[i];
}

TEST(AverageTracking, TheSumOfEstimatesIsThatOfTheInputsAtEveryTick) {
  for (const char* topology : {"path", "complete", "star"}) {
    std::string toml = Five(100, 20, Tracking(kSeveral));
    toml.replace(toml.find("'path'"), 6, "'" + std::string(topology) + "'");
    IdealNetwork network(toml);
    while (network.time_s() < 20) {
      const double t_s = network.time_s();
      network.Step();
      Eigen::Vector3d off_W = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < 5; ++i) {
        off_W += Eigen::Map<const Eigen::Vector3d>(network.messages[i].data());
        off_W -= InputOf(i, {0.1, 0.2, 0.3, 0.45, 0.7}, t_s);
      }
      ASSERT_LT(off_W.norm(), 1e-12) << topology << " at " << t_s;
    }
  }
}

TEST(AverageTracking, TheSumIsKeptAlsoWhenAnAgentComesLate) {
  const LawRun run(Five(100, 4, Tracking(kSeveral) + "[[agents.override]]\nid = 2\nstart_s = 1.0\n"));
  EXPECT_LT(run.Measured("sum_off_m"), 1e-12) << "from then on; what the others say is heard by a law that just begins";
  EXPECT_EQ(run.prediction.silent, "agents come or go");
}

TEST(AverageTracking, OfInputsThatStandStillItIsConsensusToTheirMean) {
  IdealNetwork network(Five(100, 20, "name = 'average_tracking'\n"));
  network.RunUntil(20);
  for (const Motion& motion : network.motions) EXPECT_NEAR(motion.p_WB.x(), 0.4, 1e-9) << "where they started";
}

TEST(AverageTracking, ARampIsFollowedWithTheLagOfTheClosedForm) {
  // All but agent 1 stand still: x - mean(r) = pinv(L) ramp / gain, the solution of L x = ramp - mean with sum 0.
  IdealNetwork network(Five(100, 60,
                            "name = 'average_tracking'\ngain = 2.0\n"
                            "ramps_m_per_s = [[1, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n"));
  network.RunUntil(60);
  const Eigen::MatrixXd l = network.experiment.graph.Laplacian();
  Eigen::VectorXd x(5);
  for (int i = 0; i < 5; ++i) x(i) = network.messages[static_cast<std::size_t>(i)][0];
  Eigen::VectorXd ramp = Eigen::VectorXd::Constant(5, -0.2);
  ramp(0) += 1;
  EXPECT_LT((2 * l * x - ramp).norm(), 1e-6);
}

TEST(AverageTracking, TheBoundIsReachedByOneFrequencyAndHoldsForSeveral) {
  const LawRun one(Five(100, 40, Tracking(kOneFrequency)));
  EXPECT_LE(one.Measured("tracking_error_m"), one.Predicted("tracking_error_m"));
  EXPECT_GT(one.Measured("tracking_error_m"), 0.8 * one.Predicted("tracking_error_m"))
      << "x and y, the swing and the ramp are at their worst at different times";
  EXPECT_LE(one.Measured("sum_off_m"), one.Predicted("sum_off_m"));
  EXPECT_LT(one.Predicted("sum_off_m"), 1e-8);
  const LawRun several(Five(100, 40, Tracking(kSeveral)));
  EXPECT_LE(several.Measured("tracking_error_m"), several.Predicted("tracking_error_m"));
  EXPECT_GT(several.Measured("tracking_error_m"), 0.5 * several.Predicted("tracking_error_m"));
  EXPECT_EQ(several.Law()["bounds"]["tracking_error_m"], "at_most");
  const LawRun alone(Five(100, 40,
                          "name = 'average_tracking'\nfrequencies_hz = [0.2, 0.0, 0.0, 0.0, 0.0]\namplitudes_m = "
                          "[[2, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]\n"));
  EXPECT_NEAR(alone.Measured("tracking_error_m"), alone.Predicted("tracking_error_m"), 1e-3) << "one swing: exact";
}

TEST(AverageTracking, TheEstimatesDoNotDependOnTheBodies) {
  const LawRun single(Five(100, 20, Tracking(kSeveral)));
  for (const char* model : {"double_integrator", "quadrotor"}) {
    const LawRun run(With(model, Five(100, 20, Tracking(kSeveral) + "[output]\nfidelity = false\n")));
    EXPECT_EQ(run.Measured("tracking_error_m"), single.Measured("tracking_error_m")) << model;
    EXPECT_LE(run.Measured("tracking_error_m"), run.Predicted("tracking_error_m")) << model;
    EXPECT_LT(run.meter.aim().final_disagreement_m, 2.5) << model;
  }
}

TEST(AverageTracking, AgentsFlyToTheirPlacesAroundTheEstimate) {
  const LawRun run(Five(100, 20, "name = 'average_tracking'\nshape = 'circle'\nspacing_m = 3.0\n"));
  EXPECT_LT(run.meter.aim().final_disagreement_m, 1e-6) << "less the places";
  EXPECT_LT(run.meter.aim().formation->final_rms_m, 1e-6);
}

TEST(AverageTracking, TheoryIsSilentWhereMessagesAreLateAndWarnsOfAnUnstableGain) {
  EXPECT_EQ(LawRun(Five(100, 0.1, Tracking(kSeveral) + "[link]\ndelay_s = 0.1\n")).prediction.silent,
            "samples are lost or late");
  EXPECT_THAT(LawRun(Five(10, 0.2, Tracking(kSeveral, "gain = 6.0\n"))).prediction.warnings,
              Contains("law.gain: unstable: expected below 5.528 1/s at this control period and graph"));
}

// --- distributed optimisation -----------------------------------------------------------------------------

/// Costs of five agents whose minima differ, one of them along x alone.
const std::string kCosts =
    "targets_m = [[3, 0, 1], [-1, 2, 1], [4, 0, 2], [1, -3, 1], [-5, 1, 1]]\n"
    "weights = [[1], [2, 1, 1], [1, 0.5, 0, 2, 0, 1], [0.5], [1, 0, 0]]\n";

/// (sum Q)^-1 sum Q b of kCosts.
Eigen::Vector3d MinimumOfCosts() {
  Eigen::Matrix3d q[5];
  q[0].setIdentity();
  q[1] = Eigen::Vector3d(2, 1, 1).asDiagonal();
  q[2] << 1, 0.5, 0, 0.5, 2, 0, 0, 0, 1;
  q[3] = 0.5 * Eigen::Matrix3d::Identity();
  q[4] = Eigen::Vector3d(1, 0, 0).asDiagonal();
  const Eigen::Vector3d b[] = {{3, 0, 1}, {-1, 2, 1}, {4, 0, 2}, {1, -3, 1}, {-5, 1, 1}};
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 5; ++i) {
    sum += q[i];
    right += q[i] * b[i];
  }
  return sum.inverse() * right;
}

const std::string kGradient = "name = 'gradient_tracking'\naxes = 'xyz'\n";

TEST(GradientTracking, AllEndWhereTheSumOfTheCostsIsLeast) {
  for (const char* topology : {"path", "complete", "star"}) {
    std::string toml = Five(100, 20, kGradient + kCosts);
    toml.replace(toml.find("'path'"), 6, "'" + std::string(topology) + "'");
    IdealNetwork network(toml);
    network.RunUntil(20);
    for (const auto& message : network.messages)
      EXPECT_LT((Eigen::Map<const Eigen::Vector3d>(message.data()) - MinimumOfCosts()).norm(), 1e-9) << topology;
    for (const Motion& motion : network.motions) EXPECT_LT((motion.p_WB - MinimumOfCosts()).norm(), 1e-9) << topology;
  }
}

TEST(GradientTracking, TheTrackersSumUpToTheGradientsAtEveryTick) {
  // With Q = 1, sum y = sum (x - b); b: the starts (3, -1, 4, 1, -5).
  IdealNetwork network(Five(100, 5, kGradient));
  while (network.time_s() < 5) {
    network.Step();
    double off = 2;  // sum b
    for (const auto& message : network.messages) off += message[3] - message[0];
    ASSERT_NEAR(off, 0, 1e-12) << network.time_s();
  }
}

TEST(GradientTracking, OfEqualCostsOnACompleteGraphTheRateIsThatOfTheMean) {
  // W = J / 5: the mean of x obeys m+ = (1 - step) m, and disagreement is gone after two ticks but for what the step
  // brings: x+ = -step y, y+ = -x - step y, whose roots are below sqrt(step) for a step below 1.
  const auto run = [](const std::string& targets) {
    std::string toml = Five(100, 10, kGradient + "step = 0.1\n" + targets);
    toml.replace(toml.find("'path'"), 6, "'complete'");
    return LawRun(toml);
  };
  const double rate_per_s = -100 * std::log(0.9);
  const LawRun far = run("targets_m = [[5, 1, 0], [5, 2, 0], [5, 3, 0], [5, 4, 0], [5, 5, 0]]\n");
  EXPECT_NEAR(far.Predicted("rate_per_s"), rate_per_s, 0.01 * rate_per_s) << "between whole ticks";
  EXPECT_NEAR(far.Measured("rate_per_s"), far.Predicted("rate_per_s"), 0.01 * rate_per_s);
  // Where each starts at its own target, the mean is there from the start.
  EXPECT_GT(run("").Predicted("rate_per_s"), 5 * rate_per_s);
}

TEST(GradientTracking, TheRateIsPredictedAndMeasured) {
  for (const double step : {0.02, 0.05, 0.1}) {
    const LawRun run(Five(100, 40, kGradient + kCosts + "step = " + ShortestFloat(step) + "\n"));
    EXPECT_NEAR(run.Measured("rate_per_s") / run.Predicted("rate_per_s"), 1, 0.02) << step;
    EXPECT_LT(run.Measured("error_m"), 1e-9);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(run.summary["consensus"]["predicted"]["value_m"][axis].get<double>(), MinimumOfCosts()[axis], 1e-12);
  }
}

TEST(GradientTracking, AStepBeyondTheLimitThatItNamesDiverges) {
  const LawRun run(Five(100, 1, kGradient + kCosts + "step = 2.0\n"));
  ASSERT_EQ(run.prediction.warnings.size(), 1u);
  const std::string& warning = run.prediction.warnings.front();
  ASSERT_TRUE(warning.starts_with("law.step: unstable: expected below ")) << warning;
  const double limit = std::stod(warning.substr(35));
  const LawRun below(Five(100, 8, kGradient + kCosts + "step = " + ShortestFloat(0.98 * limit) + "\n"));
  const LawRun above(Five(100, 8, kGradient + kCosts + "step = " + ShortestFloat(1.02 * limit) + "\n"));
  EXPECT_LT(below.Measured("error_m"), 1);
  EXPECT_GT(above.Measured("error_m"), 5);
}

TEST(GradientTracking, TheEstimatesDoNotDependOnTheBodies) {
  for (const char* model : {"double_integrator", "quadrotor"}) {
    const LawRun run(With(model, Five(100, 20, kGradient + kCosts + "p_gain = 0.5\n[output]\nfidelity = false\n")));
    EXPECT_LT(run.Measured("error_m"), 1e-9) << model;
    EXPECT_LT(run.meter.aim().final_disagreement_m, 0.02) << model;
  }
}

TEST(GradientTracking, TheoryIsSilentOnDirectedGraphs) {
  std::string toml = Five(100, 1, kGradient);
  toml.replace(toml.find("'path'"), 6, "'directed_ring'");
  EXPECT_EQ(LawRun(toml).prediction.silent, "the closed forms are of undirected graphs");
}

}  // namespace
}  // namespace mascot
