// Predictions are of the team as it is sampled, from the experiment's own start: commands are held for a control
// period.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/law_run.h"

namespace mascot {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A team that starts at random places in a box of 10 m, on a connected graph.
class RandomTeams {
 public:
  explicit RandomTeams(unsigned seed) : random_(seed) {}
  double In(double least, double most) { return std::uniform_real_distribution<double>(least, most)(random_); }
  int Count(int least, int most) { return std::uniform_int_distribution<int>(least, most)(random_); }
  std::string Toml(int count, double duration_s, const std::string& model, const std::string& law, int rate_hz = 100) {
    std::string positions;
    for (int i = 0; i < count; ++i) positions += fmt::format("[{:.3f}, {:.3f}, {}], ", In(-5, 5), In(-5, 5), 1 + 3 * i);
    static constexpr const char* kTopologies[] = {"path", "ring", "star", "complete"};
    return fmt::format(
        "[run]\nduration_s = {}\n[physics]\ncollisions = false\nground = false\n[control]\nrate_hz = {}\n"
        "max_speed_m_per_s = 1000.0\nmax_acceleration_m_per_s2 = 1000.0\n"
        "[agents]\ncount = {}\nmodel = '{}'\nposition_m = [{}]\n[graph]\ntopology = '{}'\n[law]\n{}",
        duration_s, rate_hz, count, model, positions, kTopologies[Count(0, 3)], law);
  }

