#include "experiment/experiment.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include "agent/laws/laws.h"
#include "experiment/placement.h"
#include "experiment/processes.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// The smallest experiment, followed by `text`.
std::string Config(const std::string& text = "") { return "run.duration_s = 10\nagents.count = 4\n" + text; }

Experiment Load(const std::string& text, const std::string& default_name = "e") {
  return LoadExperiment(Section::FromText(text, "e.toml"), default_name);
}

std::vector<std::string> Mistakes(const std::string& text) {
  try {
    Load(text);
  } catch (const ConfigError& error) {
    return error.mistakes();
  }
  return {};
}

// --- defaults ---------------------------------------------------------------------------------------

TEST(Experiment, NeedsADurationAndACountOnly) {
  const Experiment e = Load(Config(), "stem");
  EXPECT_EQ(e.run.name, "stem");
  EXPECT_EQ(e.run.duration_s, 10);
  EXPECT_EQ(e.run.mode, Mode::kLockstep);
  EXPECT_EQ(e.run.seed, 1u);
  EXPECT_EQ(e.run.agent_timeout_s, 5);
  EXPECT_EQ(e.run.start_timeout_s, 60);
  EXPECT_EQ(e.run.speed, 1);
  EXPECT_EQ(e.physics.rate_hz, 1000);
  EXPECT_EQ(e.physics.gravity_m_per_s2, 9.81);
  EXPECT_TRUE(e.physics.collisions);
  EXPECT_TRUE(e.physics.ground);
  EXPECT_EQ(e.size(), 4);
  EXPECT_EQ(e.agent(4).id, 4);
  EXPECT_EQ(e.agent(1).model, "quadrotor");
  EXPECT_EQ(e.agent(1).airframe.name, "mascot");
  EXPECT_EQ(e.agent(1).v_W, Eigen::Vector3d::Zero());
  EXPECT_FALSE(e.agent(1).external);
  EXPECT_EQ(e.control.rate_hz, 100);
  EXPECT_EQ(e.agent(1).control.heading_rad, 0);
  EXPECT_EQ(e.agent(1).control.max_acceleration_m_per_s2, 3);
  EXPECT_EQ(e.agent(1).control.inversion, Inversion::kSmallAngle);
  EXPECT_TRUE(e.agent(1).control.drag_compensation);
  EXPECT_EQ(e.graph.edges(), 12u);
  EXPECT_EQ(e.law.name, "consensus");
  EXPECT_EQ(e.law.leader, 0);
  EXPECT_EQ(e.law.axes, Axes::kXy);
  EXPECT_EQ(e.record.file, "run.mcap");
  EXPECT_THAT(e.record.topics, ElementsAre("*"));
  EXPECT_FALSE(e.record.ros_types);
  EXPECT_EQ(e.ticks_per_row(), 1);
  EXPECT_TRUE(e.output.position_plot && e.output.velocity_plot && e.output.save_plot && e.output.save_data);
  EXPECT_FALSE(e.output.show_plot);
  EXPECT_EQ(e.network.domain, -1);
  EXPECT_EQ(e.network.transport, "auto");
}

// --- every key is read ------------------------------------------------------------------------------

TEST(Experiment, TakesEveryKeyOfTheFile) {
  const Experiment e = Load(R"(
    [run]
    name = "my run"
    duration_s = 2.5
    mode = "realtime"
    seed = 9223372036854775807
    agent_timeout_s = 1.5
    start_timeout_s = 2.5
    speed = 0.5
    [physics]
    rate_hz = 400
    gravity_m_per_s2 = 1.62
    collisions = false
    ground = false
    [agents]
    count = 2
    model = "double_integrator"
    airframe = "crazyflie"
    position_m = [[1, 2, 3], [4, 5, -6]]
    velocity_m_per_s = [[0.5, 0, 0], [0, 0, -0.5]]
    [control]
    rate_hz = 200
    heading_rad = 0.5
    max_acceleration_m_per_s2 = 0.6
    inversion = "exact"
    drag_compensation = false
    [graph]
    topology = "directed_path"
    [law]
    name = "consensus"
    leader = 2
    axes = "xyz"
    [record]
    file = "other.mcap"
    topics = ["/clock"]
    ros_types = true
    rate_hz = 50
    [output]
    position_plot = false
    velocity_plot = false
    save_plot = false
    show_plot = true
    save_data = false
    [network]
    domain = 7
    transport = "udp"
  )");
  EXPECT_EQ(e.run.name, "my run");
  EXPECT_EQ(e.run.duration_s, 2.5);
  EXPECT_EQ(e.run.mode, Mode::kRealtime);
  EXPECT_EQ(e.run.seed, 9223372036854775807u);
  EXPECT_EQ(e.run.agent_timeout_s, 1.5);
  EXPECT_EQ(e.run.start_timeout_s, 2.5);
  EXPECT_EQ(e.run.speed, 0.5);
  EXPECT_EQ(e.physics.rate_hz, 400);
  EXPECT_EQ(e.physics.gravity_m_per_s2, 1.62);
  EXPECT_FALSE(e.physics.collisions);
  EXPECT_FALSE(e.physics.ground);
  EXPECT_EQ(e.agent(2).model, "double_integrator");
  EXPECT_EQ(e.agent(2).airframe.name, "crazyflie");
  EXPECT_EQ(e.agent(2).p_W, Eigen::Vector3d(4, 5, -6));
  EXPECT_EQ(e.agent(2).v_W, Eigen::Vector3d(0, 0, -0.5));
  EXPECT_EQ(e.control.rate_hz, 200);
  EXPECT_EQ(e.agent(1).control.heading_rad, 0.5);
  EXPECT_EQ(e.agent(1).control.max_acceleration_m_per_s2, 0.6);
  EXPECT_EQ(e.agent(1).control.inversion, Inversion::kExact);
  EXPECT_FALSE(e.agent(1).control.drag_compensation);
  EXPECT_EQ(e.graph.edges(), 1u);
  EXPECT_EQ(e.law.leader, 2);
  EXPECT_EQ(e.law.axes, Axes::kXyz);
  EXPECT_EQ(e.record.file, "other.mcap");
  EXPECT_THAT(e.record.topics, ElementsAre("/clock"));
  EXPECT_TRUE(e.record.ros_types);
  EXPECT_EQ(e.record.rate_hz, 50);
  EXPECT_EQ(e.ticks_per_row(), 4);
  EXPECT_FALSE(e.output.position_plot || e.output.velocity_plot || e.output.save_plot || e.output.save_data);
  EXPECT_TRUE(e.output.show_plot);
  EXPECT_EQ(e.network.domain, 7);
  EXPECT_EQ(e.network.transport, "udp");
}

