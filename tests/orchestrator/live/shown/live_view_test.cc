// A run as its viewers see it: flown in this process, watched by our own test clients and by Foxglove's packages.

#include "orchestrator/live/shown/live_view.h"

#include <gmock/gmock.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "agent/laws/laws.h"
#include "bus/wire.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/live/shown/ros_view.h"
#include "orchestrator/live/shown/view_sink.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/recording/run_writer.h"
#include "tests/orchestrator/live/shown/viewer.h"
#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using Json = nlohmann::json;

constexpr const char* kThree = R"(
[run]
name = "three"
duration_s = 3.0
[agents]
count = 3
position_m = [[0, 0, 1], [4, 0, 1], [0, 4, 2]]
model = "double_integrator"
[physics]
obstacles = [{ shape = "box", position_m = [9, 9, 1], size_m = [1, 2, 3] }]
[graph]
edges = [[1, 2], [2, 3], [3, 1]]
[law]
name = "consensus"
leader = 1
leader_waypoints_m = [[1, 1, 1]]
)";

Experiment Load(const std::string& toml, const std::string& key = "", const std::string& value = "") {
  std::vector<Override> more;
  if (!key.empty()) more.push_back({key, value});
  return LoadExperiment(Section::FromText(toml, "test.toml", more), "test");
}

/// Grants everything but stop.
class Control final : public RunControl {
 public:
  Answer Ask(const Request& request) override {
    const std::lock_guard lock(mutex_);
    requests_.push_back(request);
    if (breaks) throw std::runtime_error("made up");
    return {request.kind != Request::Kind::kStop, "asked"};
  }
  std::vector<Request> requests() {
    const std::lock_guard lock(mutex_);
    return requests_;
  }
  std::atomic<bool> breaks = false;

 private:
  std::mutex mutex_;
  std::vector<Request> requests_;
};

/// A run in this process, which goes on tick by tick as the test says.
class Watched {
 public:
  explicit Watched(Experiment flown, std::vector<RowSink*> more = {})
      : experiment(std::move(flown)),
        prediction_(Predict(experiment)),
        meter_(experiment),
        view(experiment, prediction_, meter_, control,
             {.port = 0, .page = SourceFolder() + "/orchestrator/live/page", .source = {.engine = "inprocess"}},
             [this](const std::string& line) {
               const std::lock_guard lock(mutex_);
               log_ += line + "\n";
             }),
        sinks_(std::move(more)) {
    sinks_.insert(sinks_.begin(), {&meter_, &view});
  }

  /// Flies; calls `before_tick` before each tick, which may wait.
  EngineResult Fly(const std::function<void(std::int64_t)>& before_tick = {}) {
    std::int64_t tick = 0;
    EngineResult result = RunInProcess(experiment, sinks_, [&] {
      if (before_tick) before_tick(tick++);
      return !over;
    });
    view.SetState({.phase = result.failure.empty() ? RunState::Phase::kDone : RunState::Phase::kFailed, .contacts = 0});
    return result;
  }

  void AddSink(RowSink& sink) { sinks_.push_back(&sink); }
  std::string log() {
    const std::lock_guard lock(mutex_);
    return log_;
  }

  const Experiment experiment;
  Control control;
  bool over = false;  // the run ends before the next tick

 private:
  Prediction prediction_;
  RunMeter meter_;
  std::mutex mutex_;
  std::string log_;

 public:
  LiveView view;

 private:
  std::vector<RowSink*> sinks_;
};

TEST(LiveView, DescribesTheExperiment) {
  Watched run(Load(kThree));
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/experiment");
  const Json experiment = viewer.NextJsonOf("/ui/experiment");
  EXPECT_EQ(experiment["name"], "three");
  EXPECT_EQ(experiment["source"], "run");
  EXPECT_EQ(experiment["ticks"], 300);
  EXPECT_EQ(experiment["axes"], "xy");
  EXPECT_EQ(experiment["edges"], Json::parse("[[1,2,1.0],[2,3,1.0],[3,1,1.0]]"));
  EXPECT_EQ(experiment["obstacles"][0]["kind"], "box");
  const Json& leader = experiment["agents"][0];
  EXPECT_EQ(leader["leads"], true);
  EXPECT_EQ(leader["rolls"], false);
  EXPECT_EQ(leader["goto"], true);
  EXPECT_EQ(leader["waypoints_m"], Json::parse("[[1.0,1.0,1.0]]"));
  EXPECT_EQ(experiment["agents"][1]["goto"], false);
  EXPECT_EQ(experiment["agents"][1]["waypoints_m"], Json::array());
  const Json& prediction = experiment["prediction"];
  EXPECT_EQ(prediction["stable"], true);
  EXPECT_EQ(prediction["rate_per_s"], nullptr) << "the leader flies, so that no start is flown ahead";
  EXPECT_GT(prediction["slowest_rate_per_s"], 0);
}

