// Laws of motion along given ways: waypoints, trajectories, platoons, pursuit. Their closed forms, on the law alone and
// in whole runs.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

#include "agent/laws/platoon/string_stability.h"
#include "agent/laws/trajectory/path_samples.h"
#include "orchestrator/sweeping/table/metrics.h"
#include "tests/experiment/fly_rows.h"
#include "tests/support/folders.h"
#include "tests/support/ideal_network.h"
#include "tests/support/law_run.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

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

/// Where the agents of a run with three quadrotors are at its end. `agents`: more lines of [agents], in which each has
/// its own targets; `law`: of [law].
std::vector<Eigen::Vector3d> EndOf(const std::string& agents, const std::string& law, const std::string& events = "") {
  const auto rows =
      Fly("[run]\nduration_s = 12\n[agents]\ncount = 3\nposition_m = [[0, 0, 2], [0, 4, 2], [0, 8, 2]]\n" + agents +
          "[law]\nname = 'waypoint'\n" + law + events);
  std::vector<Eigen::Vector3d> ends_W;
  for (const Motion& motion : rows.back().motions) ends_W.push_back(motion.p_WB);
  return ends_W;
}

TEST(Waypoints, MayBeOnesOfEachAgent) {
  const std::string each = "waypoints_m = [[[1, 0, 2]], [[0.5, 4, 2], [2, 4, 2]], [[3, 8, 3]]]\n";
  const std::string own =
      "[[agents.override]]\nid = 1\nlaw = { waypoints_m = [[1, 0, 2]] }\n"
      "[[agents.override]]\nid = 2\nlaw = { waypoints_m = [[0.5, 4, 2], [2, 4, 2]] }\n"
      "[[agents.override]]\nid = 3\nlaw = { waypoints_m = [[3, 8, 3]] }\n";
  const auto ends_W = EndOf(each, "");
  EXPECT_TRUE(ends_W.at(0).isApprox(Eigen::Vector3d(1, 0, 2), 0.05)) << ends_W[0];
  EXPECT_TRUE(ends_W.at(1).isApprox(Eigen::Vector3d(2, 4, 2), 0.05)) << ends_W[1];
  EXPECT_TRUE(ends_W.at(2).isApprox(Eigen::Vector3d(3, 8, 3), 0.05)) << ends_W[2];
  EXPECT_EQ(ends_W, EndOf(own, "waypoints_m = [[9, 9, 9]]\n")) << "as if each had them in a law table of its own";
}

TEST(Waypoints, OfEachAgentGiveWayToEventsForOneAndForAll) {
  const std::string each = "waypoints_m = [[[1, 0, 2]], [[2, 4, 2]], [[3, 8, 2]]]\n";
  const auto gone_W = EndOf(each, "", "[[events]]\nat_s = 1.0\ngoto = { agent = 2, position_m = [-1, 4, 2] }\n");
  EXPECT_TRUE(gone_W.at(1).isApprox(Eigen::Vector3d(-1, 4, 2), 0.05)) << gone_W[1];
  EXPECT_TRUE(gone_W.at(2).isApprox(Eigen::Vector3d(3, 8, 2), 0.05)) << "the others go on";
  const auto set_W =
      EndOf("model = 'double_integrator'\n" + each, "",
            "[physics]\ncollisions = false\n[[events]]\nat_s = 1.0\nset = { 'law.waypoints_m' = [[0, 2, 5]] }\n");
  for (const Eigen::Vector3d& end_W : set_W) EXPECT_TRUE(end_W.isApprox(Eigen::Vector3d(0, 2, 5), 0.05)) << end_W;
  const auto phase_W = EndOf(each, "p_gain = 0.5\n[[law.schedule]]\nat_s = 1.0\np_gain = 1.0\n");
  EXPECT_TRUE(phase_W.at(2).isApprox(Eigen::Vector3d(3, 8, 2), 0.05)) << "a phase keeps them";
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
  EXPECT_EQ(cut.prediction.figures_silent, "the limit of the acceleration cuts what the law asks for");
}

TEST(Waypoints, HaveColumnsInSweeps) {
  const auto names = SweepMetricNames({"waypoint"});
  EXPECT_THAT(names, Contains("laws.waypoint.overshoot_m"));
  EXPECT_THAT(names, Contains("laws.waypoint.predicted.settling_time_s"));
  const LawRun run(Step(kTenMetres));
  EXPECT_EQ(std::stod(SweepMetrics(run.figures).at("laws.waypoint.tracking_rms_m")), run.Measured("tracking_rms_m"));
}

// --- trajectories -----------------------------------------------------------------------------------------

