// [[law.schedule]]: another law, formation or gain from a time on, of the team or of an agent.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "experiment/phase.h"
#include "tests/experiment/fly_rows.h"
#include "tests/support/law_run.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

/// Two single integrators on the x axis, 8 m apart, that hear each other. `law`: lines of [law].
std::string Pair(const std::string& law, const std::string& duration_s = "2.0") {
  return "[run]\nduration_s = " + duration_s +
         "\n[agents]\ncount = 2\nmodel = 'single_integrator'\nposition_m = [[-4, 0, 1], [4, 0, 3]]\n"
         "[graph]\ntopology = 'complete'\n[law]\n" +
         law;
}

std::string Phase(const std::string& at_s, const std::string& lines) {
  return "[[law.schedule]]\nat_s = " + at_s + "\n" + lines + "\n";
}

double DistanceAt(const std::vector<DecodedRow>& rows, std::size_t tick) {
  return rows[tick].motions[1].p_WB.x() - rows[tick].motions[0].p_WB.x();
}

/// v_i = gain (x_j - x_i): the distance of a pair shrinks by 1 - 2 h gain each tick.
std::string Pull(const std::string& gain) {
  return "name = 'prescribed_time'\ntime_s = 1000.0\nexponent = 0.0\ngain = " + gain + "\n";
}
double Shrunk(double from_m, double gain, int ticks) { return from_m * std::pow(1 - 2 * 0.01 * gain, ticks); }

// --- what flies -------------------------------------------------------------------------------------

TEST(LawSchedule, ChangesAGainFromItsTickOn) {
  const auto rows = Fly(Pair(Pull("0.5") + Phase("1.0", "gain = 2.0")));
  EXPECT_NEAR(DistanceAt(rows, 100), Shrunk(8, 0.5, 100), 1e-9);
  EXPECT_NEAR(DistanceAt(rows, 200), Shrunk(Shrunk(8, 0.5, 100), 2, 100), 1e-9) << "the product of the phases' maps";
}

TEST(LawSchedule, PhasesBeginWhenTheySay) {
  const auto early = Fly(Pair(Pull("0.5") + Phase("0.5", "gain = 2.0"))),
             late = Fly(Pair(Pull("0.5") + Phase("1.5", "gain = 2.0")));
  EXPECT_NEAR(DistanceAt(early, 200), Shrunk(Shrunk(8, 0.5, 50), 2, 150), 1e-9);
  EXPECT_NEAR(DistanceAt(late, 200), Shrunk(Shrunk(8, 0.5, 150), 2, 50), 1e-9);
}

TEST(LawSchedule, APhaseGoesOnWithTheParametersOfTheOneBefore) {
  const auto rows = Fly(Pair(Pull("0.5") + Phase("0.5", "gain = 2.0") + Phase("1.0", "exponent = 0.0")));
  EXPECT_NEAR(DistanceAt(rows, 200), Shrunk(Shrunk(8, 0.5, 50), 2, 150), 1e-9);
}

TEST(LawSchedule, AnotherLawBeginsWithItsDefaults) {
  const auto rows = Fly(Pair(std::string("name = 'waypoint'\nwaypoints_m = [[0, 0, 1]]\naxes = 'xy'\np_gain = 0.0\n"
                                         "d_gain = 0.0\n") +
                             Phase("0.5", "name = 'prescribed_time'\ntime_s = 1.0")));
  EXPECT_EQ(DistanceAt(rows, 50), 8) << "nobody moves in the first phase";
  EXPECT_LT(DistanceAt(rows, 151), 1e-3);
}

TEST(LawSchedule, TheTimeOfALawCountsFromThePhasesBegin) {
  const std::string law = "name = 'waypoint'\nwaypoints_m = [[0, 0, 1], [0, 9, 1]]\ntimes_s = [0.0, 1.0]\n";
  const auto rows = Fly(Pair(Pull("0.0") + Phase("0.5", law)));
  EXPECT_EQ(rows[149].commands[0].a_limited_W.y(), 0);
  EXPECT_GT(rows[150].commands[0].a_limited_W.y(), 0);
}

