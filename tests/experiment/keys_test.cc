// Every key of an experiment file has an effect: changing it changes a result. output_keys_test.cc tests the keys of
// what a run leaves behind, engines_test.cc and faults_test.cc those for DDS and real time, laws_test.cc also the
// parameters of laws.

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <map>

#include "agent/laws/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/recording/state_arrays.h"
#include "orchestrator/team/row_sink.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

/// What states.npz holds of a run.
using Arrays = std::array<std::vector<double>, kStateArrays.size()>;

/// Keeps the states of a run.
class States final : public RowSink {
 public:
  explicit States(const Experiment& experiment) : experiment_(experiment), row_(experiment.size()) {}
  void Add(const FlownRow& row) override {
    row_.Set(experiment_.time_s(row.tick()), row.decoded());
    for (std::size_t k = 0; k < arrays.size(); ++k)
      arrays[k].insert(arrays[k].end(), row_.Values(k).begin(), row_.Values(k).end());
  }
  /// Whether the newest row is that of `others` at the same tick.
  bool FitsSoFar(const Arrays& others) const {
    for (std::size_t k = 0; k < arrays.size(); ++k) {
      const std::size_t end = arrays[k].size(), begin = end - std::min(end, row_.Values(k).size());
      if (end > others[k].size()) return false;
      if (!std::equal(arrays[k].begin() + begin, arrays[k].end(), others[k].begin() + begin)) return false;
    }
    return true;
  }
  Arrays arrays;

 private:
  const Experiment& experiment_;
  StateRow row_;
};

/// The states of a run of configs/leaderless.toml with `sets` (KEY=VALUE). With `others`: until they differ from those.
Arrays Fly(const std::vector<std::string>& sets, const Arrays* others = nullptr) {
  std::vector<Override> overrides;
  for (const std::string& set : sets)
    overrides.push_back({.key = set.substr(0, set.find('=')), .value = set.substr(set.find('=') + 1)});
  const std::string file = std::string(MASCOT_SOURCE_DIR) + "/configs/leaderless.toml";
  const Experiment experiment = LoadExperiment(Section::FromFile(file, overrides), "leaderless");
  States states(experiment);
  const auto go_on = [&] { return others == nullptr || states.FitsSoFar(*others); };
  EXPECT_EQ(RunInProcess(experiment, {&states}, go_on).failure, "");
  return states.arrays;
}

/// As Fly(sets), which it flies once for all tests of a process.
const Arrays& Flown(const std::vector<std::string>& sets) {
  static std::map<std::vector<std::string>, Arrays> flown;
  const auto found = flown.find(sets);
  return found != flown.end() ? found->second : flown.emplace(sets, Fly(sets)).first->second;
}

/// A test that setting `key` to `value`, in addition to `base`, changes the states. `name` is the name of the test: the
/// key that is changed and, if several tests change it, how or for which agents.
struct Row {
  std::string key, value;
  std::vector<std::string> base = {};
  std::string name = key;
};

void PrintTo(const Row& row, std::ostream* out) {
  *out << row.key << "=" << row.value;
  for (const std::string& set : row.base) *out << (&set == &row.base.front() ? " on top of " : ", ") << set;
}

class Key : public testing::TestWithParam<Row> {};

TEST_P(Key, ChangesTheStates) {
  const Row& row = GetParam();
  std::vector<std::string> base = row.base;
  if (row.key != "run.duration_s") base.insert(base.begin(), "run.duration_s=1.0");
  auto changed = base;
  changed.push_back(row.key + "=" + row.value);
  const Arrays& states = Flown(base);
  EXPECT_FALSE(Fly(changed, &states) == states);
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

}  // namespace
}  // namespace mascot::test