/// Agents that follow a path of 3 m and 10 s, from its start; `law`: more lines of [law].
std::string Circling(const std::string& law, const std::string& more = "",
                     const std::string& model = "double_integrator", double duration_s = 40) {
  return "[run]\nduration_s = " + ShortestFloat(duration_s) + "\n[agents]\ncount = 1\nmodel = '" + model +
         "'\nposition_m = [[3, 0, 1]]\n[control]\nmax_acceleration_m_per_s2 = 100\n[law]\nname = 'trajectory'\n"
         "radius_m = 3\nperiod_s = 10\n" +
         law + more;
}

TEST(Trajectory, WithFeedForwardTheErrorGoesToZeroOnEveryPath) {
  for (const std::string path : {"circle", "figure_eight"}) {
    IdealNetwork network(Circling("path = '" + path + "'\n"));
    network.RunUntil(30);
    const LawRun run(Circling("path = '" + path + "'\n"));
    EXPECT_LT(run.Predicted("tracking_rms_m"), 1e-4) << path << ": what the hold leaves";
    EXPECT_LT(run.Measured("tracking_rms_m"), 1e-4) << path;
    EXPECT_NEAR(run.Measured("lag_s"), 0, 1e-4) << path;
    EXPECT_NEAR(run.Measured("amplitude_ratio"), 1, 1e-4) << path;
  }
  IdealNetwork network(Circling("path = 'figure_eight'\n"));
  network.RunUntil(31.25);  // an eighth of the way: (r sin 45, r sin 45 cos 45)
  EXPECT_NEAR((network.agent(1).p_WB - Eigen::Vector3d(3 * std::sqrt(0.5), 1.5, 1)).norm(), 0, 1e-3);
}

TEST(Trajectory, WithoutFeedForwardTheCircleComesOutLargerAndLate) {
  const LawRun run(Circling("feed_forward = false\n"));
  const double w = 2 * std::numbers::pi / 10;  // p = 1, d = 2: (1 + 2jw) / (1 - w^2 + 2jw)
  const double above = 1 + 4 * w * w, below = (1 + w * w) * (1 + w * w);
  EXPECT_NEAR(run.Predicted("amplitude_ratio"), std::sqrt(above / below), 5e-3) << "but for the hold";
  EXPECT_NEAR(run.Predicted("tracking_rms_m"), 3 * w * w / (1 + w * w), 0.01);
  const double phase = std::atan2(2 * w, 1 - w * w) - std::atan2(2 * w, 1);
  EXPECT_NEAR(run.Predicted("lag_s"), std::sqrt(above / below) * std::sin(phase) / w, 5e-3);
  for (const char* figure : {"tracking_rms_m", "lag_s", "amplitude_ratio"})
    EXPECT_NEAR(run.Measured(figure), run.Predicted(figure), 1e-6)
        << figure << ": the sampled loop is predicted exactly";
}

TEST(Trajectory, ThePredictionHoldsForFiguresOfEightAndSlowLoopsToo) {
  for (const std::string rate : {"10", "50"}) {
    std::string toml = Circling("path = 'figure_eight'\nfeed_forward = false\nd_gain = 1.5\n");
    toml.insert(toml.find("max_acceleration"), "rate_hz = " + rate + "\n");
    const LawRun run(toml);
    for (const char* figure : {"tracking_rms_m", "lag_s", "amplitude_ratio"})
      EXPECT_NEAR(run.Measured(figure), run.Predicted(figure), 1e-5) << rate << " " << figure;
  }
}

TEST(Trajectory, AFormationKeepsItsPlacesAlongTheWay) {
  IdealNetwork network(
      "[run]\nduration_s = 40\n[agents]\ncount = 3\nmodel = 'double_integrator'\nposition_m = "
      "[[0, 0, 1], [5, 5, 2], [-4, 1, 3]]\n[law]\nname = 'trajectory'\nperiod_s = 10\n"
      "offsets_m = [[0, 0, 0], [1, 0, 0], [0, 2, 1]]\n");
  network.RunUntil(20);
  EXPECT_LT((network.agent(2).p_WB - network.agent(1).p_WB - Eigen::Vector3d(1, 0, 0)).norm(), 1e-5);
  EXPECT_LT((network.agent(3).p_WB - network.agent(1).p_WB - Eigen::Vector3d(0, 2, 1)).norm(), 1e-5);
  EXPECT_LT((network.agent(1).p_WB - Eigen::Vector3d(2, 0, 1)).norm(), 1e-3) << "two periods of the circle";
}

