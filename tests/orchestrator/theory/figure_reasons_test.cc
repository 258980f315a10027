// Theory says what each figure that a law measures will be, or why it does not say.
#include <gmock/gmock.h>

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/model_traits.h"
#include "orchestrator/report/law_report.h"
#include "orchestrator/theory/theory.h"
#include "tests/support/folders.h"
#include "tests/support/param_name.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;

/// What is changed in an experiment of each law: other bodies, other graphs, shorter and slower runs.
const std::vector<std::vector<Override>>& Changes() {
  static const std::vector<std::vector<Override>> kChanges = {
      {},
      {{.key = "agents.model", .value = "single_integrator"}},
      {{.key = "agents.model", .value = "double_integrator"}},
      {{.key = "agents.model", .value = "quadrotor"}},
      {{.key = "agents.model", .value = "unicycle"}},
      {{.key = "run.duration_s", .value = "0.5"}},
      {{.key = "control.rate_hz", .value = "5"}},
      {{.key = "graph.range_m", .value = "3.0"}},
      {{.key = "link.loss", .value = "0.1"}},
      {{.key = "law.gain", .value = "100.0"}},
      {{.key = "law.gain", .value = "0.001"}},
      {{.key = "law.trigger", .value = "dynamic"}},
      {{.key = "law.disturbance_m_per_s", .value = "0.0"}},
      {{.key = "law.repulsion", .value = "0.001"}},
      {{.key = "law.density", .value = "[[1, 1, 1, 1]]"}},
      {{.key = "law.f", .value = "0"}},
      {{.key = "law.exponent", .value = "0.1"}},
      {{.key = "law.step", .value = "100.0"}},
      {{.key = "law.safety.distance_m", .value = "0.1"}},
  };
  return kChanges;
}

class FigureReasons : public testing::TestWithParam<std::string_view> {};

TEST_P(FigureReasons, StandWherePredictionsDoNot) {
  const std::string path = test::SourceFolder() + "/configs/" + std::string(GetParam()) + ".toml";
  const std::string text = ReadRegularFile(path);
  int read = 0;
  for (const std::vector<Override>& change : Changes()) {
    Experiment experiment;
    try {
      experiment = LoadExperiment(Section::FromText(text, path, change), "test");
    } catch (const ConfigError&) {
      continue;  // this law has no such key, or takes no such body
    }
    ++read;
    const std::string what = change.empty() ? "as it is" : change[0].key + " = " + change[0].value;
    const Prediction prediction = Predict(experiment);
    Json json;
    AddPredictedFigures(experiment, prediction, json);
    for (const LawFigure& figure : EntryOf(experiment.law).figures) {
      const std::string name(figure.name);
      const Json& value = json["figures"].at(name);
      bool is_there = !value.is_null();
      for (const Json& one : value.is_array() ? value : Json::array()) is_there = is_there && !one.is_null();
      const Json& reason = json["figure_reasons"].at(name);
      EXPECT_NE(is_there, reason.is_string() && !reason.get<std::string>().empty()) << what << ": " << name;
      EXPECT_EQ(value.is_null(), json["figure_bounds"].at(name).is_null()) << what << ": " << name;
      EXPECT_EQ(value.is_null(), json["figure_rounding"].at(name).is_null()) << what << ": " << name;
    }
  }
  EXPECT_GT(read, 3) << "experiments of this law";
}

std::vector<std::string_view> LawsWithFigures() {
  std::vector<std::string_view> names;
  for (const LawEntry& law : Laws())
    if (!law.figures.empty() && law.predict != nullptr) names.push_back(law.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(OfLaws, FigureReasons, testing::ValuesIn(LawsWithFigures()),
                         [](const auto& law) { return test::ParamName(std::string(law.param)); });

TEST(FigureReasonsOfCheck, AreLinesOfTheirOwn) {
  const Override ideal[] = {{.key = "agents.model", .value = "\"double_integrator\""}};
  const Experiment experiment =
      LoadExperiment(Section::FromFile(test::SourceFolder() + "/configs/flocking.toml", ideal), "test");
  std::string text;
  for (const auto& [label, line] : PredictedFigureLines(experiment, Predict(experiment)))
    text += label + ": " + line + "\n";
  EXPECT_THAT(text, HasSubstr("order: not predicted, because where the energy has minima is not known (length of"));
}

TEST(Theory, SaysSomethingOrWhyItDoesNot) {
  for (const char* name : {"leaderless", "leader_follower", "formation", "waypoint", "minmax", "switching"})
    for (const std::vector<Override>& change :
         std::vector<std::vector<Override>>{{},
                                            {{.key = "graph", .value = "{ edges = [[1, 2], [2, 1]] }"}},
                                            {{.key = "control.max_acceleration_m_per_s2", .value = "0.01"}},
                                            {{.key = "law.beta", .value = "0.001"}},
                                            {{.key = "graph.range_m", .value = "0.1"}},
                                            {{.key = "agents.model", .value = "unicycle"}}}) {
      Experiment experiment;
      try {
        experiment =
            LoadExperiment(Section::FromFile(test::SourceFolder() + "/configs/" + name + ".toml", change), "test");
      } catch (const ConfigError&) {
        continue;
      }
      const Prediction said = Predict(experiment);
      const bool says = said.stable || said.value_m || !said.minmax_edges.empty() || !said.law_figures.empty();
      EXPECT_TRUE(says || !said.silent.empty()) << name << ": " << (change.empty() ? "" : change[0].key);
    }
}

// --- bounds that say nothing --------------------------------------------------------------------------------

TEST(FigureBounds, AreNoBetterThanWhatHoldsAnywayOnlyIfTheyAreNotTold) {
  for (const LawEntry& law : Laws())
    for (const LawFigure& figure : law.figures) EXPECT_LT(figure.least, figure.most) << law.name << " " << figure.name;
}

}  // namespace
}  // namespace mascot
