// What is asked of a run that somebody else has changed meanwhile. That which all runs do: run_requests_test.
#include "orchestrator/engines/tick_requests.h"

#include <gmock/gmock.h>

#include <atomic>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/support/three_agents.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using Next = TickRequests::Next;

/// Asks in a thread of its own; `run` goes on meanwhile, until the answer is there.
Answer AskMeanwhile(RunRequests& requests, const Request& request, const std::function<void()>& run) {
  Answer answer;
  std::atomic<bool> is_there = false;
  std::jthread asking([&] {
    answer = requests.Ask(request);
    is_there = true;
  });
  test::Await("an answer", [&] {
    run();
    return is_there.load();
  });
  return answer;
}

class AtTicks : public testing::Test {
 protected:
  Answer Ask(
      const Request& request, const std::function<void(const Event&)>& take = [](const Event&) {}) {
    TickRequests asked(experiment, requests, take);
    return AskMeanwhile(requests, request, [&] {
      if (next != Next::kStop) next = asked.Await(1, {}, [] { return true; });
    });
  }

  const Experiment experiment = Load(Three("name = 'consensus'\n"));
  RunRequests requests{experiment, 0};
  Next next = Next::kLeave;
};

TEST_F(AtTicks, AnEventThatTheRunDoesNotTakeAnyMoreIsRefusedWithItsWords) {
  const Request cut{.kind = Request::Kind::kEvent, .toml = "cut = [[1, 2]]"};
  EXPECT_EQ(Ask(cut,
                [](const Event&) {
                  throw ConfigError({"there is no such edge", "not any more"});
                }),
            (Answer{false, "there is no such edge\nnot any more"}));
  EXPECT_EQ(next, Next::kTick);
}

TEST_F(AtTicks, AndSoWithOtherErrors) {
  const Request cut{.kind = Request::Kind::kEvent, .toml = "cut = [[1, 2]]"};
  EXPECT_EQ(Ask(cut, [](const Event&) { throw std::invalid_argument("the episode is over"); }),
            (Answer{false, "the episode is over"}));
}

TEST_F(AtTicks, AStopIsNotWhatEndsTheWait) {
  EXPECT_TRUE(Ask({.kind = Request::Kind::kStop}).granted);
  EXPECT_EQ(next, Next::kStop);
}

TEST_F(AtTicks, ARunThatBeginsInAPauseWaitsForAStep) {
  RunRequests paused(experiment, 0, /*paused=*/true);
  TickRequests asked(experiment, paused, [](const Event&) {});
  int looks = 0;
  EXPECT_EQ(asked.Await(1, {}, [&] { return ++looks < 3; }), Next::kLeave);
  EXPECT_TRUE(paused.status().paused);
  const Answer granted = AskMeanwhile(paused, {.kind = Request::Kind::kStep, .number = 1}, [&] {
    if (next != Next::kTick) next = asked.Await(1, {}, [] { return true; });
  });
  EXPECT_TRUE(granted.granted) << granted.words;
  EXPECT_EQ(next, Next::kTick);
}

TEST_F(AtTicks, WhoDoesNotWantToWaitLeaves) {
  TickRequests asked(experiment, requests, [](const Event&) {});
  EXPECT_EQ(asked.Await(1, 1e-3, [] { return false; }), Next::kLeave);
  EXPECT_EQ(requests.status().pace, 1e-3);  // what an event has set holds nevertheless
}

}  // namespace
}  // namespace mascot