TEST(Trajectory, SamplesAreFlownThroughAtTheirTimesFromRestToRest) {
  const std::string samples =
      "path = 'samples'\nsamples = \"\"\"\nt,x,y,z\n0,3,0,1\n4,5,2,2\n8, 6, -1, 3\n12,4,0,1\n\"\"\"\n";
  IdealNetwork network(Circling(samples, "", "double_integrator", 15));
  const auto at = [&](double t_s) {
    network.RunUntil(t_s);
    return network.agent(1);
  };
  EXPECT_LT((at(4).p_WB - Eigen::Vector3d(5, 2, 2)).norm(), 2e-3);
  EXPECT_LT((at(8).p_WB - Eigen::Vector3d(6, -1, 3)).norm(), 2e-3);
  EXPECT_LT((at(12).p_WB - Eigen::Vector3d(4, 0, 1)).norm(), 2e-3);
  EXPECT_LT(at(12).v_WB.norm(), 0.01) << "at rest";
  const LawRun run(Circling(samples, "", "double_integrator", 12));
  EXPECT_LT(run.Measured("tracking_rms_m"), 2e-3);
  EXPECT_EQ(run.prediction.silent, "the closed form is of circles and figures of eight");
}

TEST(Trajectory, SamplesOfAFileAreInTheResolvedExperiment) {
  const std::string path = test::SourceFolder() + "/tests/good_configs/trajectory_file.toml";
  Section document = Section::FromFile(path);
  const Experiment experiment = LoadExperiment(document, "test");
  IdealNetwork again(document.Resolved());
  EXPECT_THAT(document.Resolved(), HasSubstr("1.5,0.5,0,1.2"));
  again.RunUntil(3);
  EXPECT_GT(again.agent(1).p_WB.x(), 0.1);
}

TEST(Trajectory, AMistakeInAFileNamesTheFileAndTheLine) {
  const ScratchFolder folder;
  WriteFile(folder.File("way.csv"), "t,x,y,z\n0,0,0,1\n1,far,0,1\n");
  WriteFile(folder.File("way.toml"), Circling("path = 'samples'\nfile = 'way.csv'\n"));
  try {
    LoadExperiment(Section::FromFile(folder.File("way.toml")), "test");
    FAIL() << "it was read";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(),
                 "way.csv:3:3: law.file: expected four numbers in [-1e+06, 1e+06], t,x,y,z, got '1,far,0,1'");
  }
}

TEST(PathSamples, AreFourFiniteNumbersInEachLineAndElseItsPlaceIsNamed) {
  struct Case {
    std::string text;
    int line, column;
    const char* got;
  };
  const std::string good = "t,x,y,z\n 0 , 0,\t0,1 \r\n\n", longer(100, '1');
  for (const Case& wrong : std::vector<Case>{{"1,2,3\n", 4, 6, "'1,2,3'"},
                                             {"1,2,3,4,5\n", 4, 9, "'1,2,3,4,5'"},
                                             {"1 0,2,3,4\n", 4, 1, "'1 0,2,3,4'"},
                                             {"1,2,nan,4\n", 4, 5, "'1,2,nan,4'"},
                                             {"1,2,3,inf\n", 4, 7, "'1,2,3,inf'"},
                                             {"1,2,3,1e7\n", 4, 7, "'1,2,3,1e7'"},
                                             {"1,1e999,3,4\n", 4, 3, "'1,1e999,3,4'"},
                                             {"1,,3,4\n", 4, 3, "'1,,3,4'"},
                                             {"1;2;3;4\n", 4, 1, "'1;2;3;4'"},
                                             {"1,+2,3,4\n", 4, 3, "'1,+2,3,4'"},
                                             {"1,0x2,3,4\n", 4, 3, "'1,0x2,3,4'"},
                                             {"t,x,y,z\n", 4, 1, "'t,x,y,z'"},
                                             {longer + "\n", 4, 1, "'1111"},
                                             {"1,2,3," + longer + "\n", 4, 7, "'1,2,3,1111"},
                                             {"0,2,3,4\n", 4, 1, "times that increase, got '0,2,3,4'"},
                                             {"", 3, 1, "two lines t,x,y,z, got 1"}}) {
    PathSamples samples;
    TextPlace place;
    const std::string mistake = samples.Read(good + wrong.text, place);
    EXPECT_THAT(mistake, HasSubstr(wrong.got)) << wrong.text;
    EXPECT_LT(mistake.size(), 150U) << wrong.text;
    EXPECT_EQ(place.line, wrong.line) << wrong.text;
    EXPECT_EQ(place.column, wrong.column) << wrong.text;
  }
  PathSamples samples;
  TextPlace place;
  EXPECT_EQ(samples.Read(good + "1.5,-2e-1,3,4", place), "");
  EXPECT_EQ(samples.duration_s(), 1.5);
}

