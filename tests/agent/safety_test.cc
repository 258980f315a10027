// The safety filter around any law: what it promises, on ideal bodies and in whole runs, and what is said of it.
#include "agent/safety.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "agent/agent.h"
#include "orchestrator/report/prediction_report.h"
#include "orchestrator/team/ideal_team.h"
#include "tests/support/folders.h"
#include "tests/support/law_run.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using PlaceList = std::vector<Eigen::Vector3d>;

std::string List(const PlaceList& places) {
  std::string text;
  for (const Eigen::Vector3d& p : places)
    text += "[" + ShortestFloat(p.x()) + ", " + ShortestFloat(p.y()) + ", " + ShortestFloat(p.z()) + "], ";
  return "[" + text + "]";
}

/// `count` places on a circle, of which each is `skew_m` farther out than the one before.
PlaceList Circle(int count, double radius_m, double skew_m = 0) {
  PlaceList places;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * k / count, r = radius_m + skew_m * k;
    places.emplace_back(r * std::cos(angle), r * std::sin(angle), 2);
  }
  return places;
}

/// Agents of `model` at these places, which all hear each other. `law`: lines from [law] on. `more`: tables in front.
std::string TeamOf(const std::string& model, const PlaceList& places, const std::string& law,
                   const std::string& more = "", const std::string& agents = "", double duration_s = 10) {
  return "[run]\nduration_s = " + ShortestFloat(duration_s) + "\n" + more +
         "[agents]\ncount = " + std::to_string(places.size()) + "\nmodel = '" + model +
         "'\nposition_m = " + List(places) + "\n" + agents + "[graph]\ntopology = 'complete'\n[law]\n" + law;
}

const std::string kMeet = "name = 'velocity_consensus'\np_gain = 5.0\n";            // of single integrators
const std::string kMeetByForce = "name = 'consensus'\np_gain = 5.0\nbeta = 1.0\n";  // of double integrators
const std::string kNoBodies = "[physics]\ncollisions = false\n";

std::string Safety(double distance_m, double gamma = 1) {
  return "safety = { distance_m = " + ShortestFloat(distance_m) + ", gamma = " + ShortestFloat(gamma) + " }\n";
}

Experiment Read(const std::string& toml) { return LoadExperiment(Section::FromText(toml, "test.toml"), "test"); }

double Distance_m(const IdealTeam& team, int i, int j) { return (team.p_W(i) - team.p_W(j)).norm(); }

/// The smallest distance (m) between two agents over all ticks, on ideal bodies.
double MinDistance_m(const std::string& toml) {
  const Experiment experiment = Read(toml);
  IdealTeam team(experiment);
  double min_m = Distance_m(team, 1, 2);
  for (std::int64_t tick = 0; tick < experiment.ticks(); ++tick) {
    team.Step();
    for (int i = 1; i <= experiment.size(); ++i)
      for (int j = 1; j < i; ++j) min_m = std::min(min_m, Distance_m(team, i, j));
  }
  return min_m;
}

// --- driven by velocity -----------------------------------------------------------------------------------

TEST(SafetyOfVelocities, LosesTheBarrierAtItsRateGammaWhenTwoAgentsHeadForEachOther) {
  const double gamma = 1.5, D = 1, h0 = 5 * 5 - D * D;
  const Experiment experiment = Read(TeamOf("single_integrator", {{0, 0, 2}, {3, 4, 2}},
                                            "name = 'velocity_consensus'\np_gain = 100.0\n" + Safety(D, gamma)));
  const double T = experiment.period_s();
  IdealTeam team(experiment);
  double d = 5;
  for (int tick = 1; tick <= 500; ++tick) {
    team.Step();
    d -= 2 * T * gamma * (d * d - D * D) / (4 * d);  // both close with their share gamma h / 4 d
    ASSERT_NEAR(Distance_m(team, 1, 2), d, 1e-12) << tick;
    const double h = d * d - D * D, t = tick * T;
    EXPECT_GE(h, h0 * std::pow(1 - gamma * T, tick)) << "the bound with commands held for a tick";
    EXPECT_LE(h, h0 * std::exp(-gamma * t));
    EXPECT_GE(h, h0 * std::exp(-gamma * t) * (1 - gamma * gamma * T * t)) << "the bound of continuous time";
  }
}