 private:
  std::mt19937 random_;
};

std::string Placed(const std::string& positions, double duration_s, const std::string& graph, const std::string& law) {
  const auto count = std::ranges::count(positions, '[');
  return fmt::format(
      "[run]\nduration_s = {}\n[physics]\ncollisions = false\nground = false\n[agents]\ncount = {}\nmodel = "
      "'single_integrator'\nposition_m = [{}]\n[graph]\n{}\n[law]\n{}",
      duration_s, count, positions, graph, law);
}

bool IsNumber(const nlohmann::json& value) { return value.is_number(); }

// --- finite time ------------------------------------------------------------------------------------------

constexpr const char* kTwentyOnAPath =
    "[0.12, 2.5, 1.0], [4.5, -2.2, 2.53], [-3.56, -0.15, 4.05], [4.49, 4.81, 5.58], [-1.88, 4.62, 7.11], [-0.77, 2.25, "
    "8.63], [3.28, 0.41, 10.16], [-0.91, -2.23, 11.68], [0.5, -3.39, 13.21], [-4.72, 4.7, 14.74], [2.54, 0.16, 16.26], "
    "[0.38, -3.84, 17.79], [-1.7, 1.23, 19.32], [2.88, 2.77, 20.84], [-1.97, 1.13, 22.37], [-0.47, 4.17, 23.89], "
    "[-3.66, -4.6, 25.42], [-0.97, 0.29, 26.95], [-2.97, -0.41, 28.47], [-2.38, -4.38, 30.0]";

/// Agents end no farther apart than is predicted, and come there when it is predicted, within two ticks or 1 %, about
/// the predicted point.
void ExpectAgreementAsPredicted(const LawRun& run, const std::string& what) {
  const auto& law = run.Law();
  EXPECT_EQ(run.prediction.silent, "") << what;
  EXPECT_EQ(law["bounds"]["band_m"], "at_most") << what;
  EXPECT_LE(run.Measured("band_m"), run.Predicted("band_m")) << what;
  if (!IsNumber(law["predicted"]["agreement_time_s"])) {
    EXPECT_THAT(run.prediction.warnings, Contains(HasSubstr("agents do not meet exactly"))) << what;
    return;
  }
  const double time_s = run.Predicted("agreement_time_s");
  if (time_s > run.experiment.run.duration_s) {
    EXPECT_FALSE(IsNumber(law["agreement_time_s"])) << what;
    return;
  }
  EXPECT_EQ(law["bounds"]["agreement_time_s"], "equal") << what;
  if (run.prediction.value_m) {
    EXPECT_LE(run.summary["consensus"]["deviation"]["value_m"].get<double>(), run.Predicted("band_m")) << what;
  }
  ASSERT_TRUE(IsNumber(law["agreement_time_s"])) << what << ": " << time_s;
  EXPECT_NEAR(run.Measured("agreement_time_s"), time_s, std::max(2.01 * run.experiment.period_s(), 0.01 * time_s))
      << what;
}

TEST(HeldCommands, BySignALongPathTremblesFartherThanWhatCountsAsTogether) {
  const LawRun run(Placed(kTwentyOnAPath, 20, "topology = 'path'", "name = 'finite_time'\nform = 'sign'\n"));
  EXPECT_TRUE(run.Law()["predicted"]["agreement_time_s"].is_null());
  EXPECT_TRUE(run.Law()["agreement_time_s"].is_null());
  EXPECT_GT(run.Measured("band_m"), 0.2);
  EXPECT_LE(run.Measured("band_m"), run.Predicted("band_m"));
  EXPECT_LT(run.Predicted("band_m"), 1.5 * run.Measured("band_m")) << "the bound is not idle";
  EXPECT_THAT(run.prediction.warnings,
              Contains(HasSubstr("control.rate_hz: agents do not meet exactly, because commands are held for 0.01 s")));
  EXPECT_THAT(run.text, HasSubstr("; theory: at most "));
}

TEST(HeldCommands, ByPowerTheLimitCycleIsPredicted) {
  const LawRun run(
      Placed("[-4.14, -0.21, 1.0], [-2.63, -3.4, 6.8], [3.01, 2.35, 12.6], [0.82, -3.86, 18.4], [-4.06, -1.09, 24.2], "
             "[-0.67, 0.17, 30.0]",
             20, "topology = 'complete'", "name = 'finite_time'\nalpha = 0.2\n"));
  EXPECT_TRUE(run.Law()["predicted"]["agreement_time_s"].is_null());
  EXPECT_TRUE(run.Law()["agreement_time_s"].is_null());
  const double cycle_m = std::pow(0.01 * 5, 1 / (1 - 0.2));  // (h gain sum_j a_ij)^(1/(1-alpha))
  EXPECT_GT(run.Measured("band_m"), 0.3 * cycle_m);
  EXPECT_LE(run.Measured("band_m"), run.Predicted("band_m"));
  EXPECT_LT(run.Predicted("band_m"), 4 * cycle_m);
  EXPECT_LT(run.summary["consensus"]["deviation"]["value_m"].get<double>(), 1e-6) << "the mean is kept";
}

TEST(HeldCommands, FiniteTimeEndsAsItsSampledFlightFromAnyStart) {
  RandomTeams teams(1);
  int timed = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const std::string law = trial % 2 == 0
                                ? fmt::format("name = 'finite_time'\nform = 'sign'\ngain = {:.3f}\n", teams.In(0.3, 3))
                                : fmt::format("name = 'finite_time'\ngain = {:.3f}\nalpha = {:.3f}\n", teams.In(0.3, 3),
                                              teams.In(0.1, 0.9));
    const LawRun run(teams.Toml(teams.Count(2, 12), std::round(teams.In(6, 12)), "single_integrator", law,
                                trial % 3 == 0 ? 20 : 100));
    ExpectAgreementAsPredicted(run, run.experiment.law.name + " " + law);
    timed += IsNumber(run.Law()["agreement_time_s"]) ? 1 : 0;
  }
  EXPECT_GT(timed, 10) << "most of them come together";
}

TEST(HeldCommands, TheSpeedLimitIsPartOfTheFlight) {
  // Two agents 8 m apart want 2 m/s, and fly 0.5 m/s.
  const LawRun run(
      "[run]\nduration_s = 12\n[physics]\ncollisions = false\n[control]\nmax_speed_m_per_s = 0.5\n[agents]\ncount = "
      "2\nmodel = 'single_integrator'\n"
      "position_m = [[-4, 0, 1], [4, 0, 1]]\n[law]\nname = 'finite_time'\nform = 'sign'\ngain = 2.0\n");
  EXPECT_NEAR(run.Predicted("agreement_time_s"), 8 - 0.08, 0.02) << "until they are 4 gain h = 0.08 m apart";
  EXPECT_NEAR(run.Measured("agreement_time_s"), run.Predicted("agreement_time_s"), 0.02);
}

