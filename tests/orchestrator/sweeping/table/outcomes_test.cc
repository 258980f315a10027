#include "orchestrator/sweeping/table/outcomes.h"

#include <gmock/gmock.h>

#include "orchestrator/formats/csv.h"
#include "orchestrator/sweeping/table/table.h"
#include "tests/support/strict_csv.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::IsEmpty;

const Outcomes::Cells kColumns = {"run", "law.name", "run.seed", "error", "consensus.settling_time_s", "laws.a.cost"};

SweepPlan Plan() { return SweepPlan({.sets = {"law.name=a,b"}, .randoms = {}, .seeds = "1..3"}); }

/// Runs of the law of their law.name each: a, whose agents agree, and b, whose agents do not.
KnownLaws LawsOf(const SweepPlan& plan) {
  KnownLaws known{.alike = SweepPlan::Alike::kInValues, .of_run = {}};
  for (std::size_t run = 0; run < plan.size(); ++run) {
    const bool is_a = plan[run].overrides[0].value == "a";
    known.of_run[run] = {.team = is_a ? "a" : "b", .team_agrees = is_a, .names = {is_a ? "a" : "b"}};
  }
  return known;
}

/// Lines of the outcomes of these rows.
std::vector<std::string> LinesOf(const std::vector<Outcomes::Cells>& rows) {
  const SweepPlan plan = Plan();
  const KnownLaws known = LawsOf(plan);
  const SweepLaws laws(plan, known);
  Outcomes outcomes(plan, laws, kColumns);
  for (const Outcomes::Cells& row : rows) outcomes.Add(row);
  return outcomes.Lines();
}

/// Statistics of these rows.
std::string StatisticsOf(const std::vector<std::string>& metrics, const std::vector<Outcomes::Cells>& rows) {
  const SweepPlan plan = Plan();
  const KnownLaws known = LawsOf(plan);
  const SweepLaws laws(plan, known);
  Outcomes outcomes(plan, laws, kColumns);
  for (const Outcomes::Cells& row : rows) outcomes.Add(row);
  std::string csv;
  outcomes.WriteStatistics(metrics, [&](std::string_view line) { csv += line; });
  return csv;
}

TEST(Outcomes, SayNothingWhereEveryRunIsWell) { EXPECT_THAT(LinesOf({{"0", "a", "1", "", "4.0", ""}}), IsEmpty()); }

TEST(Outcomes, CountWhatFailedAndWhatDidNotSettle) {
  const auto lines = LinesOf({{"0", "a", "1", "it fell", "", ""},
                              {"1", "a", "2", "", "", ""},
                              {"2", "a", "3", "it fell", "", ""},
                              {"3", "b", "1", std::string(300, 'x'), "", ""},
                              {"4", "b", "2", "c", "", ""},
                              {"5", "b", "3", "d", "", ""}});
  EXPECT_THAT(
      lines,
      ElementsAre("failed: 5 of 6 runs", "  run 0 and 1 more: it fell",
                  "  run 3: " + std::string(100, 'x') + " ... " + std::string(100, 'x'), "  run 4: c",
                  "  and 1 other reason",
                  "not settled by the end: 1 of 3 runs whose law makes agents agree (no consensus.settling_time_s), "
                  "first run 1"));
}

TEST(Outcomes, HaveStatisticsOverTheSeedsOfEachPoint) {
  const std::string csv =
      StatisticsOf({"consensus.settling_time_s", "laws.a.cost"}, {{"0", "a", "1", "", "4.0", "1"},
                                                                  {"1", "a", "2", "", "6.0", ""},
                                                                  {"2", "a", "3", "", "5.0", ""},
                                                                  {"3", "b", "1", "it fell", "", ""},
                                                                  {"4", "b", "2", "", "", ""},
                                                                  {"5", "b", "3", "", "2.0", ""}});
  EXPECT_EQ(csv,
            "law.name,metric,runs,failed,without_value,mean,mean_low_95,mean_high_95,median,decile_1,decile_9\n"
            "a,consensus.settling_time_s,3,0,0,5.0,2.5158622882496724,7.484137711750328,5.0,4.2,5.8\n"
            "b,consensus.settling_time_s,3,1,1,2.0,,,inf,inf,inf\n"
            "a,laws.a.cost,3,0,2,1.0,,,1.0,1.0,1.0\n")
      << "a run that does not settle is later than all others; a cost that is missing is none";
}