TEST(LawSchedule, TheTimesOfALeaderCountFromThePhasesBegin) {
  const std::string law =
      "name = 'consensus'\nleader = 1\nleader_waypoints_m = [[-4, 0, 1], [-4, 9, 1]]\nleader_times_s = [0.0, 1.0]\n";
  const auto rows = Fly(Pair(Pull("0.0") + Phase("0.5", law)));
  EXPECT_EQ(rows[149].commands[0].a_law_W.y(), 0);
  EXPECT_GT(rows[150].commands[0].a_law_W.y(), 0);
}

TEST(LawSchedule, ConcernsAgentsThatComeLate) {
  const std::string late = "[[agents.override]]\nid = 2\nstart_s = 1.0\n";
  const auto before = Fly(Pair(Pull("0.5") + Phase("0.5", "gain = 2.0")) + late);
  EXPECT_EQ(DistanceAt(before, 100), 8) << "agent 1 hears nobody";
  EXPECT_NEAR(DistanceAt(before, 200), Shrunk(8, 2, 100), 1e-9) << "agent 2 begins in the second phase";
  const auto after = Fly(Pair(Pull("0.5") + Phase("1.5", "gain = 2.0")) + late);
  EXPECT_NEAR(DistanceAt(after, 200), Shrunk(Shrunk(8, 0.5, 50), 2, 50), 1e-9);
  const auto at_once = Fly(Pair(Pull("0.5") + Phase("1.0", "gain = 2.0")) + late);
  EXPECT_NEAR(DistanceAt(at_once, 200), Shrunk(8, 2, 100), 1e-9);
}

TEST(LawSchedule, TheTimeOfALawCountsFromThePhasesBeginAlsoForAgentsThatComeLate) {
  const std::string law = "name = 'waypoint'\nwaypoints_m = [[0, 0, 1], [0, 9, 1]]\ntimes_s = [0.0, 1.0]\n";
  const auto rows = Fly(Pair(Pull("0.0") + Phase("0.5", law)) + "[[agents.override]]\nid = 2\nstart_s = 1.2\n");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(rows[149].commands[i].a_limited_W.y(), 0) << i;
    EXPECT_GT(rows[150].commands[i].a_limited_W.y(), 0) << i;
  }
}

TEST(LawSchedule, ALawOfTheSameNameGoesOnIfOnlyLiveKeysDiffer) {
  // The first phase's clock runs on: prescribed_time is past its time when the second phase begins.
  const std::string law = "name = 'prescribed_time'\ntime_s = 0.2\nexponent = 4.0\ngain = 0.0\n";
  const auto goes_on = Fly(Pair(law + Phase("0.5", "gain = 0.0"), "1.0"));
  EXPECT_EQ(DistanceAt(goes_on, 60), DistanceAt(goes_on, 100)) << "all is over";
  const Experiment begins = Load(Pair(law + Phase("0.5", "time_s = 0.3"), "1.0"));
  LiveExperiment live(begins, &LawTable(), true);
  EXPECT_EQ(live.After(begins.events.front())->agent(1).law.since, 50) << "time_s is not live";
  const Experiment same = Load(Pair(law + Phase("0.5", "gain = 1.0"), "1.0"));
  LiveExperiment other(same, &LawTable(), true);
  EXPECT_EQ(other.After(same.events.front())->agent(1).law.since, 0);
}

TEST(LawSchedule, OfAnAgentConcernsItAlone) {
  const std::string own =
      "[[agents.override]]\nid = 2\nlaw = { gain = 0.0, schedule = [{ at_s = 1.0, gain = 1.0 }] }\n";
  const auto rows = Fly(Pair(Pull("0.5")) + own);
  for (const std::size_t tick : {50U, 100U}) EXPECT_EQ(rows[tick].motions[1].p_WB.x(), 4) << tick;
  EXPECT_NEAR(DistanceAt(rows, 200), Shrunk(8, 0.25, 100) * std::pow(1 - 0.01 * 1.5, 100), 1e-9);
}

TEST(LawSchedule, OfTheTeamLeavesAgentsWithALawOfTheirOwnAlone) {
  const auto rows =
      Fly(Pair(Pull("0.5") + Phase("1.0", "gain = 3.0")) + "[[agents.override]]\nid = 2\nlaw = { gain = 0.0 }\n");
  EXPECT_EQ(rows[200].motions[1].p_WB.x(), 4);
  EXPECT_NEAR(DistanceAt(rows, 200), 8 * std::pow(1 - 0.01 * 0.5, 100) * std::pow(1 - 0.01 * 3, 100), 1e-9);
}