TEST(Trajectory, FliesOnQuadrotorsAndSingleIntegrators) {
  const LawRun quadrotor(Circling("", "", "quadrotor"));
  EXPECT_LT(quadrotor.Measured("tracking_rms_m"), 0.25);
  const LawRun single(Circling("", "", "single_integrator"));
  EXPECT_LT(single.Measured("tracking_rms_m"), 0.05);
  EXPECT_EQ(single.prediction.silent, "the closed form is of double integrators");
}

TEST(Trajectory, TheoryIsSilentWhereTheLongRunIsNotReached) {
  EXPECT_EQ(LawRun(Circling("", "", "double_integrator", 11)).prediction.silent,
            "the run ends before the start has been forgotten for a period");
  EXPECT_EQ(LawRun(Circling("p_gain = 0.0\n", "", "double_integrator", 1)).prediction.silent,
            "the loop of law.p_gain and law.d_gain does not decay");
  EXPECT_EQ(LawRun(Circling("", "[[agents.override]]\nid = 1\ncontrol = { max_acceleration_m_per_s2 = 1.0 }\n"))
                .prediction.silent,
            "the limit of the acceleration cuts what the trajectory takes");
}

// --- platoons ---------------------------------------------------------------------------------------------

/// A platoon of four with the gains and the vehicle of Ploeg et al. (2011, 2014) that starts with its distances at 5
/// m/s. `law`: more lines of [law]; `more`: of other tables.
std::string Driving(double headway_s, const std::string& law = "", const std::string& model = "double_integrator",
                    double period_s = 10, const std::string& more = "") {
  std::string positions, velocities;
  for (int i = 0; i < 4; ++i) {
    positions += (i == 0 ? "[" : ", [") + ShortestFloat(-i * (3 + 5 * headway_s)) + ", 0, 1]";
    velocities += i == 0 ? "[5, 0, 0]" : ", [5, 0, 0]";
  }
  return "[run]\nduration_s = 90\n[agents]\ncount = 4\nmodel = '" + model + "'\nposition_m = [" + positions +
         "]\nvelocity_m_per_s = [" + velocities + "]\n[graph]\ntopology = 'directed_path'\n" + more +
         "[law]\nname = 'platoon'\nspacing_m = 3\np_gain = 0.2\nd_gain = 0.7\ndisturbance_period_s = " +
         ShortestFloat(period_s) + "\nheadway_s = " + ShortestFloat(headway_s) + "\n" + law;
}

/// The published controller and vehicle, sampled every `h` seconds; messages are `theta_s` old, 0: there are none.
Following Published(double headway_s, double theta_s, double h = 1e-3) {
  return {.p = 0.2,
          .d = 0.7,
          .headway_s = headway_s,
          .lag_s = 0.1,
          .feed_forward = theta_s > 0,
          .message_ticks = std::max(1, static_cast<int>(std::lround(theta_s / h))),
          .h = h};
}

/// |Gamma(jw)| as the paper has it, without sampling.
double GammaOf(const Following& law, double w) {
  using Complex = std::complex<double>;
  const Complex s(0, w), g = std::exp(-law.delay_ticks * law.h * s) / (s * s * (law.lag_s * s + 1.0));
  const Complex k = law.p + law.d * s + law.dd * s * s;
  const Complex d = law.feed_forward ? std::exp(-law.message_ticks * law.h * s) : Complex(0);
  return std::abs((g * k + d) / (1.0 + g * k) / (law.headway_s * s + 1.0));
}

TEST(Platoon, ThePublishedLeastHeadwaysAreThoseFromWhichOnTheStringIsStable) {
  for (const auto& [theta_s, published_s] : {std::pair(0.0, 3.16), std::pair(0.15, 0.67)}) {
    const StringStability string(Published(published_s, theta_s));
    EXPECT_NEAR(string.MinHeadway_s().value_or(0), published_s, 0.005) << "published with two decimals";
    EXPECT_NEAR(string.LargestGain(), 1, 2e-4) << published_s;
    EXPECT_EQ(StringStability(Published(published_s + 0.01, theta_s)).LargestGain(), 1) << published_s;
    EXPECT_GT(StringStability(Published(published_s - 0.05, theta_s)).LargestGain(), 1 + 1e-6) << published_s;
    EXPECT_GT(StringStability(Published(0, theta_s)).LargestGain(), 1.01) << "a constant spacing never does";
  }
}

