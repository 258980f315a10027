#include "orchestrator/theory/linear_team.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agent/laws/laws.h"
#include "tests/orchestrator/theory/flown_network.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;

std::string Two(const std::string& rest) {
  return "[run]\nduration_s = 100.0\n[physics]\ncollisions = false\n[agents]\ncount = 2\n"
         "position_m = [[0, 0, 1], [1, 0, 2]]\n" +
         rest;
}

Linearity LinearityOf(const std::string& toml) {
  return LinearTeamOf(LoadExperiment(Section::FromText(toml, "test.toml"), "test"));
}

LinearAgent First(const std::string& toml) { return LinearityOf(toml).team.value().agents.front(); }

TEST(LinearTeam, TakesLawsThatWantAnAccelerationAsTheyAre) {
  const LinearAgent agent = First(Two("[law]\nname = 'consensus'\np_gain = 0.3\nv_gain = 0.2\nbeta = 0.7\n"));
  EXPECT_EQ(agent.order, 2);
  EXPECT_EQ(agent.hold, 0.5);
  EXPECT_EQ(agent.p, 0.3);
  EXPECT_EQ(agent.g, 0.2);
  EXPECT_EQ(agent.b, 0.7);
  EXPECT_TRUE(
      agent.MovesAs(First(Two("[law]\nname = 'formation'\nshape = 'line'\np_gain = 0.3\nv_gain = 0.2\n"
                              "beta = 0.7\n"))));
}

TEST(LinearTeam, TurnsAVelocityIntoAnAccelerationWhereThatDrivesTheModel) {
  const std::string law = "[law]\nname = 'velocity_consensus'\np_gain = 0.3\n[control]\nvelocity_gain = 5.0\n";
  const LinearAgent quadrotor = First(Two(law));
  EXPECT_EQ(quadrotor.order, 2);
  EXPECT_EQ(quadrotor.p, 1.5);
  EXPECT_EQ(quadrotor.b, 5.0);
  EXPECT_EQ(First(Two("model = 'single_integrator'\n" + law)).order, 1);
}

TEST(LinearTeam, AddsUncompensatedDrag) {
  const std::string toml = Two("[law]\nname = 'consensus'\nbeta = 0.7\n[control]\ndrag_compensation = false\n");
  const Experiment experiment = LoadExperiment(Section::FromText(toml, "test.toml"), "test");
  const Airframe& airframe = experiment.agent(1).airframe;
  EXPECT_DOUBLE_EQ(First(toml).b, 0.7 + airframe.linear_drag_kg_per_s / airframe.mass_kg);
}

TEST(LinearTeam, KnowsItsLeaders) {
  const LinearTeam team =
      LinearityOf(Two("[law]\nname = 'consensus'\nleader = 2\nleader_waypoints_m = [[1, 2, 3]]\n")).team.value();
  EXPECT_THAT(team.Leaders(), ElementsAre(2));
  EXPECT_TRUE(team.agent(2).flies);
  EXPECT_TRUE(team.Followed(Graph({{{2, 1.0}}, {{1, 1.0}}})).HeardBy(2).empty());
  const LinearTeam mixed =
      LinearityOf(
          Two("[[agents.override]]\nid = 1\nlaw = { name = 'waypoint', axes = 'xy', waypoints_m = [[1, 2, 3]] }\n"
              "[law]\nname = 'consensus'\n"))
          .team.value();
  EXPECT_THAT(mixed.Leaders(), ElementsAre(1));
  EXPECT_TRUE(mixed.agent(1).flies);
}

TEST(LinearTeam, SaysWhyATeamIsNotLinear) {
  EXPECT_EQ(LinearityOf(Two("[[agents.override]]\nid = 2\nmodel = 'unicycle'\n[law]\nname = 'consensus'\n")).why_not,
            "agent 2 is a unicycle, which turns before going where wanted");
  EXPECT_EQ(LinearityOf(Two("model = 'unicycle'\n[law]\nname = 'consensus'\n")).why_not,
            "agents 1 and 2 are unicycles, which turn before going where wanted");
  EXPECT_EQ(
      LinearityOf(Two("[[agents.override]]\nid = 2\nlaw = { name = 'custom', python = 'def control(t, me, neighbours): "
                      "return 0, 0' }\n[law]\nname = 'consensus'\n"))
          .why_not,
      "the law custom is code of a user, of which theory has no model (agent 2)");
  EXPECT_EQ(LinearityOf(Two("[[agents.override]]\nid = 2\nlaw = { spacing_m = 5.0 }\n[law]\nname = 'formation'\n"
                            "shape = 'line'\n"))
                .why_not,
            "agents keep different formations");
}

TEST(LinearTeam, MatchesTheMotionOfTheAgents) {
  // The first second of a pair of agents: the equations of linear_team.h against a full simulation.
  for (const std::string model : {"single_integrator", "double_integrator"}) {
    for (const std::string law : {"'velocity_consensus'", "'consensus'\nbeta = 0.8\nv_gain = 0.4"}) {
      const std::string toml = Two("model = '" + model + "'\n[law]\nname = " + law + "\n");
      const LinearAgent agent = First(toml);
      FlownNetwork network(toml);
      Eigen::Vector2d q(0, 1), v(0, 0);
      const double h = network.experiment.period_s();
      for (int k = 0; k < 100; ++k) {
        const Eigen::Vector2d u = agent.p * (q.reverse() - q) + agent.g * (v.reverse() - v) - agent.b * v;
        q += agent.order == 1 ? Eigen::Vector2d(h * u) : Eigen::Vector2d(h * v + agent.hold * h * h * u);
        v = agent.order == 1 ? u : Eigen::Vector2d(v + h * u);
        network.Step();
        ASSERT_LT((network.x() - q).norm(), 1e-9) << model << " " << law << " " << k;
      }
    }
  }
}

}  // namespace
}  // namespace mascot