TEST(Experiment, TakesWindObstaclesAndFailuresOfPhysics) {
  const Experiment e = Load(Config(R"(
    agents.heading_rad = [0, 1, -1, 10]
    [physics]
    wind = { mean_m_per_s = [4, 0, -1], gust_std_m_per_s = 1.5, gust_time_s = 2 }
    [[physics.obstacles]]
    shape = "box"
    position_m = [20, 0, 5]
    size_m = [1, 2, 3]
    heading_rad = 0.5
    [[physics.obstacles]]
    shape = "sphere"
    position_m = [30, 0, 5]
    size_m = [2, 2, 2]
    [[physics.obstacles]]
    shape = "cylinder"
    position_m = [40, 0, 5]
    size_m = [1, 1, 10]
    [[physics.rotor_failures]]
    agent = 3
    rotor = 4
    at_s = 2.5
    remaining = 0.75
    [[physics.rotor_failures]]
    agent = 1
    rotor = 1
    at_s = 0
  )"));
  EXPECT_EQ(e.physics.wind.mean_m_per_s, Eigen::Vector3d(4, 0, -1));
  EXPECT_EQ(e.physics.wind.gust_std_m_per_s, 1.5);
  EXPECT_EQ(e.physics.wind.gust_time_s, 2);
  ASSERT_THAT(e.physics.obstacles, SizeIs(3));
  EXPECT_EQ(e.physics.obstacles[0].shape, Shape::kBox);
  EXPECT_EQ(e.physics.obstacles[0].p_W, Eigen::Vector3d(20, 0, 5));
  EXPECT_EQ(e.physics.obstacles[0].size_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(e.physics.obstacles[0].heading_rad, 0.5);
  EXPECT_EQ(e.physics.obstacles[1].shape, Shape::kSphere);
  EXPECT_EQ(e.physics.obstacles[2].shape, Shape::kCylinder);
  EXPECT_EQ(e.physics.obstacles[2].heading_rad, 0);
  ASSERT_THAT(e.physics.rotor_failures, SizeIs(2));
  EXPECT_EQ(e.physics.rotor_failures[0].agent, 3);
  EXPECT_EQ(e.physics.rotor_failures[0].rotor, 4);
  EXPECT_EQ(e.physics.rotor_failures[0].at_s, 2.5);
  EXPECT_EQ(e.physics.rotor_failures[0].remaining, 0.75);
  EXPECT_EQ(e.physics.rotor_failures[1].remaining, 0);
  EXPECT_EQ(e.agent(3).heading_rad, -1);
}

TEST(Experiment, HasStillAirAndNothingInTheWayByDefault) {
  const Experiment e = Load(Config());
  EXPECT_EQ(e.physics.wind.mean_m_per_s, Eigen::Vector3d::Zero());
  EXPECT_EQ(e.physics.wind.gust_std_m_per_s, 0);
  EXPECT_EQ(e.physics.wind.gust_time_s, 1);
  EXPECT_THAT(e.physics.obstacles, IsEmpty());
  EXPECT_THAT(e.physics.rotor_failures, IsEmpty());
  EXPECT_EQ(e.agent(4).heading_rad, 0);
}

TEST(Experiment, ControlGainsReplaceThoseOfEveryAirframe) {
  const Experiment e = Load(Config(R"(
    [control]
    altitude = { kp = 1, kd = 2 }
    heading = { kp = 3, kd = 4 }
    attitude = { kp = 5, kd = 6 }
    position = { kp = 7, kd = 8 }
    tilt_limit_rad = 0.2
    [[agents.override]]
    id = 3
    airframe = "crazyflie"
  )"));
  for (const AgentConfig& agent : e.agents) {
    EXPECT_EQ(agent.airframe.altitude.kp, 1);
    EXPECT_EQ(agent.airframe.altitude.kd, 2);
    EXPECT_EQ(agent.airframe.heading.kp, 3);
    EXPECT_EQ(agent.airframe.attitude.kd, 6);
    EXPECT_EQ(agent.airframe.position.kp, 7);
    EXPECT_EQ(agent.airframe.tilt_limit_rad, 0.2);
  }
  EXPECT_EQ(e.agent(3).airframe.name, "crazyflie");
}

TEST(Experiment, GainsComeInPairs) {
  EXPECT_THAT(Mistakes(Config("[control]\naltitude = { kp = 1 }\n")),
              ElementsAre("e.toml:4:12: control.altitude.kd: expected a number in [0, 10000], got nothing"));
}

TEST(Experiment, OverridesAreForOneAgent) {
  const Experiment e = Load(Config(R"(
    [[agents.override]]
    id = 2
    model = "double_integrator"
    [[agents.override]]
    id = 4
    host = "external"
    airframe = { base = "crazyflie", mass_kg = 0.03 }
  )"));
  EXPECT_EQ(e.agent(1).model, "quadrotor");
  EXPECT_EQ(e.agent(2).model, "double_integrator");
  EXPECT_FALSE(e.agent(2).external);
  EXPECT_TRUE(e.agent(4).external);
  EXPECT_EQ(e.agent(4).model, "quadrotor");
  EXPECT_EQ(e.agent(4).airframe.mass_kg, 0.03);
  EXPECT_EQ(e.agent(3).airframe.name, "mascot");
}

/// The resolved form of `text`; checks that resolving it again changes nothing.
std::string ResolvedTwice(const std::string& text) {
  const std::string resolved = Load(text).resolved;
  EXPECT_EQ(Load(resolved).resolved, resolved);
  return resolved;
}

TEST(Experiment, AnOverrideReplacesTheKeysThatItContradicts) {
  const std::string bursts = "link.gilbert_elliott = { good_to_bad = 0.1, bad_to_good = 0.5 }\n";
  const LinkTable some =
      Load(ResolvedTwice(Config(bursts + "[[link.override]]\nedges = [[1, 2]]\nloss = 0.3\n"))).links;
  EXPECT_FALSE(some.Of(1, 2).bursts);
  EXPECT_EQ(some.Of(1, 2).loss, 0.3);
  EXPECT_TRUE(some.Of(2, 1).bursts);
  const LinkTable other = Load(ResolvedTwice(Config("link.loss = 0.3\n[[link.override]]\nedges = [[1, 2]]\n"
                                                    "gilbert_elliott = { good_to_bad = 0.1, bad_to_good = 0.5 }\n")))
                              .links;
  EXPECT_TRUE(other.Of(1, 2).bursts);
  EXPECT_EQ(other.Of(1, 2).loss, 0);
  EXPECT_EQ(other.Of(2, 1).loss, 0.3);

  const auto own = [](const std::string& team, const std::string& law) {
    return ResolvedTwice(Config("[law]\n" + team + "\n[[agents.override]]\nid = 2\nlaw = { " + law + " }\n"));
  };
  const std::string waypoints = "name = 'waypoint'\nwaypoints_m = [[0, 0, 1], [1, 0, 1]]\n";
  EXPECT_THAT(own(waypoints + "dwell_s = 3\narrival_radius_m = 0.7\n", "times_s = [0, 5]"),
              HasSubstr("times_s = [0.0, 5.0]"));
  EXPECT_THAT(own(waypoints + "times_s = [0, 5]\n", "dwell_s = 3"), HasSubstr("dwell_s = 3.0"));
  EXPECT_THAT(own("name = 'formation'\nshape = 'vee'\nspacing_m = 3\n",
                  "offsets_m = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]"),
              HasSubstr("offsets_m = ["));
  EXPECT_THAT(own("name = 'formation'\noffsets_m = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]\n", "shape = 'line'"),
              HasSubstr("shape = \"line\""));
}

TEST(Experiment, APythonLawOfAnOverrideDoesNotKeepTheFileNameOfTheTeams) {
  const std::string resolved =
      ResolvedTwice(Config("[law]\nname = 'custom'\npython = 'def control(t, me, n): return 1, 0'\npython_file = "
                           "'team.py'\npython_line = 7\n"
                           "[[agents.override]]\nid = 2\nlaw = { python = 'def control(t, me, n): return 2, 0' }\n"));
  EXPECT_THAT(resolved, AllOf(HasSubstr("return 2, 0\"\npython_file = \"e.toml\"\npython_line = 10\n"),
                              HasSubstr("return 1, 0\"\npython_file = \"team.py\"\npython_line = 7\n")));
}

TEST(Experiment, LawsChooseTheAxesTheyMoveAgentsAlong) {
  EXPECT_EQ(Load(Config("[law]\nname = 'waypoint'\nwaypoints_m = [[0, 0, 1]]\n")).law.axes, Axes::kXyz);
  EXPECT_EQ(Load(Config("[law]\nname = 'waypoint'\nwaypoints_m = [[0, 0, 1]]\naxes = 'xy'\n")).law.axes, Axes::kXy);
}

// --- time -------------------------------------------------------------------------------------------

TEST(Experiment, CountsTicksWithoutRoundingThemAway) {
  const Experiment e = Load("run.duration_s = 0.1\nagents.count = 1\ncontrol.rate_hz = 30\nphysics.rate_hz = 960\n");
  EXPECT_EQ(e.ticks(), 3);
  EXPECT_EQ(e.steps_per_tick(), 32);
  EXPECT_EQ(e.time_s(3), 0.1);
}

TEST(Experiment, RefusesTimesThatDoNotFitTogether) {
  EXPECT_THAT(Mistakes("run.duration_s = 0.015\nagents.count = 1\n"),
              ElementsAre("e.toml:1:18: run.duration_s: expected a whole number of periods of control.rate_hz (100), "
                          "got 0.015"));
  EXPECT_THAT(Mistakes("run.duration_s = 1e-12\nagents.count = 1\n"), ElementsAre(HasSubstr("a whole number")));
  EXPECT_THAT(Mistakes(Config("control.rate_hz = 300\n")),
              ElementsAre("e.toml:3:19: control.rate_hz: expected a divisor of physics.rate_hz (1000), got 300"));
}

// --- names ------------------------------------------------------------------------------------------

TEST(Experiment, DerivesItsNameFromTheFileNameWhateverItsCharacters) {
  EXPECT_EQ(Load(Config(), "ring of 6").run.name, "ring of 6");
  EXPECT_EQ(Load(Config(), "a(1)").run.name, "a_1_");
  EXPECT_EQ(Load(Config(), "..").run.name, "experiment");
  EXPECT_EQ(Load(Config(), "").run.name, "experiment");
}

TEST(Experiment, RefusesNamesThatLeaveTheirFolder) {
  EXPECT_THAT(Mistakes(Config("run.name = '../x'\n")), ElementsAre(HasSubstr("e.toml:3:12: run.name: expected")));
  EXPECT_THAT(Mistakes(Config("run.name = ''\n")), SizeIs(1));
  EXPECT_THAT(Mistakes(Config("record.file = '../run.mcap'\n")), ElementsAre(HasSubstr("without folders")));
}

// --- starts -----------------------------------------------------------------------------------------

TEST(RandomStart, KeepsAgentsApartInHeightWheneverThereIsRoom) {
  for (int seed = 0; seed < 50; ++seed) {
    const Experiment e = Load("run = { duration_s = 1, seed = " + std::to_string(seed) +
                              " }\nagents = { count = 7, random = { max_m = [10, 10, 4] } }\n");
    std::vector<double> heights_m;
    for (const AgentConfig& agent : e.agents) {
      EXPECT_THAT(agent.p_W.cwiseAbs().head<2>().maxCoeff(), testing::Le(10));
      heights_m.push_back(agent.p_W.z());
    }
    std::sort(heights_m.begin(), heights_m.end());
    EXPECT_GE(heights_m.front(), 1);
    EXPECT_LE(heights_m.back(), 4);
    for (std::size_t i = 1; i < heights_m.size(); ++i) EXPECT_GE(heights_m[i] - heights_m[i - 1], 0.5 - 1e-12);
  }
}

TEST(RandomStart, KeepsAgentsApartInSpaceWhenTheyMoveInSpace) {
  const Experiment e =
      Load("run.duration_s = 1\nagents = { count = 50, random = { min_separation_m = 2 } }\nlaw.axes = 'xyz'\n");
  for (int i = 1; i <= e.size(); ++i)
    for (int j = 1; j < i; ++j) EXPECT_GE((e.agent(i).p_W - e.agent(j).p_W).norm(), 2);
}

TEST(RandomStart, HasRoomForAnyNumberByDefault) {
  for (const int count : {1, 2, 6, 7, 100, 1000}) {
    const std::string text = "run.duration_s = 1\ngraph.topology = 'path'\nagents.count = " + std::to_string(count);
    EXPECT_THAT(Mistakes(text + "\n"), IsEmpty()) << count;
    EXPECT_THAT(Mistakes(text + "\nlaw.axes = 'xyz'\n"), IsEmpty()) << count;
  }
}

TEST(RandomStart, NeverHasAgentsTouch) {
  const Experiment e = Load(
      "run.duration_s = 1\nlaw.axes = 'xyz'\n"
      "agents = { count = 40, random = { min_m = [0, 0, 1], max_m = [5, 5, 3], min_separation_m = 0 } }\n");
  EXPECT_EQ(FirstTouching(e.agents), std::nullopt);
}

TEST(RandomStart, DependsOnTheSeedAlone) {
  const auto start = [](const std::string& text) { return Load(text).agent(3).p_W; };
  EXPECT_EQ(start(Config()), start(Config("graph.topology = 'ring'\ncontrol.rate_hz = 200\n")));
  EXPECT_NE(start(Config()), start(Config("run.seed = 2\n")));
}

TEST(RandomStart, GivesUpAfterABoundedNumberOfTries) {
  EXPECT_THAT(
      Mistakes("run.duration_s = 1\nlaw.axes = 'xyz'\n"
               "agents = { count = 9, random = { min_m = [0, 0, 0], max_m = [1, 1, 1], min_separation_m = 2 } }\n"),
      ElementsAre("e.toml:3:32: agents.random: expected room for 9 agents 2.0 m apart, got too small a box; what helps "
                  "is a larger one (min_m, "
                  "max_m) or less min_separation_m"));
}

/// Two unicycles and two quadrotors, followed by `text`.
std::string Mixed(const std::string& text) {
  return Config(
             "agents.override = [{ id = 2, model = 'unicycle' }, { id = 4, model = 'unicycle' }]\n"
             "agents.random.min_separation_m = 3\n") +
         text;
}

TEST(RandomStart, PutsUnicyclesOnTheGroundApartInXAndY) {
  for (int seed = 0; seed < 50; ++seed) {
    const Experiment e = Load(Mixed("run.seed = " + std::to_string(seed) + "\n"));
    EXPECT_EQ(e.agent(2).p_W.z(), kBallRadius_m);
    EXPECT_EQ(e.agent(4).p_W.z(), kBallRadius_m);
    EXPECT_GE((e.agent(2).p_W - e.agent(4).p_W).head<2>().norm(), 3);
    EXPECT_GE(std::abs(e.agent(1).p_W.z() - e.agent(3).p_W.z()), 3 - 1e-12) << "those that fly, in z";
    EXPECT_GE(std::min(e.agent(1).p_W.z(), e.agent(3).p_W.z()), kBallRadius_m + 3) << "and above those that stand";
  }
}

TEST(RandomStart, PutsUnicyclesAnywhereWhereThereIsNoGround) {
  const Experiment e = Load(Mixed("physics.ground = false\n"));
  for (const AgentConfig& agent : e.agents) EXPECT_GE(agent.p_W.z(), 1);
}

TEST(RandomStart, HasRoomForAnyNumberOfUnicyclesByDefault) {
  for (const int count : {1, 10, 1000})
    EXPECT_THAT(Mistakes("run.duration_s = 1\ngraph.topology = 'path'\nagents.model = 'unicycle'\nagents.count = " +
                         std::to_string(count) + "\n"),
                IsEmpty())
        << count;
}

TEST(RandomStart, AvoidsObstaclesUnlessCollisionsAreOff) {
  const std::string wall =
      "physics.obstacles = [{ shape = 'box', position_m = [0, 0, 0], size_m = [19, 19, 40], heading_rad = 0.1 }]\n";
  const auto inside = [&](const std::string& text) {
    const Experiment e = Load("run.duration_s = 1\nagents.count = 20\n" + text + wall);
    return FirstInObstacle(e.agents, e.physics.obstacles).has_value();
  };
  EXPECT_FALSE(inside(""));
  EXPECT_FALSE(inside("law.axes = 'xyz'\n"));
  EXPECT_FALSE(inside("agents.model = 'unicycle'\nagents.random.min_separation_m = 0.1\n"));
  EXPECT_TRUE(inside("physics.collisions = false\n"));
}

/// `count` agents that start as `random` says, by `seed`.
Experiment Started(int count, const std::string& random, int seed = 1, const std::string& more = "") {
  return Load("run = { duration_s = 1, seed = " + std::to_string(seed) + " }\ngraph.topology = 'path'\n" +
              "agents = { count = " + std::to_string(count) + ", random = { " + random + " } }\n" + more);
}

TEST(RandomStart, HasRoomInEveryShapeForAnyNumberByDefault) {
  for (const std::string shape : {"plane", "circle", "grid", "sphere"})
    for (const int count : {1, 2, 30, 300}) {
      const Experiment e = Started(count, "shape = '" + shape + "'");
      EXPECT_EQ(FirstTouching(e.agents), std::nullopt) << shape << count;
      for (const AgentConfig& agent : e.agents) EXPECT_GE(agent.p_W.z(), 1) << shape;
    }
}

TEST(RandomStart, InAPlaneIsApartInXAndY) {
  const Experiment e = Started(50, "shape = 'plane', min_m = [0, 0, 3], max_m = [20, 20, 8], min_separation_m = 1");
  for (int i = 1; i <= e.size(); ++i) {
    EXPECT_EQ(e.agent(i).p_W.z(), 3);
    EXPECT_TRUE((e.agent(i).p_W.head<2>().array() >= 0).all() && (e.agent(i).p_W.head<2>().array() <= 20).all());
    for (int j = 1; j < i; ++j) EXPECT_GE((e.agent(i).p_W - e.agent(j).p_W).norm(), 1);
  }
}

TEST(RandomStart, OnASphereIsUniform) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0;
  int count = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    const Experiment e =
        Started(100, "shape = 'sphere', radius_m = 40, center_m = [0, 0, 50], min_separation_m = 0", seed);
    for (const AgentConfig& agent : e.agents) {
      const Eigen::Vector3d away = (agent.p_W - Eigen::Vector3d(0, 0, 50)) / 40;
      EXPECT_NEAR(away.norm(), 1, 1e-12);
      sum += away;
      squares += away.z() * away.z();
      ++count;
    }
  }
  const double sigma = 1 / std::sqrt(3.0 * count);  // of the mean of one coordinate, whose variance is 1/3
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(sum[axis] / count, 0, 4 * sigma);
  EXPECT_NEAR(squares / count, 1.0 / 3, 4 * std::sqrt(4.0 / 45 / count)) << "z is uniform";
}

TEST(RandomStart, OnAGridTakesEachPointOnce) {
  std::set<std::pair<double, double>> points;
  const Experiment e = Started(9, "shape = 'grid', grid_spacing_m = 2, center_m = [10, 0, 5]");
  for (const AgentConfig& agent : e.agents) points.emplace(agent.p_W.x(), agent.p_W.y());
  EXPECT_THAT(points,
              ElementsAre(std::pair(8, -2), std::pair(8, 0), std::pair(8, 2), std::pair(10, -2), std::pair(10, 0),
                          std::pair(10, 2), std::pair(12, -2), std::pair(12, 0), std::pair(12, 2)));
  EXPECT_NE(e.agent(1).p_W, Started(9, "shape = 'grid', grid_spacing_m = 2, center_m = [10, 0, 5]", 2).agent(1).p_W)
      << "who stands where is drawn";
}

TEST(RandomStart, DrawsVelocitiesUniformInTheBallAndYaws) {
  const Experiment e = Started(400, "max_speed_m_per_s = 3, heading = true", 1, "law.axes = 'xyz'\n");
  double cubes = 0, turns = 0;
  for (const AgentConfig& agent : e.agents) {
    EXPECT_LE(agent.v_W.norm(), 3);
    EXPECT_LE(std::abs(agent.heading_rad), std::numbers::pi);
    cubes += std::pow(agent.v_W.norm() / 3, 3);
    turns += agent.heading_rad;
  }
  const double sigma = 1 / std::sqrt(12.0 * 400);  // of the mean of numbers that are uniform in [0, 1]
  EXPECT_NEAR(cubes / 400, 0.5, 4 * sigma);
  EXPECT_NEAR(turns / 400, 0, 4 * sigma * 2 * std::numbers::pi);
}

TEST(RandomStart, SendsUnicyclesAlongTheirHeadings) {
  const Experiment e = Load(
      "run.duration_s = 1\ngraph.topology = 'path'\n"
      "agents = { count = 20, model = 'unicycle', random = { max_speed_m_per_s = 3, heading = true } }\n");
  for (const AgentConfig& agent : e.agents) {
    const Eigen::Vector3d side(-std::sin(agent.heading_rad), std::cos(agent.heading_rad), 0);
    EXPECT_NEAR(agent.v_W.dot(side), 0, 1e-12);
  }
}

TEST(RandomStart, SaysWhichKeysBelongToAShape) {
  const auto mistakes = [](const std::string& random) {
    return Mistakes("run.duration_s = 1\nagents = { count = 4, random = { " + random + " } }\n");
  };
  const auto only = [](const std::string& words) { return ElementsAre(testing::EndsWith(words)); };
  EXPECT_THAT(mistakes("radius_m = 3"),
              only("agents.random.radius_m: expected shape = \"circle\" or \"sphere\" with it, got \"box\""));
  EXPECT_THAT(mistakes("shape = 'grid', min_separation_m = 3"),
              only("agents.random.min_separation_m: expected shape = \"box\" or \"plane\" or \"circle\" or \"sphere\" "
                   "with it, got \"grid\""));
  EXPECT_THAT(mistakes("shape = 'circle', max_m = [3, 3, 3]"),
              only("agents.random.max_m: expected shape = \"box\" or \"plane\" with it, got \"circle\""));
  EXPECT_THAT(mistakes("shape = 'sphere', center_m = [0, 0, 2]"),
              only("agents.random.center_m: expected z >= 5 (physics.ground), got 2.0"));
  EXPECT_THAT(mistakes("shape = 'ball'"),
              only("agents.random.shape: expected one of box, plane, circle, grid, sphere, got 'ball'"));
  EXPECT_THAT(mistakes("shape = 'circle', radius_m = 0.1"),
              only("got too small a circle; what helps is a larger radius_m or less min_separation_m"));
  EXPECT_THAT(mistakes("shape = 'grid', grid_spacing_m = 0.01"),
              only("expected room for 4 agents that do not touch, got too small a grid; what helps is a larger "
                   "grid_spacing_m"));
  EXPECT_THAT(Mistakes("run.duration_s = 1\nagents = { count = 2, model = 'unicycle', random.shape = 'sphere' }\n"),
              only("expected another one than \"sphere\", because unicycles stand on the ground"));
  EXPECT_THAT(Mistakes("run.duration_s = 1\nagents = { count = 2, heading_rad = [0, 1], random.heading = true }\n"),
              only("agents.random.heading: expected one of heading_rad, random.heading, got both"));
  EXPECT_THAT(Mistakes("run.duration_s = 1\nagents = { count = 2, velocity_m_per_s = [[0, 0, 0], [1, 0, 0]], "
                       "random.max_speed_m_per_s = 1 }\n"),
              only("expected one of velocity_m_per_s, random.max_speed_m_per_s, got both"));
}

// --- starts from a table ------------------------------------------------------------------------------

TEST(Starts, ComeFromAFileWhichTheRunKeeps) {
  ScratchFolder folder;
  WriteFile(folder.File("starts.csv"), "x,y,z,vx,vy,vz,heading\n0, 0, 1, 0.5, 0, 0, 1.5\r\n\n3,0,2,0,0,0,0\n");
  WriteFile(folder.File("e.toml"), "run.duration_s = 1\nagents = { count = 2, starts_file = 'starts.csv' }\n");
  const Experiment e = LoadExperiment(Section::FromFile(folder.File("e.toml")), "e");
  EXPECT_EQ(e.agent(1).p_W, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(e.agent(1).v_W, Eigen::Vector3d(0.5, 0, 0));
  EXPECT_EQ(e.agent(1).heading_rad, 1.5);
  EXPECT_EQ(e.agent(2).p_W, Eigen::Vector3d(3, 0, 2));
  const Experiment again = Load(e.resolved);
  EXPECT_EQ(again.agent(1).v_W, e.agent(1).v_W);
  EXPECT_EQ(again.resolved, e.resolved);
}

TEST(Starts, SaysWhereATableIsWrong) {
  const auto mistakes = [](const std::string& lines, const std::string& more = "") {
    ScratchFolder folder;
    WriteFile(folder.File("starts.csv"), lines);
    WriteFile(folder.File("e.toml"),
              "run.duration_s = 1\nagents = { count = 2, starts_file = 'starts.csv' " + more + "}\n");
    try {
      LoadExperiment(Section::FromFile(folder.File("e.toml")), "e");
    } catch (const ConfigError& error) {
      return error.mistakes();
    }
    return std::vector<std::string>();
  };
  const auto only = [](const std::string& words) { return ElementsAre(testing::EndsWith(words)); };
  EXPECT_THAT(mistakes("0,0,1\n1,x,1\n"), only("starts.csv:2:3: agents.starts_file: expected 3, 6 or 7 numbers in "
                                               "[-1e+06, 1e+06], x,y,z,vx,vy,vz,heading, got '1,x,1'"));
  EXPECT_THAT(mistakes("0,0,1\n1,0\n"), only("starts.csv:2:4: agents.starts_file: expected 3, 6 or 7 numbers in "
                                             "[-1e+06, 1e+06], x,y,z,vx,vy,vz,heading, got '1,0'"));
  EXPECT_THAT(mistakes("0,0,1\n1,0,1,2,3,4,5,6\n"), only("got '1,0,1,2,3,4,5,6'"));
  EXPECT_THAT(mistakes("0,0,1\n"), only("starts.csv:1:1: agents.starts_file: expected 2 lines, one per agent, got 1"));
  EXPECT_THAT(mistakes("0,0,1\n0,0,-1\n"),
              only("starts.csv:2:1: agents.starts_file: expected z >= 0 (physics.ground), got -1.0"));
  EXPECT_THAT(mistakes("0,0,1\n0,0,1\n"), only("starts.csv:2:1: agents.starts_file: expected agents apart "
                                               "(physics.collisions), got agent 2 touching agent 1"));
  EXPECT_THAT(mistakes("0,0,1,0,0,0\n3,0,1,0,0,0\n", ", velocity_m_per_s = [[0, 0, 0], [0, 0, 0]]"),
              only("expected x,y,z alone beside velocity_m_per_s, got '0,0,1,0,0,0'"));
  EXPECT_THAT(mistakes("0,0,1,0,0,0,1\n3,0,1,0,0,0,1\n", ", heading_rad = [0, 0]"),
              only("expected no heading beside heading_rad, got '0,0,1,0,0,0,1'"));
  EXPECT_THAT(mistakes("0,0,1\n3,0,1\n", ", random = {}"),
              only("agents.starts_file: expected one of position_m, random, starts_file, starts, got both random and "
                   "starts_file"));
  EXPECT_THAT(Mistakes("run.duration_s = 1\nagents = { count = 2, starts = '0,0' }\n"),
              only("agents.starts: line 1, column 4: expected 3, 6 or 7 numbers in [-1e+06, 1e+06], "
                   "x,y,z,vx,vy,vz,heading, got '0,0'"));
}

TEST(RandomStart, SaysWhatThereIsNoRoomFor) {
  EXPECT_THAT(
      Mistakes(Mixed("agents.random.max_m = [10, 10, 3]\nagents.random.min_m = [-10, -10, 1]\n")),
      ElementsAre("e.toml:4:8: agents.random: expected room for 4 agents 3.0 m apart in z "
                  "(law.axes = \"xy\"; unicycles in x, y), got too small a box; what helps is a higher one (max_m), "
                  "less min_separation_m, or shape = \"plane\""));
  EXPECT_THAT(Mistakes(Config("law.axes = 'xyz'\nagents.random.min_separation_m = 0.0\n"
                              "physics.obstacles = [{ shape = 'sphere', position_m = [0, 0, 0], "
                              "size_m = [99, 99, 99] }]\n")),
              ElementsAre("e.toml:4:8: agents.random: expected room for 4 agents 0.0 m apart, clear of obstacles "
                          "(physics.obstacles), got too small a box; what helps is a larger one (min_m, max_m) or less "
                          "min_separation_m"));
}

TEST(GivenStart, OfAUnicycleIsTakenAsItIs) {
  EXPECT_EQ(Load("run.duration_s = 1\n"
                 "agents = { count = 1, model = 'unicycle', position_m = [[1, 2, 0.7]] }\n")
                .agent(1)
                .p_W,
            Eigen::Vector3d(1, 2, 0.7));
}

/// The mistakes in an experiment with two agents, the second at `place`, and two obstacles.
std::vector<std::string> Beside(const std::string& obstacle, const std::string& place,
                                const std::string& more = "agents.model = 'double_integrator'\n") {
  return Mistakes("run.duration_s = 1\nagents.count = 2\nagents.position_m = [[50, 0, 5], " + place + "]\n" +
                  "physics.obstacles = [{ shape = 'sphere', position_m = [-50, 0, 5], size_m = [1, 1, 1] }, " +
                  obstacle + "]\n" + more);
}

TEST(GivenStart, MayNotBeInsideAnObstacleUnlessCollisionsAreOff) {
  const std::string box = "{ shape = 'box', position_m = [0, 0, 5], size_m = [2, 4, 6] }";
  EXPECT_THAT(
      Beside(box, "[1.09, 0, 5]"),
      ElementsAre("e.toml:3:34: agents.position_m[1]: expected agents apart from obstacles (physics.obstacles), "
                  "got agent 2 inside obstacle 2"));
  EXPECT_THAT(Beside(box, "[1.09, 0, 5]", "agents.model = 'double_integrator'\nphysics.collisions = false\n"),
              IsEmpty());
}

TEST(GivenStart, MayBeJustOutsideAnObstacleOfAnyShape) {
  const std::string box = "{ shape = 'box', position_m = [0, 0, 5], size_m = [2, 4, 6] }";
  const std::string turned = "{ shape = 'box', position_m = [0, 0, 5], size_m = [2, 4, 6], heading_rad = 1.5707963 }";
  const std::string sphere = "{ shape = 'sphere', position_m = [0, 0, 5], size_m = [2, 2, 2] }";
  const std::string cylinder = "{ shape = 'cylinder', position_m = [0, 0, 5], size_m = [2, 2, 6] }";
  EXPECT_THAT(Beside(box, "[1.11, 0, 5]"), IsEmpty());
  EXPECT_THAT(Beside(box, "[0, 2.09, 5]"), SizeIs(1));
  EXPECT_THAT(Beside(box, "[0, 2.11, 5]"), IsEmpty());
  EXPECT_THAT(Beside(box, "[0, 0, 8.09]"), SizeIs(1));
  EXPECT_THAT(Beside(box, "[0, 0, 8.11]"), IsEmpty());
  EXPECT_THAT(Beside(turned, "[2.09, 0, 5]"), SizeIs(1));
  EXPECT_THAT(Beside(turned, "[2.11, 0, 5]"), IsEmpty());
  EXPECT_THAT(Beside(sphere, "[1.09, 0, 5]"), SizeIs(1));
  EXPECT_THAT(Beside(sphere, "[0.9, 0.9, 5]"), IsEmpty()) << "beside the sphere, inside the box about it";
  EXPECT_THAT(Beside(cylinder, "[0, 1.09, 7.9]"), SizeIs(1));
  EXPECT_THAT(Beside(cylinder, "[0.9, 0.9, 5]"), IsEmpty());
  EXPECT_THAT(Beside(cylinder, "[0, 0, 8.11]"), IsEmpty());
}

TEST(GivenStart, CountsTheYawOfABody) {
  const std::string wide = "agents.airframe = { size_m = [2, 0.2, 0.2] }\n";
  const std::string wall = "{ shape = 'box', position_m = [0, 0, 5], size_m = [2, 2, 2] }";
  EXPECT_THAT(Beside(wall, "[0, 1.5, 5]", wide), IsEmpty());
  EXPECT_THAT(Beside(wall, "[0, 1.5, 5]", wide + "agents.heading_rad = [0, 1.5]\n"), SizeIs(1));
  const std::string abreast = Config("agents.position_m = [[0, 0, 5], [0, 1, 5], [0, 2, 5], [0, 3, 5]]\n") + wide;
  EXPECT_THAT(Mistakes(abreast), IsEmpty());
  EXPECT_THAT(Mistakes(abreast + "agents.heading_rad = [1.5, 1.5, 0, 0]\n"), SizeIs(1));
}

TEST(GivenStart, IsNotCheckedAgainstAnInvalidObstacle) {
  EXPECT_THAT(Beside("{ shape = 'box', size_m = [2, 2, 2] }", "[0, 0, 0]"),
              ElementsAre(HasSubstr("physics.obstacles[1].position_m: expected")));
}

TEST(GivenStart, MayNotTouchUnlessCollisionsAreOff) {
  const std::string touching = "agents.position_m = [[0, 0, 1], [9, 0, 1], [0, 5, 1], [0.1, 0.1, 1.1]]\n";
  EXPECT_THAT(Mistakes(Config(touching)),
              ElementsAre("e.toml:3:55: agents.position_m[3]: expected agents apart (physics.collisions), "
                          "got agent 4 touching agent 1"));
  EXPECT_THAT(Mistakes(Config(touching + "physics.collisions = false\n")), IsEmpty());
}

TEST(GivenStart, MayBeBelowZeroOnlyWithoutGround) {
  const std::string below = "agents.position_m = [[0, 0, 1], [9, 0, 1], [0, 5, -1], [5, 5, 0]]\n";
  EXPECT_THAT(Mistakes(Config(below)),
              ElementsAre("e.toml:3:44: agents.position_m[2]: expected z >= 0 (physics.ground), got -1.0"));
  EXPECT_THAT(Mistakes(Config(below + "physics.ground = false\n")), IsEmpty());
}

// --- one mistake, one message -----------------------------------------------------------------------

TEST(Experiment, DoesNotReportMistakesThatFollowFromOthers) {
  const std::string rest =
      "agents.position_m = [[0, 0, 1]]\ngraph.adjacency = [[0, 1], [1, 0]]\n"
      "law = { name = 'minmax', leader = 7, beta = [1, 2] }\n";
  EXPECT_THAT(Mistakes("run.duration_s = 1\nagents.count = 'four'\n" + rest), SizeIs(1));
  EXPECT_THAT(Mistakes(Config("graph.laplacian = [[1]]\nlaw = { name = 'minmax', leader = 1, beta = [1, 2, 3, 4] }\n")),
              ElementsAre(HasSubstr("graph.laplacian: expected 4 rows")));
  EXPECT_THAT(Mistakes(Config("law = { name = 'minmaxx', beta = 'x', boundary_layer = 'y' }\n")),
              ElementsAre(HasSubstr("law.name: expected one of")));
  EXPECT_THAT(Mistakes("run.duration_s = 'x'\nagents.count = 1\nphysics.rate_hz = 0\ncontrol.rate_hz = 300\n"),
              SizeIs(2));
}

TEST(Experiment, FindsMistakesOfDifferentTablesAtOnce) {
  EXPECT_THAT(Mistakes(Config("graph.topology = 'cube'\nlaw.p_gain = 'fast'\noutput.save_plot = 1\nrun.spee = 2\n")),
              ElementsAre(HasSubstr(":3:18: graph.topology: "), HasSubstr(":4:14: law.p_gain: "),
                          HasSubstr(":5:20: output.save_plot: "),
                          "e.toml:6:5: run.spee: unknown key (did you mean \"speed\"?)"));
}

TEST(Experiment, SecurityGoesWithWhatItCanSecure) {
  const Experiment e = Load(Config("network.security = 'graph'\nnetwork.protection = 'sign'\n"));
  EXPECT_TRUE(e.network.is_secure());
  EXPECT_EQ(e.network.protection, Protection::kSign);
  EXPECT_FALSE(Load(Config("")).network.is_secure());
  EXPECT_THAT(Mistakes(Config("network.protection = 'sign'\n")),
              ElementsAre(HasSubstr("network.protection: expected \"none\" with security = \"off\", got 'sign'")));
  EXPECT_THAT(
      Mistakes(Config("network.security = 'graph'\nnetwork.transport = 'shm'\n")),
      ElementsAre(HasSubstr("network.transport: expected \"auto\" or \"udp\" with security = \"graph\", got 'shm'")));
  EXPECT_THAT(Mistakes(Config("network.security = 'graph'\nnetwork.ros_view = true\n")),
              ElementsAre(HasSubstr("network.ros_view: expected false with security = \"graph\": RViz2 has no "
                                    "certificate, got true")));
}

TEST(Experiment, KnowsOnlyKeysThatDoSomething) {
  for (const std::string later : {"run.deterministic = true", "network.compression = 'zstd'", "law.file = 'x.py'"})
    EXPECT_THAT(Mistakes(Config(later + "\n")), ElementsAre(HasSubstr("unknown key"))) << later;
}

// --- the resolved file ------------------------------------------------------------------------------

// --- hosts ------------------------------------------------------------------------------------------

/// The agents of each process: "1-3".
std::vector<std::string> Processes(const std::string& text) {
  std::vector<std::string> all;
  for (const AgentRange& agents : AgentProcesses(Load(text)))
    all.push_back(std::to_string(agents.first) + "-" + std::to_string(agents.last));
  return all;
}

TEST(Hosts, HaveTheAgentsThatTheyName) {
  const Experiment e = Load(Config("[[hosts]]\nname = 'me@lab1'\nagents = '2-3'\n"));
  ASSERT_THAT(e.hosts, SizeIs(1));
  EXPECT_THAT(e.hosts[0].launch, ElementsAre("ssh", "-oBatchMode=yes", "-oConnectTimeout=10", "me@lab1"));
  EXPECT_EQ(e.agent(1).host, "");
  EXPECT_EQ(e.agent(2).host, "me@lab1");
  EXPECT_EQ(e.agent(4).host, "");
  EXPECT_THAT(Load(e.resolved).hosts, SizeIs(1));
}

TEST(Hosts, ShareNoProcess) {
  const std::string shared = Config("network.agents_per_process = 3\n");
  EXPECT_THAT(Processes(shared), ElementsAre("1-3", "4-4"));
  EXPECT_THAT(Processes(shared + "[[hosts]]\nname = 'a'\nagents = '2-3'\n"), ElementsAre("1-1", "2-3", "4-4"));
  EXPECT_THAT(Processes(shared + "[[hosts]]\nname = 'a'\nagents = '1,4'\n[[hosts]]\nname = 'b'\nagents = '3'\n"),
              ElementsAre("1-1", "2-2", "3-3", "4-4"));
}

TEST(Hosts, AreRefusedWithAgentsOrAddressesThatAreNone) {
  const auto host = [](const std::string& more) { return Config("[[hosts]]\nname = 'a'\n" + more); };
  for (const char* agents : {"", "0", "5", "2-1", "1-", "-1", "1,", "1 2", "1-2-3", "a"})
    EXPECT_THAT(Mistakes(host("agents = '" + std::string(agents) + "'\n")), SizeIs(1)) << agents;
  for (const char* agents : {"1", "1-4", "1,3", "1-2,4", "3,1"})
    EXPECT_THAT(Mistakes(host("agents = '" + std::string(agents) + "'\n")), IsEmpty()) << agents;
  for (const char* address : {"1.2.3", "1.2.3.4.5", "1.2.3.256", "1.2.3.", "1..2.3", "-1.2.3.4", "a.b.c.d", "::1"})
    EXPECT_THAT(Mistakes(host("agents = '1'\naddress = '" + std::string(address) + "'\n")), SizeIs(1)) << address;
  EXPECT_THAT(Mistakes(host("agents = '1'\naddress = '192.168.1.11'\n")), IsEmpty());
}

TEST(ResolvedExperiment, IsTheSameAgainWhenRead) {
  std::vector<Experiment> experiments;
  for (const std::string& text :
       {Config(), Config("graph.random = { kind = 'erdos_renyi', p = 0.5 }\nagents.random.min_separation_m = 0.3\n"),
        Config("control.altitude = { kp = 1, kd = 2 }\n[agents.airframe]\nbase = 'crazyflie'\nposition = { kp = 3 }\n"
               "[[agents.override]]\nid = 2\nairframe = { mass_kg = 2 }\n[[agents.override]]\nid = 3\nhost = "
               "'external'\n")})
    experiments.push_back(Load(text));
  for (const auto& entry : std::filesystem::directory_iterator(test::SourceFolder() + "/configs")) {
    if (entry.path().extension() == ".toml")
      experiments.push_back(LoadExperiment(Section::FromFile(entry.path()), "test"));
  }
  for (const Experiment& experiment : experiments) {
    const std::string resolved = experiment.resolved;
    const Experiment again = Load(resolved, "another name");
    EXPECT_EQ(again.resolved, resolved);
    ASSERT_EQ(again.size(), experiment.size());
    for (int id = 1; id <= again.size(); ++id) {
      EXPECT_EQ(again.agent(id).p_W, experiment.agent(id).p_W);
      EXPECT_EQ(again.agent(id).airframe.mass_kg, experiment.agent(id).airframe.mass_kg);
    }
    EXPECT_EQ(again.graph.Laplacian(), experiment.graph.Laplacian());
  }
}

TEST(AsksAgain, InLockstepIfTheRunHasStartedAllProcessesOnThisHost) {
  const std::string three = "run.duration_s = 1\nagents.count = 3\ngraph.topology = 'ring'\n";
  EXPECT_TRUE(AsksAgain(Load(three)));
  EXPECT_TRUE(AsksAgain(Load(three + "network.agents_per_process = 3\n")));
  EXPECT_FALSE(AsksAgain(Load(three + "run.mode = 'realtime'\n")));
  EXPECT_FALSE(AsksAgain(Load(three + "network.delivery = 'topics'\n")));
  EXPECT_FALSE(AsksAgain(Load(three + "network.transport = 'udp'\n"))) << "datagrams get lost, again and again";
  EXPECT_FALSE(
      AsksAgain(Load("run.duration_s = 1\nagents = { count = 3, override = [{ id = 2, host = 'external' }] }\n"
                     "graph.topology = 'ring'\n")));
  EXPECT_FALSE(AsksAgain(Load(three + "[[hosts]]\nname = 'pi'\nagents = '3'\n")));
}

}  // namespace
}  // namespace mascot