TEST(SafetyOfVelocities, KeepsTheDistanceAndTheRateOfEveryPairInACrowd) {
  for (const char* axes : {"axes = 'xy'\n", "axes = 'xyz'\n"}) {
    PlaceList places = Circle(8, 3, 0.2);
    for (std::size_t k = 0; k < places.size(); k += 2) places[k].z() = 4;
    const Experiment experiment = Read(TeamOf("single_integrator", places, kMeet + axes + Safety(1, 2)));
    IdealTeam team(experiment);
    double min_m = 10;
    for (int tick = 0; tick < 400; ++tick) {
      std::vector<double> before;
      const auto each = [&](auto visit) {
        for (int i = 1; i <= 8; ++i)
          for (int j = 1; j < i; ++j) visit(Along(experiment.law.axes, team.p_W(i) - team.p_W(j)));
      };
      each([&](const Eigen::Vector3d& dp) { before.push_back(dp.squaredNorm() - 1); });
      team.Step();
      std::size_t pair = 0;
      each([&](const Eigen::Vector3d& dp) {
        min_m = std::min(min_m, dp.norm());
        ASSERT_GE(dp.squaredNorm() - 1, (1 - 2 * experiment.period_s()) * before[pair++] - 1e-9) << tick;
      });
    }
    EXPECT_GE(min_m, 1 - 1e-9);
    EXPECT_LT(min_m, 1.01) << "they were held back, and no more than needed";
  }
}

