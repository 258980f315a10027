// What the page is told of faults.
#include "orchestrator/live/shown/ui_channels.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "agent/laws/laws.h"
#include "experiment/live_experiment.h"
#include "tests/support/load.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kPath =
    "[run]\nduration_s = 10.0\non_agent_loss = 'hold'\n[agents]\ncount = 4\nmodel = 'double_integrator'\n"
    "position_m = [[0, 0, 1], [2, 0, 1], [4, 0, 1], [6, 0, 1]]\n[[agents.override]]\nid = 4\nlie = { from_s = 6.0, "
    "offset_m = [1, 0, 0] }\n"
    "[graph]\ntopology = 'path'\n[law]\nname = 'consensus'\n";

nlohmann::json Told(const Experiment& now, const ShownSource& source = {.engine = "inprocess"}) {
  const Prediction nothing;
  const std::vector<PartResponse> none;
  return nlohmann::json::parse(ExperimentJson(now, {nothing, none}, source, {}));
}

TEST(UiChannels, TellWhatIsWrongWithEachAgentInWords) {
  LiveExperiment live(Load(kPath), &LawTable(), /*checked=*/true);
  EXPECT_THAT(Told(live.current())["agents"][1]["faults"], IsEmpty());
  EXPECT_EQ(Told(live.current())["agents"][1]["lost"], false);
  live.Take({.tick = 100, .fault = Fault{.agent = 2}, .where = "test"});
  live.Take({.tick = 200,
             .fault = Fault{.agent = 3, .of = FaultPart::kLink, .kind = FaultKind::kDelayed, .delay_s = 0.5},
             .where = "test"});
  const nlohmann::json agents = Told(live.current())["agents"];
  EXPECT_EQ(agents[1]["lost"], true);
  EXPECT_EQ(agents[1]["faults"], nlohmann::json({"lost: its process has died"}));
  EXPECT_EQ(agents[2]["lost"], false);
  EXPECT_EQ(agents[2]["faults"], nlohmann::json({"link delayed by 0.5 s"}));
}

TEST(UiChannels, TellWhatTheTeamCanStillDoFromWhichTimeOn) {
  LiveExperiment live(Load(kPath), &LawTable(), /*checked=*/true);
  nlohmann::json told = Told(live.current())["survives"];
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0]["from_s"], 6.0);
  EXPECT_EQ(told[0]["is_wrong"], true);
  EXPECT_THAT(told[0]["words"].get<std::string>(), HasSubstr("agent 4 lies"));
  live.Take({.tick = 100, .fault = Fault{.agent = 2}, .where = "test"});
  told = Told(live.current())["survives"];
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0]["from_s"], 0.0);
  EXPECT_EQ(told[0]["words"], "agent 2 is lost: no spanning tree: agent 1 is cut off from agents 3 and 4");
  EXPECT_EQ(told[1]["from_s"], 6.0);
}

TEST(UiChannels, TellTheTableOfFaultsToThoseWhoMayUseIt) {
  const nlohmann::json told = Told(Load(kPath));
  EXPECT_EQ(told["on_agent_loss"], "hold");
  ASSERT_EQ(told["fault_kinds"].size(), FaultRows().size());
  EXPECT_EQ(
      told["fault_kinds"][0],
      nlohmann::json(
          {{"of", "agent"}, {"kind", "kill"}, {"parameters", "unanswered"}, {"meaning", FaultRows()[0].meaning}}));
  EXPECT_THAT(Told(Load(kPath), {.recorded = RecordedPart{}})["fault_kinds"], IsEmpty());
}

}  // namespace
}  // namespace mascot