TEST(Platoon, WithoutMessagesLagAndDelayOfTheVehicleDoNotChangeTheLeastHeadway) {
  for (const double lag_s : {0.0, 0.1, 0.3})
    for (const int delay_ticks : {0, 200}) {
      Following law = Published(1, 0);
      law.lag_s = lag_s;
      law.delay_ticks = delay_ticks;
      EXPECT_NEAR(StringStability(law).MinHeadway_s().value_or(0), std::sqrt(2 / 0.2), 1e-3) << lag_s << delay_ticks;
    }
}

TEST(Platoon, TheSampledStringTendsToThePublishedTransferFunction) {
  for (const double dd : {0.0, 0.3})
    for (const double theta_s : {0.0, 0.02, 0.15}) {
      Following law = Published(0.7, theta_s, 1e-5);
      law.dd = dd;
      law.delay_ticks = 5000;
      for (const double w : {0.01, 0.3, 1.0, 3.0, 10.0})
        EXPECT_NEAR(StringStability(law).Gain(w), GammaOf(law, w), 5e-4) << dd << " " << theta_s << " " << w;
    }
}

TEST(Platoon, TheLargestGainIsThatOfASearchOverAllFrequencies) {
  for (const double headway_s : {0.0, 0.3, 2.0})
    for (const double h : {0.01, 0.1})
      for (const double theta_s : {0.0, 0.1, 0.5}) {
        const StringStability string(Published(headway_s, theta_s, h));
        double largest = 1;
        for (int k = 1; k * 2e-3 < std::numbers::pi / h; ++k) largest = std::max(largest, string.Gain(k * 2e-3));
        EXPECT_NEAR(string.LargestGain(), largest, 2e-5) << headway_s << " " << h << " " << theta_s;
      }
}

TEST(Platoon, AVehicleForgetsItsStartIffItsLagIsShortEnoughForTheGains) {
  for (const double theta_s : {0.0, 0.15})
    for (const double headway_s : {0.0, 0.7}) {
      Following law = Published(headway_s, theta_s, 1e-4);
      law.lag_s = 0.99 * law.d / law.p;  // Routh: s^2 (tau s + 1) + d s + p has its zeros on the left iff d > p tau
      EXPECT_TRUE(StringStability(law).Decays()) << headway_s;
      law.lag_s = 1.01 * law.d / law.p;
      EXPECT_FALSE(StringStability(law).Decays()) << headway_s;
    }
  Following late = Published(0.7, 0, 1e-3);
  late.lag_s = 0;
  const double crossing = std::sqrt((0.49 + std::sqrt(0.49 * 0.49 + 4 * 0.04)) / 2);  // |p + j d w| = w^2
  const double margin_s = std::atan2(0.7 * crossing, 0.2) / crossing;                 // delay margin of (d s + p) / s^2
  late.delay_ticks = static_cast<int>(0.98 * margin_s / late.h);
  EXPECT_TRUE(StringStability(late).Decays());
  late.delay_ticks = static_cast<int>(1.02 * margin_s / late.h);
  EXPECT_FALSE(StringStability(late).Decays());
}

TEST(Platoon, SwingsGrowOrShrinkByThePredictedFactorFromVehicleToVehicle) {
  const std::vector<std::string> laws = {"feed_forward = false\n", "", "message_delay_s = 0.15\n",
                                         "actuator_delay_s = 0.2\nactuator_lag_s = 0.3\n",
                                         "actuator_lag_s = 0.0\ndd_gain = 0.5\nfeed_forward = false\n"};
  for (const double headway_s : {0.0, 0.7})
    for (const std::string& law : laws) {
      const LawRun run(Driving(headway_s, law));
      const auto& predicted = run.Law()["predicted"]["amplification"];
      const auto& measured = run.Law()["amplification"];
      ASSERT_EQ(measured.size(), 3u);
      ASSERT_EQ(predicted.size(), 3u) << headway_s << law;
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(measured[i].get<double>(), predicted[i].get<double>(), 2e-4) << headway_s << law << i + 1;
      EXPECT_EQ(run.Law()["bounds"]["string_gain"], "at_most");
      EXPECT_LE(run.Measured("string_gain"), run.Predicted("string_gain") + 2e-4) << headway_s << law;
      EXPECT_NEAR(run.Measured("least_gap_m"), run.Predicted("least_gap_m"), 1e-6) << headway_s << law;
      const bool is_stable = headway_s >= run.Predicted("least_headway_s");
      EXPECT_EQ(run.Predicted("string_gain") < 1 + 1e-6, is_stable) << headway_s << law << "; tolerance: rounding";
      EXPECT_EQ(run.prediction.warnings.empty(), is_stable) << headway_s << law;
    }
}

