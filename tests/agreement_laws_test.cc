// Laws by which agents agree, beyond linear consensus: their closed forms, on the law alone and in whole runs.
#include <gmock/gmock.h>

#include <cmath>

#include "orchestrator/sweeping/metrics.h"
#include "tests/ideal_network.h"
#include "tests/law_run.h"

namespace mascot {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// Five single integrators on a path that start at (3, -1, 4, 1, -5) along x, whose lambda_2 is 0.381966. `more`: lines
/// from [law] on.
std::string Five(int rate_hz, double duration_s, const std::string& more) {
  return "[run]\nduration_s = " + ShortestFloat(duration_s) +
         "\n[physics]\ncollisions = false\n[agents]\ncount = 5\nmodel = 'single_integrator'\n"
         "position_m = [[3, 0, 1], [-1, 0, 1], [4, 0, 1], [1, 0, 1], [-5, 0, 1]]\n[control]\nrate_hz = " +
         std::to_string(rate_hz) + "\n[graph]\ntopology = 'path'\n[law]\n" + more;
}

double MeanX(const IdealNetwork& network) {
  double sum = 0;
  for (const Motion& motion : network.motions) sum += motion.p_WB.x();
  return sum / static_cast<double>(network.motions.size());
}

double SpreadX(const IdealNetwork& network) {
  double least = network.motions[0].p_WB.x(), most = least;
  for (const Motion& motion : network.motions) {
    least = std::min(least, motion.p_WB.x());
    most = std::max(most, motion.p_WB.x());
  }
  return most - least;
}

// --- finite time ------------------------------------------------------------------------------------------

const std::string kSign = "name = 'finite_time'\nform = 'sign'\n";
const std::string kPower = "name = 'finite_time'\n";

TEST(FiniteTime, BySignTheOutermostMeetMidwayAtTheirSpeed) {
  IdealNetwork network(Five(1000, 10, kSign));
  network.RunUntil(4);
  EXPECT_NEAR(SpreadX(network), 9 - 2 * 4, 4e-3) << "both ends at 1 m/s, but for the ticks at which they change";
  network.RunUntil(4.5);
  EXPECT_LE(SpreadX(network), 4e-3) << "the way of four ticks";
  network.RunUntil(10);
  EXPECT_LE(SpreadX(network), 4e-3) << "they stay together";
  EXPECT_NEAR(MeanX(network), -0.5, 2e-3);
}

TEST(FiniteTime, ByPowerTheMeanIsKeptAndTheBoundHolds) {
  for (const double alpha : {0.25, 0.5, 0.75}) {
    IdealNetwork network(Five(1000, 60, kPower + "alpha = " + ShortestFloat(alpha) + "\n"));
    const double v = 51.2 / 2;  // half the sum of squares of (2.6, -1.4, 3.6, 0.6, -5.4)
    const double bound_s = 4 * std::pow(v, (1 - alpha) / 2) / ((1 - alpha) * std::pow(4 * 0.381966, (1 + alpha) / 2));
    network.RunUntil(bound_s / 4);
    EXPECT_GT(SpreadX(network), 0.01) << alpha << ": the bound is not idle";
    network.RunUntil(bound_s);
    EXPECT_LT(SpreadX(network), 1e-3) << alpha;
    EXPECT_NEAR(MeanX(network), 0.4, 1e-12) << alpha;
  }
}

TEST(FiniteTime, IsPredictedAndMeasured) {
  const LawRun by_sign(Five(100, 6, kSign));
  EXPECT_DOUBLE_EQ(by_sign.Predicted("agreement_time_s"), 4.5);
  EXPECT_NEAR(by_sign.Measured("agreement_time_s"), 4.5, 0.02) << "tolerance: the way of four ticks, from both ends";
  EXPECT_EQ(by_sign.Law()["bounds"]["agreement_time_s"], "equal");
  EXPECT_NEAR(by_sign.summary["consensus"]["predicted"]["value_m"][0].get<double>(), -0.5, 1e-12);
  EXPECT_THAT(by_sign.text, HasSubstr("agreement_time_s 4.5 (from which on all agents are together); theory: 4.5, "));
  const LawRun by_power(Five(100, 14, kPower));
  EXPECT_EQ(by_power.Law()["bounds"]["agreement_time_s"], "at_most");
  EXPECT_NEAR(by_power.Predicted("agreement_time_s"), 13.09, 0.01);
  EXPECT_LT(by_power.Measured("agreement_time_s"), by_power.Predicted("agreement_time_s"));
  EXPECT_NEAR(by_power.summary["consensus"]["predicted"]["value_m"][0].get<double>(), 0.4, 1e-12);
}

TEST(FiniteTime, TwiceTheGainHalvesTheTimeOfTheSignAndShortensThatOfThePower) {
  EXPECT_DOUBLE_EQ(LawRun(Five(100, 1, kSign + "gain = 2.0\n")).Predicted("agreement_time_s"), 2.25);
  EXPECT_NEAR(LawRun(Five(100, 1, kPower + "gain = 2.0\n")).Predicted("agreement_time_s"), 13.09 / 2, 0.01)
      << "time scales with the gain";
}

TEST(FiniteTime, TheoryIsSilentWhereItsClosedFormsDoNotHold) {
  const auto silent = [](const std::string& more) { return LawRun(Five(100, 0.1, kPower + more)).prediction.silent; };
  EXPECT_EQ(silent(""), "");
  EXPECT_EQ(silent("[link]\nloss = 0.1\n"), "samples are lost or late");
  EXPECT_EQ(silent("[sensors.own]\nposition_std_m = 0.1\n"), "what agents measure is noisy or late");
  EXPECT_EQ(silent("[[agents.override]]\nid = 2\nmodel = 'quadrotor'\n"), "the closed form is of single integrators");
  EXPECT_EQ(silent("[[agents.override]]\nid = 2\nstop_s = 3\n"), "agents come or go");
  EXPECT_EQ(silent("[[graph.schedule]]\nat_s = 0.05\ntopology = 'ring'\n"), "the graph changes");
  EXPECT_EQ(silent("[[agents.override]]\nid = 2\nlaw = { name = 'velocity_consensus' }\n"),
            "agents have laws of their own");
  EXPECT_EQ(silent("[[events]]\nat_s = 0.05\nset = { \"law.gain\" = 2.0 }\n"), "events change the run, from 0.05 s on");
}

// --- figures of laws in tables ------------------------------------------------------------------------------

TEST(LawFigures, HaveColumnsInSweepsOfTheirLaw) {
  const auto names = SweepMetricNames({"finite_time"});
  EXPECT_THAT(names, Contains("laws.finite_time.agreement_time_s"));
  EXPECT_THAT(names, Contains("laws.finite_time.predicted.agreement_time_s"));
  EXPECT_THAT(SweepMetricNames({"consensus"}), ::testing::Not(Contains(HasSubstr("laws."))));
  const LawRun run(Five(100, 6, kSign));
  const auto cells = SweepMetrics(run.summary.dump(), names);
  EXPECT_EQ(cells.at("laws.finite_time.predicted.agreement_time_s"), "4.5");
  EXPECT_EQ(std::stod(cells.at("laws.finite_time.agreement_time_s")), run.Measured("agreement_time_s"));
  EXPECT_EQ(cells.at("consensus.value_m.y"), "0.0");
}

}  // namespace
}  // namespace mascot