TEST(LawSchedule, TakesThePlaceOfWhatEventsHaveSet) {
  const std::string set = "[[events]]\nat_s = 0.5\nset = { \"law.gain\" = 1.0 }\n";
  const auto rows = Fly(Pair(Pull("0.5") + Phase("1.0", "name = 'prescribed_time'")) + set);
  EXPECT_NEAR(DistanceAt(rows, 200), Shrunk(Shrunk(Shrunk(8, 0.5, 50), 1, 50), 0.5, 100), 1e-9);
  const std::string of_one = "[[events]]\nat_s = 0.5\nset = { \"law.gain\" = 1.0 }\nagents = [2]\n";
  const auto other = Fly(Pair(Pull("0.5") + Phase("1.0", "name = 'finite_time'\nform = 'sign'\ngain = 0.5")) + of_one);
  EXPECT_NEAR(DistanceAt(other, 200) - DistanceAt(other, 199), -2 * 0.5 * 0.01, 1e-9) << "also for agent 2";
}

TEST(LawSchedule, LeavesItsLiveKeysToLaterEvents) {
  const std::string set = "[[events]]\nat_s = 1.5\nset = { \"law.gain\" = 1.0 }\n";
  const auto rows = Fly(Pair("name = 'waypoint'\nwaypoints_m = [[0, 0, 1]]\naxes = 'xy'\np_gain = 0.0\nd_gain = 0.0\n" +
                             Phase("1.0", Pull("0.5"))) +
                        set);
  EXPECT_NEAR(DistanceAt(rows, 200), Shrunk(Shrunk(8, 0.5, 50), 1, 50), 1e-9);
}

TEST(LawSchedule, BeginsBeforeOtherEventsOfItsTick) {
  const std::string set = "[[events]]\nat_s = 0.5\nset = { \"law.gain\" = 1.0 }\n";
  const auto rows = Fly(Pair(Pull("0.5") + Phase("0.5", "gain = 2.0")) + set);
  EXPECT_NEAR(DistanceAt(rows, 200), Shrunk(Shrunk(8, 0.5, 50), 1, 150), 1e-9);
  const auto other =
      Fly(Pair("name = 'consensus'\np_gain = 0.0\n" + Phase("0.5", Pull("2.0"))) + set + "agents = [2]\n");
  EXPECT_NEAR(DistanceAt(other, 200), Shrunk(8, 1.5, 150), 1e-9) << "agent 1 pulls with 2, agent 2 with 1";
}

TEST(LawSchedule, NoLawGetsMessagesOfAnother) {
  // Sums of estimates stay those of the inputs only if the first tick hears nothing of the law before.
  const std::string inputs = "inputs_m = [[3, 0, 1], [-1, 2, 1]]\n";
  const LawRun run(Pair("name = 'gradient_tracking'\ntargets_m = [[1, 0, 1], [9, 9, 1]]\n" +
                            Phase("0.5", "name = 'average_tracking'\n" + inputs),
                        "4.0"));
  EXPECT_LT(run.summary["laws"]["average_tracking"]["sum_off_m"].get<double>(), 1e-9);
  EXPECT_GT(run.experiment.agent(1).sends_messages, 0);
  const LawRun silent(Pair("name = 'consensus'\n" + Phase("0.5", "name = 'average_tracking'\n" + inputs), "4.0"));
  EXPECT_LT(silent.summary["laws"]["average_tracking"]["sum_off_m"].get<double>(), 1e-9);
}

TEST(LawSchedule, GoToCountsFromThePhasesBegin) {
  const std::string law = "name = 'waypoint'\nwaypoints_m = [[0, 0, 1], [0, 9, 1]]\ntimes_s = [0.0, 1.0]\n";
  const std::string go_to = "[[events]]\nat_s = 1.0\ngoto = { agent = 1, position_m = [-4, 5, 1] }\n";
  const auto rows = Fly(Pair(Pull("0.0") + Phase("0.5", law), "20.0") + go_to);
  EXPECT_LT((rows[2000].motions[0].p_WB - Eigen::Vector3d(-4, 5, 1)).head<2>().norm(), 0.05);
  EXPECT_LT((rows[2000].motions[1].p_WB - Eigen::Vector3d(0, 9, 1)).head<2>().norm(), 0.05);
}

