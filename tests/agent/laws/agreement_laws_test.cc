// Laws by which agents agree, beyond linear consensus: their closed forms, on the law alone and in whole runs.
#include <gmock/gmock.h>

#include <cmath>

#include "base/random.h"
#include "orchestrator/sweeping/table/metrics.h"
#include "tests/agent/laws/five_on_a_path.h"
#include "tests/support/law_run.h"

namespace mascot {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

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
  EXPECT_NEAR(by_sign.Predicted("agreement_time_s"), 4.5, 0.03) << "tolerance: the way of four ticks, from both ends";
  EXPECT_NEAR(by_sign.Measured("agreement_time_s"), by_sign.Predicted("agreement_time_s"), 0.02);
  EXPECT_EQ(by_sign.Law()["bounds"]["agreement_time_s"], "equal");
  EXPECT_LE(by_sign.Measured("band_m"), by_sign.Predicted("band_m"));
  EXPECT_NEAR(by_sign.summary["consensus"]["predicted"]["value_m"][0].get<double>(), -0.5, 0.02);
  EXPECT_THAT(by_sign.text, HasSubstr("(from which on all are within 0.1 % of their first spread, or with sign 4 gain "
                                      "T, along each axis); theory: 4.5, "));
  const LawRun by_power(Five(100, 14, kPower));
  EXPECT_EQ(by_power.Law()["bounds"]["agreement_time_s"], "equal");
  EXPECT_LT(by_power.Predicted("agreement_time_s"), 13.09) << "the bound of continuous time";
  EXPECT_NEAR(by_power.Measured("agreement_time_s"), by_power.Predicted("agreement_time_s"), 0.02);
  EXPECT_NEAR(by_power.summary["consensus"]["predicted"]["value_m"][0].get<double>(), 0.4, 1e-12);
}

TEST(FiniteTime, WhoIsAloneHasAgreedAtOnce) {
  const LawRun run("[run]\nduration_s = 0.1\n[agents]\ncount = 1\nmodel = 'single_integrator'\n[law]\n" + kPower);
  EXPECT_EQ(run.Predicted("agreement_time_s"), 0);
  EXPECT_EQ(run.Measured("agreement_time_s"), 0);
}

TEST(FiniteTime, TwiceTheGainHalvesTheTimeOfTheSignAndShortensThatOfThePower) {
  const auto time_s = [](const std::string& law, const char* gain) {
    return LawRun(Five(100, 1, law + "gain = " + gain)).Predicted("agreement_time_s");
  };
  EXPECT_NEAR(time_s(kSign, "2.0\n"), 2.25, 0.03);
  EXPECT_NEAR(time_s(kPower, "2.0\n"), time_s(kPower, "1.0\n") / 2, 0.03) << "time scales with the gain";
}

TEST(FiniteTime, BodiesThatFollowWithALagTrembleAboutWhereTheyMeet) {
  const auto off_m = [](const std::string& model, const std::string& law) {
    std::string toml = Five(100, 30, law);
    toml.replace(toml.find("single_integrator"), 17, model);
    return LawRun(toml).meter.aim().final_disagreement_m;
  };
  for (const char* model : {"double_integrator", "quadrotor"}) {
    EXPECT_LT(off_m(model, kPower), 0.1) << model;
    EXPECT_LT(off_m(model, kSign), 0.5) << model << ": commanded 1 m/s to and fro";
  }
}

