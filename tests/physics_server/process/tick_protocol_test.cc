#include "physics_server/process/tick_protocol.h"

#include <gtest/gtest.h>

#include <limits>
#include <ostream>

#include "tests/support/made_up_time.h"

namespace mascot {

void PrintTo(const TickProtocol::Actions& actions, std::ostream* out) {
  *out << "{" << (actions.take ? " take" : "") << (actions.step ? " step" : "") << (actions.publish ? " publish" : "")
       << (actions.ask ? " ask" : "") << (actions.wake ? " wake" : "") << " }";
}

namespace {

using namespace std::chrono_literals;
using Actions = TickProtocol::Actions;
using Time = TickProtocol::Time;
using Turn = TickProtocol::Turn;

constexpr bool kStop = true;
constexpr Actions kNothing = {}, kTake = {.take = true}, kPublish = {.publish = true}, kWake = {.wake = true},
                  kStepAndPublish = {.step = true, .publish = true},
                  kTakeStepAndPublish = {.take = true, .step = true, .publish = true},
                  kTakeAndWake = {.take = true, .wake = true};

/// TickProtocol with helpers for the tests.
class Exchange : public TickProtocol {
 public:
  explicit Exchange(const Rules& rules) : TickProtocol(rules), agents_(rules.agents) {}

  Actions OnCommand(int id, std::int64_t tick, bool stop_requested = false) {
    return TickProtocol::OnCommand(id, tick, stop_requested);
  }
  /// All agents answer the newest tick. Returns the actions for the last of these commands.
  Actions OnAllCommands(bool stop_requested = false) {
    const std::int64_t tick = published();
    for (int id = 1; id < agents_; ++id) OnCommand(id, tick, stop_requested);
    return OnCommand(agents_, tick, stop_requested);
  }
  Turn Look(Time now, bool stop_requested = false) { return TickProtocol::Look(now, stop_requested); }

