// Laws of motion along given ways: waypoints, trajectories, platoons, pursuit. Their closed forms, on the law alone and
// in whole runs.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "orchestrator/sweeping/metrics.h"
#include "tests/ideal_network.h"
#include "tests/law_run.h"

namespace mascot {
namespace {

using ::testing::Contains;

// --- waypoints --------------------------------------------------------------------------------------------

/// A double integrator that flies 10 m along x, from rest. `law`: more lines of [law]; `more`: of other tables.
std::string Step(const std::string& law, const std::string& more = "", const std::string& model = "double_integrator") {
  return "[run]\nduration_s = 30\n[agents]\ncount = 1\nmodel = '" + model +
         "'\nposition_m = [[0, 0, 1]]\n[control]\nmax_acceleration_m_per_s2 = 100\n[law]\nname = 'waypoint'\n" + law +
         more;
}
const std::string kTenMetres = "waypoints_m = [[10, 0, 1]]\n";

TEST(Waypoints, OvershootAndSettlingAreThoseOfTheSecondOrderResponse) {
  for (const double d : {0.4, 1.0, 1.4}) {
    const std::string law = kTenMetres + "d_gain = " + ShortestFloat(d) + "\n";
    const double zeta = d / 2, root = std::sqrt(1 - zeta * zeta);
    const LawRun run(Step(law));
    const double overshoot_m = 10 * std::exp(-std::numbers::pi * zeta / root);
    EXPECT_NEAR(run.Predicted("overshoot_m"), overshoot_m, 0.01 * overshoot_m + 1e-3) << d << ": 1 % for the hold";
    EXPECT_NEAR(run.Measured("overshoot_m"), run.Predicted("overshoot_m"), 0.02) << d;
    EXPECT_NEAR(run.Measured("settling_time_s"), run.Predicted("settling_time_s"), 0.03) << d;
    EXPECT_LE(run.Predicted("settling_time_s"), std::log(50 / root) / zeta + 0.1) << d << ": the envelope is above";
    EXPECT_NEAR(run.Measured("tracking_rms_m"), run.Predicted("tracking_rms_m"), 2e-3) << d;
    EXPECT_EQ(run.Law()["bounds"]["overshoot_m"], "equal");
  }
}

TEST(Waypoints, TheHoldOfTheCommandIsPartOfThePrediction) {
  // At 5 Hz with p = 4, d = 2 the sampled response has z^2 - (2 - h d - h^2 p / 2) z + 1 - h d + h^2 p / 2.
  const LawRun run(Step(kTenMetres + "p_gain = 4.0\nd_gain = 2.0\n"));
  const LawRun slow(
      "[control]\nrate_hz = 5\n[physics]\nrate_hz = 10000\n[run]\nduration_s = 30\n[agents]\ncount = 1\n"
      "model = 'double_integrator'\nposition_m = [[0, 0, 1]]\n[law]\nname = 'waypoint'\naxes = 'xy'\n"
      "waypoints_m = [[0.5, 0, 1]]\np_gain = 4.0\nd_gain = 2.0\n");
  EXPECT_GT(slow.Predicted("overshoot_m") / 0.5, 1.2 * run.Predicted("overshoot_m") / 10) << "the hold destabilises";
  EXPECT_NEAR(slow.Measured("overshoot_m"), slow.Predicted("overshoot_m"), 1e-3);
  EXPECT_NEAR(slow.Measured("tracking_rms_m"), slow.Predicted("tracking_rms_m"), 1e-3);
}

TEST(Waypoints, EachHasItsTimeOfArrivalWhichIsThatOfTheLastAgent) {
  const std::string two =
      "[run]\nduration_s = 25\n[agents]\ncount = 2\nmodel = 'double_integrator'\n"
      "position_m = [[0, 0, 1], [0, 9, 5]]\n[physics]\ncollisions = false\n[control]\n"
      "max_acceleration_m_per_s2 = 100\n[law]\nname = 'waypoint'\nd_gain = 2.0\n"
      "waypoints_m = [[4, 0, 1], [4, 8, 1], [90, 8, 1]]\n";
  const LawRun run(two);
  const auto& arrivals = run.Law()["arrival_time_s"];
  ASSERT_EQ(arrivals.size(), 3u);
  // From rest and critically damped, the distance is D (1 + t) exp(-t); agent 2 has D = sqrt(16 + 81 + 16).
  const double t_s = arrivals[0].get<double>();
  EXPECT_NEAR(std::sqrt(113.) * (1 + t_s) * std::exp(-t_s), 0.2, 0.01);
  EXPECT_GT(arrivals[1].get<double>(), t_s + 1.0) << "dwell_s = 1 lies between";
  for (std::size_t n = 0; n < 3; ++n)
    EXPECT_NEAR(arrivals[n].get<double>(), run.Law()["predicted"]["arrival_time_s"][n].get<double>(), 0.03) << n;
  EXPECT_NEAR(run.Measured("overshoot_m"), 0, 0.02) << "critically damped";
  const LawRun cut(two + "[[events]]\nat_s = 12\ngoto = { agent = 1, position_m = [0, 0, 1] }\n");
  EXPECT_EQ(cut.Law()["arrival_time_s"].size(), 3u) << "agent 2 still flies the list";
  EXPECT_TRUE(cut.Law()["predicted"]["arrival_time_s"].is_null());
}

TEST(Waypoints, WithoutDwellingAndByTimeTheyAreReachedToo) {
  const std::string list = "waypoints_m = [[2, 0, 1], [4, 0, 1]]\nd_gain = 2.0\n";
  const LawRun prompt(Step(list + "dwell_s = 0\n"));
  EXPECT_GT(prompt.Law()["arrival_time_s"][0].get<double>(), 1);
  EXPECT_GT(prompt.Law()["arrival_time_s"][1].get<double>(), prompt.Law()["arrival_time_s"][0].get<double>());
  const LawRun timed(Step(list + "times_s = [1.0, 2.0]\n"));
  EXPECT_TRUE(timed.Law()["arrival_time_s"][0].is_null()) << "one second is too short";
  EXPECT_GT(timed.Law()["arrival_time_s"][1].get<double>(), 2);
  EXPECT_NEAR(timed.Measured("settling_time_s"), timed.Predicted("settling_time_s"), 0.03) << "from 2 s on";
}

TEST(Waypoints, QuadrotorsAreMeasuredBesideTheIdealBody) {
  const LawRun run(Step(kTenMetres + "p_gain = 0.3\nd_gain = 0.8\n", "", "quadrotor"));
  EXPECT_NEAR(run.Measured("overshoot_m"), run.Predicted("overshoot_m"), 0.5);
  EXPECT_NEAR(run.Measured("settling_time_s"), run.Predicted("settling_time_s"), 1.0);
}

TEST(Waypoints, TheoryIsSilentWhereALimitCutsTheResponse) {
  const LawRun cut(Step(kTenMetres, "[[agents.override]]\nid = 1\ncontrol = { max_acceleration_m_per_s2 = 1.0 }\n"));
  EXPECT_EQ(cut.prediction.silent, "the limit of the acceleration cuts what the law asks for");
}

TEST(Waypoints, HaveColumnsInSweeps) {
  const auto names = SweepMetricNames({"waypoint"});
  EXPECT_THAT(names, Contains("laws.waypoint.overshoot_m"));
  EXPECT_THAT(names, Contains("laws.waypoint.predicted.settling_time_s"));
  const LawRun run(Step(kTenMetres));
  EXPECT_EQ(std::stod(SweepMetrics(run.summary.dump(), names).at("laws.waypoint.tracking_rms_m")),
            run.Measured("tracking_rms_m"));
}

}  // namespace
}  // namespace mascot
