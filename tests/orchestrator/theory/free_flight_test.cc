// Predictions where limits of speed or acceleration cut what laws ask for: those of closed forms are not told, and
// those that are told are true.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>

#include "tests/support/law_run.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

std::string Five(const std::string& model, const std::string& limits, const std::string& graph, const std::string& law,
                 double duration_s = 60) {
  return fmt::format(
      "[run]\nduration_s = {:.1f}\n[physics]\ncollisions = false\nground = false\n[control]\n{}\n[agents]\ncount = 5\n"
      "model = '{}'\nposition_m = [[-4, 1, 1], [3, 0, 2], [1, 5, 3], [-2, -2, 4], [6, -3, "
      "5]]\n[graph]\n{}\n[law]\n{}\n",
      duration_s, limits, model, graph, law);
}

constexpr const char* kTight = "max_speed_m_per_s = 0.3\nmax_acceleration_m_per_s2 = 0.3";
constexpr const char* kWide = "max_speed_m_per_s = 100.0\nmax_acceleration_m_per_s2 = 100.0";

TEST(Limits, ThatCutKeepTheoryFromTellingClosedFormsOfLawsWithoutThem) {
  const struct {
    std::string model, graph, law;
  } rows[] = {{"single_integrator", "topology = 'path'", "name = 'containment'\nleaders = [1, 5]\ngain = 0.5"},
              {"single_integrator", "topology = 'ring'", "name = 'prescribed_time'\ntime_s = 5.0\ngain = 0.2"},
              {"single_integrator", "topology = 'ring'", "name = 'event_triggered'\ngain = 0.5"},
              {"single_integrator", "topology = 'ring'", "name = 'event_triggered'\ngain = 0.2\ntrigger = 'dynamic'"},
              {"single_integrator", "topology = 'ring'", "name = 'cyclic_pursuit'\ngain = 0.5"},
              {"single_integrator", "topology = 'ring'", "name = 'cyclic_pursuit'\ngain = 0.05\nalpha_deg = 60.0"},
              {"single_integrator", "range_m = 12.0", "name = 'rendezvous'\ngain = 0.5"},
              {"double_integrator", "topology = 'complete'", "name = 'flocking'\ndistance_m = 3.0"}};
  for (const auto& row : rows) {
    const Prediction cut = Predict(Load(Five(row.model, kTight, row.graph, row.law)));
    EXPECT_THAT(
        cut.silent,
        MatchesRegex("the limit of the (speed|acceleration) cuts what the law asks for: of agent [1-5] at [0-9.]+ s"))
        << row.law;
    EXPECT_FALSE(cut.value_m) << row.law;
    EXPECT_EQ(Predict(Load(Five(row.model, kWide, row.graph, row.law))).silent, "") << row.law;
  }
}

TEST(Limits, OfSoManyAgentsThatNobodyIsFlownMustBeFarAboveTheFirstCommand) {
  const auto silent = [](double limit) {
    return Predict(Load(fmt::format(
                       "run.duration_s = 1000\ncontrol.max_speed_m_per_s = {:.1f}\nagents = {{ count = 40, model "
                       "= 'single_integrator' }}\ngraph.topology = 'ring'\nlaw = {{ name = 'containment', "
                       "leaders = [1], gain = 0.5 }}\n",
                       limit)))
        .silent;
  };
  EXPECT_EQ(silent(1000), "");
  EXPECT_EQ(silent(1),
            "so many agents are not flown ahead for so many ticks, to see whether a limit cuts what the law asks for");
}

TEST(Limits, ThatCutLinearTeamsAreInTheFlightThatSaysWhereAndWhenTheyMeet) {
  for (const std::string model : {"double_integrator", "single_integrator"})
    for (const std::string law :
         {"name = 'consensus'\np_gain = 0.6\nbeta = 1.5", "name = 'velocity_consensus'\np_gain = 0.5",
          "name = 'consensus'\np_gain = 0.4\nbeta = 1.2\nleader = 2"})
      for (const std::string more : {"", "[link]\ndelay_s = 0.1\n"}) {
        const LawRun run(Five(model, kTight, "topology = 'path'\n" + more, law));
        const auto& is = run.summary["consensus"];
        const std::string what = model + " " + law + " " + more;
        ASSERT_TRUE(run.prediction.settling_time_s && run.prediction.value_m) << what << run.prediction.silent;
        EXPECT_TRUE(run.prediction.from_start) << what;
        EXPECT_NEAR(is["deviation"]["settling_time_s"].get<double>(), 0, 0.021) << what;
        EXPECT_NEAR(is["deviation"]["value_m"].get<double>(), 0, 0.04) << what;  // of 10 m; it goes on
        if (run.prediction.rate_per_s && !is["deviation"]["rate_per_s"].is_null()) {
          EXPECT_NEAR(is["deviation"]["rate_per_s"].get<double>() / *run.prediction.rate_per_s, 0, 0.01) << what;
        }
        const LawRun wide(Five(model, kWide, "topology = 'path'\n" + more, law));
        EXPECT_GT(std::abs(*wide.prediction.settling_time_s - *run.prediction.settling_time_s), 0.5) << what;
      }
}

TEST(Limits, ThatCutATeamWhoseSamplesAreLostLeaveNoNumberOfTheLinearTeam) {
  const Prediction lossy = Predict(Load(Five("double_integrator", kTight, "topology = 'path'\n[link]\nloss = 0.2\n",
                                             "name = 'consensus'\np_gain = 0.6\nbeta = 1.5")));
  EXPECT_EQ(lossy.silent, "a limit cuts what the law asks for, and samples are lost: neither is linear");
  EXPECT_FALSE(lossy.value_m || lossy.settling_time_s || lossy.rate_per_s);
  EXPECT_TRUE(lossy.stable.value_or(false));
}

