// People steer a run: what they ask, what is answered, and what becomes of the run.
#include "orchestrator/control/run_requests.h"

#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "tests/support/three_agents.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using ::testing::StartsWith;
using Kind = Request::Kind;

const std::string kFirstLeads = "name = 'consensus'\nleader = 1\n";

/// The positions of all ticks, and the events.
class Kept final : public RowSink {
 public:
  void Add(const FlownRow& row) override {
    for (const Motion& motion : row.decoded().motions) positions.push_back(motion.p_WB);
    for (const auto& event : row.decoded().events) events.emplace_back(row.tick(), event.event.Toml());
    newest = row.tick();
  }
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::pair<std::int64_t, std::string>> events;
  std::atomic<std::int64_t> newest = -1;
};

/// Waits for a thread that asks.
void JoinSoon(std::jthread& thread) {
  const test::Deadline deadline("the end of a thread that asks");
  thread.join();
}

/// A run in this process, in a thread of its own, which pauses after tick 0.
class Steered {
 public:
  explicit Steered(const std::string& toml, double pace = 0)
      : experiment(Load(toml)), requests(experiment, pace), thread_([this] {
          result = RunInProcess(
              experiment, {&kept, &requests}, [] { return true; }, &requests);
        }) {}
  ~Steered() {
    if (!thread_.joinable()) return;
    Ask({.kind = Kind::kStop});
    Join();
  }

  Answer Ask(const Request& request) {
    const test::Deadline deadline("an answer of the run");
    return requests.Ask(request);
  }
  Answer Event(const std::string& toml) { return Ask({.kind = Kind::kEvent, .toml = toml}); }
  void Join() {
    const test::Deadline deadline("the end of the run");
    thread_.join();
  }
  /// Waits until the run has come to this tick.
  void Reach(std::int64_t tick) const {
    test::Await("tick " + std::to_string(tick), [&] { return requests.status().tick >= tick; });
  }

  const Experiment experiment;
  RunRequests requests;
  Kept kept;
  EngineResult result;

 private:
  std::jthread thread_;
};

/// A long run that has paused.
class Paused : public Steered {
 public:
  explicit Paused(const std::string& toml = Long(Three(kFirstLeads))) : Steered(toml, 1) {
    const Answer answer = Ask({.kind = Kind::kPause});
    EXPECT_TRUE(answer.granted) << answer.words;
    EXPECT_THAT(answer.words, StartsWith("paused after tick "));
  }
  static std::string Long(std::string toml) {
    return toml.replace(toml.find("duration_s = 1.0"), 16, "duration_s = 1000.0");
  }
};

TEST(RunRequests, AnswersWhatWillHappen) {
  Paused run;
  const std::int64_t at = run.requests.status().tick;
  const auto seconds = [](std::int64_t tick) { return ShortestFloat(static_cast<double>(tick) / 100) + " s)"; };
  const auto says = [&](const Request& request, const std::string& words) {
    const Answer answer = run.Ask(request);
    EXPECT_TRUE(answer.granted);
    EXPECT_EQ(answer.words, words);
  };
  const std::string next = "tick " + std::to_string(at + 1) + " (" + seconds(at + 1);
  says({.kind = Kind::kEvent, .toml = "cut = [[1, 2]]"}, "takes effect at " + next);
  says({.kind = Kind::kStep, .number = 3}, "pauses after tick " + std::to_string(at + 3) + " (" + seconds(at + 3));
  says({.kind = Kind::kPace, .number = 2.5}, "2.5 simulated seconds a second");
  says({.kind = Kind::kPace, .number = 0}, "as fast as it goes");
  says({.kind = Kind::kStop}, "the run stops, and its results are written");
}

TEST(RunRequests, RefusesInTheWordsOfTheFileAndChangesNothing) {
  Paused run;
  const auto refusal = [&](const std::string& toml) {
    const Answer answer = run.Event(toml);
    EXPECT_FALSE(answer.granted);
    return answer.words;
  };
  EXPECT_EQ(refusal("set = { \"law.p_gain\" = -4 }"),
            "event by hand: law.p_gain: expected a number in [0, 1000], got -4");
  EXPECT_EQ(refusal("set = { \"law.p_gian\" = 4 }"),
            "event by hand: law.p_gian: unknown key (did you mean \"law.p_gain\"?)");
  EXPECT_EQ(refusal("set = { \"agents.count\" = 4 }"),
            "event by hand: agents.count: expected a live key, got one that no event changes");
  EXPECT_EQ(refusal("goto = { agent = 9, position_m = [1, 1, 1] }"),
            "event by hand: goto.agent: expected an integer in [1, 3], got 9");
  EXPECT_THAT(refusal("goto = { agent = 2, position_m = [1, 1, 1] }"),
              StartsWith("event by hand: goto: expected an agent that flies waypoints, or a leader"));
  EXPECT_EQ(refusal("cut = [[2, 1]]"), "event by hand: expected an edge of the graph (i hears j), got [2, 1]");
  EXPECT_EQ(refusal("at_s = 3.0\ncut = [[1, 2]]"), "event by hand: at_s: unknown key");
  EXPECT_EQ(refusal("law = { name = \"waypoint\" }"),
            "event by hand: law: expected a phase in [[law.schedule]] of the file, got one by hand");
  EXPECT_EQ(refusal("law = 3"), "event by hand: law: expected a table, got a number");
  EXPECT_THAT(refusal("cut = [["), StartsWith("event by hand:1:9: "));
  EXPECT_EQ(refusal(""), "event by hand: expected one of set, goto, graph, cut, mend, fault, restart, got none");
  run.Ask({.kind = Kind::kStop});
  run.Join();
  EXPECT_TRUE(run.kept.events.empty());
}