TEST(LiveView, SaysWhichBodiesRoll) {
  Watched run(Load(kThree, "agents.model", "\"unicycle\""));
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/experiment");
  const Json agent = viewer.NextJsonOf("/ui/experiment")["agents"][0];
  EXPECT_EQ(agent["model"], "unicycle");
  EXPECT_EQ(agent["rolls"], true);
  EXPECT_EQ(agent["actuator"], "forward speed (m/s), turning speed (rad/s), unused, unused");
}

/// What a viewer is told of an experiment of six ideal agents under this law, of which 6 lies from 1 s on.
Json DescribedWith(const std::string& law) {
  Watched run(
      Load("[run]\nduration_s = 0.1\n[agents]\ncount = 6\nmodel = 'single_integrator'\n"
           "position_m = [[0, 0, 1], [4, 0, 1], [0, 4, 2], [1, 1, 1], [2, 1, 1], [1, 2, 1]]\n"
           "[[agents.override]]\nid = 6\nlie = { from_s = 1.0, offset_m = [9.0, 0.0, 0.0] }\n"
           "[graph]\ntopology = 'complete'\n[law]\n" +
           law));
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/experiment");
  return viewer.NextJsonOf("/ui/experiment");
}

std::vector<int> Leading(const Json& experiment) {
  std::vector<int> ids;
  for (const Json& agent : experiment["agents"])
    if (agent["leads"]) ids.push_back(agent["id"]);
  return ids;
}

TEST(LiveView, TellsWhatIsDrawnOfALaw) {
  const Json none = Json::array();
  const Json covering = DescribedWith("name = 'coverage'\nregion_m = [[0, 0], [5, 0], [5, 5], [0, 5]]\n");
  EXPECT_EQ(covering["cells"],
            Json::parse(R"([{"region_m":[[0.0,0.0],[5.0,0.0],[5.0,5.0],[0.0,5.0]],"agents":[1,2,3,4,5,6]}])"));
  EXPECT_EQ(covering["hulls"], none);
  EXPECT_EQ(covering["leaves_out"], false);
  EXPECT_THAT(Leading(covering), testing::IsEmpty());

  const Json contained = DescribedWith("name = 'containment'\nleaders = [1, 2, 3]\n");
  EXPECT_EQ(contained["cells"], none);
  EXPECT_EQ(contained["hulls"], Json::parse(R"([{"agents":[1,2,3],"axes":"xy"}])"));
  EXPECT_THAT(Leading(contained), ElementsAre(1, 2, 3));
  EXPECT_EQ(contained["agents"][0]["goto"], false) << "its leaders fly no waypoints";

  const Json resilient = DescribedWith("name = 'resilient'\n");
  EXPECT_EQ(resilient["cells"], none);
  EXPECT_EQ(resilient["hulls"], none);
  EXPECT_EQ(resilient["leaves_out"], true);
  EXPECT_EQ(resilient["agents"][4]["lies_from_s"], nullptr);
  EXPECT_EQ(resilient["agents"][5]["lies_from_s"], 1.0);
}

TEST(Laws, NameAKeyForWhatIsDrawnOfThemIfAndOnlyIfTheyHaveItsValue) {
  for (const LawEntry& law : Laws()) {
    EXPECT_EQ(law.drawing.hull.key.empty(), law.drawing.hull.of == nullptr) << law.name;
    EXPECT_EQ(law.drawing.cells.key.empty(), law.drawing.cells.of == nullptr) << law.name;
  }
}