TEST(LawSchedule, AtItsWaypointsTimesAnAgentHoldsWhereItsPhaseBegan) {
  const std::string law = "name = 'waypoint'\nwaypoints_m = [[0, 9, 1]]\ntimes_s = [50.0]\naxes = 'xy'\n";
  const auto rows = Fly(Pair(Pull("1.0") + Phase("0.5", law), "20.0"));
  EXPECT_NEAR(DistanceAt(rows, 2000), Shrunk(8, 1.0, 50), 0.2) << "not where the run started";
}

TEST(LawSchedule, AgentsWithALawOfTheirOwnInheritNothingOfATeamsPhase) {
  const std::string own = "[[agents.override]]\nid = 2\nlaw = { beta = 2.0 }\n";
  const std::string phase = Phase("0.5", "leader = 1\nleader_waypoints_m = [[1, 1, 1]]\nsafety = { distance_m = 0.5 }");
  const Experiment experiment = Load(Pair("name = 'consensus'\n" + phase) + own);
  LiveExperiment live(experiment, &LawTable(), false);
  const auto now = live.After(experiment.events.front());
  EXPECT_TRUE(now->agent(1).law.safety);
  EXPECT_FALSE(now->agent(2).law.safety);
  EXPECT_EQ(now->agent(2).law.leader, 0);
  EXPECT_EQ(LinearFormOf(now->agent(2).law)->beta, 2);
}

TEST(LawSchedule, ASafetyFilterStaysAroundAnotherLaw) {
  const std::string filtered = "name = 'consensus'\nsafety = { distance_m = 1.5, gamma = 0.5 }\n";
  const Experiment experiment = Load(Pair(filtered +
                                          Phase("0.5",
                                                "name = 'waypoint'\nwaypoints_m = [[0, 0, 1]]\naxes = "
                                                "'xy'") +
                                          Phase("1.0", "name = 'consensus'\nsafety = { distance_m = 2.5 }")));
  LiveExperiment live(experiment, &LawTable(), false);
  const auto second = live.After(experiment.events[0]), third = live.After(experiment.events[1]);
  EXPECT_EQ(second->agent(1).law.safety->distance_m, 1.5);
  EXPECT_EQ(second->agent(1).law.safety->gamma, 0.5);
  EXPECT_EQ(third->agent(1).law.safety->distance_m, 2.5);
  EXPECT_EQ(third->agent(1).law.safety->gamma, 0.5);
  EXPECT_EQ(third->agent(1).law.since, 100);
  const Experiment changed = Load(Pair(filtered + Phase("0.5", "safety = { distance_m = 2.0 }")));
  LiveExperiment other(changed, &LawTable(), false);
  EXPECT_EQ(other.After(changed.events[0])->agent(1).law.since, 0) << "a filter is nothing that a law remembers";
}

TEST(LawSchedule, APythonLawBeginsAnewWithOtherParams) {
  const std::string text =
      "def start(me, params):\\n  me.k = params['k']\\ndef control(t, me, neighbours):\\n  return [me.k, 0]\\n";
  const auto rows = Fly(Pair("name = 'custom'\noutput = 'velocity'\nparams = { k = 1.0 }\npython = \"" + text + "\"\n" +
                                 Phase("0.5", "params = { k = 2.0 }"),
                             "1.0"));
  EXPECT_NEAR(rows[100].motions[0].p_WB.x(), -4 + 0.5 + 1, 1e-9);
}

TEST(LawSchedule, PhasesThatTheRunDoesNotReachAreWarnedOf) {
  const std::string toml = Pair("name = 'consensus'\n" + Phase("2.0", "p_gain = 2.0") + Phase("3.5", "p_gain = 3.0"));
  const Experiment experiment = Load(toml);
  EXPECT_THAT(experiment.events, IsEmpty());
  const Prediction prediction = Predict(experiment);
  EXPECT_THAT(prediction.warnings,
              IsSupersetOf({"law.schedule: the phase of 2 s does not begin: the run ends at 2 s",
                            "law.schedule: the phase of 3.5 s does not begin: the run ends at 2 s"}));
  EXPECT_THAT(prediction.later, IsEmpty());
  EXPECT_THAT(Refusal(Pair("name = 'consensus'\n" + Phase("3.5", "p_gain = -3.0"))),
              HasSubstr("law.schedule[0].p_gain"));
}