TEST(Limits, AFlightThatDoesNotSettleSoonIsNotToldTheTimeOfAMode) {
  const Prediction slow = Predict(Load(Five("double_integrator", "max_acceleration_m_per_s2 = 0.001",
                                            "topology = 'path'", "name = 'consensus'\np_gain = 0.6\nbeta = 1.5", 5)));
  EXPECT_EQ(slow.silent,
            "a limit cuts what the law asks for, and the team, which is flown ahead, does not settle soon");
  EXPECT_FALSE(slow.value_m || slow.settling_time_s || slow.rate_per_s);
}

TEST(Contacts, OnTheWayAreFoundByFlyingAheadAndKeepTheoryFromTellingFigures) {
  const auto silent = [](const std::string& law, const std::string& more = "", const std::string& places = "") {
    return Predict(Load("[run]\nduration_s = 15\n[agents]\ncount = 3\nmodel = 'single_integrator'\nposition_m = " +
                        (places.empty() ? "[[2, 0, 3], [-1, 1.7, 3], [-1, -1.7, 3]]" : places) +
                        "\n[graph]\ntopology = 'ring'\n" + more + "[law]\n" + law))
        .silent;
  };
  const std::string pursuit = "name = 'cyclic_pursuit'\ngain = 0.5\nalpha_deg = 20.0\n";
  EXPECT_THAT(silent(pursuit), MatchesRegex("agents [12] and [23] may touch, [0-9.]+ s from the start"));
  EXPECT_EQ(silent(pursuit, "", "[[2, 0, 3], [-1, 1.7, 4], [-1, -1.7, 5]]"), "") << "at heights of their own";
  EXPECT_EQ(silent(pursuit, "[physics]\ncollisions = false\n"), "");
  EXPECT_THAT(silent("name = 'containment'\nleaders = [1]\ngain = 0.5\n"), HasSubstr(" may touch, "));
  const std::string wall = "[[physics.obstacles]]\nshape = 'box'\nposition_m = [0.8, 0, 4]\nsize_m = [0.5, 2, 8]\n";
  EXPECT_THAT(silent("name = 'event_triggered'\ngain = 0.5\n", wall, "[[4, 0, 3], [-1, 1.7, 4], [-1, -1.7, 5]]"),
              MatchesRegex("agent 1 may touch an obstacle, [0-9.]+ s from the start"));
  EXPECT_THAT(silent("name = 'event_triggered'\ngain = 0.5\naxes = 'xyz'\n", "[physics]\ncollisions = false\n",
                     "[[4, 0, 3], [-1, 1.7, 0.101], [-1, -1.7, 2]]"),
              HasSubstr(" may touch the ground, "));
  EXPECT_EQ(silent("name = 'average_tracking'\n"), "") << "messages do not touch";
}

TEST(Linear, ATeamThatAgreesFromTheStartIsToldNoTimeAndNoShortRun) {
  const std::string same =
      "run.duration_s = 2\nphysics.collisions = false\nagents = { count = 3, model = 'double_integrator', position_m = "
      "[[0.1, 0.7, 1], [0.1, 0.7, 2], [0.1, 0.7, 3]] }\ngraph.topology = 'path'\nlaw.name = 'consensus'\n";
  const LawRun run(same);
  EXPECT_FALSE(run.prediction.settling_time_s);
  EXPECT_TRUE(run.summary["consensus"]["settling_time_s"].is_null());
  EXPECT_THAT(run.prediction.warnings, testing::Not(testing::Contains(HasSubstr("run.duration_s"))));
}

TEST(Linear, ATeamOfQuadrotorsMeetsWhereItsLowLevelLoopsBringItInSpiteOfDrag) {
  for (const std::string compensation : {"true", "false"}) {
    const LawRun run(
        "[run]\nduration_s = 40.0\n[agents]\ncount = 2\nposition_m = [[0, 0, 1], [1, 0, 3]]\n"
        "velocity_m_per_s = [[2, 0, 0], [0, 0, 0]]\n[law]\nname = 'consensus'\n[control]\ndrag_compensation = " +
        compensation + "\n");
    ASSERT_TRUE(run.prediction.value_m);
    EXPECT_NEAR(run.summary["consensus"]["deviation"]["value_m"].get<double>(), 0, 1e-6) << compensation;
    EXPECT_NEAR(run.prediction.value_m->x(), 1.495, 1e-3) << compensation;
  }
}

TEST(CyclicPursuit, AgentsThatAreTogetherButForRoundingHaveNoTurnRateToPredict) {
  const LawRun run(Five("single_integrator", kWide, "topology = 'ring'", "name = 'cyclic_pursuit'\ngain = 2.0", 60));
  EXPECT_LT(run.Measured("radius_m"), 1e-9);
  EXPECT_TRUE(run.Law()["predicted"]["turn_rate_rad_per_s"].is_null());
  EXPECT_EQ(run.Law()["reasons"]["turn_rate_rad_per_s"],
            "agents are together by the end, and rounding decides where each of them is");
  const LawRun brief(Five("single_integrator", kWide, "topology = 'ring'", "name = 'cyclic_pursuit'\ngain = 2.0", 4));
  EXPECT_NEAR(brief.Measured("turn_rate_rad_per_s"), brief.Predicted("turn_rate_rad_per_s"), 1e-6);
}

}  // namespace
}  // namespace mascot
