// Why theory is silent: shipped experiments, changed until it has nothing to say.

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "agent/laws/laws.h"
#include "orchestrator/theory/theory.h"
#include "tests/support/folders.h"
#include "tests/support/param_name.h"

namespace mascot {
namespace {

struct Row {
  std::string config;
  std::string key, value;
  std::string silent;
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.config << ": " << row.key << " = " << row.value; }

class Silence : public testing::TestWithParam<Row> {};

std::string SilentOf(const std::string& config, const std::vector<Override>& changes) {
  const std::string path = test::SourceFolder() + "/configs/" + config + ".toml";
  return Predict(LoadExperiment(Section::FromFile(path, changes), config)).silent;
}

TEST_P(Silence, IsExplained) {
  const Row& row = GetParam();
  EXPECT_EQ(SilentOf(row.config, {}), "") << "the experiment as shipped is predicted";
  EXPECT_EQ(SilentOf(row.config, {{.key = row.key, .value = row.value}}), row.silent);
}

constexpr const char* kSixAtOnePlace = "[[1, 2, 1], [1, 2, 2], [1, 2, 3], [1, 2, 4], [1, 2, 5], [1, 2, 6]]";
constexpr const char* kTwoPairs = "{ edges = [[1, 2], [2, 1], [3, 4], [4, 3]] }";

std::string NameOf(const testing::TestParamInfo<Row>& row) {
  return test::ParamName(row.param.config + " " + row.param.key);
}

INSTANTIATE_TEST_SUITE_P(
    OfLaws, Silence,
    testing::Values(
        Row{"platoon", "control.max_acceleration_m_per_s2", "0.1",
            "the limit of the acceleration cuts what the law asks for"},
        Row{"pursuit_evasion", "control.max_speed_m_per_s", "0.5", "the limit of the speed cuts the pursuit"},
        Row{"pursuit_evasion", "graph", "{ edges = [[1, 2], [1, 3], [1, 4]] }", "nobody hears the evader"},
        Row{"affine_formation", "law.gain", "0.0", "with gain = 0 followers stay where they are"},
        Row{"containment", "law.gain", "0.0", "with gain = 0 followers stay where they are"},
        Row{"cyclic_pursuit", "law.gain", "1000.0", "the radius is no finite multiple of that at the start"},
        Row{"cyclic_pursuit", "agents.position_m", kSixAtOnePlace,
            "the radius is no finite multiple of that at the start"},
        Row{"bearing_formation", "agents.position_m", kSixAtOnePlace,
            "all agents start at one place, from which there are no directions"},
        Row{"distance_formation", "law.gain", "0.5", "a limit cuts the speeds that the law asks for"},
        Row{"switching", "agents.position_m", kSixAtOnePlace,
            "agents agree when they start: there is nothing to settle"},
        Row{"leader_follower", "law.leader_waypoints_m", "[[2, 1, 3], [4, 1, 3]]",
            "agents settle after their leader, agent 4, which does not stand still"},
        Row{"finite_time", "graph", kTwoPairs, "the graph is not connected"},
        Row{"prescribed_time", "graph", kTwoPairs, "the graph is not connected"},
        Row{"prescribed_time", "law.time_s", "1e6", "law.time_s is after the end of the run"}),
    NameOf);

// --- large teams ------------------------------------------------------------------------------------

/// A law that is predicted up to `most` agents.
struct LargeTeam {
  std::string law;  ///< its name, and further lines of [law]
  int most = 0;
  std::string silent;
};

void PrintTo(const LargeTeam& team, std::ostream* out) { *out << team.law; }

class LargeTeams : public testing::TestWithParam<LargeTeam> {};

std::string SilentOfTeam(const std::string& law, int count, const std::string& topology) {
  const std::string toml =
      "[run]\nduration_s = 1.0\n[agents]\nmodel = 'single_integrator'\nrandom = { min_m = [-500, -500, 1], max_m = "
      "[500, 500, 1000] }\ncount = " +
      std::to_string(count) + "\n[graph]\ntopology = '" + topology + "'\n[law]\nname = " + law;
  const Experiment experiment = LoadExperiment(Section::FromText(toml, "test.toml"), "test");
  return LawsIn(experiment).front()->predict(experiment).silent;
}

TEST_P(LargeTeams, AreBeyondWhatTheoryComputes) {
  EXPECT_EQ(SilentOfTeam(GetParam().law, 4, "complete"), "");
  EXPECT_EQ(SilentOfTeam(GetParam().law, GetParam().most + 1, "path"), GetParam().silent);
}

INSTANTIATE_TEST_SUITE_P(
    OfLaws, LargeTeams,
    testing::Values(LargeTeam{"'finite_time'\n", 1000, "the modes of so many agents are not computed"},
                    LargeTeam{"'gradient_tracking'\n", 40, "the modes of so many agents are not computed"},
                    LargeTeam{"'containment'\nleaders = [1, 2]\n", 1000, "the team is large"},
                    LargeTeam{"'distance_formation'\nshape = 'circle'\ngain = 1e-9\n", 200,
                              "the team is large: its rigidity is not checked"},
                    LargeTeam{"'bearing_formation'\nshape = 'circle'\n", 200,
                              "the team is large: its rigidity is not checked"}),
    [](const auto& row) { return test::ParamName(row.param.law.substr(1, row.param.law.find('\'', 1) - 1)); });

// --- phases -----------------------------------------------------------------------------------------

TEST(SilenceOfAPhase, AfterALawThatFailsOnIdealBodiesNamesTheFailure) {
  const std::string toml =
      "[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\nname = 'custom'\npython = "
      "'''\n"
      "def control(t, me, neighbours):\n    return [0, 0] if t < 0.2 else me.no_such_thing\n'''\n"
      "[[law.schedule]]\nat_s = 0.5\nname = 'consensus'\n";
  const Prediction prediction = Predict(LoadExperiment(Section::FromText(toml, "test.toml"), "test"));
  EXPECT_THAT(prediction.later.at(0).prediction.silent,
              testing::StartsWith("a law before it fails on ideal bodies: tick 20: "));
}

}  // namespace
}  // namespace mascot
