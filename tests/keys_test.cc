// Every key of an experiment file has an effect: changing it changes a result. engines_test.cc and faults_test.cc test
// the keys for DDS and real time; laws_test.cc also tests the parameters of laws.

#include <gmock/gmock.h>

#include <map>

#include "orchestrator/formats/mcap/reader.h"
#include "tests/orchestrator.h"
#include "tests/param_name.h"

namespace mascot::test {
namespace {

namespace fs = std::filesystem;

/// A short run in one process of a shipped configuration, with `sets` (KEY=VALUE).
struct Flown {
  Flown(const ScratchFolder& folder, const std::string& name, const std::string& config, std::vector<std::string> sets)
      : up(folder, name, Config(config), Words(std::move(sets))) {
    EXPECT_EQ(up.Wait(), 0) << up.err();
  }
  static std::vector<std::string> Words(std::vector<std::string> sets) {
    std::vector<std::string> words{"--engine", "inprocess"};
    for (std::string& set : sets) words.insert(words.end(), {"--set", std::move(set)});
    return words;
  }
  Up up;
};

/// A test that setting `key` to `value`, in addition to `base`, changes the states. `name` is the name of the test: the
/// key that is changed and, if several tests change it, how or for which agents.
struct Row {
  std::string key, value;
  std::vector<std::string> base = {};
  std::string name = key;
  std::string config = "leaderless";
};

void PrintTo(const Row& row, std::ostream* out) {
  *out << row.key << "=" << row.value;
  for (const std::string& set : row.base) *out << (&set == &row.base.front() ? " on top of " : ", ") << set;
}

class Key : public testing::TestWithParam<Row> {};

TEST_P(Key, ChangesTheStates) {
  ScratchFolder folder;
  const Row& row = GetParam();
  std::vector<std::string> base = row.base;
  if (row.key != "run.duration_s") base.insert(base.begin(), "run.duration_s=1.0");
  auto changed = base;
  changed.push_back(row.key + "=" + row.value);
  const Flown before(folder, "before", row.config, base);
  const Flown after(folder, "after", row.config, changed);
  EXPECT_FALSE(before.up.File("states.npz") == after.up.File("states.npz"));
}

std::string NameOf(const testing::TestParamInfo<Row>& row) { return ParamName(row.param.name); }

INSTANTIATE_TEST_SUITE_P(Wind, Key,
                         testing::Values(Row{"physics.wind.mean_m_per_s", "[1, 0, 0]"},
                                         Row{"physics.wind.gust_std_m_per_s", "1.0"},
                                         Row{"physics.wind.gust_time_s", "3.0", {"physics.wind.gust_std_m_per_s=1.0"}}),
                         NameOf);

/// One obstacle, by default a box of 1 m at [1.2, 0, 1]; `more`: further keys.
std::string Block(const std::string& shape = "box", const std::string& place = "[1.2, 0, 1]",
                  const std::string& size = "[1, 1, 1]", const std::string& more = "") {
  return "[{ shape = '" + shape + "', position_m = " + place + ", size_m = " + size + more + " }]";
}

/// Sets `key` to `value` for an agent that passes `obstacle` closely.
Row Passing(const std::string& obstacle, const std::string& key, const std::string& value) {
  return {key,
          value,
          {"agents={ count = 2, position_m = [[0, 0.2, 1], [9, 0, 3]], velocity_m_per_s = [[3, 0, 0], [0, 0, 0]] }",
           "physics.obstacles=" + obstacle}};
}

/// Replaces Block() by another obstacle; `what` names the difference.
Row OtherBlock(const std::string& what, const std::string& block) {
  Row row = Passing(Block(), "physics.obstacles", block);
  row.name = "physics.obstacles." + what;
  return row;
}

INSTANTIATE_TEST_SUITE_P(
    Obstacles, Key,
    testing::Values(Passing("[]", "physics.obstacles", Block()), OtherBlock("shape to cylinder", Block("cylinder")),
                    OtherBlock("shape to sphere", Block("sphere")),
                    OtherBlock("position_m", Block("box", "[1.3, 0, 1]")),
                    OtherBlock("size_m", Block("box", "[1.2, 0, 1]", "[1.1, 1, 1]")),
                    OtherBlock("heading_rad", Block("box", "[1.2, 0, 1]", "[1, 1, 1]", ", heading_rad = 0.1")),
                    Passing(Block(), "physics.collisions", "false")),
    NameOf);

/// Replaces the failure of rotor 1 of agent 1 at 0.5 s by another rotor failure; `what` names the difference.
Row Failing(const std::string& what, int agent, int rotor, const std::string& at_s, const std::string& more = "") {
  return {
      "physics.rotor_failures",
      "[{ agent = " + std::to_string(agent) + ", rotor = " + std::to_string(rotor) + ", at_s = " + at_s + more + "}]",
      {"physics.rotor_failures=[{ agent = 1, rotor = 1, at_s = 0.5 }]"},
      "physics.rotor_failures." + what};
}

INSTANTIATE_TEST_SUITE_P(RotorFailures, Key,
                         testing::Values(Row{"physics.rotor_failures", "[{ agent = 1, rotor = 1, at_s = 0.5 }]"},
                                         Failing("agent", 2, 1, "0.5"), Failing("rotor", 1, 2, "0.5"),
                                         Failing("at_s", 1, 1, "0.6"),
                                         Failing("remaining", 1, 1, "0.5", ", remaining = 0.5")),
                         NameOf);

INSTANTIATE_TEST_SUITE_P(
    Models, Key,
    testing::Values(
        Row{"agents.heading_rad", "[0, 0, 1, 0]"},
        Row{"agents.heading_rad", "[0, 0, 1, 0]", {"agents.model=unicycle"}, "agents.heading_rad of unicycles"},
        Row{"agents.model",
            "single_integrator",
            {"agents.model=double_integrator"},
            "agents.model to single_integrator"},
        Row{"agents.model", "unicycle", {"agents.model=single_integrator"}, "agents.model to unicycle"},
        Row{"agents.override", "[{ id = 2, model = \"unicycle\" }]", {}, "agents.override.model"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    All, Key,
    testing::Values(
        Row{"run.duration_s", "1.5", {"run.duration_s=1.0"}}, Row{"run.seed", "2"}, Row{"physics.rate_hz", "500"},
        Row{"physics.gravity_m_per_s2", "1.62"},
        Row{"physics.collisions",
            "false",
            {"agents={ count = 2, position_m = [[0, 0, 1], [1, 0, 1]], velocity_m_per_s = [[1, 0, 0], [-1, 0, 0]] }"}},
        Row{"physics.ground", "false", {"agents.velocity_m_per_s=[[0,0,-8],[0,0,0],[0,0,0],[0,0,0]]"}},
        Row{"agents.count", "5"}, Row{"agents.model", "double_integrator"}, Row{"agents.airframe", "mascot_published"},
        Row{"agents.airframe", "{ mass_kg = 2.0 }", {}, "agents.airframe.mass_kg"},
        Row{"agents.random", "{ max_m = [5, 5, 4] }", {}, "agents.random.max_m"},
        Row{"agents.random", "{ min_m = [0, 0, 2] }", {}, "agents.random.min_m"},
        Row{"agents.random", "{ min_separation_m = 1.0 }", {}, "agents.random.min_separation_m"},
        Row{"agents.velocity_m_per_s", "[[1,0,0],[0,0,0],[0,0,0],[0,0,0]]"},
        Row{"agents.override", "[{ id = 2, model = \"double_integrator\" }]", {}, "agents.override.model"},
        Row{"agents.override", "[{ id = 2, airframe = \"crazyflie\" }]", {}, "agents.override.airframe"},
        Row{"control.rate_hz", "50"},
        Row{"control.altitude",
            "{ kp = 1.0, kd = 1.0 }",
            {"agents.velocity_m_per_s=[[0,0,1],[0,0,0],[0,0,0],[0,0,0]]"}},
        Row{"control.heading", "{ kp = 1.0, kd = 1.0 }", {"control.heading_rad=0.5"}},
        Row{"control.attitude", "{ kp = 50.0, kd = 10.0 }"}, Row{"control.heading_rad", "0.5"},
        Row{"control.max_acceleration_m_per_s2", "0.5"}, Row{"control.tilt_limit_rad", "0.01"},
        Row{"control.inversion", "exact"}, Row{"control.drag_compensation", "false"}, Row{"graph.topology", "path"},
        Row{"graph", "{ laplacian = [[1,-1,0,0],[0,1,-1,0],[0,0,1,-1],[-1,0,0,1]] }", {}, "graph.laplacian"},
        Row{"graph", "{ adjacency = [[0,1,0,0],[0,0,2,0],[0,0,0,1],[1,0,0,0]] }", {}, "graph.adjacency"},
        Row{"graph", "{ edges = [[1, 2], [2, 1, 0.5]] }", {}, "graph.edges"},
        Row{"graph", "{ random = { kind = \"erdos_renyi\", p = 0.1 } }", {}, "graph.random"},
        Row{"graph.random.p", "0.9", {"graph={ random = { kind = \"erdos_renyi\", p = 0.1 } }"}},
        Row{"agents", "{ count = 4, position_m = [[0,0,1],[1,0,2],[2,0,3],[3,0,4]] }", {}, "agents.position_m"},
        Row{"law", "{ name = \"waypoint\", waypoints_m = [[5, 0, 1]] }", {}, "law.name"}, Row{"law.leader", "2"},
        Row{"law.axes", "xyz"}, Row{"law.safety", "{ distance_m = 30.0 }"},
        Row{"law.safety.distance_m", "29.0", {"law.safety.distance_m=30.0"}},
        Row{"law.safety.gamma", "2.0", {"law.safety.distance_m=30.0"}}, Row{"law.p_gain", "0.02"},
        Row{"law.beta", "0.5"}, Row{"law.leader_waypoints_m", "[[5,5,1]]", {"law.leader=1"}}),
    NameOf);

// --- [link] -----------------------------------------------------------------------------------------

const std::string kBursts = "link.gilbert_elliott={ good_to_bad = 0.2, bad_to_good = 0.3 }";

INSTANTIATE_TEST_SUITE_P(
    Link, Key,
    testing::Values(
        Row{"link.loss", "0.3"}, Row{"link.delay_s", "0.05"}, Row{"link.jitter_s", "0.03", {"link.delay_s=0.05"}},
        Row{"link.reordering", "0.3", {"link.delay_s=0.05"}}, Row{"link.symmetric", "true", {"link.loss=0.3"}},
        Row{"link.hold_s", "0.1", {"link.loss=0.3"}},
        Row{"link.gilbert_elliott", "{ good_to_bad = 0.2, bad_to_good = 0.3 }"},
        Row{"link.gilbert_elliott.good_to_bad", "0.4", {kBursts}},
        Row{"link.gilbert_elliott.bad_to_good", "0.6", {kBursts}},
        Row{"link.gilbert_elliott.loss_good", "0.2", {kBursts}}, Row{"link.gilbert_elliott.loss_bad", "0.8", {kBursts}},
        Row{"run.seed", "2", {"link.loss=0.3", "agents={ count = 2, position_m = [[0, 0, 1], [5, 0, 2]] }"}}),
    NameOf);

/// Replaces the link override that delays the edge [1, 2] by another one; `what` names the difference.
Row OtherLinks(const std::string& what, const std::string& value) {
  return {"link.override",
          "[{ " + value + " }]",
          {"link.override=[{ edges = [[1, 2]], delay_s = 0.05 }]"},
          "link.override." + what};
}

INSTANTIATE_TEST_SUITE_P(
    LinkOverride, Key,
    testing::Values(
        Row{"link.override", "[{ edges = [[1, 2]], delay_s = 0.05 }]"},
        OtherLinks("edges turned round", "edges = [[2, 1]], delay_s = 0.05"),
        OtherLinks("edges both ways", "edges = [[1, 2], [2, 1]], delay_s = 0.05"),
        OtherLinks("delay_s", "edges = [[1, 2]], delay_s = 0.06"),
        OtherLinks("loss", "edges = [[1, 2]], delay_s = 0.05, loss = 0.3"),
        OtherLinks("jitter_s", "edges = [[1, 2]], delay_s = 0.05, jitter_s = 0.03"),
        OtherLinks("reordering", "edges = [[1, 2]], delay_s = 0.05, reordering = 0.3"),
        OtherLinks("gilbert_elliott",
                   "edges = [[1, 2]], delay_s = 0.05, gilbert_elliott = { good_to_bad = 0.2, bad_to_good = 0.3 }"),
        Row{"link.override", "[{ edges = [[1, 2]], hold_s = 0.1 }]", {"link.loss=0.3"}, "link.override.hold_s"},
        Row{"link.override", "[{ edges = [[2, 1]], symmetric = true }]", {"link.loss=0.3"}, "link.override.symmetric"}),
    NameOf);

// --- [sensors] --------------------------------------------------------------------------------------

INSTANTIATE_TEST_SUITE_P(Sensors, Key,
                         testing::Values(Row{"sensors.own.position_std_m", "0.1"},
                                         Row{"sensors.own.velocity_std_m_per_s", "0.1"},
                                         Row{"sensors.own.position_bias_std_m", "0.1"},
                                         Row{"sensors.own.velocity_bias_std_m_per_s", "0.1"},
                                         Row{"sensors.range_m",
                                             "5.0",
                                             {"physics.obstacles=" + Block(),
                                              "law={ name = 'custom', python = \"def control(t, me, neighbours): "
                                              "return len(me.ranges), 0\" }"}},
                                         Row{"sensors.own.delay_s", "0.05"}, Row{"sensors.heard.position_std_m", "0.1"},
                                         Row{"sensors.heard.velocity_std_m_per_s", "0.1", {"law.v_gain=0.5"}},
                                         Row{"sensors.heard.position_bias_std_m", "0.1"},
                                         Row{"sensors.heard.velocity_bias_std_m_per_s", "0.1", {"law.v_gain=0.5"}},
                                         Row{"run.seed",
                                             "2",
                                             {"sensors.own.position_std_m=0.1",
                                              "agents={ count = 2, position_m = [[0, 0, 1], [5, 0, 2]] }"}}),
                         NameOf);

// --- [graph] ----------------------------------------------------------------------------------------

/// Replaces the random graph `was` by `is`; `what` names the difference.
Row OtherRandomGraph(const std::string& what, const std::string& was, const std::string& is) {
  return {"graph",
          "{ random = { " + is + " } }",
          {"agents={ count = 8 }", "graph={ random = { " + was + " } }"},
          "graph.random." + what};
}

INSTANTIATE_TEST_SUITE_P(
    RandomGraphs, Key,
    testing::Values(
        OtherRandomGraph("kind to small_world", "kind = 'erdos_renyi', p = 0.4",
                         "kind = 'small_world', k = 2, p = 0.4"),
        OtherRandomGraph("kind to geometric", "kind = 'erdos_renyi', p = 0.4", "kind = 'geometric', radius_m = 8.0"),
        OtherRandomGraph("radius_m", "kind = 'geometric', radius_m = 8.0", "kind = 'geometric', radius_m = 12.0"),
        OtherRandomGraph("k", "kind = 'small_world', k = 2, p = 0.1", "kind = 'small_world', k = 4, p = 0.1"),
        OtherRandomGraph("p", "kind = 'small_world', k = 2, p = 0.0", "kind = 'small_world', k = 2, p = 0.9")),
    NameOf);

const std::string kSwitch = "graph.schedule=[{ at_s = 0.4, topology = 'path' }]";

INSTANTIATE_TEST_SUITE_P(
    Schedule, Key,
    testing::Values(Row{"graph.schedule", "[{ at_s = 0.4, topology = 'path' }]"},
                    Row{"graph.schedule", "[{ at_s = 0.41, topology = 'path' }]", {kSwitch}, "graph.schedule.at_s"},
                    Row{"graph.schedule", "[{ at_s = 0.4, topology = 'star' }]", {kSwitch}, "graph.schedule.topology"},
                    Row{"graph.schedule", "[{ at_s = 0.4, edges = [[1, 2]] }]", {kSwitch}, "graph.schedule.edges"},
                    Row{"graph.schedule",
                        "[{ at_s = 0.4, random = { kind = 'erdos_renyi', p = 0.3 } }]",
                        {kSwitch},
                        "graph.schedule.random"},
                    Row{"graph.schedule",
                        "[{ at_s = 0.4, topology = 'path' }, { at_s = 0.6, topology = 'star' }]",
                        {kSwitch},
                        "graph.schedule of two switches"},
                    Row{"graph.repeat_s", "0.8", {kSwitch}}, Row{"graph.range_m", "8.0"},
                    Row{"graph.range_m", "12.0", {"graph.range_m=8.0"}, "graph.range_m from 8 to 12"}),
    NameOf);

// --- [control] --------------------------------------------------------------------------------------

/// Agents of `model` under a law that wants velocities.
std::vector<std::string> DrivenByVelocity(const std::string& model) {
  return {"agents.model=" + model, "law={ name = 'velocity_consensus' }"};
}

INSTANTIATE_TEST_SUITE_P(
    Control, Key,
    testing::Values(
        Row{"control.max_speed_m_per_s", "0.5", DrivenByVelocity("single_integrator"),
            "control.max_speed_m_per_s of single_integrator with velocity_consensus"},
        Row{"control.max_speed_m_per_s", "0.5", DrivenByVelocity("quadrotor"),
            "control.max_speed_m_per_s of quadrotor with velocity_consensus"},
        Row{"control.max_speed_m_per_s",
            "0.05",
            {"agents.model=single_integrator"},
            "control.max_speed_m_per_s of single_integrator with consensus"},
        Row{"control.velocity_gain", "1.0", DrivenByVelocity("double_integrator")},
        Row{"control.look_ahead_m", "0.2", DrivenByVelocity("unicycle")},
        Row{"control.position", "{ kp = 2.0, kd = 2.0 }"},
        Row{"control.position.kp", "1.0", {"control.position={ kp = 2.0, kd = 2.0 }"}},
        Row{"control.position.kd", "1.0", {"control.position={ kp = 2.0, kd = 2.0 }"}},
        Row{"control.attitude.kp", "60.0", {"control.attitude={ kp = 50.0, kd = 10.0 }"}},
        Row{"control.attitude.kd", "11.0", {"control.attitude={ kp = 50.0, kd = 10.0 }"}},
        Row{"control.altitude.kp",
            "2.0",
            {"control.altitude={ kp = 1.0, kd = 1.0 }", "agents.velocity_m_per_s=[[0,0,1],[0,0,0],[0,0,0],[0,0,0]]"}},
        Row{"control.altitude.kd",
            "2.0",
            {"control.altitude={ kp = 1.0, kd = 1.0 }", "agents.velocity_m_per_s=[[0,0,1],[0,0,0],[0,0,0],[0,0,0]]"}},
        Row{"control.heading.kp", "2.0", {"control.heading={ kp = 1.0, kd = 1.0 }", "control.heading_rad=0.5"}},
        Row{"control.heading.kd", "2.0", {"control.heading={ kp = 1.0, kd = 1.0 }", "control.heading_rad=0.5"}}),
    NameOf);

// --- [[agents.override]] ----------------------------------------------------------------------------

/// Overrides `key` by `value` for agent 2.
Row Override(const std::string& key, const std::string& value, std::vector<std::string> base = {}) {
  return {"agents.override", "[{ id = 2, " + key + " = " + value + " }]", std::move(base), "agents.override." + key};
}

INSTANTIATE_TEST_SUITE_P(
    AgentsOverride, Key,
    testing::Values(Override("start_s", "0.5"),
                    Row{"agents.override",
                        "[{ id = 2, start_s = 0.6 }]",
                        {"agents.override=[{ id = 2, start_s = 0.5 }]"},
                        "agents.override.start_s from 0.5 to 0.6"},
                    Override("stop_s", "0.5"),
                    Row{"agents.override",
                        "[{ id = 2, stop_s = 0.6 }]",
                        {"agents.override=[{ id = 2, stop_s = 0.5 }]"},
                        "agents.override.stop_s from 0.5 to 0.6"},
                    Row{"agents.override",
                        "[{ id = 3, stop_s = 0.5 }]",
                        {"agents.override=[{ id = 2, stop_s = 0.5 }]"},
                        "agents.override.id"},
                    Override("lie", "{ offset_m = [1.0, 0.0, 0.0] }"),
                    Row{"agents.override",
                        "[{ id = 2, lie = { offset_m = [2.0, 0.0, 0.0] } }]",
                        {"agents.override=[{ id = 2, lie = { offset_m = [1.0, 0.0, 0.0] } }]"},
                        "agents.override.lie.offset_m"},
                    Row{"agents.override",
                        "[{ id = 2, lie = { offset_m = [1.0, 0.0, 0.0], from_s = 0.5 } }]",
                        {"agents.override=[{ id = 2, lie = { offset_m = [1.0, 0.0, 0.0] } }]"},
                        "agents.override.lie.from_s"},
                    Row{"agents.override",
                        "[{ id = 2, lie = { offset_m = [1.0, 0.0, 0.0], kind = 'oscillating' } }]",
                        {"agents.override=[{ id = 2, lie = { offset_m = [1.0, 0.0, 0.0] } }]"},
                        "agents.override.lie.kind"},
                    Row{"agents.override",
                        "[{ id = 2, lie = { offset_m = [1.0, 0.0, 0.0], kind = 'oscillating', period_s = 1.0 } }]",
                        {"agents.override=[{ id = 2, lie = { offset_m = [1.0, 0.0, 0.0], kind = 'oscillating' } }]"},
                        "agents.override.lie.period_s"},
                    Override("law.p_gain", "0.1"), Override("law.axes", "'xyz'"), Override("law.leader", "2"),
                    Override("law.safety", "{ distance_m = 30.0 }"),
                    Row{"agents.override",
                        "[{ id = 2, law.safety.distance_m = 29.0 }]",
                        {"agents.override=[{ id = 2, law.safety.distance_m = 30.0 }]"},
                        "agents.override.law.safety.distance_m"},
                    Row{"agents.override",
                        "[{ id = 2, law.safety = { distance_m = 30.0, gamma = 2.0 } }]",
                        {"agents.override=[{ id = 2, law.safety.distance_m = 30.0 }]"},
                        "agents.override.law.safety.gamma"},
                    Override("law.name", "'velocity_consensus'"), Override("control.max_acceleration_m_per_s2", "0.3"),
                    Override("control.tilt_limit_rad", "0.01"), Override("control.inversion", "'exact'"),
                    Override("control.drag_compensation", "false"), Override("control.heading_rad", "0.5"),
                    Override("control.attitude", "{ kp = 50.0, kd = 10.0 }"),
                    Override("control.position", "{ kp = 2.0, kd = 2.0 }"),
                    Override("control.max_speed_m_per_s", "0.5", DrivenByVelocity("single_integrator")),
                    Override("control.velocity_gain", "1.0", DrivenByVelocity("double_integrator")),
                    Override("control.look_ahead_m", "0.2", DrivenByVelocity("unicycle"))),
    NameOf);

std::vector<std::string> TopicsOf(const Flown& run, const std::string& file) {
  std::vector<std::string> topics;
  for (const auto& [id, channel] : ReadMcap(run.up.path() / file).channels) topics.push_back(channel.topic);
  return topics;
}

TEST(Key, RecordFileNamesTheRecording) {
  ScratchFolder folder;
  const Flown run(folder, "run", "leaderless", {"run.duration_s=0.1", "record.file=flight.mcap"});
  EXPECT_TRUE(fs::exists(run.up.path() / "flight.mcap"));
  EXPECT_FALSE(fs::exists(run.up.path() / "run.mcap"));
}

TEST(Key, RecordTopicsChooses) {
  ScratchFolder folder;
  const Flown run(folder, "run", "leaderless",
                  {"run.duration_s=0.1", "record.topics=[\"/agent_[12]/state\", \"/clock\"]"});
  EXPECT_THAT(TopicsOf(run, "run.mcap"), testing::ElementsAre("/agent_1/state", "/agent_2/state", "/clock"));
  EXPECT_EQ(run.up.Summary()["samples"]["topics"], 3);
  EXPECT_TRUE(fs::exists(run.up.path() / "states.npz"));  // not affected by record.topics
}

TEST(Key, OutputSaveDataKeepsOrDropsTheArrays) {
  ScratchFolder folder;
  const Flown run(folder, "run", "leaderless", {"run.duration_s=0.1", "output.save_data=false"});
  EXPECT_FALSE(fs::exists(run.up.path() / "states.npz"));
}

std::vector<std::string> Pictures(const Flown& run) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(run.up.path()))
    if (entry.path().extension() == ".png") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Key, OutputPlotsAreMadeAsAskedFor) {
  ScratchFolder folder;
  const std::vector<std::string> base = {"run.duration_s=0.5", "output.save_plot=true"};
  auto with = [&](const std::string& set) {
    auto sets = base;
    sets.push_back(set);
    return sets;
  };
  const Flown all(folder, "all", "leaderless", base);
  EXPECT_THAT(Pictures(all), testing::IsSupersetOf({"disagreement", "paths", "position", "velocity"}));
  const Flown no_position(folder, "no_position", "leaderless", with("output.position_plot=false"));
  EXPECT_THAT(Pictures(no_position), testing::Not(testing::Contains("position")));
  EXPECT_THAT(Pictures(no_position), testing::Contains("velocity"));
  const Flown no_velocity(folder, "no_velocity", "leaderless", with("output.velocity_plot=false"));
  EXPECT_THAT(Pictures(no_velocity), testing::Not(testing::Contains("velocity")));
  EXPECT_THAT(Pictures(no_velocity), testing::Contains("position"));
  const Flown arrays_for_pictures_only(folder, "only", "leaderless", with("output.save_data=false"));
  EXPECT_THAT(Pictures(arrays_for_pictures_only), testing::Contains("paths"));
  EXPECT_FALSE(fs::exists(arrays_for_pictures_only.up.path() / "states.npz"));
}

TEST(Key, OutputShowPlotWithoutADisplaySaysSoAndDrawsAsWell) {
  ScratchFolder folder;
  const Ran run = Shell("env -u DISPLAY -u WAYLAND_DISPLAY '" MASCOT_BINARY_DIR "/orchestrator' up '" +
                        Config("leaderless") + "' --engine inprocess --duration-s 0.5 --set output.show_plot=true " +
                        "--out '" + folder.File("run") + "'");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, testing::HasSubstr("no display: no window is opened\n"));
  EXPECT_TRUE(fs::exists(folder.File("run/paths.png")));
}

TEST(Key, OutputShowPlotNeedsNeitherPicturesNorArraysAsFiles) {
  ScratchFolder folder;
  const Ran run = Shell("env -u DISPLAY -u WAYLAND_DISPLAY '" MASCOT_BINARY_DIR "/orchestrator' up '" +
                        Config("leaderless") + "' --engine inprocess --duration-s 0.5 --set output.show_plot=true " +
                        "--set output.save_plot=false --set output.save_data=false --out '" + folder.File("run") + "'");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_FALSE(fs::exists(folder.File("run/states.npz")));
}

TEST(Key, OutputFidelityComparesWithIdealIntegratorsOrNot) {
  ScratchFolder folder;
  const Flown with(folder, "with", "leaderless", {"run.duration_s=0.1"});
  EXPECT_TRUE(with.up.Summary()["fidelity"]["rms_m"].is_number());
  const Flown without(folder, "without", "leaderless", {"run.duration_s=0.1", "output.fidelity=false"});
  EXPECT_TRUE(without.up.Summary()["fidelity"]["rms_m"].is_null());
  EXPECT_TRUE(without.up.Summary()["fidelity"]["max_m"].is_null());
  EXPECT_EQ(without.up.Summary()["fidelity"]["travelled_m"], with.up.Summary()["fidelity"]["travelled_m"]);
}

/// Counts of the summary for each edge: {sent, lost, late, bytes} by [hearer, heard].
std::map<std::pair<int, int>, std::vector<std::int64_t>> EdgesOf(const Flown& run) {
  std::map<std::pair<int, int>, std::vector<std::int64_t>> edges;
  const nlohmann::json summary = run.up.Summary();
  for (const auto& edge : summary["links"]["edges"])
    edges[{edge["hearer"], edge["heard"]}] = {edge["sent"], edge["lost"], edge["late"], edge["bytes"]};
  return edges;
}

const std::vector<std::string> kLossyTriangle = {
    "run.duration_s=2.0", "agents={ count = 3, position_m = [[0, 0, 1], [9, 0, 2], [0, 9, 3]] }",
    "graph={ edges = [[1, 2], [2, 3], [3, 1]] }", "link={ loss = 0.3, delay_s = 0.05, jitter_s = 0.05 }"};

TEST(LinkCounts, OfAnEdgeDoNotDependOnOtherAgents) {
  ScratchFolder folder;
  const Flown three(folder, "three", "leaderless", kLossyTriangle);
  auto sets = kLossyTriangle;
  sets[1] = "agents={ count = 4, position_m = [[0, 0, 1], [9, 0, 2], [0, 9, 3], [9, 9, 4]] }";
  sets[2] = "graph={ edges = [[4, 1], [1, 4], [1, 2], [2, 3], [3, 1]] }";
  const Flown four(folder, "four", "leaderless", sets);
  const auto before = EdgesOf(three), after = EdgesOf(four);
  EXPECT_EQ(before.size(), 3u);
  EXPECT_EQ(after.size(), 5u);
  for (const auto& [edge, counts] : before) EXPECT_EQ(after.at(edge), counts) << edge.first << " hears " << edge.second;
}

TEST(LinkCounts, OfAllEdgesAddUp) {
  ScratchFolder folder;
  const Flown run(folder, "run", "leaderless", kLossyTriangle);
  const auto links = run.up.Summary()["links"];
  std::vector<std::int64_t> sums(4, 0);
  for (const auto& [edge, counts] : EdgesOf(run)) {
    EXPECT_EQ(counts[0], 201) << "one a tick, from 0 to 200";
    for (std::size_t k = 0; k < 4; ++k) sums[k] += counts[k];
  }
  EXPECT_EQ(sums, (std::vector<std::int64_t>{links["sent"], links["lost"], links["late"], links["bytes"]}));
  EXPECT_GT(sums[1], 0);
  EXPECT_GT(sums[2], 0);
}

TEST(Key, RunNameNamesTheRunFolder) {
  ScratchFolder folder;
  const Flown run(folder, "run", "leaderless", {"run.duration_s=0.1", "run.name=meeting"});
  EXPECT_EQ(run.up.Summary()["experiment"], "meeting");
}

}  // namespace
}  // namespace mascot::test
