// The cells of a run in the table of a sweep.

#include "orchestrator/sweeping/table/metrics.h"

#include <gmock/gmock.h>

#include <limits>

#include "tests/support/law_run.h"

namespace mascot {
namespace {

constexpr const char* kThree =
    "[run]\nduration_s = 2.0\n[agents]\ncount = 3\nmodel = 'double_integrator'\n[graph]\ntopology = 'ring'\n";

/// Names of the columns of all laws, beyond which no table has any.
std::vector<std::string> AllColumns() {
  std::vector<std::string> laws;
  for (const LawEntry& law : Laws()) laws.emplace_back(law.name);
  return SweepMetricNames(laws);
}

TEST(SweepMetrics, AreToTheCharacterWhatTheSummaryOfTheRunSays) {
  const std::string experiments[] = {
      std::string(kThree) + "[law]\np_gain = 0.3\n",
      std::string(kThree) + "[law]\np_gain = 0.3\n[law.safety]\ndistance_m = 0.2\n",
      std::string(kThree) + "[law]\nname = 'formation'\nshape = 'circle'\nspacing_m = 3.0\n",
      std::string(kThree) + "[law]\nname = 'finite_time'\n",
      std::string(kThree) + "[law]\nname = 'minmax'\nbeta = [0.5, 0.8, 1.2]\nleader = 1\n",
      std::string(kThree) + "[law]\nname = 'waypoint'\nwaypoints_m = [[1, 2, 3], [4, 5, 6]]\n",
      std::string(kThree) + "[link]\nloss = 0.3\n[law]\np_gain = 0.3\n",
      std::string(kThree) + "[law]\np_gain = 0.3\n[[law.schedule]]\nat_s = 1.0\nname = 'finite_time'\n"};
  for (const std::string& experiment : experiments) {
    const LawRun run(experiment);
    auto cells = SweepMetrics(run.figures);
    std::size_t numbers = 0;
    for (const auto& [column, cell] : SweepMetrics(run.summary.dump(), AllColumns())) {
      EXPECT_EQ(cells[column], cell) << column << " of\n" << experiment;
      numbers += !cell.empty();
    }
    EXPECT_GT(numbers, 20U) << experiment;
  }
}

TEST(SweepMetrics, HaveNoCellForWordsListsTablesAndWhatIsNoNumber) {
  Figures figures;
  figures.Add("none", FigureValue());
  figures.AddWords("words", "why");
  figures.Add("list", FigureValues{1.0});
  figures.Add("table", [] { return Json(); });
  figures.Add("infinite", std::numeric_limits<double>::infinity());
  figures.Add("undefined", std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(SweepMetrics(figures), ::testing::IsEmpty());
  figures.Add("whole", 2.0);
  figures.Add("count", std::int64_t{2});
  figures.Add("holds", false);
  const std::map<std::string, std::string> cells = {{"whole", "2.0"}, {"count", "2"}, {"holds", "false"}};
  EXPECT_EQ(SweepMetrics(figures), cells);
}

}  // namespace
}  // namespace mascot
