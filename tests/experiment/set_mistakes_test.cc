// Mistakes that values of the command line make in an experiment are said to be theirs, wherever they show.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/toml/blame.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr const char* kSmall =
    "run.duration_s = 2\n"
    "agents = { count = 4 }\n"
    "graph.topology = \"ring\"\n"
    "law = { name = \"consensus\" }\n";

std::vector<std::string> MistakesOf(const std::string& text, const std::vector<Override>& overrides) {
  try {
    LoadExperiment(text, "small.toml", overrides);
    return {};
  } catch (const ConfigError& error) {
    return error.mistakes();
  }
}

struct Row {
  std::string set;
  std::string mistake;  ///< after "--set KEY=VALUE: "
};

TEST(MistakesOfSet, StandAtSet) {
  const std::vector<Row> rows = {
      {"law.p_gain.x=1", "law.p_gain: expected a number in [0, 1000], got a table"},
      {"law.p_gian=1", "law.p_gian: unknown key (did you mean \"p_gain\"?)"},
      {"law.p_gain='a'", "law.p_gain: expected a number in [0, 1000], got 'a'"},
      {"law.p_gain=-1", "law.p_gain: expected a number in [0, 1000], got -1"},
      {"law=3", "law: expected a table, got 3"},
      {"law={name='nobody'}", "law.name: expected one of "},
      {"law.safety.gamma=2", "law.safety.gamma: expected distance_m with it, got none"},
      {"agents.random.min_m=[0, 0]", "agents.random.min_m: expected three numbers in [-1e+06, 1e+06], got a list of 2"},
      {"agents.count.x=1", "agents.count: expected a table to set x in, got 4"},
      {"agents.override[0].id=1", "agents.override: expected a list to set [0] in, got nothing"},
      {"agents.override=[{}]", "agents.override[0].id: expected an integer in [1, 4], got nothing"},
      {"agents.position_m=[[0, 0, 1]]", "agents.position_m: expected 4 points, one per agent, got a list of 1"},
      {"agents.position_m=[[0,0,1],[1,1],[2,0,1],[3,0,1]]",
       "agents.position_m[1]: expected three numbers in [-1e+06, 1e+06], got a list of 2"},
      {"link.loss=1.5", "link.loss: expected a number in [0, 1], got 1.5"},
      {"nothing.of.this=1", "nothing: unknown key"},
      // of two keys that must fit, the other one is in the file, or nowhere
      {"physics.rate_hz=77", "control.rate_hz: expected a divisor of physics.rate_hz (77), got 100"},
      {"law.name=rendezvous",
       "law.name: expected graph.range_m, within which agents hear each other, for the law "
       "rendezvous, got none"},
      {"law.name=waypoint", "law.waypoints_m: expected "},
      {"events=[{at_s=1}]", "events[0]: expected one of set, goto, graph, cut, mend, fault, restart, got none"},
  };
  for (const Row& row : rows) {
    const auto equals = row.set.find('=');
    const auto mistakes = MistakesOf(kSmall, {{row.set.substr(0, equals), row.set.substr(equals + 1)}});
    ASSERT_FALSE(mistakes.empty()) << row.set;
    for (const std::string& mistake : mistakes) EXPECT_TRUE(mistake.starts_with("--set " + row.set + ": ")) << mistake;
    EXPECT_TRUE(std::ranges::any_of(mistakes, [&](const std::string& mistake) {
      return mistake.starts_with("--set " + row.set + ": " + row.mistake);
    })) << mistakes.front();
  }
}

