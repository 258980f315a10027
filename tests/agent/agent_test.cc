#include "agent/agent.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "agent/laws/laws.h"
#include "agent/low_level.h"

namespace mascot {
namespace {

using ::testing::ThrowsMessage;

/// Two agents; agent 1 hears agent 2.
Experiment Two(const std::string& law, const std::string& control = "",
               const std::string& model = "double_integrator") {
  return LoadExperiment(
      Section::FromText("[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = '" + model +
                            "'\n"
                            "position_m = [[0, 0, 1], [10, 0, 2]]\n[graph]\nedges = [[1, 2]]\n[control]\n" +
                            control + "\n[law]\n" + law,
                        "test.toml"),
      "test");
}

/// The sample that agent 1 hears: agent 2 with this motion.
std::vector<Sample> Other(const Motion& motion) { return {{&motion}}; }

Motion At(double x, double y, double z) {
  Motion motion;
  motion.p_WB = {x, y, z};
  return motion;
}

/// The complete command of agent 1.
Command Decide(const Experiment& experiment, const Motion& self, const std::vector<Sample>& heard) {
  Agent agent(experiment, 1);
  Command command = agent.Want(0, self, heard);
  const Controller::Input driven = agent.Driven(command);
  LowLevel(experiment, {1, 1}).Actuate({&driven, 1}, {&command, 1});
  return command;
}

TEST(Agent, LimitsTheLawPerAxisAndSaysSo) {
  Experiment experiment = Two("name = 'consensus'", "max_acceleration_m_per_s2 = 2.0");
  Agent agent(experiment, 1);
  const Motion other = At(10, -1, 0);
  const std::vector<Sample> heard = Other(other);
  const Command command = agent.Want(0, At(0, 0, 0), heard);
  EXPECT_EQ(command.a_law_W, Eigen::Vector3d(10, -1, 0));
  EXPECT_EQ(command.a_limited_W, Eigen::Vector3d(2, -1, 0));
  EXPECT_EQ(command.flags, kAccelerationLimited);
}

TEST(Agent, LeavesAnAccelerationAtTheLimitAloneAndUnflagged) {
  Experiment experiment = Two("name = 'consensus'", "max_acceleration_m_per_s2 = 2.0");
  Agent agent(experiment, 1);
  const Motion other = At(2, -2, 0);
  const std::vector<Sample> heard = Other(other);
  const Command command = agent.Want(0, At(0, 0, 0), heard);
  EXPECT_EQ(command.a_limited_W, Eigen::Vector3d(2, -2, 0));
  EXPECT_EQ(command.flags, 0u);
}

// docs/recording.md, "commanded acceleration": its four rows are LimitsTheLawPerAxisAndSaysSo and the next three tests.
TEST(Agent, LimitsTheSpeedThenTheAccelerationThatAVelocityMeans) {
  const Motion other = At(10, 0, 0);
  const std::vector<Sample> heard = Other(other);
  const auto wants = [&](const std::string& control) {
    const Experiment experiment = Two("name = 'velocity_consensus'", control);
    return Agent(experiment, 1).Want(0, At(0, 0, 0), heard);
  };
  const Command slow = wants("max_speed_m_per_s = 1.0");
  EXPECT_EQ(slow.a_law_W.x(), 2 * 10) << "k_v (v* - v), before all limits";
  EXPECT_EQ(slow.a_limited_W.x(), 2 * 1);
  EXPECT_EQ(slow.flags, kSpeedLimited);
  const Command weak = wants("max_speed_m_per_s = 1.0\nmax_acceleration_m_per_s2 = 1.5");
  EXPECT_EQ(weak.a_law_W.x(), 2 * 10);
  EXPECT_EQ(weak.a_limited_W.x(), 1.5);
  EXPECT_EQ(weak.flags, kSpeedLimited | kAccelerationLimited);
}

TEST(Agent, CommandsNoAccelerationToAModelThatTakesAVelocity) {
  const Experiment experiment = Two("name = 'velocity_consensus'", "max_speed_m_per_s = 4.0", "single_integrator");
  const Motion other = At(10, -1, 0);
  const std::vector<Sample> heard = Other(other);
  const Command command = Decide(experiment, At(0, 0, 0), heard);
  EXPECT_EQ(command.a_law_W, Eigen::Vector3d::Zero());
  EXPECT_EQ(command.a_limited_W, Eigen::Vector3d::Zero());
  EXPECT_EQ(command.flags, kSpeedLimited);
  EXPECT_EQ(command.v_law_W, Eigen::Vector3d(10, -1, 0));
  EXPECT_EQ(command.actuator[0], 4);
  EXPECT_EQ(command.actuator[1], -1);
}

TEST(Agent, CommandsTheAccelerationThatTheSpeedLimitLeaves) {
  const Experiment experiment =
      Two("name = 'consensus'", "rate_hz = 8\nmax_speed_m_per_s = 0.625\nmax_acceleration_m_per_s2 = 2.0",
          "single_integrator");
  Agent agent(experiment, 1);
  const Motion other = At(10, -1, 0);
  const std::vector<Sample> heard = Other(other);
  const double left[] = {2, 2, 1, 0};  // v* = 0.25, 0.5, 0.625, 0.625
  for (int tick = 0; tick < 4; ++tick) {
    const Command command = agent.Want(tick, At(0, 0, 0), heard);
    EXPECT_EQ(command.a_law_W, Eigen::Vector3d(10, -1, 0));
    EXPECT_EQ(command.a_limited_W, Eigen::Vector3d(left[tick], -1, 0));
    EXPECT_EQ(command.flags, tick < 2 ? kAccelerationLimited : kAccelerationLimited | kSpeedLimited);
  }
}

TEST(Agent, IgnoresTheLawInZWhereTheAltitudeIsHeld) {
  Experiment flat = Two("name = 'consensus'");
  Experiment full = Two("name = 'consensus'\naxes = 'xyz'");
  const Motion other = At(1, 0, 1);
  const std::vector<Sample> heard = Other(other);
  EXPECT_EQ(Agent(flat, 1).Want(0, At(0, 0, 0), heard).a_law_W, Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(Agent(full, 1).Want(0, At(0, 0, 0), heard).a_law_W, Eigen::Vector3d(1, 0, 1));
}

TEST(Agent, GivesTheLawTheTimeOfTheTick) {
  Experiment experiment =
      Two("name = 'waypoint'\nwaypoints_m = [[1, 0, 1], [-1, 0, 1]]\ntimes_s = [0.0, 0.5]", "rate_hz = 50");
  Agent agent(experiment, 1);
  const Motion here = At(0, 0, 1);
  EXPECT_EQ(agent.Want(24, here, Other(here)).a_law_W.x(), 1);
  EXPECT_EQ(agent.Want(25, here, Other(here)).a_law_W.x(), -1);
}

TEST(Agent, DecidesWhatItWantsAndActuatesIt) {
  Experiment experiment = Two("name = 'consensus'");
  const Motion other = At(1, -0.5, 2);
  const std::vector<Sample> heard = Other(other);
  const Command wanted = Agent(experiment, 1).Want(0, At(0, 0, 1), heard);
  const Command command = Decide(experiment, At(0, 0, 1), heard);
  EXPECT_EQ(command.a_law_W, wanted.a_law_W);
  EXPECT_EQ(command.a_limited_W, wanted.a_limited_W);
  EXPECT_GT(command.actuator[0], 0);
  EXPECT_LT(command.actuator[1], 0);
}

TEST(Agent, EndsTheRunNamingTickAndAgentWhenTheLawIsNotFinite) {
  Experiment experiment = Two("name = 'consensus'");
  Agent agent(experiment, 1);
  EXPECT_EQ(agent.id(), 1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto want = [&agent](double x, double y) {
    const Motion other = At(x, y, 0);
    const std::vector<Sample> heard = Other(other);
    agent.Want(4, At(0, 0, 1), heard);
  };
  EXPECT_THAT([&] { want(nan, 0); },
              ThrowsMessage<std::runtime_error>("tick 4: agent 1: the law's acceleration is not finite (nan, 0, 0)"));
  EXPECT_THAT([&] { want(-nan, 0.5); },
              ThrowsMessage<std::runtime_error>("tick 4: agent 1: the law's acceleration is not finite (nan, 0.5, 0)"));
  EXPECT_THAT([&] { want(1, -infinity); },
              ThrowsMessage<std::runtime_error>("tick 4: agent 1: the law's acceleration is not finite (1, -inf, 0)"));
}

}  // namespace
}  // namespace mascot
