// The low-level stack at the control period: bounds of the control rate, in theory and in flight.
#include "orchestrator/theory/stack_rate.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>

#include "tests/support/law_run.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::string Flying(const std::string& rate_hz, const std::string& agents = "",
                   const std::string& law = "name = 'waypoint'\nwaypoints_m = [[3, 1, 3]]\n", double duration_s = 20) {
  return "[run]\nduration_s = " + ShortestFloat(duration_s) + "\n[agents]\ncount = 1\nposition_m = [[0, 0, 2]]\n" +
         agents + "[control]\nrate_hz = " + rate_hz + "\n[law]\n" + law;
}

std::vector<std::string> OfRate(const std::vector<std::string>& warnings) {
  std::vector<std::string> of_rate;
  std::ranges::copy_if(warnings, std::back_inserter(of_rate),
                       [](const std::string& warning) { return warning.starts_with("control.rate_hz: unstable"); });
  return of_rate;
}

TEST(StackRate, AQuadrotorAt2HzFallsAndItsRateIsBlamedOnce) {
  const LawRun run(Flying("2"));
  EXPECT_EQ(run.prediction.stable, false);
  EXPECT_EQ(run.prediction.silent, "the attitude loop of agent 1 is unstable");
  EXPECT_THAT(OfRate(run.prediction.warnings),
              ElementsAre(AllOf(StartsWith("control.rate_hz: unstable at this rate, it must be above 15"),
                                HasSubstr(", got 2: the attitude loop of agent 1 (the gains `attitude` of "
                                          "agents.airframe) computes once in a control period"))));
  EXPECT_GT(run.summary["safety"]["contacts"]["ground"], 0);
}

TEST(StackRate, LinearLawsAreNotBlamedForIt) {
  const Prediction prediction = Predict(Load(
      "[run]\nduration_s = 5.0\n[agents]\ncount = 3\n[control]\nrate_hz = 10\n[law]\nname = 'velocity_consensus'\n"));
  EXPECT_THAT(prediction.warnings, Not(Contains(StartsWith("law.p_gain"))));
  EXPECT_EQ(OfRate(prediction.warnings).size(), 1U);
}

TEST(StackRate, EveryBuiltInAirframeIsStableAtTheDefaultRate) {
  for (const std::string_view name : AirframeNames())
    EXPECT_FALSE(FindUnstableLoop(Load(Flying("100", "airframe = '" + std::string(name) + "'\n")))) << name;
}

// With n -> infinity, h < min(2 / kd, 2 kd / kp); with these n = 100 and more.
TEST(StackRate, KnowsTheBoundOfEachLoopFromTheGains) {
  const struct {
    std::string gains;
    std::string_view name;
    double rate_hz;
  } rows[] = {{"altitude = { kp = 100, kd = 80 }", "altitude", 40},
              {"altitude = { kp = 4000, kd = 40 }", "altitude", 50},
              {"heading = { kp = 10, kd = 60 }", "heading", 30},
              {"attitude = { kp = 100, kd = 70 }", "attitude", 35}};
  for (const auto& row : rows) {
    const auto loop =
        FindUnstableLoop(Load(Flying("20", "airframe = { " + row.gains + " }\n") + "[physics]\nrate_hz = 10000\n"));
    ASSERT_TRUE(loop) << row.gains;
    EXPECT_EQ(loop->name, row.name);
    EXPECT_NEAR(*loop->rate_hz, row.rate_hz, 0.02 * row.rate_hz) << row.gains;
  }
}

TEST(StackRate, HeldHeightsAndWantedVelocitiesOfDoubleIntegratorsHaveBoundsToo) {
  const std::string law = "name = 'velocity_consensus'\np_gain = 0.01\n", model = "model = 'double_integrator'\n";
  const std::string fast = "velocity_gain = 50.0\n";
  EXPECT_FALSE(FindUnstableLoop(Load(Flying("4", model, law)))) << "it starts where it is to stay";
  const auto of_height = FindUnstableLoop(Load(Flying("4", model + "velocity_m_per_s = [[0, 0, 0.1]]\n", law)));
  ASSERT_TRUE(of_height);
  EXPECT_EQ(of_height->name, "altitude");
  EXPECT_NEAR(*of_height->rate_hz, 5, 0.05) << "kd = 10: 2 / kd = 0.2 s";
  const auto of_velocity = FindUnstableLoop(Load(Flying("20\n" + fast, model, law)));
  ASSERT_TRUE(of_velocity);
  EXPECT_EQ(of_velocity->name, "velocity");
  EXPECT_NEAR(*of_velocity->rate_hz, 25, 0.05) << "2 / k_v";
  EXPECT_FALSE(FindUnstableLoop(Load(Flying("1", "model = 'single_integrator'\n", law))));
}

TEST(StackRate, RotorsThatAreTooSlowForTheGainsAreUnstableAtEveryRate) {
  const Experiment experiment = Load(Flying("100", "airframe = { rotor_time_constant_s = 0.2 }\n"));
  const auto loop = FindUnstableLoop(experiment);
  ASSERT_TRUE(loop);
  EXPECT_FALSE(loop->rate_hz);
  EXPECT_EQ(Warning(*loop, experiment),
            "agents.airframe: the attitude loop of agent 1 is unstable at every control.rate_hz, by the gains "
            "`attitude` of agents.airframe");
}

TEST(StackRate, FlightsAreUnstableBelowTheBoundAndStableAboveIt) {
  const std::string law = "name = 'waypoint'\nwaypoints_m = [[0.2, 0.1, 2]]\np_gain = 0.5\nd_gain = 1.0\n";
  const LawRun above(Flying("20", "", law)), below(Flying("10", "", law));
  EXPECT_EQ(above.prediction.stable, true);
  EXPECT_EQ(below.prediction.stable, false);
  EXPECT_LT(above.meter.aim().final_speed_m_per_s, 0.01);
  EXPECT_GT(below.meter.aim().final_speed_m_per_s, 0.05);
}

TEST(StackRate, AGainThatHardlyDampsIsNamedBesideTheRateThatItAsksFor) {
  const Prediction prediction =
      Predict(Load("[run]\nduration_s = 5.0\n[agents]\ncount = 4\nmodel = 'double_integrator'\n[law]\nname = "
                   "'consensus'\np_gain = 10.0\nbeta = 0.01\n"));
  EXPECT_THAT(prediction.warnings,
              Contains("control.rate_hz: unstable at this rate, it must be above 2000, got 100: law.beta = 0.01 damps "
                       "so little that holding a command for a tick undoes it"));
}

}  // namespace
}  // namespace mascot
