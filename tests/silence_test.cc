// Why theory is silent: shipped experiments, changed until it has nothing to say.

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "agent/laws.h"
#include "orchestrator/theory/theory.h"
#include "tests/param_name.h"

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
  const std::string path = std::string(MASCOT_SOURCE_DIR "/configs/") + config + ".toml";
  return Predict(LoadExperiment(Section::FromFile(path, changes), config)).silent;
}

TEST_P(Silence, IsExplained) {
  const Row& row = GetParam();
  EXPECT_EQ(SilentOf(row.config, {}), "") << "the experiment as shipped is predicted";
  EXPECT_EQ(SilentOf(row.config, {{.key = row.key, .value = row.value}}), row.silent);
}

constexpr const char* kTwoPairs = "{ edges = [[1, 2], [2, 1], [3, 4], [4, 3]] }";

std::string NameOf(const testing::TestParamInfo<Row>& row) {
  return test::ParamName(row.param.config + " " + row.param.key);
}

INSTANTIATE_TEST_SUITE_P(
    OfLaws, Silence,
    testing::Values(
        Row{"platoon", "control.max_acceleration_m_per_s2", "0.1", "the limit of the acceleration cuts the swing"},
        Row{"pursuit_evasion", "control.max_speed_m_per_s", "0.5", "the limit of the speed cuts the pursuit"},
        Row{"pursuit_evasion", "graph", "{ edges = [[1, 2], [1, 3], [1, 4]] }", "nobody hears the evader"},
        Row{"affine_formation", "law.gain", "0.0", "with gain = 0 followers stay where they are"},
        Row{"containment", "law.gain", "0.0", "with gain = 0 followers stay where they are"},
        Row{"finite_time", "graph", kTwoPairs, "the graph is not connected"},
        Row{"gradient_tracking", "graph", kTwoPairs, "the graph is not connected"},
        Row{"prescribed_time", "graph", kTwoPairs, "the graph is not connected"}),
    NameOf);

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
