// Bands that theory predicts of laws on bodies that lag: that they hold in flight, and why there are none.
#include "orchestrator/theory/loop_bands.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "orchestrator/theory/loop_team.h"
#include "tests/support/law_run.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Expects that every figure is measured where it is predicted, and that `least` of them are predicted.
void ExpectTrue(const LawRun& run, int least, const std::string& what) {
  int predicted = 0;
  const auto& law = run.Law();
  for (const auto& [name, of_theory] : law["predicted"].items()) {
    if (of_theory.is_null()) continue;
    const nlohmann::json values = of_theory.is_array() ? of_theory : nlohmann::json::array({of_theory});
    const nlohmann::json measured = of_theory.is_array() ? law[name] : nlohmann::json::array({law[name]});
    const nlohmann::json& width = law["tolerances"][name];
    const nlohmann::json widths = width.is_array() ? width : nlohmann::json::array({width});
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k].is_null()) continue;
      ++predicted;
      ASSERT_EQ(law["bounds"][name], "within") << what;
      ASSERT_TRUE(measured[k].is_number()) << what << ": " << name;
      EXPECT_NEAR(measured[k].get<double>(), values[k].get<double>(), widths[k].get<double>()) << what << ": " << name;
    }
  }
  EXPECT_GE(predicted, least) << what << ": " << run.prediction.silent << run.prediction.figures_silent;
}

const std::string kFive = "position_m = [[3, 0, 1], [-1, 1, 2], [4, 2, 3], [1, 3, 4], [-5, 4, 5]]\n";

/// The text of an experiment with quadrotors, unless `agents` says otherwise.
std::string Team(double duration_s, const std::string& agents, const std::string& law,
                 const std::string& graph = "topology = 'path'\n", const std::string& more = "") {
  return "[run]\nduration_s = " + ShortestFloat(duration_s) + "\n[agents]\ncount = 5\n" + kFive + agents + "[graph]\n" +
         graph + more + "[law]\n" + law;
}

TEST(LoopBands, HoldForAFlockOfQuadrotorsWhoseEnergyBoundDidNot) {
  const LawRun run(
      "[run]\nduration_s = 30.0\n[physics]\ncollisions = false\nground = false\n[agents]\ncount = 5\nposition_m = "
      "[[0, 0, 5], [3, 1, 6], [-2, 2, 7], [1, -3, 8], [4, 4, 9]]\n[law]\nname = 'flocking'\n");
  ExpectTrue(run, 1, "flocking");
}

TEST(LoopBands, HoldForEventTriggeredQuadrotorsWhoSayWhereTheyAre) {
  const LawRun run(Team(20, "", "name = 'event_triggered'\nc0_m = 0.01\nc1_m = 0.0\n"));
  ExpectTrue(run, 1, "event_triggered");
}

TEST(EventTriggered, SaysOfABodyThatLagsWhereItWillBeAndNotWhereItWouldLikeToBe) {
  for (const std::string model : {"quadrotor", "double_integrator"}) {
    const LawRun run(Team(5, "model = '" + model + "'\n", "name = 'event_triggered'\nc0_m = 0.01\nc1_m = 0.0\n"));
    const Experiment& experiment = run.experiment;
    const auto law = MakeLaw(experiment, 1);
    Motion self;
    self.p_WB = {1, 2, 3};
    self.v_WB = {0.5, 0, 0};
    law->Want_W(0, self, {});
    ASSERT_EQ(law->Message().size(), 3U);
    EXPECT_NEAR(law->Message()[0], 1 + 0.5 * experiment.period_s(), 1e-12) << model;
  }
}

/// On a circle, r = R e^(iwt), the law a = a_r + p (r - x) + d (v_r - v) on a body with v = G(iw) a; see
/// tests/orchestrator/theory/low_level_loop_test.cc for G.
double TrackingErrorOfCircle_m(const Airframe& body, double radius_m, double period_s, double p, double d) {
  const std::complex<double> s(0, 2 * std::numbers::pi / period_s);
  const std::complex<double> tilt = body.attitude.kp / (s * s + body.attitude.kd * s + body.attitude.kp);
  const std::complex<double> pull = body.position.kd + body.position.kp / s;
  const std::complex<double> place = tilt * (1.0 + pull / s) / (s + tilt * pull) / s;
  const std::complex<double> follows = place * (s * s + d * s + p) / (1.0 + place * (d * s + p));
  return radius_m * std::abs(1.0 - follows);
}

TEST(LoopBands, OfACircleAreThoseOfTheFrequencyResponseOfTheLoop) {
  const LawRun run(
      "[run]\nduration_s = 60.0\n[agents]\ncount = 1\nposition_m = [[3, 0, 8]]\n[control]\nrate_hz = 200\n[law]\nname "
      "= 'trajectory'\npath = 'circle'\ncentre_m = [0, 0, 8]\nradius_m = 3.0\nperiod_s = 12.0\np_gain = 1.2\nd_gain = "
      "1.0\n");
  ExpectTrue(run, 1, "circle");
  const double error_m = TrackingErrorOfCircle_m(run.experiment.agent(1).airframe, 3, 12, 1.2, 1.0);
  EXPECT_NEAR(run.Predicted("tracking_rms_m"), error_m, 0.1 * error_m + 0.001);
}