TEST(MistakesOfSet, SayWhereTheKeyOfTheFileStandsThatTheyContradict) {
  EXPECT_THAT(MistakesOf("run.duration_s = 2\nagents.count = 3\n\nlaw = { name = 'consensus', p_gain = 0.1 }\n",
                         {{"law.name", "flocking"}}),
              ElementsAre("--set law.name=flocking: law.p_gain: unknown key (small.toml:4:29)"));
  EXPECT_THAT(MistakesOf("run.duration_s = 2\nagents.count = 3\ncontrol.rate_hz = 100\nlaw.name = 'consensus'\n",
                         {{"run.seed", "1"}, {"physics.rate_hz", "77"}, {"law.p_gain", "2"}}),
              ElementsAre("--set physics.rate_hz=77: control.rate_hz: expected a divisor of physics.rate_hz (77), got "
                          "100 (small.toml:3:19)"));
}

TEST(MistakesOfSet, AreNoneWhereAKeyTakesThePlaceOfOneInTheFile) {
  EXPECT_THAT(MistakesOf(kSmall, {{"graph.edges", "[[1, 2], [2, 3], [3, 4], [4, 1]]"}}), IsEmpty()) << "of topology";
  EXPECT_THAT(MistakesOf(kSmall, {{"graph.random", "{kind = 'erdos_renyi', p = 0.9}"}}), IsEmpty());
  EXPECT_THAT(MistakesOf(kSmall, {{"agents.position_m", "[[0,0,1],[3,0,1],[6,0,1],[9,0,1]]"}}), IsEmpty());
  EXPECT_THAT(
      MistakesOf(kSmall, {{"graph.edges", "[[1, 2]]"}, {"graph.topology", "ring"}}),
      ElementsAre(testing::HasSubstr(
          "graph.edges: expected one of topology, laplacian, adjacency, edges, random, got topology and edges")));
}

TEST(MistakesOfSet, LeaveThoseOfTheFileAtTheFile) {
  const std::string wrong = "run.duration_s = -2\nagents.count = 3\nlaw.name = 'consensus'\n";
  const std::string of_file = "small.toml:1:18: run.duration_s: expected a number in (0, 1e+06], got -2";
  EXPECT_THAT(MistakesOf(wrong, {}), ElementsAre(of_file));
  EXPECT_THAT(MistakesOf(wrong, {{"law.p_gain", "1"}}), ElementsAre(of_file));
  EXPECT_THAT(MistakesOf(wrong, {{"law.p_gain", "-1"}}),
              ElementsAre(of_file, "--set law.p_gain=-1: law.p_gain: expected a number in [0, 1000], got -1"));
  EXPECT_THAT(MistakesOf(wrong, {{"run.duration_s", "1"}}), IsEmpty()) << "mended";
}

TEST(MistakesOfSet, StandAtTheOptionThatHasItsOwnName) {
  EXPECT_THAT(MistakesOf(kSmall, {{"run.duration_s", "soon", "--duration-s soon"}}),
              ElementsAre("--duration-s soon: run.duration_s: expected a number in (0, 1e+06], got 'soon'"));
}

// --- the rule alone -----------------------------------------------------------------------------------------

TEST(BlameOverrides, FindsTheLastWithoutWhichThereIsNoMistake) {
  const std::vector<Override> two = {{"a", "1"}, {"b", "2"}};
  const auto with_a_and_b = [](std::span<const Override> overrides) -> std::vector<std::string> {
    if (overrides.size() < 2) return {};
    return {"f:2:3: c: no"};
  };
  EXPECT_THAT(BlameOverrides({"f:2:3: c: no"}, "f", two, with_a_and_b), ElementsAre("--set b=2: c: no (f:2:3)"));
  const auto with_a = [](std::span<const Override> overrides) -> std::vector<std::string> {
    if (overrides.empty() || overrides.front().key != "a") return {};
    return {"f:1:1: c: no"};
  };
  EXPECT_THAT(BlameOverrides({"f:1:1: c: no"}, "f", two, with_a), ElementsAre("--set a=1: c: no"));
  const auto always = [](std::span<const Override>) -> std::vector<std::string> { return {"f:1:1: c: no"}; };
  EXPECT_THAT(BlameOverrides({"f:1:1: c: no", "f: no"}, "f", two, always), ElementsAre("f:1:1: c: no", "f: no"));
}

}  // namespace
}  // namespace mascot