TEST(Platoon, WithoutMessagesASlowSwingGrowsAndWithThemItShrinks) {
  const double w = 2 * std::numbers::pi / 15;
  const LawRun alone(Driving(0.8, "feed_forward = false\n", "double_integrator", 15));
  EXPECT_NEAR(alone.Measured("string_gain"), GammaOf(Published(0.8, 0), w), 5e-3) << "but for the period";
  EXPECT_GT(alone.Measured("string_gain"), 1.15);
  EXPECT_FALSE(alone.experiment.agents.front().sends_messages);
  EXPECT_THAT(alone.prediction.warnings, Contains(HasSubstr("the string is not stable: swings grow by up to 1.20")));
  EXPECT_THAT(alone.prediction.warnings, Contains(HasSubstr("a headway of 3.162 s would do")));
  const LawRun talking(Driving(0.8, "", "double_integrator", 15));
  EXPECT_LT(talking.Measured("string_gain"), 0.97);
  EXPECT_NEAR(talking.Predicted("string_gain"), 1, 1e-6) << "but for rounding";
  EXPECT_TRUE(talking.experiment.agents.front().sends_messages);
}

TEST(Platoon, AgentOneSwingsByTheDisturbanceWhateverTheLagOfItsVehicle) {
  for (const std::string lag :
       {"actuator_lag_s = 0.0\n", "actuator_lag_s = 0.5\n", "actuator_lag_s = 0.2\nactuator_delay_s = 0.3\n"}) {
    IdealNetwork network(Driving(0.7, lag));
    double largest = 0;
    network.RunUntil(60);
    for (int n = 0; n < 1000; ++n) {
      network.Step();
      largest = std::max(largest, std::abs(network.agent(1).v_WB.x() - 5));
    }
    EXPECT_NEAR(largest, 0.5, 1e-3) << lag;
  }
}

TEST(Platoon, UntilTheStartIsForgottenTheGrowthOfTheSwingIsNotPredictedNorSetAgainstABound) {
  int predicted = 0, silent = 0;
  for (const double headway_s : {0.2, 1.5})
    for (const double p : {0.05, 1.0})
      for (const double d : {0.1, 0.5})
        for (const std::string feed : {"true", "false"}) {
          std::string toml = Driving(headway_s, "feed_forward = " + feed + "\nactuator_lag_s = 0.02\n");
          toml.replace(toml.find("p_gain = 0.2"), 12, "p_gain = " + ShortestFloat(p));
          toml.replace(toml.find("d_gain = 0.7"), 12, "d_gain = " + ShortestFloat(d));
          toml.replace(toml.find("duration_s = 90"), 15, "duration_s = 100");
          toml.replace(toml.find("[5, 0, 0]]"), 10, "[6, 0, 0]]");  // the last starts too fast
          toml += "disturbance_m_per_s = 0.2\n";
          toml.insert(0, "[physics]\ncollisions = false\n[control]\nmax_acceleration_m_per_s2 = 100\n");
          const LawRun run(toml);
          const std::string at = ShortestFloat(headway_s) + " " + ShortestFloat(p) + " " + ShortestFloat(d) + feed;
          ASSERT_EQ(run.prediction.silent + run.prediction.figures_silent, "") << at;
          EXPECT_NEAR(run.Measured("least_gap_m"), run.Predicted("least_gap_m"), 1e-6) << at;
          if (run.Law()["predicted"]["amplification"].is_null()) {
            EXPECT_TRUE(run.Law()["predicted"]["string_gain"].is_null()) << at;
            EXPECT_THAT(run.prediction.warnings, Contains(HasSubstr("before the start has been forgotten"))) << at;
            ++silent;
            continue;
          }
          EXPECT_LE(run.Measured("string_gain"), run.Predicted("string_gain") + 2e-4) << at;
          ++predicted;
        }
  EXPECT_GE(predicted, 3);
  EXPECT_GE(silent, 3);
}

TEST(Platoon, ARunShorterThanTwoPeriodsOfTheSwingIsNeitherMeasuredNorPredicted) {
  const auto amplification = [](double period_s) {
    const LawRun run(Driving(0.8, "", "double_integrator", period_s));
    const auto& law = run.Law();
    return std::pair(law["amplification"][0].is_null(), law["predicted"]["amplification"].is_null());
  };
  EXPECT_EQ(amplification(30), std::pair(false, false));
  EXPECT_EQ(amplification(45.1), std::pair(true, true));
}