TEST(RunRequests, ChecksEventsAsTheFileDoesAlsoAfterOthers) {
  const std::string shape =
      "[run]\nduration_s = 1.0\n[agents]\ncount = 3\nmodel = 'single_integrator'\n"
      "position_m = [[0, 0, 1], [1, 0, 1], [0, 2, 1]]\n[graph]\ntopology = 'complete'\n[law]\n"
      "name = 'distance_formation'\noffsets_m = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n";
  Paused flat(Paused::Long(shape));
  EXPECT_EQ(flat.Event("set = { \"law.offsets_m\" = [[0, 0, 0], [1, 0, 0], [2, 0, 0]] }").words,
            "event by hand: law.name: expected a graph and places that are infinitesimally rigid in the plane, got 3 "
            "pairs and a rigidity matrix of rank 2, not 3");
  const std::string law =
      "name = 'custom'\nparams = { x = 1 }\n"
      "python = '''\ndef control(t, me, neighbours):\n    return [0, 0]\n'''\n";
  Paused without(Paused::Long(Three(law)));
  EXPECT_TRUE(without.Event("set = { \"control.max_speed_m_per_s\" = 3 }").granted);
  EXPECT_EQ(without.Event("set = { \"law.params.x\" = 2 }").words,
            "event by hand: law.params: expected a law that defines set(me, params), got none");
}

constexpr const char* kFliesAndThenAgrees =
    "name = 'waypoint'\nwaypoints_m = [[1, 1, 1]]\n[[law.schedule]]\nat_s = 0.5\nname = 'consensus'\n";
constexpr const char* kGoTo = "goto = { agent = 2, position_m = [1, 1, 1] }";
constexpr const char* kNoWaypoints =
    "event by hand: goto: expected an agent that flies waypoints, or a leader, got agent 2 of law 'consensus'";

TEST(RunRequests, AnEventAtTheTickOfAPhaseComesBehindIt) {
  Steered run(Paused::Long(Three(kFliesAndThenAgrees)) + "[[events]]\nat_s = 0.3\nset = { \"run.pace\" = 0.001 }\n");
  run.Reach(30);
  run.Ask({.kind = Kind::kPause});
  run.Ask({.kind = Kind::kStep, .number = 18});
  run.Reach(48);
  EXPECT_EQ(run.Event(kGoTo).words, "takes effect at tick 49 (0.49 s)");
  run.Ask({.kind = Kind::kStep, .number = 1});
  run.Reach(49);
  EXPECT_EQ(run.Event(kGoTo).words, kNoWaypoints);
  run.Ask({.kind = Kind::kStop});
  run.Join();
  EXPECT_EQ(run.result.failure, "");
}

TEST(RunRequests, ChecksAnEventAgainThatAPhaseHasOvertaken) {
  const Experiment experiment = Load(Three(kFliesAndThenAgrees));
  RunRequests requests(experiment, 0);
  requests.Open();
  Answer answer{.granted = true};
  std::jthread asking([&] { answer = requests.Ask({.kind = Kind::kEvent, .toml = kGoTo}); });
  test::Await("a request", [&] { return requests.Next().has_value(); });
  EXPECT_EQ(requests.Next()->number, 50);
  requests.CheckAgain();
  JoinSoon(asking);
  EXPECT_EQ(answer, (Answer{false, kNoWaypoints}));
}

TEST(RunRequests, RefusesNumbersThatMakeNoSense) {
  Paused run;
  const auto refusal = [&](Kind kind, double number) {
    const Answer answer = run.Ask({.kind = kind, .number = number});
    EXPECT_FALSE(answer.granted);
    return answer.words;
  };
  EXPECT_EQ(refusal(Kind::kStep, 0), "step: expected an integer in [1, 1000000000], got 0.0");
  EXPECT_EQ(refusal(Kind::kStep, 1.5), "step: expected an integer in [1, 1000000000], got 1.5");
  EXPECT_EQ(refusal(Kind::kPace, -1), "pace: expected a number in [0, 1000], got -1.0");
  EXPECT_EQ(refusal(Kind::kPace, std::nan("")), "pace: expected a number in [0, 1000], got nan");
  EXPECT_EQ(refusal(Kind::kSeek, 1), "seek: expected a recording, got a run: nobody can go back in it, or ahead");
}