TEST(SafetyOfVelocities, IsPredictedAndMeasured) {
  const LawRun run(TeamOf("single_integrator", Circle(6, 3, 0.2), kMeet + Safety(1)));
  const auto& safety = run.summary["safety"];
  EXPECT_NEAR(safety["predicted"]["min_separation_m"].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(safety["predicted"]["min_separation_along_axes_m"], safety["predicted"]["min_separation_m"]);
  EXPECT_GE(safety["min_separation_along_axes_m"], safety["predicted"]["min_separation_along_axes_m"])
      << "to the last bit: they press against each other";
  EXPECT_TRUE(safety["predicted"]["assumes"].is_null()) << "a velocity of 0 is always safe";
  EXPECT_TRUE(safety["predicted"]["silent"].is_null());
  EXPECT_GE(safety["min_separation_m"].get<double>(), 1 - 1e-9);
  EXPECT_LT(safety["min_separation_m"].get<double>(), 1.01);
  EXPECT_GT(safety["filtered_fraction"].get<double>(), 0.5);
  EXPECT_EQ(safety["infeasible_ticks"], 0);
  EXPECT_THAT(run.text, HasSubstr("\n  predicted    at least 1.0000 m in the plane (law.safety)\n"));
  EXPECT_THAT(run.text, HasSubstr(" % of commands by law.safety; 0 ticks without a safe one\n"));
  EXPECT_EQ(run.prediction.silent, "law.safety may change what the law asks for");
  EXPECT_LT(LawRun(TeamOf("single_integrator", Circle(6, 3, 0.2), kMeet, kNoBodies))
                .summary["safety"]["min_separation_m"]
                .get<double>(),
            0.01)
      << "without it, they meet";
}

TEST(SafetyOfVelocities, FiltersTheIntegralOfALawThatWantsAccelerations) {
  const PlaceList places = {{0, 0, 2}, {6, 0, 2}};
  EXPECT_LT(MinDistance_m(TeamOf("single_integrator", places, kMeetByForce)), 0.1);
  const double min_m = MinDistance_m(TeamOf("single_integrator", places, kMeetByForce + Safety(1)));
  EXPECT_GE(min_m, 1 - 1e-9);
  EXPECT_LT(min_m, 1.01);
}

TEST(SafetyOfVelocities, LeadsAgentsThatStartTooCloseApart) {
  const Experiment experiment = Read(TeamOf("single_integrator", {{0, 0, 2}, {0.5, 0, 2}}, kMeet + Safety(1, 2)));
  IdealTeam team(experiment);
  for (int tick = 0; tick < 500; ++tick) team.Step();
  EXPECT_NEAR(Distance_m(team, 1, 2), 1, 1e-3);
}

TEST(SafetyOfVelocities, IsOfDistancesAlongTheAxesOfTheLaw) {
  // Two that want to the same place in the plane, one 2 m above the other.
  const std::string toml = TeamOf("single_integrator", {{-3, 0, 3}, {3, 0.1, 5}}, kMeet + Safety(1));
  const LawRun run(toml);
  const auto& safety = run.summary["safety"];
  const double along_m = safety["min_separation_along_axes_m"], in_space_m = safety["min_separation_m"];
  EXPECT_GE(along_m, safety["predicted"]["min_separation_along_axes_m"]);
  EXPECT_LT(along_m, 1.01) << "what is promised is what is kept, and no more";
  EXPECT_NEAR(in_space_m, std::hypot(along_m, 2), 1e-6);
  EXPECT_THAT(run.text, HasSubstr("separation     2.23"));
  EXPECT_THAT(run.text, HasSubstr(" m at least (1.00"));
  EXPECT_THAT(run.text, HasSubstr(" m in the plane), 0 collisions"));
  const LawRun free(TeamOf("single_integrator", {{-3, 0, 3}, {3, 0.1, 5}}, kMeet));
  EXPECT_LT(free.summary["safety"]["min_separation_along_axes_m"], 0.01) << "measured without law.safety, too";
  EXPECT_TRUE(free.summary["safety"]["predicted"].is_null());
  const LawRun in_space(TeamOf("single_integrator", {{-3, 0, 3}, {3, 0.1, 5}}, kMeet + "axes = 'xyz'\n"));
  EXPECT_EQ(in_space.summary["safety"]["min_separation_along_axes_m"], in_space.summary["safety"]["min_separation_m"]);
}

TEST(SafetyOfAccelerations, PromisesNothingWhereBrakingTakesMoreThanTheDistance) {
  const auto prediction = PredictSafety(Read(TeamOf("double_integrator", {{-3, 0, 2}, {3, 0, 2}},
                                                    kMeetByForce + Safety(0.01, 0.5), "[control]\nrate_hz = 5\n")));
  ASSERT_TRUE(prediction);
  EXPECT_FALSE(prediction->min_separation_m) << "0.01 m less (3 + 3) 0.2^2 / 8 m is not above 0";
  EXPECT_EQ(prediction->silent,
            "braking within a control period takes more than law.safety.distance_m: agents may touch");
}

// --- driven by acceleration -------------------------------------------------------------------------------

TEST(SafetyOfAccelerations, BrakesInTimeFromAnySpeedThatCanBeStopped) {
  for (const int rate_hz : {10, 100}) {
    for (const double share : {0.0, 0.5, 0.9, 1.0}) {  // of the speed at which h = 0
      const double D = 1, a = 2 * 3, d0 = 9;
      const double v = share * std::sqrt(2 * a * (d0 - D)) / 2;
      const std::string toml =
          TeamOf("double_integrator", {{0, 0, 2}, {d0, 0, 2}}, kMeetByForce + Safety(D),
                 "[control]\nrate_hz = " + std::to_string(rate_hz) + "\n",
                 "velocity_m_per_s = [[" + ShortestFloat(v) + ", 0, 0], [" + ShortestFloat(-v) + ", 0, 0]]\n");
      const double dip_m = a / rate_hz / rate_hz / 8;
      const auto prediction = PredictSafety(Read(toml));
      ASSERT_TRUE(prediction && prediction->min_separation_m) << prediction->silent;
      EXPECT_NEAR(*prediction->min_separation_m, D - dip_m, 1e-9);
      EXPECT_EQ(prediction->assumes, "");
      const double min_m = MinDistance_m(toml);
      EXPECT_GE(min_m, D - dip_m - 1e-9) << rate_hz << " Hz, " << share;
      EXPECT_LT(min_m, D + 0.05) << rate_hz << " Hz, " << share;
    }
  }
}

TEST(SafetyOfAccelerations, KeepsPairsApartThatPassEachOtherInEveryDirection) {
  std::mt19937_64 random(1);
  const auto number = [&random](double size) { return std::uniform_real_distribution(-size, size)(random); };
  int close = 0;
  for (int flight = 0; flight < 60; ++flight) {
    const PlaceList places = {{number(4), number(4), 2}, {6 + number(4), number(4), 2}};
    std::string velocities;
    for (int k = 0; k < 2; ++k)
      velocities += "[" + ShortestFloat(number(2)) + ", " + ShortestFloat(number(2)) + ", 0], ";
    const std::string toml = TeamOf("double_integrator", places, kMeetByForce + Safety(1, 0.5 + std::abs(number(3))),
                                    "", "velocity_m_per_s = [" + velocities + "]\n", 5);
    const auto prediction = PredictSafety(Read(toml));
    if (!prediction || !prediction->min_separation_m) continue;  // some start too fast to stop
    const double min_m = MinDistance_m(toml);
    EXPECT_GE(min_m, *prediction->min_separation_m - 1e-6) << "flight " << flight;
    close += min_m < 1.1;
  }
  EXPECT_GT(close, 20);
}

TEST(SafetyOfAccelerations, AlwaysFindsASafeCommandForTwo) {
  for (const double across : {0.0, 0.05, 1.0}) {
    const std::string velocities = "velocity_m_per_s = [[4, 0, 0], [-4, " + ShortestFloat(across) + ", 0]]\n";
    const LawRun run(TeamOf("double_integrator", {{0, 0, 2}, {9, 0.01, 2}}, kMeetByForce + Safety(1), "", velocities));
    const auto& safety = run.summary["safety"];
    EXPECT_EQ(safety["infeasible_ticks"], 0) << across;
    EXPECT_GT(safety["filtered_fraction"].get<double>(), 0.2) << across;
    EXPECT_GE(safety["min_separation_m"].get<double>(), safety["predicted"]["min_separation_m"].get<double>());
  }
}

TEST(SafetyOfAccelerations, FiltersTheAccelerationThatAVelocityMeans) {
  const double min_m = MinDistance_m(TeamOf("double_integrator", {{0, 0, 2}, {6, 0, 2}}, kMeet + Safety(1)));
  EXPECT_GE(min_m, 1 - 6e-4 / 8 - 1e-9);
  EXPECT_LT(min_m, 1.05);
}

TEST(SafetyOfAccelerations, SharesTheBrakingByWhatEachAgentCan) {
  const std::string weak = "[[agents.override]]\nid = 2\ncontrol = { max_acceleration_m_per_s2 = 0.5 }\n";
  const Experiment experiment =
      Read(TeamOf("double_integrator", {{0, 0, 2}, {3, 0, 2}}, kMeetByForce + Safety(1), "", weak));
  Agent strong_agent(experiment, 1), weak_agent(experiment, 2);
  Motion left, right;
  left.v_WB = {2.5, 0, 0};
  right.p_WB = {3, 0, 0};
  const std::vector<Sample> right_sample = {{&right}}, left_sample = {{&left}};
  const double strong = strong_agent.Want(0, left, right_sample).a_limited_W.x();
  const double weakly = weak_agent.Want(0, right, left_sample).a_limited_W.x();
  EXPECT_LT(strong, 0);
  EXPECT_NEAR(strong / -weakly, 3 / 0.5, 1e-9);
  const double root = std::sqrt(2 * 3.5 * 2), h = root - 2.5;
  EXPECT_NEAR(strong - weakly, h + 3.5 * -2.5 / root, 1e-9) << "together they keep h' = -gamma h";
}

TEST(SafetyOfAccelerations, HoldsWithQuadrotorsAndWithoutItTheyTouch) {
  const std::string mascots = TeamOf("quadrotor", {{0, 0, 2}, {8, 0.3, 2}}, kMeetByForce + Safety(1.2));
  const LawRun run(mascots);
  const auto& safety = run.summary["safety"];
  EXPECT_EQ(safety["predicted"]["assumes"], "quadrotors accelerate as soon as they are told");
  EXPECT_GT(safety["min_separation_m"].get<double>(), 1.1);
  EXPECT_EQ(safety["contacts"]["agents"], 0);
  const LawRun without(TeamOf("quadrotor", {{0, 0, 2}, {8, 0.3, 2}}, kMeetByForce));
  EXPECT_GT(without.summary["safety"]["contacts"]["agents"].get<int>(), 0);
  EXPECT_TRUE(without.summary["safety"]["filtered_fraction"].is_null());
  EXPECT_TRUE(without.summary["safety"]["infeasible_ticks"].is_null());
  EXPECT_TRUE(without.summary["safety"]["predicted"].is_null());
  EXPECT_THAT(without.text, Not(HasSubstr("law.safety")));
}

TEST(Safety, KeepsMixedModelsApart) {
  const std::string mixed =
      "[[agents.override]]\nid = 2\nmodel = 'single_integrator'\n[[agents.override]]\nid = 3\nmodel = 'quadrotor'\n";
  const std::string toml = TeamOf("double_integrator", Circle(4, 4, 0.3), kMeetByForce + Safety(1.2), "", mixed, 15);
  const LawRun run(toml);
  EXPECT_GT(run.summary["safety"]["min_separation_m"].get<double>(), 1.1);
  EXPECT_EQ(run.summary["safety"]["contacts"]["agents"], 0);
  EXPECT_EQ(run.prediction.safety->silent, "some agents are driven by velocity, others by acceleration");
}

// --- around any law, and only where it is needed ----------------------------------------------------------

TEST(Safety, ChangesNoBitOfAFlightInWhichNobodyComesClose) {
  for (const char* model : {"single_integrator", "double_integrator"}) {
    const PlaceList places = Circle(4, 6);
    const std::string law = "name = 'formation'\noffsets_m = " + List(Circle(4, 5)) + "\n";
    const Experiment without = Read(TeamOf(model, places, law)), with = Read(TeamOf(model, places, law + Safety(0.5)));
    IdealTeam a(without), b(with);
    for (int tick = 0; tick < 500; ++tick) {
      a.Step();
      b.Step();
      for (int id = 1; id <= 4; ++id) ASSERT_EQ(a.p_W(id), b.p_W(id)) << model << " " << tick;
    }
  }
}

TEST(Safety, IsAroundLawsOfPythonAndOfLibraries) {
  const std::string python =
      "name = 'custom'\noutput = 'velocity'\npython = '''\ndef control(t, me, neighbours):\n"
      "  return sum(2.0 * (j.position - me.position) for j in neighbours)\n'''\n";
  const std::string library = "name = 'plugin'\nlibrary = '" + test::BuildFolder() + "/tests/plugins/libmirror.so'\n";
  for (const std::string& law : {python, library}) {
    const PlaceList places = {{0, 0, 2}, {5, 0, 2}};
    const double without_m = MinDistance_m(TeamOf("single_integrator", places, law, "", "", 5));
    const double with_m = MinDistance_m(TeamOf("single_integrator", places, law + Safety(2), "", "", 5));
    EXPECT_LT(without_m, 1.5) << law;
    EXPECT_GE(with_m, 2 - 1e-9) << law;
  }
}

TEST(Safety, FlagsWhatItChangesAndWhenNothingIsSafe) {
  const Experiment experiment =
      Read(TeamOf("double_integrator", {{0, 0, 2}, {1.3, 0, 2}, {-1.3, 0, 2}}, kMeetByForce + Safety(1.2)));
  Motion middle, left, right;
  right.p_WB = {1.3, 0, 0};
  left.p_WB = {-1.3, 0, 0};
  const std::vector<Sample> others = {{&right}, {&left}};
  EXPECT_EQ(Agent(experiment, 1).Want(0, middle, others).flags, 0u) << "in the middle, at rest, it wants nothing";
  right.v_WB = {-0.25, 0, 0};
  const Command command = Agent(experiment, 1).Want(0, middle, others);
  EXPECT_EQ(command.flags, kSafetyFiltered) << "it gives way";
  EXPECT_LT(command.a_limited_W.x(), 0);
  EXPECT_EQ(command.a_law_W, Eigen::Vector3d::Zero());
  left.v_WB = {1.6, 0, 0};
  right.v_WB = {-1.6, 0, 0};
  const Command squeezed = Agent(experiment, 1).Want(0, middle, others);
  EXPECT_EQ(squeezed.flags, kSafetyInfeasible) << "what is least unsafe is to stay in the middle, as it wants";
  EXPECT_NEAR(squeezed.a_limited_W.x(), 0, 1e-6);
}

TEST(Safety, SaysThatNothingIsSafeForAgentsAtTheSamePlace) {
  const Experiment experiment = Read(TeamOf("single_integrator", {{0, 0, 2}, {0, 0, 2}}, kMeet + Safety(1), kNoBodies));
  const Motion here;
  const std::vector<Sample> other = {{&here}};
  EXPECT_EQ(Agent(experiment, 1).Want(0, here, other).flags, kSafetyInfeasible);
}

TEST(Safety, CountsTheTicksAtWhichSomebodyHadNoSafeCommand) {
  const LawRun run(TeamOf("double_integrator", {{0, 0, 2}, {2, 0, 2}, {-2, 0, 2}}, kMeetByForce + Safety(1.2),
                          kNoBodies, "velocity_m_per_s = [[0, 0, 0], [-4, 0, 0], [4, 0, 0]]\n", 2));
  EXPECT_GT(run.summary["safety"]["infeasible_ticks"].get<int>(), 0);
  EXPECT_LE(run.summary["safety"]["infeasible_ticks"].get<int>(), 201);
}

TEST(Safety, SaysOfARunInWhichTheConditionOfThePromiseDidNotHoldThatItDidNot) {
  const auto run = [](const std::string& model) {
    return LawRun(
        "[run]\nduration_s = 10\n[physics]\ncollisions = false\nground = false\n[agents]\ncount = 3\n"
        "model = '" +
        model +
        "'\nposition_m = [[-3, 0, 3], [3, 0.1, 4], [0, 3, 5]]\n[control]\nrate_hz = 20\n[law]\n"
        "name = 'velocity_consensus'\nsafety = { distance_m = 1.0, gamma = 2.0 }\n");
  };
  const LawRun late(run("quadrotor"));
  const auto& safety = late.summary["safety"];
  ASSERT_LT(safety["min_separation_along_axes_m"].get<double>(),
            safety["predicted"]["min_separation_along_axes_m"].get<double>());
  const std::string why = safety["infeasible_ticks"].get<int>() > 0
                              ? "at " + safety["infeasible_ticks"].dump() + " ticks an agent had no safe command"
                              : "quadrotors accelerated later than they were told";
  EXPECT_EQ(safety["condition_broken"], why);
  EXPECT_THAT(late.text, HasSubstr("but          the condition did not hold in this run: " + why));
  const LawRun kept(run("single_integrator"));
  EXPECT_FALSE(kept.summary["safety"]["predicted"]["min_separation_m"].is_null());
  EXPECT_TRUE(kept.summary["safety"]["condition_broken"].is_null());
  EXPECT_THAT(kept.text, Not(HasSubstr("condition did not hold")));
}

// --- the shipped experiment -------------------------------------------------------------------------------

TEST(Crossing, KeepsTenQuadrotorsApartOnTheirWayToThePlacesOpposite) {
  const std::string crossing = ReadFile(test::SourceFolder() + "/configs/crossing.toml");
  const LawRun run(crossing);
  const auto& safety = run.summary["safety"];
  EXPECT_EQ(safety["infeasible_ticks"], 0);
  EXPECT_NEAR(safety["predicted"]["min_separation_m"].get<double>(), 1.1 - 4e-4 / 8, 1e-9) << "but for rounding";
  EXPECT_GE(safety["min_separation_m"].get<double>(), safety["predicted"]["min_separation_m"].get<double>());
  EXPECT_LT(safety["min_separation_m"].get<double>(), 1.2) << "not more than needed";
  EXPECT_EQ(safety["collisions"], 0);
  EXPECT_LT(run.summary["formation"]["final_rms_m"].get<double>(), 0.05) << "all have arrived";

  const LawRun without(crossing.substr(0, crossing.find("\n[law.safety]")));
  EXPECT_LT(without.summary["safety"]["min_separation_m"].get<double>(), 1.0);
  EXPECT_GT(without.summary["safety"]["contacts"]["agents"].get<int>(), 0);
}

// --- keys -------------------------------------------------------------------------------------------------

TEST(SafetyKeys, AreInheritedByAnAgentsOwnLaw) {
  const Experiment experiment = Read(TeamOf("single_integrator", Circle(4, 5), kMeet + Safety(1, 2), "",
                                            "[[agents.override]]\nid = 1\nlaw = { p_gain = 1.0 }\n"
                                            "[[agents.override]]\nid = 2\nlaw = { safety = { gamma = 3.0 } }\n"
                                            "[[agents.override]]\nid = 3\nlaw = { name = 'consensus' }\n"));
  const auto of = [&](int id) { return experiment.agent(id).law.safety; };
  ASSERT_TRUE(of(1) && of(2) && of(4));
  EXPECT_EQ(of(1)->gamma, 2);
  EXPECT_EQ(of(2)->distance_m, 1);
  EXPECT_EQ(of(2)->gamma, 3);
  EXPECT_FALSE(of(3)) << "a law of another name inherits nothing";
  const Experiment again = Read(experiment.resolved);
  EXPECT_EQ(again.agent(2).law.safety->gamma, 3);
  EXPECT_EQ(again.agent(2).law.safety->distance_m, 1);
  EXPECT_EQ(again.resolved, experiment.resolved);
}

TEST(SafetyKeys, AreChangedByEventsForAllOrForSome) {
  const auto final_distance_m = [](const std::string& event, const std::string& overrides = "") {
    const LawRun run(TeamOf("single_integrator", {{0, 0, 2}, {5, 0, 2}}, kMeet + Safety(1, 3), "", overrides, 8) +
                     "[[events]]\nat_s = 2.0\n" + event);
    return 2 * run.summary["consensus"]["final_disagreement_m"].get<double>();
  };
  const std::string farther = "set = { 'law.safety.distance_m' = 2.0 }\n";
  EXPECT_NEAR(final_distance_m("set = { 'law.p_gain' = 4.0 }\n"), 1, 1e-3);
  EXPECT_NEAR(final_distance_m(farther), 2, 1e-3);
  EXPECT_NEAR(final_distance_m(farther, "[[agents.override]]\nid = 1\nlaw = { safety = { distance_m = 1.0 } }\n"), 2,
              1e-3)
      << "an agent's own distance, too";
  const double of_one_m = final_distance_m(farther + "agents = [2]\n");
  EXPECT_GT(of_one_m, 1.2) << "agent 2 gives way";
  EXPECT_LT(of_one_m, 1.9) << "agent 1 follows as near as it may";
  EXPECT_GT(final_distance_m("set = { 'law.safety.gamma' = 0.01 }\n"), 1.02) << "agents come closer more slowly";
}

TEST(SafetyKeys, MaySwitchTheFilterOnDuringARun) {
  const LawRun run(TeamOf("single_integrator", {{0, 0, 2}, {5, 0, 2}}, "name = 'velocity_consensus'\np_gain = 0.3\n") +
                   "[[events]]\nat_s = 1.0\nset = { 'law.safety.distance_m' = 2.0 }\n");
  EXPECT_NEAR(run.summary["safety"]["min_separation_m"].get<double>(), 2, 0.01);
  EXPECT_GT(run.summary["safety"]["filtered_fraction"].get<double>(), 0.2);
}

// --- what check says --------------------------------------------------------------------------------------

/// What theory says of a team of four. `more`: further lines of [law], and tables behind it.
SafetyPrediction PredictionOf(const std::string& more, const std::string& front = "", const std::string& agents = "",
                              const PlaceList& places = Circle(4, 5), const std::string& model = "double_integrator") {
  const auto prediction = PredictSafety(Read(TeamOf(model, places, kMeetByForce + more, front, agents)));
  EXPECT_TRUE(prediction);
  return prediction.value_or(SafetyPrediction());
}

TEST(SafetyTheory, SpeaksOfTeamsThatHearEachOtherAndStartApart) {
  const SafetyPrediction prediction = PredictionOf(Safety(1));
  EXPECT_EQ(prediction.silent, "");
  EXPECT_THAT(prediction.warnings, IsEmpty());
  EXPECT_EQ(prediction.assumes, "agents always find a safe command");
  EXPECT_EQ(SafetyText(prediction),
            "at least 0.9999 m in the plane (law.safety), if agents always find a safe command");
  EXPECT_EQ(PredictionOf(Safety(1), "", "", Circle(4, 5), "quadrotor").assumes,
            "agents always find a safe command and quadrotors accelerate as soon as they are told");
  EXPECT_FALSE(PredictSafety(Read(TeamOf("double_integrator", Circle(4, 5), kMeetByForce))));
  EXPECT_EQ(SafetyText(PredictionOf(Safety(1), "", "", {{0, 0, 2}})), "nothing: there is one agent");
}

TEST(SafetyTheory, NamesTheFirstPairThatDoesNotHearEachOtherAndCountsTheOthers) {
  const auto warnings = [](const std::string& graph) {
    std::string toml = TeamOf("double_integrator", Circle(4, 5), kMeetByForce + Safety(1));
    toml.replace(toml.find("topology = 'complete'"), 21, graph);
    return PredictSafety(Read(toml))->warnings;
  };
  const std::string silent = "law.safety: no distance is promised: ";
  EXPECT_THAT(warnings("topology = 'path'"),
              ElementsAre(silent + "agents 1 and 3 (and 2 other pairs) do not both hear each other"));
  EXPECT_THAT(warnings("topology = 'ring'"),
              ElementsAre(silent + "agents 1 and 3 (and another pair) do not both hear each other"));
  EXPECT_THAT(warnings("range_m = 3.0\ntopology = 'complete'"), ElementsAre(silent + "the graph changes"));
  std::string all_but_one = "edges = [";
  for (int i = 1; i <= 4; ++i)
    for (int j = 1; j <= 4; ++j)
      if (i != j && !(i == 2 && j == 4)) all_but_one += "[" + std::to_string(i) + ", " + std::to_string(j) + "], ";
  EXPECT_THAT(warnings(all_but_one + "]"), ElementsAre(silent + "agents 2 and 4 do not both hear each other"));
}

TEST(SafetyTheory, SaysWhyItIsSilent) {
  const auto silent = [](auto... arguments) { return PredictionOf(Safety(1), arguments...).silent; };
  EXPECT_EQ(silent("[link]\ndelay_s = 0.1\n"), "samples are lost or late");
  EXPECT_EQ(silent("[sensors.heard]\nposition_std_m = 0.1\n"), "what agents measure is noisy or late");
  EXPECT_EQ(silent("[sensors.own]\ndelay_s = 0.1\n"), "what agents measure is noisy or late");
  EXPECT_EQ(silent("", "[[agents.override]]\nid = 2\nlie = { offset_m = [1.0, 0.0, 0.0] }\n"), "an agent lies");
  EXPECT_EQ(silent("", "[[agents.override]]\nid = 2\nstart_s = 1.0\n"), "agents come or go");
  EXPECT_EQ(
      silent("", "[[agents.override]]\nid = 3\nlaw = { name = 'waypoint', waypoints_m = [[0, 0, 2]], axes = 'xy' }\n"),
      "agent 3 has no filter, and keeps no share of it");
  EXPECT_EQ(silent("", "[[agents.override]]\nid = 3\nlaw = { axes = 'xyz' }\n"), "agents have different law.axes");
  EXPECT_EQ(silent("", "[[agents.override]]\nid = 3\nmodel = 'single_integrator'\n"),
            "some agents are driven by velocity, others by acceleration");
  EXPECT_EQ(PredictionOf(Safety(1), "", "", Circle(4, 5), "unicycle").silent,
            "a unicycle turns before its centre moves as it is told");
  EXPECT_EQ(PredictionOf(Safety(1, 51)).silent,
            "a gamma of 51 1/s is more than the 50 1/s that control.rate_hz can keep");
  EXPECT_EQ(PredictionOf(Safety(1, 101), "", "", Circle(4, 5), "single_integrator").silent,
            "a gamma of 101 1/s is more than the 100 1/s that control.rate_hz can keep");
  EXPECT_EQ(PredictionOf(Safety(8)).silent,
            "agents 1 and 2 (and 3 other pairs) start closer than law.safety.distance_m");
  EXPECT_EQ(silent("", "velocity_m_per_s = [[-8, 0, 0], [0, 0, 0], [8, 0, 0], [0, 0, 0]]\n"),
            "agents 1 and 3 start too fast to stop before law.safety.distance_m");
  EXPECT_EQ(PredictionOf(Safety(1) + "[[events]]\nat_s = 1.0\nset = { 'law.p_gain' = 2.0 }\n").silent,
            "events change the run");
  EXPECT_EQ(SafetyText(PredictionOf(Safety(8), "[link]\nloss = 0.1\n")),
            "no distance, because samples are lost or late; "
            "agents 1 and 2 (and 3 other pairs) start closer than law.safety.distance_m");
  std::string realtime = TeamOf("double_integrator", Circle(4, 5), kMeetByForce + Safety(1));
  realtime.insert(realtime.find("duration_s"), "mode = 'realtime'\n");
  EXPECT_EQ(PredictSafety(Read(realtime))->silent, "commands may be late in real time");
}

TEST(SafetyTheory, WarnsOfBodiesThatTouchAtTheDistance) {
  EXPECT_THAT(
      PredictionOf(Safety(0.9), "", "", Circle(4, 5), "quadrotor").warnings,
      ElementsAre("law.safety.distance_m: it keeps centres apart; the bodies of agents 1 and 2 (and 5 other pairs) "
                  "can touch at this distance"));
  EXPECT_THAT(PredictionOf(Safety(0.9), kNoBodies, "", Circle(4, 5), "quadrotor").warnings, IsEmpty());
  EXPECT_THAT(PredictionOf(Safety(1), "", "", Circle(4, 5), "quadrotor").warnings, IsEmpty());
}

}  // namespace
}  // namespace mascot