TEST(LawSchedule, FiguresOfALawThatGoesOnAreThoseSinceItBegan) {
  const std::string inputs =
      "name = 'average_tracking'\ninputs_m = [[3, 0, 1], [-1, 2, 1]]\nramps_m_per_s = [[1, 0, 0], [0, 1, 0]]\n";
  const LawRun run(Pair(inputs + Phase("1.0", "p_gain = 3.0"), "4.0"));
  EXPECT_LT(run.summary["laws"]["average_tracking"]["sum_off_m"].get<double>(), 1e-9);
  EXPECT_TRUE(run.summary["laws"]["average_tracking"]["predicted"]["sum_off_m"].is_null());
  EXPECT_EQ(run.prediction.later.at(0).prediction.silent, "the law goes on with what it remembers of the phase before");
  EXPECT_TRUE(run.summary["phases"][0]["laws"]["average_tracking"]["predicted"]["sum_off_m"].is_number());
  const std::string own =
      "[[agents.override]]\nid = 2\nlaw = { name = 'waypoint', waypoints_m = [[4, 1, 1], [4, 2, 1]] }\n";
  const LawRun flies(Pair("name = 'consensus'\n" + Phase("8.0", "p_gain = 2.0"), "25.0") + own);
  const auto& arrivals = flies.summary["laws"]["waypoint"]["arrival_time_s"];
  EXPECT_LT(arrivals[0].get<double>(), 8) << "the phase does not concern its law";
  EXPECT_GT(arrivals[1].get<double>(), arrivals[0].get<double>());
}

TEST(LawSchedule, NoDistanceIsPromisedWhereAnEventChangesAPhase) {
  const std::string filtered = "name = 'consensus'\nsafety = { distance_m = 1.5 }\n" + Phase("1.0", "p_gain = 2.0");
  EXPECT_TRUE(Predict(Load(Pair(filtered))).safety->min_separation_m);
  const std::string set = "[[events]]\nat_s = 1.5\nset = { \"law.safety.distance_m\" = 0.5 }\n";
  const Prediction prediction = Predict(Load(Pair(filtered) + set));
  EXPECT_FALSE(prediction.safety->min_separation_m);
  EXPECT_EQ(prediction.safety->silent, "events change the run");
}

// --- the same bits ----------------------------------------------------------------------------------

TEST(LawSchedule, ResolvesToAFileThatFliesTheSame) {
  const std::string toml = Pair(Pull("0.5") + Phase("0.5", "gain = 2.0") + Phase("1.0", "name = 'consensus'")) +
                           "[[agents.override]]\nid = 2\nlaw = { schedule = [{ at_s = 1.2, name = 'waypoint', "
                           "waypoints_m = [[1, 2, 3]] }] }\n";
  const Experiment experiment = Load(toml);
  const Experiment again = LoadExperiment(Section::FromText(experiment.resolved, "config.toml"), "test", true);
  EXPECT_EQ(again.resolved, experiment.resolved);
  const Experiment of_server = ReadWithoutLaws(Section::FromText(experiment.resolved, "config.toml"), "test");
  ASSERT_EQ(experiment.events.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(again.events[k].Toml(), experiment.events[k].Toml());
    EXPECT_EQ(of_server.events[k].Toml(), experiment.events[k].Toml()) << "what the physics server publishes";
    EXPECT_EQ(of_server.events[k].tick, experiment.events[k].tick);
  }
  const auto a = Fly(toml), b = Fly(experiment.resolved);
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t i = 0; i < 2; ++i) ASSERT_EQ(a[k].motions[i].p_WB, b[k].motions[i].p_WB) << k;
}

TEST(LawSchedule, HoldsThePhaseOfAPythonLawWithoutItsFile) {
  const std::string python =
      "name = 'custom'\noutput = 'velocity'\npython = \"def control(t, me, neighbours):\\n    return [1.0, t]\"\n";
  const auto rows = Fly(Pair(Pull("0.0") + Phase("1.0", python)));
  EXPECT_NEAR(rows[200].motions[0].p_WB.x(), -4 + 1, 1e-9);
  EXPECT_NEAR(rows[200].motions[0].p_WB.y(), 0.5, 0.01) << "its t counts from the phase's begin";
}