TEST(Outcomes, TakeNoPredictionAndNoDeviationForLate) {
  const SweepPlan plan({.sets = {}, .randoms = {}, .seeds = "1..4"});
  const KnownLaws none;
  const SweepLaws laws(plan, none);
  Outcomes outcomes(plan, laws,
                    {"run", "run.seed", "error", "consensus.settling_time_s", "consensus.predicted.settling_time_s",
                     "consensus.deviation.settling_time_s", "laws.a.predicted.agreement_time_s"});
  outcomes.Add({"0", "1", "", "4.0", "5.0", "-1.0", "7.0"});
  outcomes.Add({"1", "2", "", "8.0", "5.0", "3.0", ""});
  outcomes.Add({"2", "3", "", "", "5.0", "", ""});     // not settled: how far off it is, is not known
  outcomes.Add({"3", "4", "", "9.0", "", "", "9.0"});  // not predicted
  std::string csv;
  const std::vector<std::string> metrics = {"consensus.settling_time_s", "consensus.predicted.settling_time_s",
                                            "consensus.deviation.settling_time_s", "laws.a.predicted.agreement_time_s"};
  outcomes.WriteStatistics(metrics, [&](std::string_view line) {
    const auto cells = CsvCells(line);
    csv += cells[0] + " " + cells[1] + " " + cells[3] + ", " + cells[4] + ", " + cells[7] + ", " + cells[9] + "\n";
  });
  EXPECT_THAT(csv, EndsWith("consensus.settling_time_s 4 1, 7.0, 8.5, inf\n"
                            "consensus.predicted.settling_time_s 4 1, 5.0, 5.0, 5.0\n"
                            "consensus.deviation.settling_time_s 4 2, 1.0, 1.0, 2.6\n"
                            "laws.a.predicted.agreement_time_s 4 2, 8.0, 8.0, 8.8\n"));
  for (const char* column : {"consensus.settling_time_s", "laws.a.agreement_time_s", "gather_time_s"})
    EXPECT_TRUE(IsTimeOfEvent(column)) << column;
  for (const char* column : {"consensus.predicted.settling_time_s", "consensus.deviation.settling_time_s",
                             "laws.a.predicted.agreement_time_s", "consensus.rate_per_s", "wall_s"})
    EXPECT_FALSE(IsTimeOfEvent(column)) << column;
}

TEST(Outcomes, HaveStatisticsThatAStrictReaderReadsWhateverTheValuesAre) {
  const std::string key = "law.params.\"a,b\"";
  const SweepPlan plan({.sets = {key + "='x, \"y\"','z'"}, .randoms = {}, .seeds = "1..2"});
  const KnownLaws none;
  const SweepLaws laws(plan, none);
  Outcomes outcomes(plan, laws, {"run", key, "run.seed", "error", "consensus.settling_time_s", "control.effort"});
  for (std::size_t run = 0; run < plan.size(); ++run)
    outcomes.Add({std::to_string(run), plan[run].overrides[0].value, "1", "", "4.0", "1.0"});
  std::string csv;
  outcomes.WriteStatistics(std::vector<std::string>{"control.effort"}, [&](std::string_view row) { csv += row; });
  const auto rows = StrictCsv(csv);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0][0], key);
  EXPECT_EQ(rows[1][0], plan[0].overrides[0].value);
  EXPECT_THAT(rows[1][0], ::testing::HasSubstr("x, \"y\""));
}

