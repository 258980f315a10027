#include "orchestrator/sweeping/plan/plan_table.h"

#include <gmock/gmock.h>

#include "orchestrator/sweeping/plan/plan.h"
#include "tests/orchestrator/sweeping/plan/runs.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::ThrowsMessage;

SweepPlan TablePlan(const std::string& text, const SweepPlan::Words& words = {}) {
  return {words, ReadPlanTable(text, "t.csv")};
}

/// Where the values of a run are from.
std::vector<std::string> Origins(const SweepPlan& plan, std::size_t run) {
  std::vector<std::string> origins;
  for (const Override& override : plan[run].overrides) origins.push_back(override.origin);
  return origins;
}

TEST(PlanTable, HasARunInEachRow) {
  const SweepPlan plan = TablePlan("law.p_gain,graph.topology,run.seed\n0.10,ring,1\n2e-1,path,1\n0.2,ring,3\n");
  EXPECT_THAT(plan.keys(), ElementsAre("law.p_gain", "graph.topology", "run.seed"));
  EXPECT_THAT(plan.varied(), ElementsAre("law.p_gain", "graph.topology"));
  EXPECT_THAT(Runs(plan), ElementsAre("0.1 ring 1", "0.2 path 1", "0.2 ring 3"));
  EXPECT_THAT(Origins(plan, 1), ElementsAre("t.csv:3:1", "t.csv:3:2", "t.csv:3:3"));
  ASSERT_EQ(plan.TrialCount(), 3u) << "every row is checked";
  EXPECT_EQ(plan.Trial(0).overrides[0].origin, "t.csv:2:1");
  EXPECT_EQ(plan.Trial(2).overrides[1].origin, "t.csv:4:2");
}

TEST(PlanTable, TakesWhatSetTakes) {
  EXPECT_THAT(Runs(TablePlan("a,b\n\"[1, 2]\",\"\"\"x,y\"\"\"\n\"{k=1, l=\"\"z\"\"}\",'1'\n")),
              ElementsAre("[1, 2] x,y", "{k = 1, l = \"z\"} \"1\""));
  EXPECT_THAT(Runs(TablePlan("a\nword: one\n\"a,b\"\n")), ElementsAre("word: one", "a,b"));
}

TEST(PlanTable, MayBeWrittenByASpreadsheet) {
  const SweepPlan plan = TablePlan("\xEF\xBB\xBF\"law.p_gain\", law.beta \r\n\r\n0.1 ,\t2\r\n\"0.3\",4");
  EXPECT_THAT(plan.keys(), ElementsAre("law.p_gain", "law.beta"));
  EXPECT_THAT(Runs(plan), ElementsAre("0.1 2", "0.3 4"));
  EXPECT_THAT(Origins(plan, 0), ElementsAre("t.csv:3:1", "t.csv:3:2")) << "blank lines count";
  EXPECT_THAT(Origins(TablePlan("a,b\n\"'''x\ny'''\",1\n2,3\n"), 1), ElementsAre("t.csv:4:1", "t.csv:4:2"))
      << "a cell may have several lines";
}

TEST(PlanTable, IsFlownWithSeedsSamplesAndOneValueOfOtherKeys) {
  const SweepPlan plan =
      TablePlan("a,b\n1,x\n2,y\n", {.sets = {"c=5"}, .randoms = {"d=1:1"}, .samples = 1, .seeds = "7..8"});
  EXPECT_THAT(Runs(plan), ElementsAre("5 1 x 1.0 7", "5 1 x 1.0 8", "5 2 y 1.0 7", "5 2 y 1.0 8"));
  EXPECT_THAT(Origins(plan, 3), ElementsAre("", "t.csv:3:1", "t.csv:3:2", "--random d=1:1 (1.0)", "--seeds 8"));
  ASSERT_EQ(plan.TrialCount(), 2u);
  EXPECT_EQ(plan.Trial(1).overrides[1].value, "2");
}

TEST(PlanTable, IsThePlanOfItsColumnsWithZip) {
  const SweepPlan table = TablePlan("law.p_gain,graph.topology,law.beta\n0.10,ring,1\n0.2,path,1\n0.3,ring,1.0\n");
  const SweepPlan typed({.sets = {"law.p_gain=0.1,0.2,0.3", "graph.topology=ring,path,ring", "law.beta=1"},
                         .randoms = {},
                         .samples = 1,
                         .seeds = "",
                         .zip = true});
  EXPECT_EQ(table.words(), typed.words());
  EXPECT_EQ(table.Text(), typed.Text());
  EXPECT_EQ(Runs(SweepPlan(table.words())), Runs(table)) << "also without the table";
  EXPECT_EQ(TablePlan("a\n1\n2\n").words(), SweepPlan({.sets = {"a=1,2"}, .randoms = {}, .seeds = ""}).words());
  EXPECT_EQ(TablePlan("a,b\n1,x\n").words(), SweepPlan({.sets = {"a=1", "b=x"}, .randoms = {}, .seeds = ""}).words());
}