// --- measured and predicted, phase by phase ---------------------------------------------------------

TEST(LawSchedule, EachPhaseIsMeasuredAsARunOfItsOwn) {
  const std::string team =
      "[run]\nduration_s = 40.0\n[agents]\ncount = 4\nmodel = 'double_integrator'\nposition_m = "
      "[[-4, 0, 1], [4, 0, 3], [1, 2, 5], [0, -5, 7]]\n[control]\nmax_acceleration_m_per_s2 = 100.0\n[graph]\ntopology "
      "= 'ring'\n[law]\nname = "
      "'formation'\nshape = 'line'\nv_gain = 1.0\n";
  const LawRun run(team + Phase("20.0", "shape = 'circle'"));
  const auto& phases = run.summary["phases"];
  ASSERT_EQ(phases.size(), 2U);
  std::string alone = team;
  alone.replace(alone.find("40.0"), 4, "20.0");
  const LawRun first(alone);
  EXPECT_EQ(phases[0]["at_s"], 0.0);
  EXPECT_EQ(phases[0]["law"], "formation");
  EXPECT_EQ(phases[0]["consensus"], first.summary["consensus"]);
  EXPECT_EQ(phases[0]["formation"], first.summary["formation"]);
  EXPECT_EQ(phases[0]["drawing"], first.summary["drawing"]);
  EXPECT_EQ(phases[1]["at_s"], 20.0);
  EXPECT_EQ(phases[1]["consensus"], run.summary["consensus"]) << "the summary is of the last phase";
  const double measured_s = phases[1]["consensus"]["settling_time_s"].get<double>();
  EXPECT_NEAR(phases[1]["consensus"]["predicted"]["settling_time_s"].get<double>(), measured_s, 0.01 * measured_s);
  EXPECT_THAT(run.text, HasSubstr("from 0 s       law formation\n"));
  EXPECT_THAT(run.text, HasSubstr("from 20 s      law formation\n"));
  EXPECT_FALSE(first.summary.contains("phases"));
  EXPECT_THAT(first.text, Not(HasSubstr("from 0 s")));
}

TEST(LawSchedule, TheFiguresOfALawAreThoseOfItsPhase) {
  const LawRun run(Pair(Pull("0.5") + Phase("2.0", "name = 'finite_time'\nform = 'sign'\ngain = 1.0"), "8.0"));
  const double apart_m = Shrunk(8, 0.5, 200);
  EXPECT_NEAR(run.summary["laws"]["finite_time"]["agreement_time_s"].get<double>(), apart_m / 2, 0.02);
  EXPECT_NEAR(run.summary["laws"]["finite_time"]["predicted"]["agreement_time_s"].get<double>(), apart_m / 2, 0.02);
  EXPECT_FALSE(run.summary["laws"].contains("prescribed_time"));
  EXPECT_TRUE(run.summary["phases"][0]["laws"].contains("prescribed_time"));
}

std::string SilentLater(const std::string& more) {
  const Prediction prediction = Predict(Load(Pair("name = 'consensus'\n" + Phase("1.0", "p_gain = 2.0")) + more));
  return prediction.later.at(0).prediction.silent;
}

TEST(LawSchedule, TheorySaysWhyItIsSilentAboutAPhase) {
  EXPECT_EQ(SilentLater(""), "");
  EXPECT_EQ(SilentLater("[[events]]\nat_s = 1.5\nset = { \"law.beta\" = 2.0 }\n"),
            "events change the run, from 1.5 s on");
  EXPECT_EQ(SilentLater("[[events]]\nat_s = 0.5\ncut = [[1, 2]]\n"), "events have cut edges of the graph");
  EXPECT_EQ(SilentLater("[[events]]\nat_s = 0.5\nset = { \"law.beta\" = 2.0 }\n"), "");
  const Prediction first = Predict(Load(Pair("name = 'consensus'\n" + Phase("1.0", "p_gain = 2.0")) +
                                        "[[events]]\nat_s = 0.5\nset = { \"law.beta\" = 2.0 }\n"));
  EXPECT_EQ(first.silent, "events change the run, from 0.5 s on");
  std::string switching = Pair("name = 'consensus'\n" + Phase("1.0", "p_gain = 2.0"));
  const std::string complete = "[graph]\ntopology = 'complete'\n";
  switching.replace(switching.find(complete), complete.size(),
                    "[graph]\nedges = [[1, 2]]\nrepeat_s = 0.2\n[[graph.schedule]]\nat_s = 0.1\nedges = [[2, 1]]\n");
  EXPECT_EQ(Predict(Load(switching)).later.at(0).prediction.silent,
            "graph.schedule: theory knows schedules of the graph only from the start");
}