TEST(HeldCommands, TheoryIsSilentAboutFiniteTimeWhereFlyingAheadIsTooMuchWork) {
  const std::string toml = RandomTeams(3).Toml(300, 100, "single_integrator", "name = 'finite_time'\n");
  std::string dense = toml;
  dense.replace(dense.find("topology = '"), dense.find('\n', dense.find("topology = '")) - dense.find("topology = '"),
                "topology = 'complete'");
  const Experiment experiment = LoadExperiment(Section::FromText(dense, "test.toml"), "test");
  EXPECT_EQ(Predict(experiment).silent, "so many agents are not flown ahead for so many ticks");
}

// --- rates ------------------------------------------------------------------------------------------------

TEST(HeldCommands, TheRateIsOfTheStartAndTheSlowestModeStandsBesideIt) {
  const LawRun run(Placed("[0, 0, 1], [3, 0, 2], [0, 0, 3]", 20, "topology = 'path'", "name = 'velocity_consensus'\n"));
  const auto& consensus = run.summary["consensus"];
  EXPECT_NEAR(*run.prediction.slowest_rate_per_s, -100 * std::log(1 - 0.01), 1e-9) << "lambda = 1";
  EXPECT_NEAR(*run.prediction.rate_per_s, -100 * std::log(1 - 0.03), 1e-6) << "this start has only lambda = 3";
  EXPECT_NEAR(consensus["rate_per_s"].get<double>(), *run.prediction.rate_per_s, 1e-6);
  EXPECT_TRUE(run.prediction.from_start);
}

TEST(HeldCommands, LinearTeamsDecayAsPredictedFromAnyStart) {
  RandomTeams teams(4);
  for (int trial = 0; trial < 24; ++trial) {
    const bool second = trial % 2 == 1;
    const std::string law = second ? fmt::format("name = 'consensus'\nbeta = {:.3f}\n", teams.In(1, 3))
                                   : fmt::format("name = 'velocity_consensus'\np_gain = {:.3f}\n", teams.In(0.5, 2));
    const LawRun run(teams.Toml(teams.Count(2, 6), std::round(teams.In(4, 40)),
                                second ? "double_integrator" : "single_integrator", law, 50));
    const auto& measured = run.summary["consensus"]["rate_per_s"];
    if (!IsNumber(measured)) continue;  // the run is too short
    ASSERT_TRUE(run.prediction.rate_per_s) << law;
    EXPECT_NEAR(measured.get<double>(), *run.prediction.rate_per_s, 1e-3 * *run.prediction.rate_per_s) << law;
  }
}

TEST(HeldCommands, WhereNoStartIsFlownOnlyTheSlowestModeIsNamed) {
  // All start at one place: there is nothing that could decay.
  const LawRun run(Placed("[0, 0, 1], [0, 0, 2], [0, 0, 3]", 5, "topology = 'path'", "name = 'velocity_consensus'\n"));
  EXPECT_FALSE(run.prediction.rate_per_s);
  EXPECT_TRUE(run.prediction.slowest_rate_per_s);
  EXPECT_THAT(run.text, HasSubstr("  predicted    in the long run at 1.005 1/s or faster (slowest mode)\n"));
}

TEST(HeldCommands, EstimatesApproachTheMinimumAtTheRateOfTheirStart) {
  // The costs are the starts' own: their sum of gradients is 0, and the slowest mode, of the mean, is not excited.
  const LawRun run(
      "[run]\nduration_s = 10.0\n[agents]\ncount = 4\nmodel = 'single_integrator'\nposition_m = [[-2.38, 1.0, 1.0], "
      "[-2.02, 2.29, 10.67], [3.14, -3.12, 20.33], [-4.08, -4.45, 30.0]]\n[law]\nname = 'gradient_tracking'\n");
  EXPECT_GT(run.Predicted("rate_per_s"), 100);
  EXPECT_DOUBLE_EQ(run.Measured("rate_per_s"), run.Predicted("rate_per_s"));
  EXPECT_THAT(run.text, HasSubstr("; slowest mode 5.129"));
}