TEST(Platoon, KeepsItsDistancesWestwardsTooAndTheSmallestIsMeasured) {
  std::string toml = Driving(0.8, "direction = 'west'\ndisturbance_m_per_s = 0.0\nspeed_m_per_s = 2\n");
  IdealNetwork network(toml);
  network.RunUntil(90);
  for (int id = 2; id <= 4; ++id) {
    EXPECT_NEAR(network.agent(id).p_WB.x() - network.agent(id - 1).p_WB.x(), 3 + 0.8 * 2, 1e-3) << id;
    EXPECT_NEAR(network.agent(id).v_WB.x(), -2, 1e-4) << id;
  }
}

TEST(Platoon, AVehicleThatIsOvertakenHasANegativeGap) {
  for (const double forward : {1.0, -1.0}) {
    std::string toml = Driving(0.7, forward < 0 ? "direction = 'west'\n" : "");
    const std::string speed = ShortestFloat(5 * forward);
    const auto end = toml.find("\n[graph]"), begin = toml.find("position_m");
    toml.replace(begin, end - begin,
                 "position_m = [[0, 0, 1], [" + ShortestFloat(-6.5 * forward) + ", 0, 1], [" +
                     ShortestFloat(-13 * forward) + ", 0, 1], [" + ShortestFloat(-19.5 * forward) +
                     ", 0, 1]]\nvelocity_m_per_s = [[" + speed + ", 0, 0], [" + speed + ", 0, 0], [" + speed +
                     ", 0, 0], [" + ShortestFloat(20 * forward) + ", 0, 0]]");
    toml.insert(0, "[physics]\ncollisions = false\n[control]\nmax_acceleration_m_per_s2 = 100\n");
    const LawRun run(toml);
    EXPECT_LT(run.Measured("least_gap_m"), -1) << forward;
    EXPECT_NEAR(run.Measured("least_gap_m"), run.Predicted("least_gap_m"), 1e-6) << forward;
    toml.replace(toml.find("collisions = false"), 18, "collisions = true");
    const auto touching = Predict(LoadExperiment(Section::FromText(toml, "test.toml"), "test"));
    EXPECT_EQ(touching.figures_silent + touching.silent, "vehicles collide") << forward;
  }
}

TEST(Platoon, AVehicleThatDoesNotHearItsPredecessorLetsGo) {
  IdealNetwork network(Driving(0.7, "actuator_lag_s = 0.0\n"));
  network.agent(2).p_WB.x() -= 5;
  for (int n = 0; n < 50; ++n) network.Step();
  Law& law = *network.laws[1];
  const double before = network.Wants()[1].x();
  EXPECT_GT(before, 0.1);
  for (int n = 1; n <= 3; ++n)
    EXPECT_NEAR(law.Want_W(0, network.agent(2), {}).x(), before * std::exp(-0.01 * n / 0.7), 1e-12) << n;
}

TEST(Platoon, TheoryIsSilentWhereTheLoopDoesNotDecayAndWhereTheFlightIsTooLongToFlyAhead) {
  const auto silent = [](std::string toml, const std::string& duration) {
    toml.replace(toml.find("duration_s = 90"), 15, "duration_s = " + duration);
    const Prediction prediction = Predict(LoadExperiment(Section::FromText(toml, "test.toml"), "test"));
    return prediction.figures_silent + prediction.silent;
  };
  EXPECT_EQ(silent(Driving(0.7, "actuator_lag_s = 4.0\n"), "90"),
            "the loop of law.p_gain and law.d_gain does not decay");
  EXPECT_EQ(silent(Driving(0.7), "30000"),
            "so many vehicles are not flown ahead for so many ticks, to see that the start is forgotten");
}

TEST(Platoon, FliesOnQuadrotorsAndSingleIntegrators) {
  const LawRun quadrotor(Driving(0.8, "actuator_lag_s = 0.0\n", "quadrotor"));
  EXPECT_LT(quadrotor.Law()["amplification"][2].get<double>(), 1.02);
  EXPECT_EQ(quadrotor.Law()["bounds"]["amplification"], "within");
  const LawRun single(Driving(0.8, "", "single_integrator"));
  EXPECT_LT(single.Measured("string_gain"), 1);
  EXPECT_EQ(single.prediction.silent, "the closed form is of double integrators");
}

// --- pursuit and evasion ----------------------------------------------------------------------------------

/// Agent 1 flees, the others start at these places. `more`: of [law].
std::string Chase(const std::string& positions, int agents, const std::string& more = "",
                  const std::string& model = "single_integrator") {
  return "[run]\nduration_s = 30\n[physics]\ncollisions = false\n[agents]\ncount = " + std::to_string(agents) +
         "\nmodel = '" + model + "'\nposition_m = " + positions + "\n[law]\nname = 'pursuit_evasion'\nleader = 1\n" +
         more;
}
const std::string kEvaderAndThree = "[[0, 0, 1], [-3, -4, 1], [7, 0, 1], [-2, 6, 1]]";

