// Which agents take actions in the place of their laws.
#include "orchestrator/engines/driven_agents.h"

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/toml/section.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

std::string TeamWith(const std::string& law) {
  return "[run]\nname = 'team'\nduration_s = 2\n[agents]\ncount = 3\nposition_m = [[0, 0, 1], [0, 3, 1], [0, 6, 1]]\n"
         "[graph]\ntopology = 'complete'\n[law]\n" +
         law;
}

Experiment LoadWith(const std::string& text, std::vector<Override> overrides) {
  return LoadExperiment(text, "team.toml", overrides);
}

Experiment LoadDriven(const std::string& text, const std::vector<int>& ids, std::vector<Override> overrides = {}) {
  overrides.push_back(DrivenAgents(text, "team.toml", overrides, ids));
  return LoadWith(text, std::move(overrides));
}

TEST(DrivenAgents, StandInThePlaceOfTheTeamsLaw) {
  const std::string text = TeamWith(
      "name = 'flocking'\np_gain = 1\nsafety = { distance_m = 0.7 }\n"
      "[[agents.override]]\nid = 2\nlaw = { name = 'consensus' }\n");
  const Experiment experiment =
      LoadWith(text, WithDrivenTeam(text, "team.toml", {{.key = "law.message", .value = "2"}}));
  EXPECT_EQ(experiment.agent(1).law.params->action, 5u);
  EXPECT_EQ(experiment.agent(1).law.safety->distance_m, 0.7);
  EXPECT_THAT(AgentsThatAct(experiment), ElementsAre(1, 3));
}

TEST(DrivenAgents, AreThoseOfAFileInWhichSomeTakeActions) {
  const std::string text = TeamWith("name = 'consensus'\n[[agents.override]]\nid = 2\nlaw = { name = 'actions' }\n");
  EXPECT_THAT(WithDrivenTeam(text, "team.toml", {}), IsEmpty());
  EXPECT_THAT(AgentsThatAct(LoadWith(text, {})), ElementsAre(2));
}

TEST(DrivenAgents, KeepAxesAndSafetyOfTheLawsInWhosePlaceTheyStand) {
  const std::string text = TeamWith(
      "name = 'consensus'\naxes = 'xyz'\nsafety = { distance_m = 0.7 }\n"
      "[[agents.override]]\nid = 2\nstart_s = 0.5\nlaw = { p_gain = 0.5 }\n"
      "[[agents.override]]\nid = 3\nlaw = { name = 'flocking', axes = 'xyz' }\n");
  const Experiment before = LoadWith(text, {});
  const Experiment experiment = LoadDriven(text, {1, 2, 3});
  EXPECT_THAT(AgentsThatAct(experiment), ElementsAre(1, 2, 3));
  for (int id = 1; id <= 3; ++id) {
    EXPECT_EQ(experiment.agent(id).law.axes, before.agent(id).law.axes) << id;
    EXPECT_EQ(experiment.agent(id).law.safety.has_value(), before.agent(id).law.safety.has_value()) << id;
  }
  EXPECT_EQ(experiment.agent(2).law.safety->distance_m, 0.7);
  EXPECT_EQ(experiment.agent(2).start_s, 0.5);
}

TEST(DrivenAgents, LeaveTheOthersTheirLaws) {
  const std::string text = TeamWith("name = 'consensus'\n[[agents.override]]\nid = 3\nlaw = { p_gain = 0.5 }\n");
  const Experiment experiment = LoadDriven(text, {1});
  EXPECT_THAT(AgentsThatAct(experiment), ElementsAre(1));
  EXPECT_EQ(LinearFormOf(experiment.agent(3).law)->p, 0.5);
}

TEST(DrivenAgents, TakeWhatIsSetOfTheTeamsLaw) {
  const Experiment experiment =
      LoadDriven(TeamWith("name = 'consensus'\n"), {1}, {{.key = "law.axes", .value = "'xyz'"}});
  EXPECT_EQ(experiment.agent(1).law.axes, Axes::kXyz);
}

TEST(DrivenAgents, AreRefusedInWords) {
  const std::string text = TeamWith("name = 'consensus'\n");
  EXPECT_THAT([&] { LoadDriven(text, {4}); },
              ThrowsMessage<ConfigError>("ports: expected agents of the team, from 1 to 3, got 4"));
  EXPECT_THAT(
      [&] { LoadDriven(text, {1}, {{.key = "agents.override", .value = "[{id = 1}]"}}); },
      ThrowsMessage<ConfigError>("ports: expected no --set of agents.override beside them, got agents.override"));
  const std::string later = TeamWith("name = 'consensus'\nschedule = [{ at_s = 1.0, name = 'actions' }]\n");
  EXPECT_THAT([&] { AgentsThatAct(LoadWith(later, {})); },
              ThrowsMessage<ConfigError>(HasSubstr("agent 1: expected a law that takes actions from the start on")));
}

}  // namespace
}  // namespace mascot