TEST(FiniteTime, TheoryIsSilentWhereItsClosedFormsDoNotHold) {
  const auto silent = [](const std::string& more) { return LawRun(Five(100, 0.1, kPower + more)).prediction.silent; };
  EXPECT_EQ(silent(""), "");
  EXPECT_EQ(silent("[link]\nloss = 0.1\n"), "samples are lost or late");
  EXPECT_EQ(silent("[sensors.own]\nposition_std_m = 0.1\n"), "what agents measure is noisy or late");
  EXPECT_EQ(silent("[[agents.override]]\nid = 2\nmodel = 'quadrotor'\n"),
            "the limit of the tilt cuts more than 2 % of what quadrotors are commanded");
  EXPECT_EQ(silent("[[agents.override]]\nid = 2\nstop_s = 3\n"), "agents come or go");
  EXPECT_EQ(silent("[[graph.schedule]]\nat_s = 0.05\ntopology = 'ring'\n"), "the graph changes");
  EXPECT_EQ(silent("[[agents.override]]\nid = 2\nlaw = { name = 'velocity_consensus' }\n"),
            "agents have laws of their own");
  EXPECT_EQ(silent("[[events]]\nat_s = 0.05\nset = { \"law.gain\" = 2.0 }\n"), "events change the run, from 0.05 s on");
}

// --- prescribed time --------------------------------------------------------------------------------------

std::string Prescribed(double time_s, const std::string& more = "") {
  return "name = 'prescribed_time'\ntime_s = " + ShortestFloat(time_s) + "\n" + more;
}

/// Starts the agents at random places along x, 5 m around 0 or `scale` times that. Returns their mean.
double Scatter(IdealNetwork& network, Random& random, double scale = 1) {
  for (Motion& motion : network.motions) motion.p_WB.x() = scale * random.In(-5, 5);
  return MeanX(network);
}

TEST(PrescribedTime, AllAgreeAtTheGivenTimeWhereverTheyStart) {
  Random random(7, Random::Stream::kPositions);
  for (const double time_s : {0.5, 2.0, 7.3}) {
    for (const double scale : {0.01, 1.0, 1000.0}) {
      IdealNetwork network(Five(1000, 10, Prescribed(time_s)));
      const double mean = Scatter(network, random, scale), spread = SpreadX(network);
      network.RunUntil(time_s / 2);
      EXPECT_GT(SpreadX(network), 0.004 * spread) << time_s << ": not before";
      network.RunUntil(time_s);
      EXPECT_LT(SpreadX(network), 1e-4 * spread) << time_s << " s from " << spread << " m";
      EXPECT_NEAR(MeanX(network), mean, 1e-12 * scale) << "the gain is the same for all: the mean is kept";
      network.RunUntil(time_s + 0.5);
      EXPECT_LT(SpreadX(network), 1e-4 * spread) << "they stay together";
    }
  }
}

TEST(PrescribedTime, AModeShrinksAsTheClosedFormSays) {
  // Two agents: one mode, lambda = 2. exponent lambda = 3, so |d(t) / d(0)| = exp(-2 gain t) (1 - t / T)^3.
  IdealNetwork network(
      "[run]\nduration_s = 4\n[physics]\ncollisions = false\n[agents]\ncount = 2\nmodel = 'single_integrator'\n"
      "position_m = [[3, 0, 1], [-1, 0, 1]]\n[control]\nrate_hz = 1000\n[graph]\ntopology = 'path'\n[law]\n" +
      Prescribed(4, "exponent = 1.5\ngain = 0.25\n"));
  for (const double t_s : {1.0, 2.0, 3.0, 3.5}) {
    network.RunUntil(t_s);
    EXPECT_NEAR(SpreadX(network), 4 * std::exp(-0.5 * t_s) * std::pow(1 - t_s / 4, 3), 4 * 2e-3) << t_s;
  }
  network.RunUntil(4);
  EXPECT_LT(SpreadX(network), 1e-8);
}

TEST(PrescribedTime, NobodyLeavesTheHullHoweverLargeTheGain) {
  Random random(8, Random::Stream::kPositions);
  for (const char* topology : {"complete", "star", "directed_ring", "ring"}) {
    std::string toml = Five(50, 3, Prescribed(1, "exponent = 900.0\ngain = 900.0\n"));
    toml.replace(toml.find("'path'"), 6, "'" + std::string(topology) + "'");
    IdealNetwork network(toml);
    Scatter(network, random);
    for (double before = SpreadX(network), now = 0; network.time_s() < 3; before = now) {
      network.Step();
      now = SpreadX(network);
      ASSERT_LE(now, before + 1e-12) << topology << " at " << network.time_s();
    }
  }
}