TEST(PursuitEvasion, ASinglePursuerCapturesExactlyWhenTheDifferenceOfSpeedsHasClosedTheDistance) {
  const LawRun run(Chase("[[0, 0, 1], [-3, -4, 2]]", 2, "capture_radius_m = 0.302\n"));
  EXPECT_DOUBLE_EQ(run.Predicted("capture_time_s"), 11.75)
      << "(5 - 0.302) / (1 - 0.6), at a tick: heights do not count";
  EXPECT_EQ(run.Law()["bounds"]["capture_time_s"], "equal");
  EXPECT_DOUBLE_EQ(run.Measured("capture_time_s"), 11.75);
}

TEST(PursuitEvasion, WhereRoundingDecidesAboutTheTickTheTimeIsABound) {
  const LawRun run(Chase("[[0, 0, 1], [-3, -4, 2]]", 2));
  EXPECT_NEAR(run.Predicted("capture_time_s"), 11.76, 1e-6) << "(5 - 0.3) / (1 - 0.6) = 11.75, or a tick more";
  EXPECT_EQ(run.Law()["bounds"]["capture_time_s"], "at_most");
  EXPECT_LE(run.Measured("capture_time_s"), run.Predicted("capture_time_s"));
}

TEST(PursuitEvasion, SeveralCaptureWithinTheBoundOfTheNearest) {
  const LawRun run(Chase(kEvaderAndThree, 4));
  EXPECT_NEAR(run.Predicted("capture_time_s"), 11.76, 1e-6) << "11.75, or a tick more by rounding";
  EXPECT_EQ(run.Law()["bounds"]["capture_time_s"], "at_most");
  EXPECT_LT(run.Measured("capture_time_s"), 11.75);
  EXPECT_LE(run.Measured("closest_m"), 0.3);
}

TEST(PursuitEvasion, EachPursuerComesCloserAtEveryTickByTheDifferenceOfSpeedsAtLeast) {
  IdealNetwork network(Chase(kEvaderAndThree, 4));
  const auto distance_m = [&](int id) { return (network.agent(id).p_WB - network.agent(1).p_WB).norm(); };
  for (int k = 0; k < 500; ++k) {
    const double before[] = {distance_m(2), distance_m(3), distance_m(4)};
    if (*std::min_element(std::begin(before), std::end(before)) <= 0.3) break;
    network.Step();
    for (int id = 2; id <= 4; ++id) ASSERT_LE(distance_m(id), before[id - 2] - 0.004 + 1e-12) << id << " " << k;
  }
}

TEST(PursuitEvasion, ASlowPursuerNeverCapturesAndTheorySaysNothing) {
  const LawRun run(Chase("[[0, 0, 1], [-3, -4, 1]]", 2, "evader_speed_m_per_s = 1.1\n"));
  EXPECT_TRUE(run.Law()["capture_time_s"].is_null());
  EXPECT_EQ(run.prediction.silent, "pursuers are not faster than the evader");
  EXPECT_NEAR(run.Measured("closest_m"), 5, 1e-9) << "at the start";
  EXPECT_EQ(LawRun(Chase(kEvaderAndThree, 4, "capture_radius_m = 0.005\n")).prediction.silent,
            "a pursuer may fly past the evader within a tick");
}

TEST(PursuitEvasion, WhoDoesNotHearTheEvaderStaysWhereItIs) {
  IdealNetwork network(Chase(kEvaderAndThree, 4) + "[graph]\nedges = [[1, 2], [2, 1], [1, 3]]\n");
  network.RunUntil(3);
  EXPECT_EQ(network.agent(3).p_WB, Eigen::Vector3d(7, 0, 1));
  EXPECT_NEAR((network.agent(2).p_WB - Eigen::Vector3d(-3, -4, 1)).norm(), 3, 1e-9);
}

TEST(PursuitEvasion, QuadrotorsAndDoubleIntegratorsCaptureTooALittleLater) {
  for (const std::string model : {"quadrotor", "double_integrator"}) {
    const LawRun run(Chase("[[0, 0, 1], [-3, -4, 1]]", 2, "", model));
    EXPECT_NEAR(run.Measured("capture_time_s"), 11.75, 2) << model;
    EXPECT_NEAR(run.Measured("capture_time_s"), run.Predicted("capture_time_s"), 0.5) << model;
    EXPECT_EQ(run.Law()["bounds"]["capture_time_s"], "within") << model;
  }
}

}  // namespace
}  // namespace mascot
