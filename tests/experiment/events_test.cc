// Events: what changes a run while it goes on, from exactly its tick on.
#include "experiment/events.h"

#include <gmock/gmock.h>

#include <map>
#include <random>

#include "agent/laws/laws.h"
#include "experiment/live_experiment.h"
#include "tests/experiment/fly_rows.h"
#include "tests/support/folders.h"
#include "tests/support/param_name.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

constexpr std::int64_t kTick = 50;  // of the events below: 0.5 s

/// The first tick at which `of` gives different values for two runs; -1: none.
template <class Of>
std::int64_t FirstDifference(const std::vector<DecodedRow>& a, const std::vector<DecodedRow>& b, Of of) {
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k)
    for (std::size_t i = 0; i < a[k].motions.size(); ++i)
      if (of(a[k], i) != of(b[k], i)) return static_cast<std::int64_t>(k);
  return -1;
}

Eigen::Vector3d CommandOf(const DecodedRow& row, std::size_t i) { return row.commands[i].a_limited_W; }
Eigen::Vector3d PositionOf(const DecodedRow& row, std::size_t i) { return row.motions[i].p_WB; }

std::string EventTable(const std::string& lines, const std::string& at_s = "0.5") {
  return "[[events]]\nat_s = " + at_s + "\n" + lines + "\n";
}

// --- live keys --------------------------------------------------------------------------------------

/// Three agents with a law, and an event that sets `key`. `command`, `position`: the first tick at which they differ
/// from those of the run without it.
struct LiveKey {
  std::string key, value;
  std::string law = "name = 'consensus'\n";
  std::string more = {};
  std::int64_t command = kTick;
  std::int64_t position = kTick + 1;
  std::string name = key;
};

void PrintTo(const LiveKey& row, std::ostream* out) { *out << row.key << " = " << row.value; }

class LiveKeys : public testing::TestWithParam<LiveKey> {};

TEST_P(LiveKeys, ChangeTheRunFromTheirTickOn) {
  const LiveKey& row = GetParam();
  const std::string base = Three(row.law) + row.more;
  const auto without = Fly(base);
  const auto with = Fly(base + EventTable("set = { \"" + row.key + "\" = " + row.value + " }"));
  EXPECT_EQ(FirstDifference(without, with, CommandOf), row.command);
  EXPECT_EQ(FirstDifference(without, with, PositionOf), row.position);
}

constexpr const char* kLeads = "name = 'consensus'\nleader = 1\nleader_waypoints_m = [[0.1, 0, 1], [5, 5, 2]]\n";
constexpr const char* kFlies = "name = 'waypoint'\nwaypoints_m = [[5, 5, 2]]\n";
constexpr const char* kForms = "name = 'formation'\noffsets_m = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]\n";
constexpr const char* kLossy = "[link]\nloss = 0.9\nhold_s = 1.0\n";
constexpr const char* kBursts = "[link]\ngilbert_elliott = { good_to_bad = 0.0, bad_to_good = 0.5 }\n";

std::string NameOf(const testing::TestParamInfo<LiveKey>& row) { return test::ParamName(row.param.name); }