TEST(LiveView, TellsWhatALawLeavesOutOfWhatItHears) {
  // On a line along x, at different heights, which the law does not control. From tick 2 on 4 says that it is at -17.
  Watched run(Load(R"(
[run]
duration_s = 0.1
[agents]
count = 4
model = "single_integrator"
position_m = [[0, 0, 1], [1, 0, 2], [2, 0, 3], [3, 0, 4]]
[[agents.override]]
id = 4
lie = { from_s = 0.02, offset_m = [-20.0, 0.0, 0.0] }
[graph]
topology = "complete"
[law]
name = "resilient"
f = 1
gain = 0.1
)"));
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/frame");
  run.Fly([&](std::int64_t tick) {  // 1 hears 2, 3, 4; 2 hears 1, 3, 4; ...
    if (tick == 2) {
      EXPECT_EQ(viewer.FrameAt(1)["left_out"], Json::parse("[0,0,1, 1,0,1, 1,0,1, 1,0,0]"));
    } else if (tick == 4) {
      EXPECT_EQ(viewer.FrameAt(3)["left_out"], Json::parse("[0,1,1, 0,1,1, 0,0,1, 1,0,0]"));
    }
  });
}

TEST(LiveView, SaysNothingOfLeavingOutWhereNoLawDoes) {
  Watched run(Load(kThree));
  run.Fly();
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/frame");
  EXPECT_FALSE(viewer.NextJsonOf("/ui/frame").contains("left_out"));
}

TEST(LiveView, ShowsTheTickThatTheRunStandsAt) {
  Watched run(Load(kThree));
  std::optional<Viewer> viewer;
  const EngineResult result = run.Fly([&](std::int64_t tick) {
    if (tick != 100) return;  // 0 to 99 are flown, and the run stands still: a viewer that comes now sees the newest
    viewer.emplace(run.view.url());
    viewer->Subscribe("/ui/frame");
    const Json frame = viewer->FrameAt(99);
    EXPECT_EQ(frame["t_s"], 0.99);
    EXPECT_EQ(frame["state"], "running");
    EXPECT_EQ(frame["p"].size(), 9u);
    EXPECT_EQ(frame["q"].size(), 12u);
    EXPECT_EQ(frame["u"].size(), 12u);
    EXPECT_EQ(frame["flags"].size(), 3u);
    EXPECT_EQ(frame["edge"], Json::parse("[1,1,1]"));
    EXPECT_EQ(frame["age_s"], Json::parse("[0,0,0]"));
    EXPECT_GT(frame["disagreement_m"], 0);
    EXPECT_EQ(frame["contacts"], nullptr);
  });
  EXPECT_EQ(result.failure, "");
  const Json frame =
      viewer->NextWhere("/ui/frame", "the last frame", [](const Json& f) { return f.value("state", "") == "done"; });
  EXPECT_EQ(frame["tick"], 300);
  EXPECT_EQ(frame["contacts"], 0);
  EXPECT_TRUE(viewer->NextWith("\x05\x03"));  // playback has ended
}

TEST(LiveView, KnowsWhatBecameOfEveryEdge) {
  // 1 hears 2 through a link that loses everything, 2 hears 3 later, 3 is too far from 1 to hear it.
  Watched run(Load(R"(
[run]
duration_s = 0.5
[agents]
count = 3
position_m = [[0, 0, 1], [4, 0, 1], [0, 40, 2]]
model = "double_integrator"
[graph]
edges = [[1, 2], [2, 1], [3, 1]]
range_m = 20.0
[link]
delay_s = 0.1
hold_s = 0.1
[[link.override]]
edges = [[1, 2]]
loss = 1.0
[law]
name = "consensus"
)"));
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/frame");
  run.Fly([&](std::int64_t tick) {
    if (tick == 6) {
      EXPECT_EQ(viewer.FrameAt(5)["edge"], Json::parse("[4,4,3]"));
    } else if (tick == 21) {
      const Json frame = viewer.FrameAt(20);
      EXPECT_EQ(frame["edge"], Json::parse("[4,1,3]"));
      EXPECT_NEAR(frame["age_s"][1], 0.1, 1e-6);
      EXPECT_EQ(frame["age_s"][0], -1);
    }
  });
}

TEST(LiveView, KnowsThatNobodyHearsAnAgentThatIsLostOrMuteOrHasNoLink) {
  Watched run(Load(R"(
[run]
duration_s = 0.5
on_agent_loss = "hold"
[agents]
count = 3
position_m = [[0, 0, 1], [4, 0, 1], [0, 4, 2]]
model = "double_integrator"
[graph]
edges = [[1, 2], [1, 3], [2, 1], [2, 3], [3, 1], [3, 2]]
[law]
name = "consensus"
[[events]]
at_s = 0.1
fault = { agent = 3, kind = "kill" }
[[events]]
at_s = 0.2
fault = { agent = 1, kind = "mute" }
[[events]]
at_s = 0.3
restart = 3
[[events]]
at_s = 0.4
fault = { agent = 2, of = "link", kind = "off" }
)"));
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/frame");
  const std::map<std::int64_t, const char*> edges = {
      {9, "[1,1,1,1,1,1]"}, {11, "[1,0,1,0,0,0]"}, {21, "[1,0,0,0,0,0]"}, {31, "[1,1,0,1,0,1]"}, {41, "[2,1,0,1,0,2]"}};
  run.Fly([&](std::int64_t tick) {
    const auto row = edges.find(tick - 1);
    if (row == edges.end()) return;
    EXPECT_EQ(viewer.FrameAt(row->first)["edge"], Json::parse(row->second)) << row->first;
  });
}

TEST(EdgesNow, AreLostAsOftenAsSamplesAreLostAndAbsentWhenTheGraphSaysSo) {
  const Experiment experiment = Load(R"(
[run]
duration_s = 1.0
[agents]
count = 2
model = "double_integrator"
[graph]
edges = [[1, 2], [2, 1]]
repeat_s = 0.5
[[graph.schedule]]
at_s = 0.25
edges = [[1, 2]]
[link]
loss = 0.3
[law]
name = "consensus"
)");
  RunMeter meter(experiment);
  std::map<EdgeNow::State, std::uint64_t> of_1, of_2;
  std::vector<EdgeNow> edges;
  EXPECT_EQ(RunInProcess(experiment, {&meter},
                         [&, tick = 0]() mutable {
                           if (tick++ == 0) return true;
                           meter.EdgesNow(edges);
                           ++of_1[edges[0].state];
                           ++of_2[edges[1].state];
                           return true;
                         })
                .failure,
            "");
  meter.EdgesNow(edges);  // of the last tick
  ++of_1[edges[0].state];
  ++of_2[edges[1].state];
  using State = EdgeNow::State;
  const auto traffic = meter.Traffic();
  EXPECT_GT(traffic[0].count.lost, 0u);
  EXPECT_EQ(of_1[State::kLost] + of_1[State::kNothingYet], traffic[0].count.lost);
  EXPECT_EQ(of_1[State::kHeard], 101 - traffic[0].count.lost);
  EXPECT_EQ(of_2[State::kNoEdge], 50u);  // ticks 25 to 49 and 75 to 99
  EXPECT_EQ(of_2[State::kHeard], 51 - traffic[1].count.lost);
}

TEST(RosView, StandsAtATickUntilItIsToldToGoOn) {
  const Experiment experiment = Load(kThree);
  RunMeter meter(experiment);
  RosView view(experiment, meter);
  EXPECT_EQ(view.TakeNewest(), -1);
  RosSource::Bytes first;
  const EngineResult result = RunInProcess(experiment, {&meter, &view}, [&, tick = 0]() mutable {
    if (tick++ != 100) return true;
    EXPECT_EQ(view.TakeNewest(), 99);
    first = view.Transforms();
    return true;
  });
  EXPECT_EQ(result.failure, "");
  EXPECT_EQ(view.Transforms(), first);
  EXPECT_EQ(view.TakeNewest(), 300);
  EXPECT_NE(view.Transforms(), first);
  EXPECT_EQ(view.TakeNewest(), 300);
}

TEST(LiveView, PassesRequestsToTheRunAndItsAnswersBack) {
  Watched run(Load(kThree));
  Viewer viewer(run.view.url());
  EXPECT_EQ(viewer.Ask({{"ask", "pause"}}), (Json{{"granted", true}, {"words", "asked"}}));
  EXPECT_EQ(viewer.Ask({{"ask", "stop"}}), (Json{{"granted", false}, {"words", "asked"}}));
  const auto publish = [&](const char* frame_id) {
    viewer.Send(WebClient::kBinary, std::string("\x01\x01\0\0\0", 5) + R"({"header":{"frame_id":")" + frame_id +
                                        R"("},"pose":{"position":{"x":5,"y":6,"z":7}}})");
    const auto status = viewer.NextWith("/goal: ");
    return status ? Json::parse(status->payload)["message"].get<std::string>() : "";
  };
  const auto asked = [&] { return run.control.requests().back().toml; };
  viewer.Send(WebClient::kText, R"({"op":"advertise","channels":[{"id":1,"topic":"/goal","encoding":"json",)"
                                R"("schemaName":"geometry_msgs/msg/PoseStamped"}]})");
  EXPECT_EQ(publish("agent_2"), "/goal: asked");
  EXPECT_EQ(asked(), "goto = { agent = 2, position_m = [5.000000, 6.000000, 7.000000] }");
  EXPECT_EQ(publish("map"), "/goal: asked");
  EXPECT_EQ(asked(), "goto = { agent = 1, position_m = [5.000000, 6.000000, 7.000000] }");  // the leader
  EXPECT_EQ(publish("agent_9"), "/goal: expected agent_1 to agent_3 as frame_id, got agent_9");
}