TEST(LoopBands, HoldForAFigureEightWhoseFeedForwardComesLate) {
  const LawRun run(
      "[run]\nduration_s = 60.0\n[physics]\ncollisions = false\nground = false\n[agents]\ncount = 1\nposition_m = "
      "[[0, 0, 8]]\n[law]\nname = 'trajectory'\npath = 'figure_eight'\ncentre_m = [0, 0, 8]\nradius_m = 3.0\nperiod_s "
      "= 11.2\np_gain = 1.2\nd_gain = 0.5\n");
  ExpectTrue(run, 1, "figure eight");
  EXPECT_GT(run.Predicted("tracking_rms_m"), 0.03) << "and not 2e-5";
  EXPECT_THAT(run.text, HasSubstr("; theory: within "));
  EXPECT_THAT(run.text, HasSubstr(" +- "));
}

TEST(LoopBands, HoldForLawsThatWantVelocities) {
  const struct {
    std::string law, graph;
  } rows[] = {{"name = 'containment'\nleaders = [1, 5]\ngain = 0.5\n", "topology = 'path'\n"},
              {"name = 'cyclic_pursuit'\ngain = 0.3\nalpha_deg = 20.0\n", "topology = 'ring'\n"},
              {"name = 'bearing_formation'\nshape = 'circle'\ngain = 0.4\n", "topology = 'complete'\n"}};
  for (const std::string agents : {"", "airframe = 'crazyflie'\n", "model = 'double_integrator'\n"})
    for (const auto& row : rows) ExpectTrue(LawRun(Team(20, agents, row.law, row.graph)), 1, row.law + agents);
}

TEST(LoopAgreement, TimesAndRatesOfLinearTeamsOfQuadrotorsAreThoseOfBodiesThatTurn) {
  int judged = 0;
  for (const std::string airframe : {"", "airframe = 'crazyflie'\n"})
    for (const std::string law : {"name = 'consensus'\np_gain = 0.3\nbeta = 1.2\n", "name = 'consensus'\nbeta = 1.6\n",
                                  "name = 'velocity_consensus'\np_gain = 0.5\n"})
      for (const double size_m : {0.3, 3.0}) {
        const std::string places = fmt::format("[[{0}, 0, 2], [0, {0}, 3], [-{0}, 0, 4], [0, -{0}, 5]]", size_m);
        const LawRun run("[run]\nduration_s = 40\n[agents]\ncount = 4\nposition_m = " + places + "\n" + airframe +
                         "[graph]\ntopology = 'ring'\n[law]\n" + law);
        if (!run.prediction.settling_time_s) {
          EXPECT_NE(run.prediction.silent, "") << law << size_m;
          continue;
        }
        ++judged;
        const auto& off = run.summary["consensus"]["deviation"];
        EXPECT_NEAR(off["settling_time_s"].get<double>(), 0, 0.02 + 0.05 * *run.prediction.settling_time_s)
            << airframe << law << size_m;
        EXPECT_NEAR(off["rate_per_s"].get<double>(), 0, 0.1 * run.prediction.rate_per_s.value_or(0))
            << airframe << law << size_m;
      }
  EXPECT_GE(judged, 6);
}

TEST(LoopAgreement, WhereTheLimitOfTheTiltMovesTheMeetingPointTheoryIsSilentOfIt) {
  const LawRun run(
      "[run]\nduration_s = 30\n[physics]\ncollisions = false\n[agents]\ncount = 3\nairframe = 'crazyflie'\n"
      "position_m = [[-3.672226, -2.57523, 1.5], [0.686172, -0.515671, 2.5], [-1.616807, -0.524825, 3.5]]\n"
      "[control]\nrate_hz = 50\n[graph]\ntopology = 'complete'\n[law]\nname = 'velocity_consensus'\np_gain = "
      "0.877792\n");
  EXPECT_EQ(run.prediction.silent,
            "the limit of the tilt cuts what quadrotors are commanded, and moves where they meet");
  EXPECT_FALSE(run.prediction.value_m || run.prediction.settling_time_s || run.prediction.rate_per_s);
}

TEST(LoopAgreement, AThresholdThatASwingMayJustPassIsNoTimeToTell) {
  const LawRun run(
      "[run]\nduration_s = 30\n[agents]\ncount = 3\nairframe = 'crazyflie'\nposition_m = [[-1.21498, 1.680994, 2.5], "
      "[-0.344816, -1.396532, 1.5], [1.485247, -3.493487, 3.5]]\n[control]\nrate_hz = 50\n[graph]\ntopology = "
      "'binary_tree'\n[law]\nname = 'consensus'\np_gain = 1.143098\nbeta = 1.603281\n");
  EXPECT_FALSE(run.prediction.settling_time_s);
  EXPECT_THAT(run.prediction.silent, HasSubstr("where"));
}

