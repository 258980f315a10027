// Laws whose agents speak with each other, by messages of their own: closed forms and bounds, on the law alone and in
// whole runs.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "experiment/random.h"
#include "tests/five_on_a_path.h"
#include "tests/law_run.h"

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
  // x(k) = p(k): v = -L p, but for tick 0, at which nobody has heard anything.
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

TEST(EventTriggered, BodiesThatFollowWithALagAgreeToo) {
  for (const char* model : {"double_integrator", "quadrotor"}) {
    for (const std::string& trigger : {kStatic, kDynamic}) {
      const LawRun run(With(model, Five(100, 30, "gain = 0.5\n" + trigger + "[output]\nfidelity = false\n")));
      EXPECT_LT(run.meter.Result().final_disagreement_m, 0.3) << model;
      for (const auto& messages : run.Law()["messages"]) EXPECT_LT(messages.get<double>(), 1000) << model;
    }
  }
}

}  // namespace
}  // namespace mascot
