#include "orchestrator/report/figures.h"

#include <gmock/gmock.h>

#include "tests/support/law_run.h"

namespace mascot {
namespace {

TEST(Figures, OfDottedNamesAreObjectsInEachOtherInTheOrderInWhichTheyWereAdded) {
  Figures figures;
  figures.Add("ticks", std::int64_t{200});
  figures.Add("safety.min_separation_m", 0.5);
  figures.Add("wire", true);
  figures.Add("safety.contacts.ground", std::int64_t{1});
  EXPECT_EQ(JsonOf(figures).dump(),
            R"({"ticks":200,"safety":{"min_separation_m":0.5,"contacts":{"ground":1}},"wire":true})");
}

TEST(Figures, WithoutAValueAreNull) {
  Figures figures;
  figures.Add("a", std::optional<double>());
  figures.AddWords("b", "");
  figures.AddVector("c", std::optional<Eigen::Vector3d>());
  EXPECT_EQ(JsonOf(figures).dump(), R"({"a":null,"b":null,"c":null})");
  EXPECT_EQ(figures.Number("a"), std::nullopt);
  EXPECT_EQ(figures.Words("b"), "");
  EXPECT_EQ(figures.Vector("c"), std::nullopt);
}

TEST(Figures, OfVectorsListsWordsAndTablesAreWhatTheyAre) {
  Figures figures;
  figures.AddVector("team.value_m", Eigen::Vector3d(1, 2, 0.25));
  figures.Add("each_s", FigureValues{4.5, std::nullopt});
  figures.AddWords("why", "too late");
  figures.Add("edges", [] { return Json{1, 2}; });
  EXPECT_EQ(JsonOf(figures).dump(),
            R"({"team":{"value_m":[1.0,2.0,0.25]},"each_s":[4.5,null],"why":"too late","edges":[1,2]})");
  EXPECT_EQ(figures.Number("team.value_m.z"), 0.25);
  EXPECT_EQ(figures.Vector("team.value_m"), Eigen::Vector3d(1, 2, 0.25));
  EXPECT_EQ(figures.Words("why"), "too late");
  EXPECT_EQ(figures.Number("why"), std::nullopt);
}

TEST(Figures, TablesAreMadeForWhoPrintsThemAlone) {
  int made = 0;
  Figures figures;
  figures.Add("edges", [&made] { return Json(++made); });
  Figures whole;
  whole.Add(figures);
  EXPECT_EQ(made, 0);
  EXPECT_EQ(JsonOf(whole).dump(), R"({"edges":1})");
}

TEST(Figures, OfARunAreThoseOfItsSummary) {
  const LawRun run("[run]\nduration_s = 2.0\n[agents]\ncount = 3\n[graph]\ntopology = 'ring'\n[law]\np_gain = 0.3\n");
  const auto& consensus = run.summary["consensus"];
  EXPECT_EQ(run.figures.Number("consensus.final_disagreement_m"), consensus["final_disagreement_m"].get<double>());
  EXPECT_EQ(run.figures.Number("consensus.value_m.x"), consensus["value_m"][0].get<double>());
  EXPECT_EQ(run.figures.Count("links.sent"), run.summary["links"]["sent"].get<std::int64_t>());
  EXPECT_EQ(run.figures.Number("consensus.settling_time_s"), std::nullopt);
  EXPECT_TRUE(consensus["settling_time_s"].is_null());
}

}  // namespace
}  // namespace mascot