TEST(LawSchedule, WarnsOfAPhaseThatEndsBeforeTheorySaysThatAgentsSettle) {
  const Prediction prediction = Predict(Load(Pair("name = 'consensus'\n" + Phase("1.0", "p_gain = 2.0"))));
  EXPECT_THAT(prediction.warnings, Contains(HasSubstr("law.schedule: the phase ends after 1 s, before what theory")));
  EXPECT_THAT(prediction.warnings, Contains(HasSubstr("run.duration_s: the run ends after 1 s, before what theory")));
  EXPECT_THAT(prediction.warnings, Contains(HasSubstr("(from 1 s on)")));
}

TEST(LawSchedule, PhasesAreThoseOfTeamAndAgentsTogether) {
  const std::string own =
      "[[agents.override]]\nid = 2\nlaw = { schedule = [{ at_s = 0.5, gain = 1.0 }, "
      "{ at_s = 1.0, gain = 2.0 }] }\n";
  const Experiment experiment = Load(Pair(Pull("0.5") + Phase("1.0", "gain = 1.0")) + own);
  EXPECT_THAT(PhasesOf(experiment), ElementsAre(50, 100));
  EXPECT_EQ(EndOfPhase(experiment, 0), 50);
  EXPECT_EQ(EndOfPhase(experiment, 100), 200);
  EXPECT_EQ(Predict(experiment).later.size(), 2U);
  EXPECT_THAT(PhasesOf(Load(Pair(Pull("0.5")))), IsEmpty());
}

// --- what is refused --------------------------------------------------------------------------------

TEST(LawSchedule, RefusesWhatCannotBe) {
  const auto refusal = [](const std::string& phases) { return Refusal(Pair(Pull("0.5") + phases)); };
  EXPECT_THAT(refusal(Phase("1.0", "gain = 1.0") + Phase("1.0", "gain = 2.0")),
              HasSubstr("law.schedule[1].at_s: expected a later time than that of the phase before, got 1.0"));
  EXPECT_THAT(refusal(Phase("0.005", "")), HasSubstr("law.schedule[0].at_s: expected a whole number of periods"));
  EXPECT_THAT(refusal(Phase("0.0", "")), HasSubstr("law.schedule[0].at_s: expected a number in (0, 1e+06], got 0.0"));
  EXPECT_THAT(refusal("[[law.schedule]]\ngain = 1.0\n"), HasSubstr("law.schedule[0].at_s: expected a number"));
  EXPECT_THAT(
      refusal(Phase("1.0", "axes = 'xyz'")),
      HasSubstr("law.schedule[0].axes: expected \"xy\", as before, got \"xyz\": heights are held in all phases, "
                "or in none"));
  EXPECT_THAT(refusal(Phase("1.0", "gian = 1.0")),
              HasSubstr("law.schedule[0].gian: unknown key (did you mean \"gain\"?)"));
  EXPECT_THAT(refusal(Phase("1.0", "name = 'consensu'")), HasSubstr("law.schedule[0].name: expected one of"));
  EXPECT_THAT(refusal(Phase("1.0", "gain = -1.0")), HasSubstr("law.schedule[0].gain: expected a number in"));
  EXPECT_THAT(refusal(Phase("1.0", "name = 'waypoint'")), HasSubstr("law.schedule[0].waypoints_m"));
  EXPECT_THAT(Refusal(Pair(Pull("0.5")) + "[[events]]\nat_s = 1.0\nlaw = { gain = 1.0 }\n"), HasSubstr("unknown key"));
}

}  // namespace
}  // namespace mascot