TEST(LiveView, WithoutALeaderAGoalNeedsAnAgentAndOnTheGroundItKeepsTheHeight) {
  Watched run(Load(R"(
[run]
duration_s = 0.1
[agents]
count = 2
position_m = [[0, 0, 1], [4, 0, 2.5]]
model = "double_integrator"
[law]
name = "consensus"
)"));
  run.Fly();
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/frame");
  viewer.NextOf("/ui/frame");
  viewer.Send(WebClient::kText, R"({"op":"advertise","channels":[{"id":1,"topic":"/goal","encoding":"json",)"
                                R"("schemaName":"geometry_msgs/msg/PoseStamped"}]})");
  const auto publish = [&](const std::string& json) {
    viewer.Send(WebClient::kBinary, std::string("\x01\x01\0\0\0", 5) + json);
    return viewer.NextWith("/goal: ")->payload;
  };
  EXPECT_THAT(publish(R"({"pose":{"position":{"x":5,"y":6,"z":0}}})"),
              HasSubstr("/goal: expected an agent's name as frame_id, such as agent_1, because there is no leader"));
  publish(R"({"header":{"frame_id":"agent_2"},"pose":{"position":{"x":5,"y":6,"z":0}}})");
  EXPECT_EQ(run.control.requests().back().toml, "goto = { agent = 2, position_m = [5.000000, 6.000000, 2.500000] }");
}

mascot_msgs::msg::Event EventIn(const std::string& bytes) {
  mascot_msgs::msg::Event event;
  Deserialize({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, event);
  return event;
}

TEST(LiveView, TellsOfEvents) {
  Watched run(Load(kThree));
  Viewer listener(run.view.url());  // of its own: what a viewer skips while it waits for another topic is gone
  listener.Subscribe("/event");
  listener.Subscribe("/ui/events");
  EXPECT_EQ(listener.NextJsonOf("/ui/events"), Json::array()) << "both subscriptions are known";
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/experiment");
  viewer.Subscribe("/ui/events");
  const Json before = viewer.NextJsonOf("/ui/experiment");
  EXPECT_EQ(before["live_keys"], Json::array());
  EXPECT_THAT(before["prediction"]["why"], HasSubstr("agents settle after their leader"));
  EXPECT_EQ(viewer.NextJsonOf("/ui/events"), Json::array());
  const Experiment now = Load(kThree, "law.leader_waypoints_m", "[[7, 8, 1]]");
  const Key gain = key::Number("p_gain", Above(0, 10), "pull").Unit("1/s^2");
  run.view.OnEvent({.number = 1, .tick = 50, .toml = "goto = {}", .by_hand = true}, now, {{"law.p_gain", gain, "0.5"}});
  const Json experiment = viewer.NextJsonOf("/ui/experiment");
  EXPECT_EQ(experiment["agents"][0]["waypoints_m"], Json::parse("[[7.0,8.0,1.0]]"));
  EXPECT_EQ(experiment["prediction"]["why"], "events change the run, from 0.5 s on") << "what it said held before";
  EXPECT_EQ(experiment["live_keys"], Json::parse(R"([{"key":"law.p_gain","kind":"number","unit":"1/s^2","min":0.0,
    "max":10.0,"open_min":true,"names":[],"value":0.5,"own":[],"meaning":"pull"}])"));
  EXPECT_EQ(viewer.NextJsonOf("/ui/events"),
            Json::parse(R"([{"number":1,"tick":50,"t_s":0.5,"toml":"goto = {}","by_hand":true}])"));
  const mascot_msgs::msg::Event event = EventIn(listener.NextOf("/event"));
  EXPECT_EQ(event.number(), 1u);
  EXPECT_EQ(event.tick(), 50u);
  EXPECT_EQ(event.stamp().nanosec(), 500'000'000u);
  EXPECT_EQ(event.toml(), "goto = {}");
}

/// Two points that meet, and from 1 s on twice as fast.
constexpr const char* kTwoPhases =
    "[run]\nduration_s = 3.0\n[agents]\ncount = 2\nmodel = 'single_integrator'\n"
    "position_m = [[-1, 0, 1], [1, 0, 1]]\n[graph]\ntopology = 'ring'\n[law]\nname = 'velocity_consensus'\n"
    "p_gain = 0.5\n[[law.schedule]]\nat_s = 1.0\np_gain = 1.0\n";

TEST(LiveView, TheorySpeaksOnAfterAPhaseAndIsSilentAfterAnEventByHand) {
  Watched run{Load(kTwoPhases)};
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/experiment");
  const auto spans = [](const Json& experiment) {
    std::vector<std::pair<double, double>> all;
    for (const Json& part : experiment["responses"]) all.emplace_back(part["from_s"], part["until_s"]);
    return all;
  };
  using Spans = std::vector<std::pair<double, double>>;
  const Json first = viewer.NextJsonOf("/ui/experiment");
  EXPECT_EQ(spans(first), (Spans{{0, 1}, {1, 3}}));
  EXPECT_EQ(first["responses"][0]["every_s"], 0.01);
  EXPECT_EQ(first["responses"][0]["value_m"][0], 1.0);
  EXPECT_EQ(first["prediction"]["from_s"], 0.0);
  LiveExperiment live(run.experiment, &LawTable(), /*checked=*/true);
  live.Take(run.experiment.events.at(0));
  run.view.OnEvent({.number = 1, .tick = 100, .toml = "phase", .by_hand = false}, *live.now(), {});
  const Json second = viewer.NextJsonOf("/ui/experiment");
  EXPECT_EQ(second["prediction"]["why"], "");
  EXPECT_EQ(second["prediction"]["from_s"], 1.0);
  EXPECT_GT(second["prediction"]["rate_per_s"], 0);
  EXPECT_EQ(spans(second), (Spans{{0, 1}, {1, 3}}));
  run.view.OnEvent({.number = 2, .tick = 250, .toml = "set = {}", .by_hand = true}, *live.now(), {});
  const Json third = viewer.NextJsonOf("/ui/experiment");
  EXPECT_EQ(third["prediction"]["why"], "events change the run, from 2.5 s on");
  EXPECT_EQ(spans(third), (Spans{{0, 1}, {1, 2.5}})) << "what was predicted before the event still holds up to it";
}

TEST(LiveView, WhoComesLateGetsTheCurvesFromTheStart) {
  Watched run{Load(kTwoPhases)};
  run.Fly();
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/curves");
  const Json rows = viewer.NextJsonOf("/ui/curves")["rows"];
  ASSERT_EQ(rows.size(), 301U);
  EXPECT_EQ(rows[0][0], 0.0);
  EXPECT_NEAR(rows[0][1], 1, 1e-6);
  EXPECT_EQ(rows[0][2], nullptr) << "disagreement is the curve of these laws";
  EXPECT_EQ(rows[0].size(), 5U) << "and two speeds";
  EXPECT_NEAR(rows[99][1], std::pow(0.99, 99), 1e-6);
  EXPECT_EQ(rows[300][0], 3.0);
}

TEST(LiveView, ShowsTheNewestOfEachVehicleBeforeTheFirstRowToo) {
  Watched run{Load(kTwoPhases)};
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/vehicles");
  EXPECT_EQ(viewer.NextJsonOf("/ui/vehicles"), Json::array());
  run.view.OnVehicle({.agent = 2, .phase = FlightPhase::kFound, .words = "found: PX4 1.18"});
  EXPECT_EQ(viewer.NextJsonOf("/ui/vehicles"),
            Json::parse(R"([{"agent":2,"phase":"found","words":"found: PX4 1.18"}])"));
  run.view.OnVehicle({.agent = 2, .phase = FlightPhase::kTakingOff, .words = "taking off"});
  EXPECT_EQ(viewer.NextJsonOf("/ui/vehicles")[0]["phase"], "taking off");
}

TEST(LiveView, NamesTheCurveOfTheLawAndWhatTheoryPredictsOfIt) {
  Watched run{
      Load("[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'single_integrator'\n"
           "position_m = [[0, 0, 1], [2, 0, 1]]\n[graph]\ntopology = 'complete'\n"
           "[law]\nname = 'coverage'\nregion_m = [[0, 0], [4, 0], [4, 4], [0, 4]]\n"
           "[[law.schedule]]\nat_s = 0.5\ngain = 2.0\n")};
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/experiment");
  viewer.Subscribe("/ui/frame");
  const Json curve = viewer.NextJsonOf("/ui/experiment")["curve"];
  EXPECT_EQ(curve["name"], "coverage cost");
  EXPECT_EQ(curve["unit"], "m^2");
  EXPECT_EQ(curve["decays"], false);
  EXPECT_EQ(curve["agrees"], false);
  EXPECT_EQ(curve["since_s"], 0.0);
  EXPECT_EQ(curve["predicted"]["bound"], "at_most");
  EXPECT_EQ(curve["predicted"]["figure"], "cost_end_m2");
  LiveExperiment live(run.experiment, &LawTable(), /*checked=*/true);
  live.Take(run.experiment.events.at(0));
  run.view.OnEvent({.number = 1, .tick = 50, .toml = "phase", .by_hand = false}, *live.now(), {});
  EXPECT_EQ(viewer.NextJsonOf("/ui/experiment")["curve"]["since_s"], 0.0) << "the law goes on";
  run.Fly();
  const Json last = viewer.FrameAt(100);
  EXPECT_GT(last["curve"], 0);
  EXPECT_LT(last["curve"], curve["predicted"]["value"]);
}

TEST(LiveView, WhoHasTheTokenSteersAndOthersWatch) {
  const Experiment experiment = Load(kThree);
  const Prediction prediction;
  const RunMeter meter(experiment);
  Control control;
  LiveView view(experiment, prediction, meter, control,
                {.port = 0, .page = {}, .steering = Steering(Steering::By::kToken)}, [](const std::string&) {});
  const std::string suffix = view.steering_suffix();
  ASSERT_THAT(suffix, testing::StartsWith("/#steer="));
  Viewer watches(view.url()), steers(view.url(), "/?steer=" + suffix.substr(8));
  EXPECT_EQ(watches.Ask({{"ask", "pause"}}), Json::parse(R"({"granted":false,"words":"this view only watches"})"));
  EXPECT_EQ(steers.Ask({{"ask", "pause"}})["granted"], true);
  EXPECT_EQ(control.requests().size(), 1U);
}

/// An experiment that makes what a viewer gets after each event long: a hundred times that is far more than the kernel
/// keeps for a client that reads nothing.
constexpr const char* kLarge =
    "[run]\nduration_s = 1.0\n[agents]\ncount = 400\nmodel = 'double_integrator'\nrandom = {}\n";

TEST(LiveView, AViewerThatReadsLateGetsTheNewestEventsAllTheSame) {
  constexpr int kEvents = 100;
  Watched run(Load(kLarge));
  Viewer viewer(run.view.url());
  viewer.Subscribe("/ui/experiment");
  viewer.Subscribe("/ui/events");
  EXPECT_EQ(viewer.NextJsonOf("/ui/events"), Json::array());
  for (int number = 1; number <= kEvents; ++number)
    run.view.OnEvent({.number = number, .tick = number, .toml = "cut = [[1, 2]]", .by_hand = true}, run.experiment, {});
  const Json newest =
      viewer.NextWhere("/ui/events", "the last event", [](const Json& events) { return events.size() >= kEvents; });
  EXPECT_EQ(newest.size(), static_cast<std::size_t>(kEvents));
}

TEST(LiveView, AViewerThatReadsLateGetsEverySampleOfEvents) {
  constexpr std::uint32_t kEvents = 100;
  Watched run(Load(kLarge));
  Viewer viewer(run.view.url());
  viewer.Subscribe("/event");
  viewer.Subscribe("/ui/experiment");
  viewer.NextJsonOf("/ui/experiment");
  for (int number = 1; number <= static_cast<int>(kEvents); ++number)
    run.view.OnEvent({.number = number, .tick = number, .toml = "cut = [[1, 2]]", .by_hand = true}, run.experiment, {});
  for (std::uint32_t number = 1; number <= kEvents; ++number)
    ASSERT_EQ(EventIn(viewer.NextOf("/event")).number(), number);
}

TEST(LiveView, SendsSamplesAsTheyAreRecorded) {
  const ScratchFolder folder;
  const Experiment experiment = Load(kThree, "record.topics", "['*/state']");
  std::string recorded;
  struct Keep final : RowSink {
    explicit Keep(std::string& to) : state(to) {}
    void Add(const FlownRow& row) override { state.assign(row.bytes().states[1].begin(), row.bytes().states[1].end()); }
    std::string& state;
  } keep(recorded);
  Watched run(experiment, {&keep});
  run.Fly();
  Viewer viewer(run.view.url());
  EXPECT_FALSE(viewer.Offers("/agent_2/command"));
  viewer.Subscribe("/agent_2/state");
  EXPECT_EQ(viewer.NextOf("/agent_2/state"), recorded);
}

TEST(LiveView, WatchedRunsRecordTheSameBytesAndAViewerThatDiesHoldsUpNothing) {
  const ScratchFolder folder;
  const auto fly = [&](const std::string& name, int viewers) {
    const Experiment experiment = Load(kThree);
    const RunFolder out(folder.File(name), experiment, false);
    RunWriter writer(experiment, out, experiment.resolved);
    Watched run(experiment, {&writer});
    std::vector<std::unique_ptr<Viewer>> watching;
    for (int i = 0; i < viewers; ++i) {
      watching.push_back(std::make_unique<Viewer>(run.view.url()));
      for (const char* topic : {"/ui/frame", "/scene", "/agent_1/state"}) watching.back()->Subscribe(topic);
    }
    EXPECT_EQ(run.Fly([&](std::int64_t tick) {
                   if (tick == 150 && viewers > 0) watching[0]->SendRaw("\x81");
                   if (tick == 151 && viewers > 0) watching.erase(watching.begin());
                 })
                  .failure,
              "");
    writer.Close(experiment.resolved);
    return ReadFile(folder.File(name + "/run.mcap"));
  };
  const std::string unwatched = fly("unwatched", 0);
  EXPECT_FALSE(unwatched.empty());
  EXPECT_TRUE(unwatched == fly("watched", 20));
}

/// Throws something at tick 100.
class Broken final : public RowSink {
 public:
  explicit Broken(bool by_exception) : by_exception_(by_exception) {}
  void Add(const FlownRow& row) override {
    ++rows;
    if (row.tick() != 100) return;
    if (by_exception_) throw std::runtime_error("made up");
    throw 1;
  }
  int rows = 0;

 private:
  bool by_exception_;
};

TEST(LiveView, AnErrorOfTheViewEndsTheViewAndNotTheRun) {
  const ScratchFolder folder;
  const auto fly = [&](const std::string& name, const std::function<void(Watched&)>& breaks, RowSink* more) {
    const Experiment experiment = Load(kThree);
    const RunFolder out(folder.File(name), experiment, false);
    RunWriter writer(experiment, out, experiment.resolved);
    std::vector<RowSink*> sinks{&writer};
    Watched run(experiment, sinks);
    std::optional<ViewSink> guarded;
    if (more != nullptr) run.AddSink(guarded.emplace(*more, [&run](const std::string& why) { run.view.Fail(why); }));
    Viewer viewer(run.view.url());
    const EngineResult result = run.Fly([&](std::int64_t tick) {
      if (tick == 100 && breaks) breaks(run);
    });
    EXPECT_EQ(result.failure, "") << name;
    writer.Close(experiment.resolved);
    if (breaks || more != nullptr) {
      EXPECT_TRUE(viewer.IsClosed()) << name;
      EXPECT_TRUE(Until([&] { return run.view.has_failed(); }));
      EXPECT_EQ(WebClient(run.view.url()).Get("/"), "") << "the port is closed";
      EXPECT_EQ(run.log(), "viewers: the view has ended because of an error of ours, and nothing else has: " +
                               std::string(name == "unknown" ? "an exception of the C++ type int" : "made up") + "\n");
    }
    return ReadFile(folder.File(name + "/run.mcap"));
  };
  const std::string whole = fly("whole", {}, nullptr);
  EXPECT_FALSE(whole.empty());
  EXPECT_TRUE(whole == fly(
                           "in_its_thread", [](Watched& run) { run.view.Fail("made up"); }, nullptr));
  Broken broken(/*by_exception=*/true), unknown(/*by_exception=*/false);
  EXPECT_TRUE(whole == fly("in_a_sink", {}, &broken));
  EXPECT_TRUE(whole == fly("unknown", {}, &unknown));
  EXPECT_EQ(broken.rows, 101) << "rows go to it no more";
}

TEST(RosView, IsToldWhatHasEndedItAndTellsItsThread) {
  const Experiment experiment = Load(kThree);
  RunMeter meter(experiment);
  RosView view(experiment, meter);
  Broken broken(/*by_exception=*/true);
  ViewSink guarded(broken, [&view](const std::string& why) { view.Fail(why); });
  const EngineResult result = RunInProcess(experiment, {&meter, &view, &guarded}, [] { return true; });
  EXPECT_EQ(result.failure, "");
  EXPECT_THAT([&] { view.TakeNewest(); }, testing::ThrowsMessage<std::runtime_error>("made up"));
}

TEST(LiveView, AQuestionThatThrowsIsAnswered) {
  Watched run(Load(kThree, "run.duration_s", "100000.0"));
  run.control.breaks = true;
  Viewer viewer(run.view.url());
  EXPECT_EQ(viewer.Ask({{"ask", "pause"}}), (Json{{"granted", false}, {"words", "made up"}}));
}

TEST(LiveView, EndsWhileSomebodyAsks) {
  for (int round = 0; round < 3; ++round) {
    auto run = std::make_unique<Watched>(Load(kThree));
    const Viewer viewer(run->view.url());
    const std::jthread asking([&](const std::stop_token& over) {
      const std::string head("\x02\0\0\0\0\1\0\0\0\4\0\0\0json", 17);
      while (!over.stop_requested()) viewer.Send(WebClient::kBinary, head + R"({"ask":"pause"})");
    });
    Await("requests", [&] { return run->control.requests().size() > 100; });
    run.reset();
  }
}

/// Runs wscheck against a server; it ends once it has seen all that it expects.
class WsCheck : public Running {
 public:
  WsCheck(const ScratchFolder& folder, const std::string& url)
      : Running("node", {SourceFolder() + "/tests/wscheck/wscheck.mjs", "ws" + url.substr(4)}, folder.File("wscheck")) {
  }
};

TEST(LiveView, IsReadByFoxglovesOwnPackages) {
  ASSERT_TRUE(std::filesystem::exists(SourceFolder() + "/tests/wscheck/node_modules"))
      << "tests/wscheck/node_modules is missing: run scripts/test, which installs it with `npm ci`";
  const ScratchFolder folder;
  Watched run(Load(kThree, "run.duration_s", "100000.0"));  // as long as the checker takes
  WsCheck check(folder, run.view.url());
  run.Fly([&](std::int64_t) {
    poll(nullptr, 0, 5);  // milliseconds: so that there is something to see
    run.over = check.IsOver();
  });
  EXPECT_EQ(check.Wait(), 0) << check.out() << check.err();
  const Json report = Json::parse(check.out());
  std::vector<std::string> topics;
  for (const auto& [topic, channel] : report["channels"].items()) topics.push_back(topic);
  EXPECT_THAT(topics, IsSupersetOf({"/agent_1/command", "/agent_3/state", "/clock", "/scene", "/tf", "/ui/events",
                                    "/ui/experiment", "/ui/frame"}));
  const Json& transform = report["channels"]["/tf"]["first"]["transforms"][0];
  EXPECT_EQ(transform["header"]["frame_id"], "world");
  EXPECT_EQ(transform["child_frame_id"], "agent_1");
  const Json& markers = report["channels"]["/scene"]["first"]["markers"];
  EXPECT_GT(markers.size(), 9u);
  EXPECT_EQ(report["answers"]["ask"]["granted"], true);
  EXPECT_EQ(report["answers"]["status"][0]["message"], "/goal: asked");
  const auto readers_of = [&](const std::string& topic) {
    for (const Json& row : report["answers"]["graph"]["subscribedTopics"])
      if (row["name"] == topic) return row["subscriberIds"].get<std::vector<std::string>>();
    return std::vector<std::string>();
  };
  EXPECT_THAT(readers_of("/agent_2/state"), ElementsAre("/agent_1", "/agent_2", "/orchestrator"));
}

}  // namespace
}  // namespace mascot::test