TEST(Outcomes, CallARunLateOnlyIfItsLawMakesAgentsAgreeOrHasSettledInAnother) {
  const std::vector<std::string> time = {"consensus.settling_time_s"};
  const std::vector<Outcomes::Cells> never = {{"0", "a", "1", "", "4.0", ""}, {"1", "a", "2", "", "", ""},
                                              {"2", "a", "3", "", "", ""},    {"3", "b", "1", "", "", ""},
                                              {"4", "b", "2", "", "", ""},    {"5", "b", "3", "", "", ""}};
  EXPECT_THAT(LinesOf(never), ElementsAre("not settled by the end: 2 of 3 runs whose law makes agents agree (no "
                                          "consensus.settling_time_s), first run 1"));
  EXPECT_THAT(StatisticsOf(time, never), EndsWith("decile_9\na,consensus.settling_time_s,3,0,2,4.0,,,inf,inf,inf\n"));
  std::vector<Outcomes::Cells> once = never;
  once[5][4] = "2.0";
  EXPECT_THAT(LinesOf(once),
              ElementsAre("not settled by the end: 4 of 6 runs (no consensus.settling_time_s), first run 1"));
  EXPECT_THAT(StatisticsOf(time, once), EndsWith("\nb,consensus.settling_time_s,3,0,2,2.0,,,inf,inf,inf\n"));
}

TEST(Outcomes, LeaveOutWhatNoRunHas) {
  EXPECT_EQ(StatisticsOf({"consensus.settling_time_s"}, {{"0", "a", "1", "", "", ""}}),
            "law.name,metric,runs,failed,without_value,mean,mean_low_95,mean_high_95,median,decile_1,decile_9\n");
}

TEST(Outcomes, KeepVeryManyPointsAndReasonsApart) {
  constexpr std::size_t kRuns = 20'000;
  const SweepPlan plan({.sets = {"law.p_gain=1:1:20000"}, .randoms = {}, .seeds = ""});
  const KnownLaws none;
  const SweepLaws laws(plan, none);
  Outcomes outcomes(plan, laws, {"run", "law.p_gain", "error", "consensus.settling_time_s"});
  for (std::size_t run = 0; run < kRuns; ++run)
    outcomes.Add({std::to_string(run), std::to_string(run + 1), run % 2 == 0 ? "" : "why " + std::to_string(run),
                  run % 2 == 0 ? std::to_string(run) : ""});
  EXPECT_THAT(outcomes.Lines(), ElementsAre("failed: 10000 of 20000 runs", "  run 1: why 1", "  run 3: why 3",
                                            "  run 5: why 5", "  and 9997 other reasons"));
  std::vector<std::string> lines;
  const std::vector<std::string> metrics = {"consensus.settling_time_s"};
  outcomes.WriteStatistics(metrics, [&](std::string_view line) { lines.emplace_back(line); });
  ASSERT_EQ(lines.size(), 1 + kRuns) << "one at a time";
  EXPECT_EQ(lines[19'999], "19999,consensus.settling_time_s,1,0,0,19998.0,,,19998.0,19998.0,19998.0\n");
  EXPECT_EQ(lines[20'000], "20000,consensus.settling_time_s,1,1,0,,,,,,\n");
}

TEST(Outcomes, KnowTimesThatMayNotComeToPass) {
  EXPECT_TRUE(IsTimeOfEvent("consensus.settling_time_s"));
  EXPECT_TRUE(IsTimeOfEvent("laws.finite_time.agreement_time_s"));
  EXPECT_FALSE(IsTimeOfEvent("consensus.predicted.settling_time_s"));
  EXPECT_FALSE(IsTimeOfEvent("consensus.deviation.settling_time_s"));
  EXPECT_FALSE(IsTimeOfEvent("sim_s"));
}

}  // namespace
}  // namespace mascot