TEST(HeldCommands, EstimatesApproachTheMinimumAsPredictedFromAnyStart) {
  RandomTeams teams(5);
  for (int trial = 0; trial < 16; ++trial) {
    const int count = teams.Count(2, 6);
    std::string minima;
    for (int i = 0; i < count; ++i) minima += fmt::format("[{:.2f}, {:.2f}, 1], ", teams.In(-4, 4), teams.In(-4, 4));
    const std::string law = fmt::format("name = 'gradient_tracking'\nstep = {:.3f}\n{}", teams.In(0.02, 0.2),
                                        trial % 2 == 0 ? "" : "targets_m = [" + minima + "]\n");
    const LawRun run(teams.Toml(count, 20, "single_integrator", law));
    if (!IsNumber(run.Law()["predicted"]["rate_per_s"])) continue;  // unstable, or too far from the origin
    if (run.prediction.holds_from->time_s > run.experiment.run.duration_s) {
      EXPECT_FALSE(IsNumber(run.Law()["rate_per_s"])) << law;
      continue;
    }
    // The last tick with 1e-12 of the start may be rounded one way or the other.
    EXPECT_NEAR(run.Measured("rate_per_s") / run.Predicted("rate_per_s"), 1, 0.05) << law;
  }
}

// --- when it holds ----------------------------------------------------------------------------------------

constexpr const char* kThreeApart = "[0, 0, 1], [5, 0, 2], [9, 3, 3]";

TEST(HeldCommands, TheLagOfFollowersAtTheEndIsThatOfTheStart) {
  RandomTeams teams(6);
  for (int trial = 0; trial < 16; ++trial) {
    const std::string law = fmt::format("name = 'containment'\nleaders = [1, 2]\ngain = {:.3f}\n{}", teams.In(0.1, 2),
                                        trial % 2 == 0 ? "" : "leader_velocities_m_per_s = [[0.3, -0.2, 0]]\n");
    const LawRun run(teams.Toml(teams.Count(3, 8), std::round(teams.In(1, 30)), "single_integrator", law));
    EXPECT_NEAR(run.Measured("lag_m"), run.Predicted("lag_m"), 1e-9) << law;
  }
}

TEST(HeldCommands, ARunThatEndsBeforeWhatTheoryExpectsIsWarnedOf) {
  for (const char* law :
       {"name = 'containment'\nleaders = [1]\ngain = 0.3\n", "name = 'finite_time'\ngain = 0.2\n",
        "name = 'finite_time'\nform = 'sign'\ngain = 0.2\n", "name = 'velocity_consensus'\n",
        "name = 'pursuit_evasion'\nleader = 1\ncapture_radius_m = 0.1\n", "name = 'gradient_tracking'\n"}) {
    const auto warnings = [&](double duration_s) {
      const std::string toml = Placed(kThreeApart, duration_s, "topology = 'complete'", law);
      return Predict(LoadExperiment(Section::FromText(toml, "test.toml"), "test")).warnings;
    };
    EXPECT_THAT(warnings(0.1), Contains(HasSubstr("run.duration_s: the run ends after 0.1 s"))) << law;
    EXPECT_THAT(warnings(200), Not(Contains(HasSubstr("run.duration_s")))) << law;
  }
}

TEST(HeldCommands, ARunThatIsLongerThanTheExactTimeIsNotWarnedOfABound) {
  // The bound of Wang & Xiao is several times as long as these agents need.
  const LawRun run(Placed(kThreeApart, 6, "topology = 'complete'", "name = 'finite_time'\n"));
  EXPECT_LT(run.Predicted("agreement_time_s"), 6);
  EXPECT_THAT(run.prediction.warnings, IsEmpty());
}

TEST(HeldCommands, OfABoundTheWarningSaysThatItIsOne) {
  // Two pursuers: the first captures after at most (5 - 0.1) / 0.4 s, a tick more by rounding, and perhaps sooner.
  const auto warnings = [](double duration_s) {
    return LawRun(Placed(kThreeApart, duration_s, "topology = 'complete'",
                         "name = 'pursuit_evasion'\nleader = 1\ncapture_radius_m = 0.1\n"))
        .prediction.warnings;
  };
  EXPECT_THAT(warnings(1),
              Contains("run.duration_s: the run ends after 1 s; what theory expects may take until 12.26 s"));
  EXPECT_THAT(warnings(13), IsEmpty());
}