INSTANTIATE_TEST_SUITE_P(
    OfLaws, LiveKeys,
    testing::Values(LiveKey{"law.p_gain", "2.0"}, LiveKey{"law.v_gain", "2.0"}, LiveKey{"law.beta", "2.0"},
                    LiveKey{.key = "law.p_gain", .value = "2.0", .law = kFlies, .name = "waypoint: p_gain"},
                    LiveKey{.key = "law.d_gain", .value = "2.0", .law = kFlies},
                    LiveKey{.key = "law.waypoints_m", .value = "[[1, 1, 1]]", .law = kFlies},
                    LiveKey{.key = "law.offsets_m", .value = "[[0, 0, 0], [0, 1, 0], [0, 2, 0]]", .law = kForms},
                    LiveKey{.key = "law.leader_p_gain", .value = "2.0", .law = kLeads},
                    LiveKey{.key = "law.leader_d_gain", .value = "2.0", .law = kLeads},
                    LiveKey{.key = "law.leader_waypoints_m", .value = "[[3, 3, 3]]", .law = kLeads},
                    LiveKey{.key = "law.leader_arrival_radius_m",
                            .value = "100.0",
                            .law = std::string(kLeads) + "leader_arrival_radius_m = 0.01\nleader_dwell_s = 0.1\n",
                            .command = kTick + 10,
                            .position = kTick + 11},
                    LiveKey{.key = "law.p_gain",
                            .value = "2.0",
                            .law = "name = 'velocity_consensus'\n",
                            .name = "velocity_consensus: p_gain"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    OfControl, LiveKeys,
    testing::Values(LiveKey{"control.max_acceleration_m_per_s2", "0.01"},
                    LiveKey{
                        .key = "control.max_speed_m_per_s", .value = "0.01", .law = "name = 'velocity_consensus'\n"},
                    LiveKey{.key = "control.velocity_gain", .value = "1.0", .law = "name = 'velocity_consensus'\n"}),
    NameOf);

INSTANTIATE_TEST_SUITE_P(
    OfLinks, LiveKeys,
    testing::Values(LiveKey{"link.loss", "1.0"}, LiveKey{"link.delay_s", "0.05"}, LiveKey{"graph.range_m", "0.5"},
                    LiveKey{.key = "link.hold_s", .value = "0.0", .more = kLossy},
                    LiveKey{.key = "link.gilbert_elliott.loss_good", .value = "1.0", .more = kBursts}),
    NameOf);

// --- what events say --------------------------------------------------------------------------------

/// The file's line of an event behind Three("name = 'consensus'\n").
std::string RefusalOf(const std::string& event, const std::string& law = "name = 'consensus'\n") {
  return Refusal(Three(law) + EventTable(event));
}

TEST(Events, AreRefusedWithTheirPlaceAndTheWordsOfTheFile) {
  EXPECT_EQ(RefusalOf("set = { \"law.p_gain\" = -1.0 }"),
            "folder/test.toml:13:7: law.p_gain: expected a number in [0, 1000], got -1.0");
  EXPECT_EQ(RefusalOf("set = { \"law.p_gain\" = 'fast' }"),
            "folder/test.toml:13:7: law.p_gain: expected a number in [0, 1000], got 'fast'");
  EXPECT_EQ(RefusalOf("set = { \"law.p_gian\" = 1.0 }"),
            "folder/test.toml:13:7: law.p_gian: unknown key (did you mean \"law.p_gain\"?)");
  EXPECT_EQ(RefusalOf("set = { \"law.leader\" = 1 }"),
            "folder/test.toml:13:7: law.leader: expected a live key, got one that no event changes");
  EXPECT_EQ(RefusalOf("set = { \"agents.count\" = 4 }"),
            "folder/test.toml:13:7: agents.count: expected a live key, got one that no event changes");
  EXPECT_EQ(RefusalOf("set = { beta = 1.0 }"), "folder/test.toml:13:7: beta: unknown key (did you mean \"law.beta\"?)");
  EXPECT_EQ(RefusalOf("set = { law = { beta = 1 }, \"law.beta\" = 2 }"),
            "folder/test.toml:13:7: events[0].set: expected each key once, got law.beta twice");
  EXPECT_EQ(RefusalOf("set = {}"),
            "folder/test.toml:13:7: events[0].set: expected live keys and their new values, got none");
}

TEST(Events, ThatSpoilAnotherKeyAreRefusedAtTheirOwnPlace) {
  EXPECT_EQ(Refusal("[run]\nduration_s = 1.0\n[agents]\ncount = 3\nmodel = 'single_integrator'\n"
                    "position_m = [[0, 0, 1], [1, 0, 1], [0, 2, 1]]\n[graph]\ntopology = 'complete'\n[law]\n"
                    "name = 'distance_formation'\noffsets_m = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n" +
                    EventTable("set = { \"law.offsets_m\" = [[0, 0, 0], [1, 0, 0], [2, 0, 0]] }")),
            "folder/test.toml:14:7: law.name: expected a graph and places that are infinitesimally rigid in the plane, "
            "got 3 pairs and a rigidity matrix of rank 2, not 3");
}

TEST(Events, AreOfOneKind) {
  EXPECT_EQ(RefusalOf(""),
            "folder/test.toml:11:1: events[0]: expected one of set, goto, graph, cut, mend, fault, restart, got none");
  EXPECT_EQ(RefusalOf("cut = [[1, 2]]\nmend = [[1, 3]]"),
            "folder/test.toml:11:1: events[0]: expected one of set, goto, graph, cut, mend, fault, restart, got cut "
            "and mend");
  EXPECT_EQ(RefusalOf("cut = [[1, 2]]\nagents = [1]"),
            "folder/test.toml:14:10: events[0].agents: expected only with set, got cut");
}

TEST(Events, NameAgentsAndEdgesThatExist) {
  EXPECT_EQ(RefusalOf("set = { \"law.beta\" = 1 }\nagents = [4]"),
            "folder/test.toml:14:11: events[0].agents[0]: expected an agent in 1..3, got 4");
  EXPECT_EQ(RefusalOf("set = { \"link.loss\" = 1 }\nagents = [1]"),
            "folder/test.toml:13:7: agents: expected none, got some: link.loss is the same for all");
  EXPECT_EQ(RefusalOf("cut = [[2, 1]]"),
            "folder/test.toml:13:7: expected an edge of the graph (i hears j), got [2, 1]");
  EXPECT_EQ(RefusalOf("cut = [[1, 2], [1, 3], [1, 2]]"),
            "folder/test.toml:13:24: events[0].cut[2]: expected each edge once, got [1, 2] again");
  EXPECT_EQ(RefusalOf("cut = []"), "folder/test.toml:13:7: events[0].cut: expected edges [i, j] (i hears j), got none");
  EXPECT_EQ(RefusalOf("mend = [[1, 2], [1, 2, 3]]"),
            "folder/test.toml:13:17: events[0].mend[1]: expected an edge [i, j] (i hears j)");
  EXPECT_EQ(RefusalOf("graph = { edges = [[1, 2.5]] }"),
            "folder/test.toml:13:20: events[0].graph.edges[0]: expected an edge [i, j] (i hears j)");
  EXPECT_EQ(RefusalOf("graph = {}"),
            "folder/test.toml:13:9: events[0].graph.edges: expected edges [i, j] (i hears j), got nothing");
  EXPECT_EQ(RefusalOf("goto = { agent = 2, position_m = [1, 1, 1] }"),
            "folder/test.toml:13:8: goto: expected an agent that flies waypoints, or a leader, got agent 2 of law "
            "'consensus'");
}

TEST(Events, AreAtWholeTicksOfTheRun) {
  const std::string base = Three("name = 'consensus'\n");
  EXPECT_EQ(Refusal(base + EventTable("cut = [[1, 2]]", "0.123")),
            "folder/test.toml:12:8: events[0].at_s: expected a whole number of periods of control.rate_hz (100), got "
            "0.123");
  EXPECT_EQ(Refusal(base + EventTable("cut = [[1, 2]]", "2.0")),
            "folder/test.toml:12:8: events[0].at_s: expected at most run.duration_s, got 2.0");
}

TEST(Events, AreReadInOrderOfTime) {
  const Experiment experiment = Load(Three("name = 'consensus'\n") + EventTable("cut = [[1, 2]]", "0.7") +
                                     EventTable("mend = [[1, 2]]", "0.2") + EventTable("cut = [[1, 3]]", "0.2"));
  std::vector<std::int64_t> ticks;
  for (const auto& event : experiment.events) ticks.push_back(event.tick);
  EXPECT_THAT(ticks, ElementsAre(20, 20, 70));
  EXPECT_EQ(experiment.events[0].Toml(), "mend = [[1, 2]]\n");
}

TEST(Events, AreInTheResolvedFileAndReadBackAsTheSame) {
  const Experiment experiment = Load(
      Three("name = 'consensus'\nleader = 1\n") + EventTable("set = { law = { p_gain = 2 }, \"link.loss\" = 0.5 }") +
      EventTable("set = { \"law.beta\" = 2 }\nagents = [3, 2]") +
      EventTable("goto = { agent = 1, position_m = [1, 2, 3] }") + EventTable("graph = { edges = [[1, 2]] }"));
  const Experiment again = Load(experiment.resolved);
  EXPECT_EQ(again.resolved, experiment.resolved);
  std::string events, events_again;
  for (const auto& event : experiment.events) events += event.Toml();
  for (const auto& event : again.events) events_again += event.Toml();
  EXPECT_EQ(events,
            "set = { \"law.p_gain\" = 2, \"link.loss\" = 0.5 }\n"
            "set = { \"law.beta\" = 2 }\nagents = [2, 3]\n"
            "goto = { agent = 1, position_m = [1.0, 2.0, 3.0] }\n"
            "graph = { edges = [[1, 2]] }\n");
  EXPECT_EQ(events_again, events);
}

// --- what events do ---------------------------------------------------------------------------------

TEST(Events, ConcernThoseWhomTheyName) {
  const std::string base = Three("name = 'consensus'\n");
  const auto without = Fly(base), with = Fly(base + EventTable("set = { \"law.beta\" = 5.0 }\nagents = [1]"));
  const auto one = [](const DecodedRow& row, std::size_t i) {
    return i == 0 ? Eigen::Vector3d::Zero().eval() : CommandOf(row, i);
  };
  EXPECT_EQ(FirstDifference(without, with, CommandOf), kTick);
  EXPECT_EQ(FirstDifference(without, with, one), -1) << "2 and 3 hear nobody";
}

TEST(Events, ReachAgentsWithALawOfTheirOwn) {
  const std::string base =
      Three("name = 'consensus'\nbeta = 1.0\n", "[[agents.override]]\nid = 1\nlaw = { beta = 2.0 }\n");
  const Experiment experiment = Load(base + EventTable("set = { \"law.beta\" = 3.0 }"));
  LiveExperiment live(experiment, &LawTable(), false);
  const auto now = live.After(experiment.events.front());
  for (int id = 1; id <= 3; ++id) EXPECT_EQ(LinearFormOf(now->agent(id).law)->beta, 3.0) << id;
}

TEST(Events, ForAllReachAgentsToWhichAnEarlierOneGaveAValueOfTheirOwn) {
  const Experiment experiment = Load(Three("name = 'consensus'\n"));
  LiveExperiment live(experiment, &LawTable(), false);
  const auto take = [&](const std::string& toml) { return live.After(EventFrom(3, toml, 3, "event by hand")); };
  const auto betas = [](const Experiment& now) {
    std::vector<double> each;
    for (const AgentConfig& agent : now.agents) each.push_back(LinearFormOf(agent.law)->beta);
    return each;
  };
  EXPECT_THAT(betas(*take("set = { \"law.beta\" = 2.0 }\nagents = [2]")), ElementsAre(1, 2, 1));
  EXPECT_THAT(betas(*take("set = { \"law.beta\" = 3.0 }")), ElementsAre(3, 3, 3));
  EXPECT_THAT(betas(*take("set = { \"law.beta\" = 4.0 }\nagents = [3, 2]")), ElementsAre(3, 4, 4));
  EXPECT_THAT(betas(*take("set = { \"law.beta\" = 5.0 }")), ElementsAre(5, 5, 5));
  EXPECT_THAT(betas(*take("set = { \"law.p_gain\" = 5.0 }")), ElementsAre(5, 5, 5)) << "another key changes nothing";
  const auto limit = [](const Experiment& now, int id) { return now.agent(id).control.max_speed_m_per_s; };
  take("set = { \"control.max_speed_m_per_s\" = 2.0 }\nagents = [2]");
  const auto now = take("set = { \"control.max_speed_m_per_s\" = 3.0 }");
  for (int id = 1; id <= 3; ++id) EXPECT_EQ(limit(*now, id), 3.0) << id;
}

TEST(Events, ForAllChangeTheParamsOfAgentsWithTheirOwn) {
  const std::string law =
      "name = 'custom'\nparams = { gain = 1.0 }\npython = '''\n"
      "def start(me, params):\n    me.gain = params['gain']\n"
      "def set(me, params):\n    me.gain = params['gain']\n"
      "def control(t, me, neighbours):\n    return [me.gain, 0, 0]\n'''\n";
  const auto rows = Fly(Three(law) + EventTable("set = { \"law.params.gain\" = 0.25 }\nagents = [2]", "0.3") +
                        EventTable("set = { \"law.params.gain\" = 0.5 }"));
  EXPECT_EQ(rows[49].commands[0].a_law_W.x(), 1.0);
  EXPECT_EQ(rows[49].commands[1].a_law_W.x(), 0.25);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(rows[50].commands[i].a_law_W.x(), 0.5) << i;
}

/// What two agents want, [x, y], at each tenth of a second: params x and y as they are then; table.inner, or table,
/// goes before x.
std::vector<std::vector<std::pair<double, double>>> ParamsOf(const std::string& own, const std::string& events) {
  const std::string law =
      "name = 'custom'\nparams = { x = 1.0, y = 1.0 }\npython = '''\n"
      "def start(me, params):\n    me.params = params\n"
      "def set(me, params):\n    me.params = params\n"
      "def control(t, me, neighbours):\n    x = me.params.get('table', me.params.get('x', 0))\n"
      "    return [x['inner'] if isinstance(x, dict) else x, me.params.get('y', 0), 0]\n'''\n";
  std::vector<std::vector<std::pair<double, double>>> params;
  const auto rows = Fly(Three(law, own) + events);
  for (std::size_t k = 0; k < 60; k += 10) {
    params.emplace_back();
    for (std::size_t i = 0; i < 2; ++i) {
      const Eigen::Vector3d& a_W = rows[k].commands[i].a_law_W;
      params.back().emplace_back(a_W.x(), a_W.y());
    }
  }
  return params;
}

constexpr const char* kOneParamOfAgent2 = "set = { \"law.params.x\" = 0.25 }\nagents = [2]";
constexpr const char* kNoParamsOfAgent2 = "set = { \"law.params\" = {} }\nagents = [2]";

TEST(Events, ForOneParamOfAnAgentLeaveItTheOthers) {
  const auto params = ParamsOf("", EventTable(kOneParamOfAgent2, "0.1"));
  EXPECT_THAT(params[0], ElementsAre(Pair(1, 1), Pair(1, 1)));
  EXPECT_THAT(params[1], ElementsAre(Pair(1, 1), Pair(0.25, 1)));
}

TEST(Events, ForAllThatSetATableReachAgentsWithOneParamOfTheirOwn) {
  const auto params =
      ParamsOf("", EventTable(kOneParamOfAgent2, "0.1") + EventTable("set = { \"law.params\" = { y = 0.5 } }", "0.2") +
                       EventTable("set = { \"law.params\" = { x = 0.5 } }", "0.3") +
                       EventTable(kOneParamOfAgent2, "0.4") + EventTable("set = { \"law.params\" = {} }", "0.5"));
  EXPECT_THAT(params[2], ElementsAre(Pair(1, 0.5), Pair(0.25, 0.5))) << "a table stands for the keys in it";
  EXPECT_THAT(params[3], ElementsAre(Pair(0.5, 0.5), Pair(0.5, 0.5)));
  EXPECT_THAT(params[4], ElementsAre(Pair(0.5, 0.5), Pair(0.25, 0.5)));
  EXPECT_THAT(params[5], ElementsAre(Pair(0, 0), Pair(0, 0)));
}

TEST(Events, ForAllThatSetOneParamReachAgentsWithATableOfTheirOwn) {
  const auto params =
      ParamsOf("", EventTable(kNoParamsOfAgent2, "0.1") + EventTable("set = { \"law.params.y\" = 0.5 }", "0.2") +
                       EventTable("set = { \"law.params.x\" = 0.75 }", "0.3") + EventTable(kNoParamsOfAgent2, "0.4") +
                       EventTable("set = { \"law.params\" = { x = 2.0 } }", "0.5"));
  EXPECT_THAT(params[1], ElementsAre(Pair(1, 1), Pair(0, 0)));
  EXPECT_THAT(params[2], ElementsAre(Pair(1, 0.5), Pair(0, 0.5)));
  EXPECT_THAT(params[3], ElementsAre(Pair(0.75, 0.5), Pair(0.75, 0.5)));
  EXPECT_THAT(params[4], ElementsAre(Pair(0.75, 0.5), Pair(0, 0)));
  EXPECT_THAT(params[5], ElementsAre(Pair(2, 0.5), Pair(2, 0)));
}

TEST(Events, ForAllThatSetAParamReachAgentsWithATableInItsPlace) {
  const auto params = ParamsOf("", EventTable("set = { \"law.params.table.inner\" = 7.0 }", "0.05") +
                                       EventTable("set = { \"law.params.table.inner\" = 8.0 }\nagents = [2]", "0.1") +
                                       EventTable("set = { \"law.params.table\" = 0.5 }", "0.2"));
  EXPECT_THAT(params[1], ElementsAre(Pair(7, 1), Pair(8, 1)));
  EXPECT_THAT(params[2], ElementsAre(Pair(0.5, 1), Pair(0.5, 1)));
}

TEST(Events, ForAllReachWhatTheTableOfAnAgentInTheFileHas) {
  const auto params = ParamsOf(
      "[[agents.override]]\nid = 2\nlaw = { params = { x = 2.0 } }\n",
      EventTable("set = { \"law.params.y\" = 0.5 }", "0.1") + EventTable("set = { \"law.params.x\" = 0.75 }", "0.2") +
          EventTable(kOneParamOfAgent2, "0.3") + EventTable("set = { \"law.params.y\" = 0.25 }", "0.4") +
          EventTable("set = { \"law.params\" = {} }", "0.5"));
  EXPECT_THAT(params[0], ElementsAre(Pair(1, 1), Pair(2, 0)));
  EXPECT_THAT(params[1], ElementsAre(Pair(1, 0.5), Pair(2, 0))) << "its table has no y";
  EXPECT_THAT(params[2], ElementsAre(Pair(0.75, 0.5), Pair(0.75, 0)));
  EXPECT_THAT(params[3], ElementsAre(Pair(0.75, 0.5), Pair(0.25, 0)));
  EXPECT_THAT(params[4], ElementsAre(Pair(0.75, 0.25), Pair(0.25, 0)));
  EXPECT_THAT(params[5], ElementsAre(Pair(0, 0), Pair(0, 0)));
}

TEST(Events, ForAllTakeTheWaypointsOfAnAgentThatAnEventSentElsewhere) {
  const auto rows = Fly(Three(kFlies) + EventTable("goto = { agent = 2, position_m = [9, 9, 9] }", "0.3") +
                        EventTable("set = { \"law.waypoints_m\" = [[1, 0, 2]] }"));
  EXPECT_GT(rows[49].commands[1].a_law_W.x(), 0);
  EXPECT_LE(rows[50].commands[1].a_law_W.x(), 0) << "it is beyond [1, 0, 2] and flies on";
}

TEST(Events, ThatAreRefusedChangeNothing) {
  const Experiment experiment = Load(Three("name = 'consensus'\n"));
  LiveExperiment live(experiment, &LawTable(), false);
  const auto refused = EventFrom(3, "set = { \"law.beta\" = -3.0 }\nagents = [1]", 3, "event by hand");
  try {
    live.Take(refused);
    ADD_FAILURE() << "was taken";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "event by hand: agents.override[0].law.beta: expected a number in [0, 1000], got -3.0");
  }
  EXPECT_EQ(live.now(), nullptr);
  const auto now = live.After(EventFrom(3, "set = { \"law.beta\" = 3.0 }\nagents = [2]", 3, "event by hand"));
  EXPECT_EQ(LinearFormOf(now->agent(1).law)->beta, 1.0);
  EXPECT_EQ(LinearFormOf(now->agent(2).law)->beta, 3.0);
}

/// Values of live keys: at 0 those that are the same for all, else of an agent, by id.
using Values = std::map<int, std::map<std::string, double>>;

constexpr const char* kOfAll[] = {"run.pace",        "physics.wind.gust_std_m_per_s",
                                  "graph.range_m",   "physics.wind.gust_time_s",
                                  "link.loss",       "link.delay_s",
                                  "link.reordering", "link.hold_s"};
constexpr const char* kOfAgents[] = {"law.p_gain",
                                     "law.v_gain",
                                     "law.beta",
                                     "law.safety.distance_m",
                                     "law.safety.gamma",
                                     "control.max_acceleration_m_per_s2",
                                     "control.max_speed_m_per_s",
                                     "control.velocity_gain"};

std::string Lines(const std::map<std::string, double>& values) {
  std::string text;
  for (const auto& [key, value] : values) text += key + " = " + ShortestFloat(value) + "\n";
  return text;
}

/// An experiment in which each agent has all its keys itself.
std::string FileWith(const Values& values) {
  std::string text =
      "run.duration_s = 1.0\nlaw.name = 'consensus'\ngraph.edges = [[1, 2, 0.5], [1, 3]]\nagents.count = 3\n"
      "agents.model = 'double_integrator'\nagents.position_m = [[0, 0, 1], [1, 0, 2], [0, 2, 3]]\n" +
      Lines(values.at(0)) + "[[link.override]]\nedges = [[1, 3]]\nsymmetric = true\n";
  for (int id = 1; id <= 3; ++id)
    text += "[[agents.override]]\nid = " + std::to_string(id) + "\n" + Lines(values.at(id));
  return text;
}

/// What events can change in an experiment, and some of what they cannot.
std::string LiveText(const Experiment& now) {
  std::string text;
  const auto add = [&](auto... numbers) { ((text += ShortestFloat(numbers) + " "), ...); };
  add(now.run.pace.value_or(-1), now.physics.wind.gust_std_m_per_s, now.physics.wind.gust_time_s,
      now.schedule.range_m());
  const LinkConfig& link = now.links.Of(1, 2);
  add(link.loss, link.delay_s, link.jitter_s, link.reordering, link.hold_s, now.links.Of(1, 3).symmetric ? 1.0 : 0.0);
  for (const AgentConfig& agent : now.agents) {
    const LinearForm law = *LinearFormOf(agent.law);
    add(law.p, law.g, law.beta, agent.law.safety->distance_m, agent.law.safety->gamma,
        agent.control.max_acceleration_m_per_s2, agent.control.max_speed_m_per_s, agent.control.velocity_gain,
        agent.airframe.tilt_limit_rad, agent.airframe.altitude.kp);
  }
  return text + "\n";
}

TEST(Events, InAnyOrderMakeTheExperimentOfTheFileThatHasTheirValues) {
  std::mt19937 random(7);
  const auto drawn = [&](std::size_t most) { return random() % most; };
  Values values;
  for (const char* key : kOfAll) values[0][key] = 0.5;
  for (int id = 1; id <= 3; ++id)
    for (const char* key : kOfAgents) values[id][key] = 0.5;
  // At the start the team has the values of agents, and one agent has two of them itself.
  const std::string file = FileWith(values);
  const Experiment experiment = Load(Lines(values[1]) + file.substr(0, file.find("[[agents.override]]")) +
                                     "[[agents.override]]\nid = 3\nlaw.beta = 0.5\ncontrol.velocity_gain = 0.5\n");
  LiveExperiment live(experiment, &LawTable(), /*checked=*/false);
  for (int k = 0; k < 300; ++k) {
    Event event{.tick = k / 10, .where = "test"};
    const double value = 0.01 * static_cast<double>(1 + drawn(99));
    const bool of_agents = drawn(3) > 0;
    const std::string key = of_agents ? kOfAgents[drawn(std::size(kOfAgents))] : kOfAll[drawn(std::size(kOfAll))];
    event.set[key] = Value{value};
    if (of_agents && drawn(2) > 0) event.agents = drawn(2) > 0 ? std::vector{2} : std::vector{1, 3};
    if (!of_agents) values[0][key] = value;
    for (int id = 1; of_agents && id <= 3; ++id)
      if (event.agents.empty() || std::ranges::find(event.agents, id) != event.agents.end()) values[id][key] = value;
    live.Take(event);
    if (k % 10 != 0) continue;
    ASSERT_EQ(LiveText(*live.now()), LiveText(Load(FileWith(values)))) << k << ": " << event.Toml();
  }
}

TEST(Events, ThatAreRefusedLeaveEveryTableAsItWas) {
  const Experiment experiment =
      Load(Three("name = 'custom'\nparams = { x = 1.0 }\npython = '''\n"
                 "def set(me, params):\n    pass\ndef control(t, me, neighbours):\n    return [0, 0, 0]\n'''\n"));
  LiveExperiment live(experiment, &LawTable(), /*checked=*/true);
  const auto refusal = [&](const std::string& toml) -> std::string {
    try {
      live.Take(EventFrom(3, toml, 3, "event by hand"));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(refusal("set = { \"law.params.x.y\" = 1.0 }"),
            "event by hand: law.params.x: expected a table to set y in, got 1.0");
  EXPECT_EQ(refusal("set = { \"law.params.z.y[3]\" = 1.0 }"),
            "event by hand: law.params.z.y: expected a place in a list of 0, got [3]");
  EXPECT_EQ(
      refusal("set = { \"law.params.a b\" = 1.0 }"),
      "event by hand: expected a dotted key such as law.p_gain or agents.override[0].start_s, got 'law.params.a b'");
  EXPECT_EQ(refusal("set = { \"law.params.new\" = 1.0, \"link.loss\" = 2.0 }"),
            "event by hand: link.loss: expected a number in [0, 1], got 2.0");
  EXPECT_EQ(refusal("set = { \"law.params.x\" = 5.0, \"control.velocity_gain\" = -1 }\nagents = [2, 3]"),
            "event by hand: agents.override[0].control.velocity_gain: expected a number in (0, 1000], got -1\n"
            "event by hand: agents.override[1].control.velocity_gain: expected a number in (0, 1000], got -1");
  EXPECT_EQ(live.count(), 0);
  EXPECT_EQ(ToToml(*live.ValueOf("law.params")), "{ \"x\" = 1.0 }");
  EXPECT_EQ(live.ValueOf("agents.override[0]"), std::nullopt);
  live.Take(EventFrom(3, "set = { \"law.params.y\" = 2.0 }\nagents = [3]", 3, "event by hand"));
  EXPECT_EQ(ToToml(*live.ValueOf("agents.override")),
            "[{ \"id\" = 3, \"law\" = { \"params\" = { \"x\" = 1.0, \"y\" = 2.0 } } }]");
}

TEST(Events, CutAndMendEdges) {
  const std::string base = Three("name = 'consensus'\n");
  const auto all = Fly(base),
             cut = Fly(base + EventTable("cut = [[1, 2], [1, 3]]") + EventTable("mend = [[1, 2]]", "0.7"));
  EXPECT_EQ(FirstDifference(all, cut, CommandOf), kTick);
  for (std::size_t k = 50; k < 70; ++k)
    EXPECT_EQ(cut[k].commands[0].a_law_W.head<2>(), -cut[k].motions[0].v_WB.head<2>()) << "nobody is heard at " << k;
  EXPECT_GT(cut[70].commands[0].a_law_W.x(), 0.1) << "2 is at x = 1, and is heard again";
  const auto graph =
      Fly(base + EventTable("graph = { edges = [] }") + EventTable("graph = { edges = [[1, 2]] }", "0.7"));
  EXPECT_EQ(FirstDifference(cut, graph, PositionOf), -1);
}

TEST(Events, SendALeaderAndThoseWhoFlyWaypointsElsewhere) {
  for (const std::string& law : {std::string("name = 'consensus'\nleader = 1\n"), std::string(kLeads),
                                 std::string(kLeads) + "leader_times_s = [0.1, 0.2]\n", std::string(kFlies),
                                 std::string("name = 'minmax'\nleader = 1\nbeta = [0.5, 1, 1]\n")}) {
    const std::string graph = law.find("minmax") != law.npos ? "[[2, 1], [3, 1]]" : "[[1, 2, 0.5], [1, 3]]";
    std::string base =
        "[run]\nduration_s = 12.0\n[agents]\ncount = 3\nmodel = 'double_integrator'\n"
        "position_m = [[0, 0, 1], [1, 0, 2], [0, 2, 3]]\n[graph]\nedges = " +
        graph + "\n[law]\n" + law;
    const auto rows = Fly(base + EventTable("goto = { agent = 1, position_m = [2, 1, 1] }"));
    EXPECT_LT((rows.back().motions[0].p_WB.head<2>() - Eigen::Vector2d(2, 1)).norm(), 0.05) << law;
  }
}

TEST(Events, OfTheWindMoveQuadrotorsFromTheNextTickOn) {
  const std::string base = "[run]\nduration_s = 1.0\n[agents]\ncount = 1\nposition_m = [[0, 0, 5]]\n";
  const auto without = Fly(base);
  for (const char* set : {"physics.wind.mean_m_per_s\" = [5, 0, 0]", "physics.wind.gust_std_m_per_s\" = 5.0"}) {
    const auto with = Fly(base + EventTable("set = { \"" + std::string(set) + " }"));
    EXPECT_EQ(FirstDifference(without, with, PositionOf), kTick + 1) << set;
  }
}

TEST(Events, TellPythonLawsTheirNewParams) {
  const std::string law =
      "name = 'custom'\nparams = { gain = 1.0 }\npython = '''\n"
      "def start(me, params):\n    me.gain = params['gain']\n"
      "def set(me, params):\n    me.gain = -params['gain']\n"
      "def control(t, me, neighbours):\n    return [me.gain, 0, 0]\n'''\n";
  const auto rows = Fly(Three(law) + EventTable("set = { \"law.params.gain\" = 0.25 }"));
  EXPECT_EQ(rows[49].commands[0].a_law_W.x(), 1.0);
  EXPECT_EQ(rows[50].commands[0].a_law_W.x(), -0.25);
  const std::string without =
      "name = 'custom'\npython = '''\ndef control(t, me, neighbours):\n    return [0, 0, 0]\n'''\n";
  EXPECT_THAT(Refusal(Three(without) + EventTable("set = { \"law.params.gain\" = 0.25 }")),
              HasSubstr("law.params: expected a law that defines set(me, params), got none"));
}

TEST(Events, TellPluginsTheirNewParams) {
  const auto library = [](const std::string& name) {
    return "name = 'plugin'\nlibrary = '" + test::BuildFolder() + "/tests/plugins/lib" + name + ".so'\n";
  };
  const auto without = Fly(Three(library("mirror"))),
             with = Fly(Three(library("mirror")) + EventTable("set = { \"law.params.gain\" = 2.0 }"));
  EXPECT_EQ(FirstDifference(without, with, CommandOf), kTick);
  EXPECT_DOUBLE_EQ(with[50].commands[0].a_law_W.x() + with[50].motions[0].v_WB.x(),
                   2 * (without[50].commands[0].a_law_W.x() + without[50].motions[0].v_WB.x()));
  EXPECT_THAT(Refusal(Three(library("talker")) + EventTable("set = { \"law.params\" = {} }")),
              HasSubstr("law.params: expected a law with Set(PluginParams&), got none"));
}

}  // namespace
}  // namespace mascot
