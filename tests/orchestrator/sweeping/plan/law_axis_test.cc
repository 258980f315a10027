#include "orchestrator/sweeping/plan/law_axis.h"

#include <gmock/gmock.h>

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

LawAxis AxisOf(const std::string& toml, const SweepPlan& plan) { return {Section::FromText(toml, "a.toml"), plan}; }

SweepPlan PlanOf(std::vector<std::string> sets) {
  return SweepPlan({.sets = std::move(sets), .randoms = {}, .seeds = ""});
}

/// "key=value", or "-key" for a key that is taken out.
std::vector<std::string> TextOf(const std::vector<Override>& overrides) {
  std::vector<std::string> words;
  for (const Override& override : overrides)
    words.push_back(override.removes ? "-" + override.key : override.key + "=" + override.value);
  return words;
}

const std::string kFile = "[law]\nname = 'consensus'\nbeta = 0.5\np_gain = 1\nbta = 3\n";

TEST(LawAxis, ChangesNothingWithoutASweepOverLaws) {
  const SweepPlan plan = PlanOf({"law.p_gain=1,2"});
  const LawAxis axis = AxisOf(kFile, plan);
  EXPECT_THAT(axis.laws(), IsEmpty());
  EXPECT_THAT(TextOf(axis.Fit(plan[1].overrides)), ElementsAre("law.p_gain=2"));
  EXPECT_THAT(axis.Notes(), IsEmpty());
}

TEST(LawAxis, HasALawOnceThatSeveralRowsName) {
  const SweepPlan plan({.sets = {"law.name=consensus,velocity_consensus,velocity_consensus", "law.p_gain=1,1,2"},
                        .randoms = {},
                        .samples = 1,
                        .seeds = "",
                        .zip = true});
  const LawAxis axis = AxisOf(kFile, plan);
  EXPECT_THAT(axis.laws(), ElementsAre("consensus", "velocity_consensus"));
  EXPECT_THAT(axis.Notes(), ElementsAre("law.name = velocity_consensus: without law.beta, which it does not have"));
}

TEST(LawAxis, LeavesOutWhatOnlyOtherLawsKnow) {
  const SweepPlan plan = PlanOf({"law.name=consensus,\"velocity_consensus\"", "law.v_gain=0.1", "law.p_gain=1,2"});
  const LawAxis axis = AxisOf(kFile, plan);
  EXPECT_THAT(axis.laws(), ElementsAre("consensus", "velocity_consensus"));
  EXPECT_THAT(TextOf(axis.Fit(plan[0].overrides)), ElementsAre("law.name=consensus", "law.v_gain=0.1", "law.p_gain=1"));
  EXPECT_THAT(TextOf(axis.Fit(plan[3].overrides)),
              ElementsAre("-law.beta", "-law.v_gain", "law.name=velocity_consensus", "law.p_gain=2"))
      << "no law knows bta, so that it stays a mistake";
  EXPECT_THAT(axis.Notes(), ElementsAre("law.name = velocity_consensus: without law.beta, law.v_gain, which it does "
                                        "not have"));
}

TEST(LawAxis, KeepsAKeyOfSeveralValuesForAllLaws) {
  const SweepPlan plan = PlanOf({"law.name=consensus,velocity_consensus", "law.beta=1,2"});
  EXPECT_THAT(TextOf(AxisOf(kFile, plan).Fit(plan[2].overrides)),
              ElementsAre("law.name=velocity_consensus", "law.beta=1"));
}

TEST(LawAxis, LeavesNamesOfNoLawToTheReader) {
  const SweepPlan plan = PlanOf({"law.name=consensus,consenus"});
  const LawAxis axis = AxisOf("law = 3\n", plan);
  EXPECT_THAT(axis.laws(), ElementsAre("consensus"));
  EXPECT_THAT(TextOf(axis.Fit(plan[1].overrides)), ElementsAre("law.name=consenus"));
}

}  // namespace
}  // namespace mascot