TEST(LoopAgreement, WhereTheTiltIsCutOftenNothingIsToldOfWhereAndWhenQuadrotorsMeet) {
  const Prediction cut = Predict(Load(
      "[run]\nduration_s = 30\n[agents]\ncount = 3\nairframe = 'mascot_published'\nposition_m = [[-9, 0, 2], [9, 1, "
      "3], [0, 9, 4]]\n[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\np_gain = 0.5\nbeta = 1.5\n"));
  EXPECT_EQ(cut.silent, "the limit of the tilt cuts more than 2 % of what quadrotors are commanded");
  EXPECT_FALSE(cut.value_m || cut.settling_time_s || cut.rate_per_s);
  EXPECT_EQ(cut.stable, true);
}

TEST(LoopBands, AreSilentAboutTimesThatBodiesThatLagDoNotReach) {
  const LawRun run(Team(20, "", "name = 'finite_time'\nform = 'sign'\ngain = 0.3\n"));
  EXPECT_TRUE(run.Law()["agreement_time_s"].is_null());
  EXPECT_TRUE(run.Law()["predicted"]["agreement_time_s"].is_null());
  EXPECT_THAT(run.Law()["reasons"]["agreement_time_s"].get<std::string>(),
              HasSubstr("bodies that lag do not come to it by the end of the run"));
}

TEST(LoopBands, AreSilentWhereTheLimitOfTheTiltCutsOftenHoweverLongTheTeamRestsThereafter) {
  for (const double duration_s : {5.0, 60.0, 120.0})
    EXPECT_EQ(
        Predict(Load(Team(duration_s, "airframe = 'mascot_published'\n", "name = 'event_triggered'\ngain = 2.0\n")))
            .silent,
        "the limit of the tilt cuts more than 2 % of what quadrotors are commanded")
        << duration_s;
}

TEST(LoopBands, AreSilentInWordsWhereTheLoopDoesNotDescribeTheFlight) {
  const auto silent = [](const std::string& agents, const std::string& more = "") {
    const Prediction prediction =
        Predict(Load(Team(10, agents, "name = 'containment'\nleaders = [1, 5]\n", "topology = 'path'\n", more)));
    EXPECT_THAT(prediction.law_figures, IsEmpty());
    return prediction.silent;
  };
  EXPECT_EQ(silent("", "[link]\nloss = 0.1\n"), "samples are lost at random");
  EXPECT_EQ(silent("", "[sensors.own]\nposition_std_m = 0.01\n"), "what agents measure is noisy or late");
  EXPECT_EQ(silent("", "[physics.wind]\ngust_std_m_per_s = 1.0\n"), "the wind has gusts");
  EXPECT_EQ(silent("", "[[physics.rotor_failures]]\nagent = 1\nrotor = 1\nat_s = 5.0\nremaining = 0.9\n"),
            "rotors fail");
  EXPECT_EQ(silent("heading_rad = [1.0, 0, 0, 0, 0]\n"), "agent 1 turns to control.heading_rad on its way");
  EXPECT_EQ(silent("airframe = { max_thrust_n = 10 }\n"), "quadrotors cannot keep their height");
  EXPECT_EQ(silent("", "[control]\nrate_hz = 10\n"), "the attitude loop of agent 1 is unstable");
}

TEST(LoopBands, AreSilentWhereBodiesMayTouch) {
  const std::string level =
      "[run]\nduration_s = 20.0\n[agents]\ncount = 2\nposition_m = [[0, 0, 2], [4, 0, 2]]\n[law]\nname = "
      "'event_triggered'\ngain = 0.3\n";
  EXPECT_THAT(Predict(Load(level)).silent, HasSubstr("agents 1 and 2 may touch, "));
  EXPECT_EQ(Predict(Load(level + "[physics]\ncollisions = false\n")).silent, "");
  const std::string low =
      "[run]\nduration_s = 10.0\n[agents]\ncount = 2\nposition_m = [[0, 0, 0.07], [4, 0, 2]]\n[law]\nname = "
      "'event_triggered'\ngain = 0.3\n";
  EXPECT_THAT(Predict(Load(low)).silent, HasSubstr("agent 1 may touch the ground, "));
}

TEST(LoopBands, AreSilentBeyondTheirBudgetOfWork) {
  std::string toml =
      Team(600, "", "name = 'finite_time'\ngain = 0.3\n", "topology = 'complete'\n", "[control]\nrate_hz = 200\n");
  EXPECT_GT(WorkOfLoops(Load(toml)), kMaxLoopWork);
  EXPECT_EQ(Predict(Load(toml)).silent,
            "so many agents, edges and ticks are more than are flown ahead on lagging bodies");
}

}  // namespace
}  // namespace mascot