TEST(HeldCommands, AnEvaderThatIsDrivenPastAnotherAgentIsCapturedSooner) {
  // Agent 2 drives agent 1 along x to agent 3, which hears no other and stands still.
  const std::string law = "name = 'pursuit_evasion'\nleader = 1\n", graph = "edges = [[2, 1], [1, 2]]";
  const LawRun past(Placed("[0, 0, 1], [-3, 0, 1], [2, 0.1, 1]", 10, graph, law));
  EXPECT_EQ(past.Law()["bounds"]["capture_time_s"], "at_most");
  EXPECT_LT(past.Measured("capture_time_s"), 0.6 * past.Predicted("capture_time_s"));
  const LawRun free(Placed("[0, 0, 1], [-3.003, 0, 1], [2, 1, 1]", 10, graph, law));
  EXPECT_EQ(free.Law()["bounds"]["capture_time_s"], "equal");
  EXPECT_NEAR(free.Measured("capture_time_s"), free.Predicted("capture_time_s"), 0.011);
}

std::string MinMax(int rate_hz, double duration_s, const std::string& law) {
  return fmt::format(
      "[run]\nduration_s = {}\n[physics]\ncollisions = false\nground = false\n[control]\nrate_hz = {}\n"
      "max_acceleration_m_per_s2 = 1000.0\n[agents]\ncount = 3\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], "
      "[4, 1, 4], [-2, 3, 7]]\n[graph]\ntopology = 'complete'\n[law]\nname = 'minmax'\nleader = 1\n{}",
      duration_s, rate_hz, law);
}

TEST(HeldCommands, ARelayThatIsHeldTooLongIsNotPromisedToMeet) {
  const std::string law = "beta = [0.5, 2.0, 3.0]\n";
  const LawRun quick(MinMax(100, 20, law));
  EXPECT_EQ(quick.prediction.minmax_edges.size(), 2u);
  EXPECT_THAT(quick.prediction.warnings, IsEmpty());
  for (const auto& edge : quick.summary["consensus"]["minmax_edges"]) EXPECT_TRUE(IsNumber(edge["time_s"]));
  const LawRun slow(MinMax(2, 20, law));
  for (const MinmaxEdge& edge : slow.prediction.minmax_edges)
    EXPECT_TRUE(IsNumber(slow.summary["consensus"]["minmax_edges"][edge.child - 2]["time_s"])) << edge.child;
  EXPECT_LT(slow.prediction.minmax_edges.size(), 2u);
  EXPECT_THAT(slow.prediction.warnings, Contains(HasSubstr("because commands are held for 0.5 s; a higher rate, a "
                                                           "smaller beta or law.boundary_layer does it")));
}

TEST(HeldCommands, ARunOfMinMaxIsLongEnoughOnceTheChildrenAreThere) {
  const std::string law = "beta = [0.5, 2.0, 3.0]\n";
  const LawRun whole(MinMax(100, 20, law));
  double there_s = 0;
  for (const auto& edge : whole.summary["consensus"]["minmax_edges"])
    there_s = std::max(there_s, edge["time_s"].get<double>());
  ASSERT_LT(there_s + 0.05, *whole.prediction.minmax_time_s) << "within 0.05 m, which is before the closed form";
  EXPECT_THAT(LawRun(MinMax(100, there_s + 0.05, law)).prediction.warnings, IsEmpty());
  EXPECT_THAT(LawRun(MinMax(100, there_s - 0.05, law)).prediction.warnings,
              Contains(HasSubstr("run.duration_s: the run ends after")));
}

TEST(HeldCommands, WaypointsAreTimedByTheFlightAndNotByOneLeg) {
  const auto warnings = [](double duration_s, const std::string& waypoints) {
    return LawRun(fmt::format("[run]\nduration_s = {}\n[agents]\ncount = 1\nmodel = 'double_integrator'\nposition_m = "
                              "[[0, 0, 1]]\n[law]\nname = 'waypoint'\nwaypoints_m = {}\n",
                              duration_s, waypoints))
        .prediction.warnings;
  };
  EXPECT_THAT(warnings(1, "[[0, 0, 1]]"), IsEmpty()) << "it is there from the start";
  EXPECT_THAT(warnings(8, "[[1, 0, 1], [1, 1, 1], [0, 1, 1]]"),
              Contains(HasSubstr("run.duration_s: the run ends after 8 s, before what theory expects at ")));
}

}  // namespace
}  // namespace mascot