TEST(PrescribedTime, IsPredictedAndMeasured) {
  const LawRun run(Five(100, 6, Prescribed(5)));
  EXPECT_NEAR(run.Predicted("agreement_time_s"), 5, 1e-9) << "but for rounding, which a bound has in it";
  EXPECT_EQ(run.Law()["bounds"]["agreement_time_s"], "at_most");
  EXPECT_LE(run.Measured("agreement_time_s"), 5);
  EXPECT_GT(run.Measured("agreement_time_s"), 3) << "the bound is not idle";
  EXPECT_LE(run.Measured("left_share"), run.Predicted("left_share") * (1 + 1e-6));
  EXPECT_GT(run.Measured("left_share"), 0.1 * run.Predicted("left_share")) << "this start has much of the slowest mode";
  EXPECT_THAT(run.prediction.warnings, ::testing::IsEmpty());
  EXPECT_NEAR(run.summary["consensus"]["predicted"]["value_m"][0].get<double>(), 0.4, 1e-12);
}

TEST(PrescribedTime, SaysWhatTheControlPeriodLeaves) {
  const LawRun run(Five(10, 2, Prescribed(1)));
  EXPECT_THAT(run.prediction.warnings,
              Contains(HasSubstr("law.exponent: up to 37 % of the disagreement is left at law.time_s: the control "
                                 "period bounds the gain by 2.5 1/s")));
  EXPECT_TRUE(run.Law()["predicted"]["agreement_time_s"].is_null()) << "it is not promised then";
  EXPECT_LE(run.Measured("left_share"), run.Predicted("left_share") * (1 + 1e-6));
}

TEST(PrescribedTime, BodiesThatFollowWithALagAreNearlyTogetherAtTheGivenTime) {
  for (const char* model : {"double_integrator", "quadrotor"}) {
    std::string toml = Five(100, 20, Prescribed(8, "exponent = 5.0\n"));
    toml.replace(toml.find("single_integrator"), 17, model);
    toml.replace(toml.find("[law]"), 5, "[output]\nfidelity = false\n[law]");
    const LawRun run(toml);
    EXPECT_LT(run.Measured("left_share"), 0.2) << model;
    EXPECT_LT(run.meter.aim().final_disagreement_m, 0.02 * 5.4) << model << ": in the end";
    EXPECT_EQ(run.prediction.silent,
              model[0] == 'q' ? "the limit of the tilt cuts more than 2 % of what quadrotors are commanded" : "");
    if (run.prediction.silent.empty()) {
      EXPECT_NEAR(run.Measured("left_share"), run.Predicted("left_share"),
                  run.Law()["tolerances"]["left_share"].get<double>());
    }
  }
}

// --- figures of laws in tables ------------------------------------------------------------------------------

TEST(LawFigures, HaveColumnsInSweepsOfTheirLaw) {
  const auto names = SweepMetricNames({"finite_time"});
  EXPECT_THAT(names, Contains("laws.finite_time.agreement_time_s"));
  EXPECT_THAT(names, Contains("laws.finite_time.predicted.agreement_time_s"));
  EXPECT_THAT(SweepMetricNames({"consensus"}), ::testing::Not(Contains(HasSubstr("laws."))));
  const LawRun run(Five(100, 6, kSign));
  const auto cells = SweepMetrics(run.figures);
  EXPECT_EQ(std::stod(cells.at("laws.finite_time.predicted.agreement_time_s")), run.Predicted("agreement_time_s"));
  EXPECT_EQ(std::stod(cells.at("laws.finite_time.agreement_time_s")), run.Measured("agreement_time_s"));
  EXPECT_EQ(cells.at("consensus.value_m.y"), "0.0");
}

}  // namespace
}  // namespace mascot