TEST(RunRequests, LetsARequestThatComesEarlyWaitForTheRunAndRefusesWhatComesLate) {
  const Experiment experiment = Load(Three(kFirstLeads));
  RunRequests requests(experiment, 0);
  Answer early;
  std::jthread asking([&] { early = requests.Ask({.kind = Kind::kPace, .number = 0}); });
  Kept kept;
  EXPECT_EQ(RunInProcess(
                experiment, {&kept, &requests}, [] { return true; }, &requests)
                .failure,
            "");
  JoinSoon(asking);
  EXPECT_TRUE(early.granted || early.words == "the run is over") << early.words;
  const Answer late = requests.Ask({.kind = Kind::kPause});
  EXPECT_FALSE(late.granted);
  EXPECT_EQ(late.words, "the run is over");
}

TEST(RunRequests, TellsWhoWaitsWhenTheRunEnds) {
  const Experiment experiment = Load(Three(kFirstLeads));
  RunRequests requests(experiment, 0);
  requests.Open();
  Answer answer{.granted = true};
  std::jthread asking([&] { answer = requests.Ask({.kind = Kind::kPause}); });
  test::Await("a request", [&] { return requests.Next().has_value(); });
  requests.Close();
  JoinSoon(asking);
  EXPECT_FALSE(answer.granted);
  EXPECT_EQ(answer.words, "the run is over");
}

TEST(RunRequests, StopsARunInOrder) {
  Paused run;
  run.Ask({.kind = Kind::kStep, .number = 10});
  run.Reach(10);
  EXPECT_TRUE(run.Ask({.kind = Kind::kStop}).granted);
  run.Join();
  EXPECT_EQ(run.result.failure, "");
  EXPECT_EQ(run.result.signal, 0);
}

TEST(RunRequests, AnEventOfTheFileMayChangeThePace) {
  Steered run(Paused::Long(Three(kFirstLeads)) + "[[events]]\nat_s = 0.5\nset = { \"run.pace\" = 0.001 }\n");
  run.Reach(50);
  run.Ask({.kind = Kind::kPause});
  EXPECT_EQ(run.requests.status().pace, 0.001);
  EXPECT_EQ(run.kept.newest, 50) << "the next tick is due 10 s later";
}

TEST(RunRequests, PausesStepsAndPacesLeaveNoTrace) {
  const std::string toml = Three(kFirstLeads);
  Kept plain;
  const Experiment experiment = Load(toml);
  RunInProcess(experiment, {&plain}, [] { return true; });
  Steered run(toml, 1);
  for (int k = 0; k < 20; ++k) {
    run.Ask({.kind = Kind::kPause});
    run.Ask({.kind = Kind::kStep, .number = 2});
    run.Ask({.kind = Kind::kPace, .number = 1.0 + k});
    run.Ask({.kind = Kind::kResume});
  }
  run.Ask({.kind = Kind::kPace, .number = 0});
  run.Join();
  EXPECT_EQ(run.kept.positions, plain.positions);
  EXPECT_TRUE(run.kept.events.empty());
}

TEST(RunRequests, EventsOfTwoSendersAtRandomMomentsFlyAgainFromTheFile) {
  const std::string toml = Three(kFirstLeads) + "[[events]]\nat_s = 0.3\ncut = [[1, 3]]\n[[events]]\nat_s = 0.6\n" +
                           "set = { \"law.p_gain\" = 0.4 }\n";
  Steered run(toml, 1);
  const auto send = [&](unsigned seed) {
    std::mt19937 random(seed);
    for (int k = 0; k < 10; ++k) {
      const std::string number = std::to_string(random() % 100);
      const std::string events[] = {
          "set = { \"law.p_gain\" = 0." + number + " }", "set = { \"link.loss\" = 0." + number + " }",
          "goto = { agent = 1, position_m = [" + number + ", 1, 2] }", "cut = [[1, 2]]", "mend = [[1, 2]]"};
      run.Event(events[random() % std::size(events)]);
      const std::int64_t until = run.kept.newest + static_cast<std::int64_t>(random() % 8);
      test::Await("a row of tick " + std::to_string(until), [&] { return run.kept.newest >= until; });
    }
  };
  std::jthread first([&] { send(1); }), second([&] { send(2); });
  JoinSoon(first);
  JoinSoon(second);
  run.Ask({.kind = Kind::kPace, .number = 0});
  run.Join();
  ASSERT_EQ(run.result.failure, "");
  EXPECT_EQ(run.requests.by_hand().size() + 2, run.kept.events.size());
  EXPECT_GT(run.requests.by_hand().size(), 5u);
  std::string text = run.experiment.resolved;
  for (const auto& event : run.requests.by_hand()) text = WithEvent(text, event.tick, 100, event.Toml());
  Kept again;
  const Experiment flown = Load(text);
  EXPECT_EQ(RunInProcess(flown, {&again}, [] { return true; }).failure, "");
  EXPECT_EQ(again.positions, run.kept.positions);
  EXPECT_EQ(again.events, run.kept.events);
}

}  // namespace
}  // namespace mascot
