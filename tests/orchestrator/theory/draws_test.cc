// What a run draws by its seed: DrawsOf() beside two flights with two seeds.
#include "orchestrator/theory/draws.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "agent/laws/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

Experiment Read(const std::string& toml, const std::string& seed = "1", const std::string& duration_s = "0.3") {
  const Override overrides[] = {{.key = "run.seed", .value = seed}, {.key = "run.duration_s", .value = duration_s}};
  return LoadExperiment(Section::FromText(toml, "draws.toml", overrides), "draws");
}

/// The path of an experiment of this time: where agents are, and what they want, at each tick.
std::vector<Eigen::Vector3d> PathOf(const Experiment& experiment) {
  class Path final : public RowSink {
   public:
    void Add(const FlownRow& row) override {
      for (const Motion& motion : row.decoded().motions) points.push_back(motion.p_WB);
      for (const Command& command : row.decoded().commands) points.push_back(command.a_limited_W);
    }
    std::vector<Eigen::Vector3d> points;
  } path;
  EXPECT_EQ(RunInProcess(experiment, {&path}, [] { return true; }).failure, "");
  return path.points;
}

bool DependsOnSeed(const std::string& toml, const std::string& duration_s = "0.3") {
  return PathOf(Read(toml, "1", duration_s)) != PathOf(Read(toml, "2", duration_s));
}

const std::string kStill =
    "[run]\nduration_s = 0.3\n[agents]\ncount = 3\nposition_m = [[0, 0, 1], [3, 0, 2], [0, 4, 3]]\n"
    "override = [{ id = 1 MORE}]\n[graph]\nGRAPH\n[law]\nLAW\n";

/// kStill with other words for its capitals, and `tables` at the end.
std::string Still(const std::string& tables, const std::string& graph = "topology = 'ring'",
                  const std::string& more = "", const std::string& law = "p_gain = 0.5") {
  std::string toml = kStill;
  for (const auto& [word, text] : {std::pair("MORE", more), std::pair("GRAPH", graph), std::pair("LAW", law)})
    toml.replace(toml.find(word), std::string(word).size(), text);
  return toml + tables;
}

TEST(Draws, NothingIsDrawnWhereNothingIsLeftToChance) {
  EXPECT_THAT(DrawsOf(Read(Still(""))), IsEmpty());
  EXPECT_FALSE(DependsOnSeed(Still("")));
}

TEST(Draws, EachKeyThatLeavesSomethingToChanceIsNamedAndChangesTheRun) {
  const auto only = [](const std::string& key, const std::string& toml) {
    EXPECT_THAT(DrawsOf(Read(toml)), ElementsAre(key)) << toml;
    EXPECT_TRUE(DependsOnSeed(toml)) << toml;
  };
  only("agents.random", "[agents]\ncount = 3\n[run]\nduration_s = 0.3\n");
  only("graph.random", Still("", "random = { kind = 'erdos_renyi', p = 0.5 }"));
  only("graph.schedule.random",
       Still("", "topology = 'ring'\nschedule = [{ at_s = 0.1, random = { kind = 'erdos_renyi', p = 0.5 } }]"));
  only("link.loss", Still("[link]\nloss = 0.5\n"));
  only("link.loss", Still("[link]\noverride = [{ edges = [[1, 2]], loss = 0.5 }]\n"));
  only("link.gilbert_elliott", Still("[link]\ngilbert_elliott = { good_to_bad = 0.5, bad_to_good = 0.5 }\n"));
  only("link.jitter_s", Still("[link]\ndelay_s = 0.05\njitter_s = 0.05\n"));
  only("link.reordering", Still("[link]\ndelay_s = 0.05\nreordering = 0.5\n"));
  only("sensors.own", Still("[sensors]\nown = { position_std_m = 0.1 }\n"));
  only("sensors.heard", Still("[sensors]\nheard = { velocity_bias_std_m_per_s = 0.1 }\n", "topology = 'ring'", "",
                              "p_gain = 0.5\nv_gain = 0.5"));
  only("physics.wind.gust_std_m_per_s", Still("[physics]\nwind = { gust_std_m_per_s = 1.0 }\n"));
  only("agents.override.lie", Still("", "topology = 'ring'", ", lie = { kind = 'random', offset_m = [1, 1, 0] }"));
  only("law",
       Still(
           "", "topology = 'ring'", "",
           "name = 'custom'\npython = '''\ndef control(t, me, neighbours):\n    return me.random.normal(size=2)\n'''"));
}

TEST(Draws, WhatAnEventLeavesToChanceCounts) {
  const std::string toml = Still("[[events]]\nat_s = 0.1\nset = { \"link.loss\" = 0.5 }\n");
  EXPECT_THAT(DrawsOf(Read(toml)), ElementsAre("link.loss"));
  EXPECT_TRUE(DependsOnSeed(toml));
}

TEST(Draws, WhatIsCertainOrConcernsNobodyIsNotDrawn) {
  const auto nothing = [](const std::string& toml) {
    EXPECT_THAT(DrawsOf(Read(toml)), IsEmpty()) << toml;
    EXPECT_FALSE(DependsOnSeed(toml)) << toml;
  };
  nothing(Still("", "random = { kind = 'erdos_renyi', p = 1.0 }"));
  nothing(Still("", "random = { kind = 'geometric', radius_m = 4.5 }"));
  nothing(Still("", "random = { kind = 'small_world', k = 2, p = 0.0 }"));
  nothing(Still("[link]\nloss = 1.0\n"));
  nothing(Still("[link]\nreordering = 0.5\n"));
  nothing(Still("[link]\nloss = 0.5\n", "edges = []"));
  nothing(Still("[sensors]\nheard = { position_std_m = 0.1 }\n", "edges = []"));
  nothing(Still("", "edges = []", ", lie = { kind = 'random', offset_m = [1, 1, 0] }"));
  nothing(Still("", "topology = 'ring'", ", lie = { kind = 'oscillating', offset_m = [1, 1, 0], period_s = 1 }"));
  nothing(Still("", "topology = 'ring'", "",
                "name = 'custom'\npython = '''\ndef control(t, me, neighbours):\n    return [0.1, 0.2]\n'''"));
}

TEST(Draws, ShippedExperimentsWithoutThemAreTheSameWithEverySeed) {
  int still = 0, drawn = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::SourceFolder() + "/configs")) {
    if (entry.path().extension() != ".toml") continue;
    const std::string toml = ReadFile(entry.path().string());
    const Section document = Section::FromFile(entry.path().string());
    const Experiment experiment = LoadExperiment(document, "shipped");
    const bool draws = !DrawsOf(experiment).empty();
    ++(draws ? drawn : still);
    if (draws || experiment.events.size() > 0) continue;
    EXPECT_FALSE(DependsOnSeed(experiment.resolved, "0.2")) << entry.path();
  }
  EXPECT_GT(still, 3);
  EXPECT_GT(drawn, 3);
}

}  // namespace
}  // namespace mascot