 private:
  int agents_;
};

TickProtocol::Rules Rules(int agents, std::int64_t last_tick) {
  return {.agents = agents, .last_tick = last_tick, .period_s = 0.01, .agent_timeout_s = 5, .recorder_window = 64};
}

/// A lockstep run that has started.
Exchange Lockstep(int agents, std::int64_t last_tick = 1'000'000) {
  Exchange exchange(Rules(agents, last_tick));
  EXPECT_EQ(exchange.Start(), kPublish);
  return exchange;
}

/// A lockstep run at the first tick whose states wait for the recorder, which has confirmed nothing yet.
Exchange BeyondTheWindow(int agents) {
  Exchange exchange = Lockstep(agents);
  for (std::int64_t tick = 0; tick < 63; ++tick) EXPECT_EQ(exchange.OnAllCommands(), kTakeStepAndPublish) << tick;
  EXPECT_EQ(exchange.OnAllCommands(), (Actions{.take = true, .step = true}));
  return exchange;
}

/// A real-time run with a tick every 0.25 s that has started.
Exchange Realtime(int agents, std::int64_t last_tick = 1'000'000) {
  TickProtocol::Rules rules = Rules(agents, last_tick);
  rules.period_s = 0.25;
  rules.pace = 1;
  rules.realtime = true;
  Exchange exchange(rules);
  EXPECT_EQ(exchange.Start(), kPublish);
  return exchange;
}

/// A real-time run in which all agents have answered tick 0 at kT0: tick k is due k * 0.25 s later.
Exchange Paced(int agents, std::int64_t last_tick = 1'000'000) {
  Exchange exchange = Realtime(agents, last_tick);
  EXPECT_EQ(exchange.OnAllCommands(), kTakeAndWake);
  EXPECT_EQ(exchange.Look(kT0).next_deadline, kT0 + 250ms);
  return exchange;
}

// --- lockstep -------------------------------------------------------------------------------------------

TEST(TickProtocol, PublishesTickZeroWhenItStarts) {
  Exchange exchange(Rules(2, 10));
  EXPECT_EQ(exchange.published(), -1);
  EXPECT_EQ(exchange.Start(), kPublish);
  EXPECT_EQ(exchange.published(), 0);
}

TEST(TickProtocol, StepsAndPublishesWithTheLastCommandOfEachTick) {
  Exchange exchange = Lockstep(3);
  for (std::int64_t tick = 0; tick < 10; ++tick) {
    EXPECT_EQ(exchange.OnCommand(2, tick), kTake);
    EXPECT_EQ(exchange.OnCommand(3, tick), kTake);
    EXPECT_EQ(exchange.published(), tick);
    EXPECT_EQ(exchange.OnCommand(1, tick), kTakeStepAndPublish);
    EXPECT_EQ(exchange.published(), tick + 1);
  }
}

TEST(TickProtocol, IgnoresCommandsBeforeItStarts) {
  Exchange exchange(Rules(1, 10));
  EXPECT_EQ(exchange.OnCommand(1, 0), kNothing);
  exchange.Start();
  EXPECT_EQ(exchange.answered(1), -1);
  EXPECT_EQ(exchange.OnCommand(1, 0), kTakeStepAndPublish);
}

TEST(TickProtocol, IgnoresADoubledCommand) {
  Exchange exchange = Lockstep(2);
  EXPECT_EQ(exchange.OnCommand(1, 0), kTake);
  EXPECT_EQ(exchange.OnCommand(1, 0), kNothing);
  EXPECT_EQ(exchange.OnCommand(2, 0), kTakeStepAndPublish);
  EXPECT_EQ(exchange.OnCommand(1, 0), kNothing) << "late as well";
  EXPECT_EQ(exchange.OnCommand(2, 0), kNothing);
  EXPECT_EQ(exchange.published(), 1);
}

TEST(TickProtocol, IgnoresACommandToATickThatIsNotPublished) {
  Exchange exchange = Lockstep(1);
  EXPECT_EQ(exchange.OnCommand(1, 1), kNothing);
  EXPECT_EQ(exchange.OnCommand(1, std::numeric_limits<std::int64_t>::max()), kNothing);
  EXPECT_EQ(exchange.answered(1), -1);
  EXPECT_EQ(exchange.OnCommand(1, 0), kTakeStepAndPublish);
  EXPECT_EQ(exchange.OnCommand(1, 1), kTakeStepAndPublish) << "now it is";
}

TEST(TickProtocol, IgnoresInvalidTicks) {
  Exchange exchange = Lockstep(1);
  EXPECT_EQ(exchange.OnCommand(1, -1), kNothing);
  EXPECT_EQ(exchange.OnCommand(1, std::numeric_limits<std::int64_t>::min()), kNothing);
  EXPECT_EQ(exchange.OnCommand(1, 0), kTakeStepAndPublish);
}

TEST(TickProtocol, FinishesWithTheLastCommandOfTheLastTickAndDoesNotStep) {
  Exchange exchange = Lockstep(2, /*last_tick=*/1);
  exchange.OnAllCommands();
  EXPECT_EQ(exchange.OnCommand(1, 1), kTake);
  EXPECT_FALSE(exchange.finished());
  EXPECT_EQ(exchange.OnCommand(2, 1), kTakeAndWake);
  EXPECT_TRUE(exchange.finished());
  EXPECT_EQ(exchange.Look(kT0).next_deadline, std::nullopt);
}

TEST(TickProtocol, IgnoresCommandsWhenItIsFinished) {
  Exchange exchange = Lockstep(2, /*last_tick=*/1);
  exchange.OnAllCommands();
  exchange.OnAllCommands();
  for (int id = 1; id <= 2; ++id)
    for (std::int64_t tick = -1; tick <= 2; ++tick) EXPECT_EQ(exchange.OnCommand(id, tick), kNothing) << tick;
}

TEST(TickProtocol, StopsWhenTheTickIsAnsweredAtWhichAStopWasRequested) {
  Exchange exchange = Lockstep(3);
  exchange.OnAllCommands();
  EXPECT_EQ(exchange.OnCommand(1, 1), kTake);
  EXPECT_EQ(exchange.OnCommand(2, 1, kStop), kTake);
  EXPECT_FALSE(exchange.finished());
  EXPECT_EQ(exchange.OnCommand(3, 1, kStop), kTakeAndWake);
  EXPECT_TRUE(exchange.finished());
  EXPECT_EQ(exchange.published(), 1);
}

// --- the recorder's window ------------------------------------------------------------------------------

TEST(TickProtocol, PublishesTick64OnceTheRecorderHasRow0) {
  Exchange exchange = BeyondTheWindow(2);
  EXPECT_EQ(exchange.published(), 63);
  EXPECT_EQ(exchange.OnRecorded(0), kNothing);
  EXPECT_EQ(exchange.OnRecorded(1), kPublish);
  EXPECT_EQ(exchange.published(), 64);
  EXPECT_EQ(exchange.OnAllCommands(), (Actions{.take = true, .step = true})) << "row 1 is not there";
}

TEST(TickProtocol, IgnoresCommandsToAStepWhoseStatesWaitForTheRecorder) {
  Exchange exchange = BeyondTheWindow(1);
  EXPECT_EQ(exchange.OnCommand(1, 64), kNothing);
  EXPECT_EQ(exchange.OnCommand(1, 63), kNothing);
  exchange.OnRecorded(2);
  EXPECT_EQ(exchange.OnCommand(1, 64), kTakeStepAndPublish);
}

TEST(TickProtocol, PublishesATickOnceHoweverOftenTheRecorderConfirms) {
  Exchange exchange = Lockstep(1);
  EXPECT_EQ(exchange.OnRecorded(1), kNothing);
  EXPECT_EQ(exchange.OnRecorded(1), kNothing);
  exchange.OnCommand(1, 0);
  EXPECT_EQ(exchange.OnRecorded(2), kNothing);
  EXPECT_EQ(exchange.published(), 1);
}

TEST(TickProtocol, PublishesNothingForTheRecorderBeforeItStarts) {
  Exchange exchange(Rules(1, 10));
  EXPECT_EQ(exchange.OnRecorded(0), kNothing);
  EXPECT_EQ(exchange.OnRecorded(5), kNothing);
  EXPECT_EQ(exchange.Start(), kPublish);
}

// --- late agents ----------------------------------------------------------------------------------------

TEST(TickProtocol, NamesTheAgentsThatAreSilentForTheTimeout) {
  Exchange exchange = Lockstep(3);
  exchange.OnCommand(2, 0);
  EXPECT_EQ(exchange.Look(kT0).failure, "");
  EXPECT_EQ(exchange.Look(kT0 + 5s).failure, "");
  const Turn turn = exchange.Look(kT0 + 5s + 1ns);
  EXPECT_EQ(turn.failure, "tick 0: no command from agents 1, 3 within run.agent_timeout_s = 5.0 s");
  EXPECT_EQ(turn.actions, kNothing);
}

TEST(TickProtocol, GivesTheWholeTimeoutToEveryTick) {
  Exchange exchange = Lockstep(2);
  for (int tick = 0; tick < 10; ++tick) {
    exchange.Look(kT0 + tick * 5s);
    EXPECT_EQ(exchange.Look(kT0 + tick * 5s + 5s).failure, "") << tick;
    exchange.OnAllCommands();
  }
  exchange.Look(kT0 + 50s);
  exchange.OnCommand(1, 10);
  EXPECT_EQ(exchange.Look(kT0 + 55s + 1ns).failure,
            "tick 10: no command from agent 2 within run.agent_timeout_s = 5.0 s")
      << "one command ends no tick";
}

TEST(TickProtocol, GivesTheRecorderATimeoutForEachAgent) {
  Exchange exchange = BeyondTheWindow(3);
  EXPECT_EQ(exchange.Look(kT0).failure, "");
  EXPECT_EQ(exchange.Look(kT0 + 15s).failure, "");
  EXPECT_EQ(exchange.Look(kT0 + 15s + 1ns).failure,
            "tick 64: the recorder has confirmed only 0 ticks, nothing within 3 times run.agent_timeout_s = 5.0 s");
}

TEST(TickProtocol, GivesAgentsTheirTimeFromWhenTheTickIsPublished) {
  Exchange exchange = BeyondTheWindow(3);
  exchange.Look(kT0);
  EXPECT_EQ(exchange.Look(kT0 + 14s).failure, "");
  exchange.OnRecorded(1);
  EXPECT_EQ(exchange.Look(kT0 + 14s).failure, "");
  EXPECT_EQ(exchange.Look(kT0 + 19s).failure, "");
  EXPECT_EQ(exchange.Look(kT0 + 19s + 1ns).failure,
            "tick 64: no command from agents 1-3 within run.agent_timeout_s = 5.0 s");
}

TEST(TickProtocol, LooksTwentyTimesASecondInLockstepAndAsksAgainMoreAndMoreSeldom) {
  Exchange exchange = Lockstep(2);
  for (const std::int64_t tick : {0, 1}) {
    exchange.OnCommand(1, tick);
    for (int look = 0; look < 40; ++look) {
      const Time now = kT0 + tick * 10s + look * 50ms;
      const Turn turn = exchange.Look(now);
      EXPECT_EQ(turn.actions, look == 4 || look == 12 || look == 28 ? Actions{.ask = true} : kNothing) << look;
      EXPECT_EQ(turn.next_deadline, now + 50ms);
      EXPECT_EQ(turn.due, std::nullopt);
    }
    exchange.OnCommand(2, tick);
  }
}

TEST(TickProtocol, AsksNobodyAgainWhileItWaitsForTheRecorder) {
  Exchange exchange = BeyondTheWindow(3);
  for (const auto later : {0s, 1s, 2s}) EXPECT_EQ(exchange.Look(kT0 + later).actions, kNothing);
}

// --- real time ------------------------------------------------------------------------------------------

TEST(TickProtocol, WaitsInRealTimeForEveryAgentsFirstCommand) {
  Exchange exchange = Realtime(2);
  EXPECT_EQ(exchange.OnCommand(2, 0), kTake);
  EXPECT_EQ(exchange.Look(kT0).actions, kNothing);
  EXPECT_EQ(exchange.Look(kT0 + 4s).actions, kNothing);
  EXPECT_EQ(exchange.OnCommand(1, 0), kTakeAndWake);
  const Turn turn = exchange.Look(kT0 + 4s + 1ms);
  EXPECT_EQ(turn.actions, kNothing);
  EXPECT_EQ(turn.next_deadline, kT0 + 4s + 251ms) << "a whole period for tick 0, too";
}

TEST(TickProtocol, NamesAgentsThatAreSilentFromTheStartInRealTime) {
  Exchange exchange = Realtime(2);
  exchange.OnCommand(2, 0);
  exchange.Look(kT0);
  EXPECT_EQ(exchange.Look(kT0 + 5s).failure, "");
  EXPECT_EQ(exchange.Look(kT0 + 5s + 1ns).failure,
            "tick 0: no command from agent 1 within run.agent_timeout_s = 5.0 s");
}

TEST(TickProtocol, StepsInRealTimeWhenTheNextTickIsDueAndNotBefore) {
  Exchange exchange = Paced(2);
  exchange.Look(kT0 + 250ms);
  EXPECT_EQ(exchange.OnAllCommands(), kTake) << "a complete tick does not hurry";
  EXPECT_EQ(exchange.Look(kT0 + 500ms - 1ns).actions, kNothing);
  const Turn turn = exchange.Look(kT0 + 500ms);
  EXPECT_EQ(turn.actions, kStepAndPublish);
  EXPECT_EQ(turn.due, kT0 + 500ms);
  EXPECT_EQ(turn.next_deadline, kT0 + 500ms);
  EXPECT_EQ(exchange.Look(kT0 + 500ms).next_deadline, kT0 + 750ms);
}

TEST(TickProtocol, HoldsACommandThatIsLateInRealTime) {
  Exchange exchange = Paced(2);
  for (int tick = 1; tick <= 3; ++tick) {
    EXPECT_EQ(exchange.Look(kT0 + tick * 250ms).actions, kStepAndPublish);
    EXPECT_EQ(exchange.OnCommand(1, tick), kTake);
  }
  EXPECT_EQ(exchange.answered(1), 3);
  EXPECT_EQ(exchange.answered(2), 0);
  EXPECT_EQ(exchange.OnCommand(2, 2), kTake) << "late, but newer than the one held";
  EXPECT_EQ(exchange.OnCommand(2, 1), kNothing) << "overtaken";
  EXPECT_EQ(exchange.answered(2), 2);
}

TEST(TickProtocol, NamesAgentsWhoseCommandIsHeldLongerThanTheTimeoutInRealTime) {
  Exchange exchange = Paced(3);
  for (int tick = 1; tick <= 21; ++tick) {  // the timeout is 20 periods
    EXPECT_EQ(exchange.Look(kT0 + tick * 250ms).failure, "") << tick;
    exchange.OnCommand(1, tick);
    if (tick < 21) exchange.OnCommand(3, tick);  // it has missed only the last tick
  }
  const Turn turn = exchange.Look(kT0 + 22 * 250ms);
  EXPECT_EQ(turn.failure, "tick 21: no command from agent 2 within run.agent_timeout_s = 5.0 s");
  EXPECT_EQ(turn.actions, kNothing) << "the world is not stepped with it";
  EXPECT_EQ(turn.late, std::vector<int>{2});
  EXPECT_FALSE(turn.due) << "the tick has not ended";
}

TEST(TickProtocol, FallsBehindInRealTimeOnASlowMachine) {
  Exchange exchange = Paced(1);
  Turn turn = exchange.Look(kT0 + 1s);  // three periods late
  EXPECT_EQ(turn.actions, kStepAndPublish);
  EXPECT_EQ(turn.due, kT0 + 250ms) << "from when its lateness counts";
  turn = exchange.Look(kT0 + 1s);
  EXPECT_EQ(turn.actions, kNothing);
  EXPECT_EQ(turn.next_deadline, kT0 + 1250ms) << "agents have a whole period";
  exchange.Look(kT0 + 1500ms);
  EXPECT_EQ(exchange.Look(kT0 + 1500ms).actions, kStepAndPublish) << "one period is made up for";
}

TEST(TickProtocol, WaitsForTheRecorderInRealTime) {
  Exchange exchange = Paced(2);
  for (int tick = 1; tick < 64; ++tick) {
    EXPECT_EQ(exchange.Look(kT0 + tick * 250ms).actions, kStepAndPublish);
    exchange.OnAllCommands();
  }
  const Time due = kT0 + 64 * 250ms;
  EXPECT_EQ(exchange.Look(due).actions, (Actions{.step = true}));
  EXPECT_EQ(exchange.Look(due).next_deadline, due + 50ms);
  EXPECT_EQ(exchange.Look(due + 10s).failure, "");
  EXPECT_EQ(exchange.Look(due + 10s).actions, kNothing) << "what nobody has seen is not stepped from";
  EXPECT_EQ(exchange.OnRecorded(1), (Actions{.publish = true, .wake = true}));
  const Turn turn = exchange.Look(due + 10s + 1ns);
  EXPECT_EQ(turn.failure, "");
  EXPECT_EQ(turn.actions.step, true);
  EXPECT_EQ(turn.due, due + 250ms);
}

TEST(TickProtocol, GivesTheRecorderATimeoutForEachAgentInRealTimeToo) {
  Exchange exchange = Paced(2);
  for (int tick = 1; tick <= 64; ++tick) {
    exchange.Look(kT0 + tick * 250ms);
    exchange.OnAllCommands();
  }
  const Time since = kT0 + 64 * 250ms;
  exchange.Look(since);
  EXPECT_EQ(exchange.Look(since + 10s).failure, "");
  EXPECT_EQ(exchange.Look(since + 10s + 1ns).failure,
            "tick 64: the recorder has confirmed only 0 ticks, nothing within 2 times run.agent_timeout_s = 5.0 s");
}

TEST(TickProtocol, WakesTheLoopForTheRecorderInRealTimeOnly) {
  EXPECT_EQ(Paced(1).OnRecorded(1), kWake);
  EXPECT_EQ(Lockstep(1).OnRecorded(1), kNothing);
}

TEST(TickProtocol, WaitsInRealTimeForEveryAgentsLastCommand) {
  Exchange exchange = Paced(2, /*last_tick=*/2);
  exchange.Look(kT0 + 250ms);
  EXPECT_EQ(exchange.Look(kT0 + 500ms).actions, kStepAndPublish);
  EXPECT_EQ(exchange.OnCommand(1, 2), kTake);
  for (const auto later : {500ms, 750ms, 5500ms}) {
    const Turn turn = exchange.Look(kT0 + later);
    EXPECT_EQ(turn.actions, kNothing) << "no tick comes after the last";
    EXPECT_EQ(turn.failure, "");
  }
  Exchange other = exchange;
  EXPECT_EQ(exchange.Look(kT0 + 5500ms + 1ns).failure,
            "tick 2: no command from agent 2 within run.agent_timeout_s = 5.0 s");
  EXPECT_EQ(other.OnCommand(2, 1), kTake) << "to the tick before: is held, ends nothing";
  EXPECT_EQ(other.OnCommand(2, 2), kTakeAndWake);
  EXPECT_TRUE(other.finished());
}

TEST(TickProtocol, StopsInRealTimeWhenTheNextTickIsDue) {
  Exchange exchange = Paced(2);
  exchange.Look(kT0 + 250ms);
  EXPECT_EQ(exchange.OnAllCommands(kStop), kTake);
  EXPECT_EQ(exchange.Look(kT0 + 300ms, kStop).next_deadline, kT0 + 500ms);
  EXPECT_FALSE(exchange.finished());
  const Turn turn = exchange.Look(kT0 + 500ms, kStop);
  EXPECT_EQ(turn.actions, kStepAndPublish);
  EXPECT_EQ(turn.next_deadline, std::nullopt);
  EXPECT_TRUE(exchange.finished());
  EXPECT_EQ(exchange.OnCommand(1, 2, kStop), kNothing);
}

/// A real-time run in which the states of tick 64 wait for the recorder.
Exchange PacedBeyondTheWindow() {
  Exchange exchange = Paced(1);
  for (int tick = 1; tick <= 64; ++tick) {
    exchange.Look(kT0 + tick * 250ms);
    exchange.OnAllCommands();
  }
  EXPECT_EQ(exchange.published(), 63);
  return exchange;
}

TEST(TickProtocol, StopsInRealTimeWhereItWaitsForTheRecorderAndDoesNotStep) {
  Exchange exchange = PacedBeyondTheWindow();
  const Turn turn = exchange.Look(kT0 + 20s, kStop);
  EXPECT_EQ(turn.actions, kNothing) << "nobody has seen the states of tick 64";
  EXPECT_EQ(turn.next_deadline, std::nullopt);
  EXPECT_TRUE(exchange.finished());
}

TEST(TickProtocol, PublishesNothingWhenItIsFinished) {
  Exchange exchange = PacedBeyondTheWindow();
  exchange.OnRecorded(1);
  EXPECT_EQ(exchange.Look(kT0 + 20s, kStop).actions, (Actions{.step = true})) << "tick 65 waits for the recorder";
  ASSERT_TRUE(exchange.finished());
  EXPECT_EQ(exchange.OnRecorded(2), kWake);
  EXPECT_EQ(exchange.published(), 64);
}

TEST(TickProtocol, StopsInRealTimeAtTickZeroWithoutAStep) {
  Exchange exchange = Realtime(2);
  EXPECT_EQ(exchange.OnCommand(1, 0, kStop), kTake);
  EXPECT_EQ(exchange.Look(kT0, kStop).next_deadline, kT0 + 50ms) << "tick 0 is waited for all the same";
  EXPECT_EQ(exchange.OnCommand(2, 0, kStop), kTakeAndWake);
  const Turn turn = exchange.Look(kT0 + 1ms, kStop);
  EXPECT_EQ(turn.actions, kNothing);
  EXPECT_EQ(turn.next_deadline, std::nullopt);
  EXPECT_TRUE(exchange.finished());
  EXPECT_EQ(exchange.published(), 0);
}

// --- the gate -------------------------------------------------------------------------------------------

constexpr Actions kTakeStepAndWake = {.take = true, .step = true, .wake = true};

TEST(TickProtocol, PublishesATickOfLockstepWhenTheGateOpens) {
  Exchange exchange = Lockstep(2);
  exchange.gate().SetPace(1);
  EXPECT_EQ(exchange.OnAllCommands(), kTakeStepAndWake) << "the world steps at once, but is not published";
  Turn turn = exchange.Look(kT0);
  EXPECT_EQ(turn.actions, kNothing);
  EXPECT_TRUE(turn.held);
  EXPECT_EQ(turn.next_deadline, kT0 + 10ms);
  EXPECT_EQ(exchange.Look(kT0 + 9ms).actions, kNothing);
  EXPECT_EQ(exchange.Look(kT0 + 10ms).actions, kPublish);
  EXPECT_EQ(exchange.published(), 1);
  EXPECT_EQ(exchange.Look(kT0 + 10ms).actions, kNothing) << "once";
}

TEST(TickProtocol, APausedRunOutlivesTheTimeOutOfAgents) {
  Exchange exchange = Lockstep(2);
  exchange.gate().Pause();
  exchange.OnAllCommands();
  for (int hour = 0; hour < 100; ++hour) {
    const Turn turn = exchange.Look(kT0 + hour * 1h);
    EXPECT_EQ(turn.failure, "");
    EXPECT_TRUE(turn.held);
    EXPECT_EQ(turn.next_deadline, kT0 + hour * 1h + 500ms);
  }
  exchange.gate().Resume();
  EXPECT_EQ(exchange.Look(kT0 + 100h).actions, kPublish);
  EXPECT_EQ(exchange.Look(kT0 + 100h).failure, "");
  EXPECT_EQ(exchange.Look(kT0 + 100h + 5s).failure, "") << "agents have their time from then on";
  EXPECT_EQ(exchange.Look(kT0 + 100h + 5001ms).failure,
            "tick 1: no command from agents 1-2 within run.agent_timeout_s = 5.0 s");
}

TEST(TickProtocol, AgentsThatAnswerInAPauseHaveTheirTimeFromTheStepOn) {
  Exchange exchange = Lockstep(2);
  exchange.gate().Pause();
  EXPECT_EQ(exchange.Look(kT0).failure, "");
  const Turn paused = exchange.Look(kT0 + 1h);
  EXPECT_EQ(paused.failure, "");
  EXPECT_EQ(paused.actions, kNothing) << "nobody is asked again";
  EXPECT_TRUE(paused.held);
  exchange.gate().Step(1);
  EXPECT_EQ(exchange.Look(kT0 + 2h).failure, "");
  EXPECT_EQ(exchange.Look(kT0 + 2h + 5s).failure, "");
  EXPECT_EQ(exchange.Look(kT0 + 2h + 6s).failure,
            "tick 0: no command from agents 1-2 within run.agent_timeout_s = 5.0 s");
}

TEST(TickProtocol, AStopInAPauseWaitsForAnswersAsEver) {
  Exchange exchange = Lockstep(2);
  exchange.gate().Pause();
  exchange.OnCommand(1, 0);
  EXPECT_EQ(exchange.Look(kT0, kStop).failure, "");
  EXPECT_EQ(exchange.Look(kT0 + 6s, kStop).failure,
            "tick 0: no command from agent 2 within run.agent_timeout_s = 5.0 s");
}

TEST(TickProtocol, TheLastTickIsAnsweredInAPauseToo) {
  Exchange exchange = Lockstep(2, /*last_tick=*/1);
  exchange.gate().Step(1);
  EXPECT_EQ(exchange.OnAllCommands(), (Actions{.take = true, .step = true, .wake = true}));
  EXPECT_EQ(exchange.Look(kT0).actions, kPublish);
  exchange.Look(kT0 + 1s);
  EXPECT_EQ(exchange.Look(kT0 + 7s).failure, "tick 1: no command from agents 1-2 within run.agent_timeout_s = 5.0 s");
}

TEST(TickProtocol, StepsPublishAsManyTicksAndPauseAgain) {
  Exchange exchange = Lockstep(2);
  exchange.gate().Step(2);
  for (int step = 0; step < 2; ++step) {
    EXPECT_EQ(exchange.OnAllCommands(), kTakeStepAndWake);
    EXPECT_EQ(exchange.Look(kT0).actions, kPublish);
  }
  EXPECT_EQ(exchange.OnAllCommands(), kTakeStepAndWake);
  EXPECT_TRUE(exchange.Look(kT0).held);
  EXPECT_EQ(exchange.published(), 2);
}

TEST(TickProtocol, AStopEndsAPausedRunAtOnce) {
  for (const bool realtime : {false, true}) {
    Exchange exchange = realtime ? Paced(2) : Lockstep(2);
    exchange.gate().Pause();
    if (!realtime) exchange.OnAllCommands();
    EXPECT_TRUE(exchange.Look(kT0 + 1s).held);
    EXPECT_EQ(exchange.Look(kT0 + 1s, kStop).next_deadline, std::nullopt);
    EXPECT_TRUE(exchange.finished());
    EXPECT_EQ(exchange.published(), 0);
  }
}

TEST(TickProtocol, APausedTickOfLockstepStillWaitsForTheRecorder) {
  Exchange exchange = BeyondTheWindow(1);
  exchange.gate().SetPace(1000);
  EXPECT_FALSE(exchange.Look(kT0).held);
  EXPECT_EQ(exchange.OnRecorded(1), kWake) << "for the loop to look at the gate";
  EXPECT_TRUE(exchange.Look(kT0).held);
  EXPECT_EQ(exchange.Look(kT0 + 1s).actions, kPublish);
}

TEST(TickProtocol, APauseStopsTheClockOfRealTime) {
  Exchange exchange = Paced(1);
  exchange.gate().Pause();
  EXPECT_TRUE(exchange.Look(kT0 + 10h).held);
  EXPECT_EQ(exchange.published(), 0);
  exchange.gate().Resume();
  EXPECT_EQ(exchange.Look(kT0 + 10h).next_deadline, kT0 + 10h + 250ms);
  EXPECT_EQ(exchange.Look(kT0 + 10h + 250ms).actions, kStepAndPublish);
}

TEST(TickProtocol, StepsOfAPausedRealTimeRunWaitForEveryCommand) {
  Exchange exchange = Paced(1);
  exchange.gate().Step(2);
  EXPECT_EQ(exchange.Look(kT0).actions, kStepAndPublish);
  EXPECT_EQ(exchange.Look(kT0).actions, kNothing) << "tick 1 is not answered";
  EXPECT_EQ(exchange.OnCommand(1, 1), kTakeAndWake);
  EXPECT_EQ(exchange.Look(kT0).actions, kStepAndPublish);
  EXPECT_EQ(exchange.OnCommand(1, 2), kTakeAndWake);
  EXPECT_TRUE(exchange.Look(kT0).held);
}

// --- losses ---------------------------------------------------------------------------------------------

TEST(TickProtocol, GoesOnWithoutAnAgentThatIsLost) {
  Exchange exchange = Lockstep(2);
  const Time now = (kT0 + 0s);
  EXPECT_EQ(exchange.OnCommand(1, 0), kTake);
  EXPECT_EQ(exchange.Lose(2, true), kWake) << "the loop goes on";
  const Turn turn = exchange.Look(now);
  EXPECT_EQ(turn.actions, kStepAndPublish);
  EXPECT_EQ(turn.next_deadline, now);
  EXPECT_EQ(exchange.OnCommand(2, 1), kNothing) << "what it sends too late does not count";
  EXPECT_EQ(exchange.last_whole(), 1);
  EXPECT_EQ(exchange.OnCommand(1, 1), kTakeStepAndPublish);
}

TEST(TickProtocol, ATickOfWhichTheNextOneWouldHaveSaidWhoHasNotAnsweredIsNotWhole) {
  Exchange exchange = Lockstep(2);
  exchange.OnAllCommands();
  exchange.OnCommand(1, 1);
  exchange.Lose(2, true);
  EXPECT_FALSE(exchange.Look(kT0, kStop).next_deadline);
  EXPECT_EQ(exchange.published(), 1);
  EXPECT_EQ(exchange.last_whole(), 0);
}

TEST(TickProtocol, GoesOnWithoutAnybody) {
  Exchange exchange = Lockstep(1, 2);
  exchange.Lose(1, true);
  EXPECT_EQ(exchange.Look((kT0 + 0s)).actions, kStepAndPublish);
  EXPECT_EQ(exchange.Look((kT0 + 0s)).actions, kStepAndPublish);
  EXPECT_FALSE(exchange.Look((kT0 + 0s)).next_deadline);
  EXPECT_TRUE(exchange.finished());
}

TEST(TickProtocol, TellsWhoIsLateAndWaitsForThemNoMoreIfTheyAreLost) {
  Exchange exchange = Lockstep(3);
  exchange.OnCommand(2, 0);
  exchange.Look((kT0 + 0s));
  const Turn turn = exchange.Look((kT0 + 6s));
  EXPECT_EQ(turn.failure, "tick 0: no command from agents 1, 3 within run.agent_timeout_s = 5.0 s");
  EXPECT_EQ(turn.late, (std::vector<int>{1, 3}));
  ASSERT_TRUE(turn.next_deadline);
  for (const int id : turn.late) exchange.Lose(id, true);
  EXPECT_EQ(exchange.Look((kT0 + 6s)).actions, kStepAndPublish);
}

TEST(TickProtocol, AFreshAgentIsWaitedForAgain) {
  Exchange exchange = Lockstep(2);
  exchange.Lose(2, true);
  EXPECT_EQ(exchange.OnCommand(1, 0), kTakeStepAndPublish);
  exchange.Regain(2);
  EXPECT_EQ(exchange.OnCommand(1, 1), kTake);
  EXPECT_EQ(exchange.OnCommand(2, 1), kTakeStepAndPublish);
}

TEST(TickProtocol, HoldsATickUntilItIsReleased) {
  Exchange exchange = Lockstep(1);
  exchange.Hold();
  EXPECT_EQ(exchange.OnCommand(1, 0), (Actions{.take = true, .step = true}));
  const Turn turn = exchange.Look((kT0 + 100s));
  EXPECT_EQ(turn.actions, kNothing);
  EXPECT_TRUE(turn.held);
  EXPECT_EQ(turn.failure, "") << "however long it takes";
  EXPECT_EQ(exchange.OnRecorded(1), kNothing);
  EXPECT_EQ(exchange.Release(), (Actions{.publish = true, .wake = true}));
  EXPECT_EQ(exchange.OnCommand(1, 1), kTakeStepAndPublish);
}

TEST(TickProtocol, StopsWhileItHoldsATick) {
  Exchange exchange = Lockstep(1);
  exchange.Hold();
  exchange.OnCommand(1, 0);
  EXPECT_FALSE(exchange.Look((kT0 + 1s), kStop).next_deadline);
  EXPECT_TRUE(exchange.finished());
}

}  // namespace
}  // namespace mascot