TEST(PlanTable, KnowsWhichRowsDifferInTheirSeedsAlone) {
  const SweepPlan plan = TablePlan("a,run.seed,b\n1,7,x\n2,7,y\n1,8,x\n1,9,z\n");
  std::vector<std::size_t> all;
  for (std::size_t run = 0; run < plan.size(); ++run)
    all.push_back(plan.RepresentativesOf(SweepPlan::Alike::kInValues)[run]);
  EXPECT_THAT(all, ElementsAre(0, 1, 0, 3)) << "they share a row of the statistics";
  EXPECT_THAT(plan.WithFirstSeed(), ElementsAre(0, 1, 3));
}

TEST(PlanTable, FliesEqualRowsOnce) {
  const SweepPlan plan = TablePlan("a,b\n1,x\n2,y\n1,'x'\n2,x\n");
  EXPECT_THAT(Runs(plan), ElementsAre("1 x", "2 y", "2 x"));
  EXPECT_THAT(plan.notes(), ElementsAre("t.csv: 1 of the 4 rows are equal to others: each is flown once"));
  EXPECT_THAT(Origins(plan, 2), ElementsAre("t.csv:5:1", "t.csv:5:2"));
}

TEST(PlanTable, SaysWhatIsWrongAndWhere) {
  const auto refuses = [](const std::string& text, const std::string& mistakes) {
    EXPECT_THAT([&] { ReadPlanTable(text, "t.csv"); }, ThrowsMessage<ConfigError>(mistakes)) << text;
  };
  refuses("", "t.csv:1:1: expected column names, keys such as law.p_gain, got nothing");
  refuses("\n\n", "t.csv:2:1: expected column names, keys such as law.p_gain, got nothing");
  refuses("a,b\n\n", "t.csv:2:1: expected a row for each run, got none");
  refuses("a,,a.b,a\n1,2,3,4\n",
          "t.csv:1:2: expected a key such as law.p_gain, got nothing\n"
          "t.csv:1:3: expected each key once, got a.b and a\n"
          "t.csv:1:4: expected each key once, got a again");
  refuses("law.beta;law.p_gain\n1;2\n",
          "t.csv:1:1: expected a key such as law.p_gain, got 'law.beta;law.p_gain' (commas separate cells)");
  refuses("law beta\n1\n", "t.csv:1:1: expected a key such as law.p_gain, got 'law beta'");
  refuses("a,b\n1\n2,3\n4,5,6\n7,\n",
          "t.csv:2:1: expected 2 cells, as there are keys, got 1\n"
          "t.csv:4:3: expected 2 cells, as there are keys, got 3\n"
          "t.csv:5:2: b: expected a value, got nothing");
  refuses("a,b\n1,0:1:5\n2,\"1,2\"\n[3,4\n5,\"\"\"x\"\n",
          "t.csv:2:2: b: expected one value, got '0:1:5'\n"
          "t.csv:3:2: b: expected one value, got '1,2'\n"
          "t.csv:4:1: a: expected one value, got '[3'\n"
          "t.csv:5:2: b: expected one value, got '\"x'");
  const std::string quotes = "expected quotes around a whole cell, and in it two for each one, got ";
  refuses("a,b\n1,{k=\"x\"}\n2,3\n", "t.csv:2:2: " + quotes + "a quote in a cell without quotes");
  refuses("a,b\n\"1\"2,3\n", "t.csv:2:1: " + quotes + "a character behind the second quote");
  refuses("a,b\n1,\"2\n3,4\n", "t.csv:2:2: " + quotes + "no second quote");
  refuses("\"a", "t.csv:1:1: " + quotes + "no second quote");
  std::string many = "a\n", mistakes;
  for (int row = 0; row < 25; ++row) many += "1:2\n";
  for (int line = 2; line < 22; ++line)
    mistakes.append("t.csv:").append(std::to_string(line)).append(":1: a: expected one value, got '1:2'\n");
  refuses(many, mistakes + "t.csv: 5 more mistakes");
}

TEST(PlanTable, IsRefusedBesideOptionsThatSayOtherwise) {
  const auto refuses = [](const SweepPlan::Words& words, const std::string& text) {
    EXPECT_THAT([&] { TablePlan("law.beta,run.seed\n1,2\n3,4\n", words); }, ThrowsMessage<ConfigError>(text));
  };
  refuses({.sets = {"a=1", "law.p_gain=1,2"}, .randoms = {}, .seeds = ""},
          "--set: expected one value of a key beside the rows of t.csv, got 'law.p_gain=1,2'");
  refuses({.sets = {"a=1:1:2"}, .randoms = {}, .seeds = ""},
          "--set: expected one value of a key beside the rows of t.csv, got 'a=1:1:2'");
  refuses({.sets = {"law.beta=1"}, .randoms = {}, .seeds = ""}, "sweep: expected each key once, got law.beta again");
  refuses({.sets = {}, .randoms = {}, .samples = 1, .seeds = "1..2"},
          "--seeds: expected no column run.seed in t.csv, which gives each run its seed, got both");
  refuses({.sets = {}, .randoms = {}, .samples = 1, .seeds = "", .zip = true},
          "--zip: expected no --plan, because a row of t.csv is a run already");
}

}  // namespace
}  // namespace mascot
