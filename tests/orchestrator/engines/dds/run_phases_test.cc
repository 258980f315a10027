// The orchestrator's decisions during a run, without processes, DDS or clock.
#include "orchestrator/engines/dds/run_phases.h"

#include <gmock/gmock.h>
#include <signal.h>

#include <string>
#include <vector>

namespace mascot {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Phase = RunPhases::Phase;
using Actions = RunPhases::Actions;
using View = RunPhases::View;
using Exit = RunPhases::Exit;

constexpr auto kInstant = 1ms;

/// A run of ticks 0 to 10; the test sets the time.
class RunPhasesTest : public testing::Test {
 protected:
  explicit RunPhasesTest(double period_s = 0) : phases_(RulesOf(period_s), now_) {}

  RunPhases::Rules RulesOf(double period_s) {
    return {.start_timeout_s = 60,
            .agent_timeout_s = 2,
            .period_s = period_s,
            .violation = [this] { return violation_; },
            .missing = [] { return std::string("nothing was heard of agent_2"); },
            .lacking = [this] { return lacking_; },
            .is_loss = [this](const std::string& process) { return goes_on_ && process != "physics_server"; },
            .last_lines =
                [this](const std::string& process) {
                  return printed_.empty() ? std::vector<std::string>{process + " sighs"} : printed_;
                }};
  }

  Actions Look() { return phases_.Look(view_, now_); }
  Actions LookAfter(RunPhases::Time::duration span) {
    now_ += span;
    return Look();
  }
  /// Lets the first sample arrive.
  void Fly() {
    view_.newest_tick = 0;
    Look();
    ASSERT_EQ(phases_.phase(), Phase::kFlying);
  }
  /// Lets the server be done with tick 10; `rows` of 11 rows are recorded.
  void FinishFlight(std::int64_t rows) {
    Fly();
    view_.newest_tick = 10;
    view_.last_tick = 10;
    view_.rows = rows;
    Look();
  }
  Actions Collect() { return phases_.Collected(view_, now_); }
  void Exits(const std::string& process, std::optional<int> code, const std::string& text) {
    phases_.OnExits({{process, code, text}}, now_);
  }

  std::string violation_, lacking_;
  bool goes_on_ = false;              // run.on_agent_loss is not "abort"
  std::vector<std::string> printed_;  // by a child that has ended; empty: it has sighed
  RunPhases::Time now_ = RunPhases::Time() + 1h;
  View view_;
  RunPhases phases_;
};

class RealtimeRunPhasesTest : public RunPhasesTest {
 protected:
  RealtimeRunPhasesTest() : RunPhasesTest(/*period_s=*/0.01) {}
};

// --- a run in order -----------------------------------------------------------------------------------

TEST_F(RunPhasesTest, ARunInOrderStartsFliesIsCollectedAndEnds) {
  EXPECT_EQ(Look(), Actions());
  EXPECT_EQ(phases_.phase(), Phase::kStarting);
  view_.everybody_found = true;
  EXPECT_EQ(Look(), Actions{.say_ready = true});
  view_.newest_tick = 3;
  EXPECT_EQ(Look(), Actions());
  EXPECT_EQ(phases_.phase(), Phase::kFlying);
  view_ = {.newest_tick = 10, .rows = 11, .last_tick = 10};
  EXPECT_EQ(Look(), Actions());
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_EQ(Collect(), Actions());
  EXPECT_EQ(phases_.phase(), Phase::kEnding);
  EXPECT_TRUE(phases_.in_order());
  EXPECT_TRUE(phases_.found_everybody());
}

TEST_F(RunPhasesTest, ReadinessIsSaidAgainUntilTheFirstStateComes) {
  view_.everybody_found = true;
  EXPECT_EQ(Look(), Actions{.say_ready = true});
  EXPECT_EQ(LookAfter(50ms), Actions{.say_ready = true});
  view_.newest_tick = 0;
  EXPECT_EQ(LookAfter(50ms), Actions());
}

TEST_F(RunPhasesTest, TheRecorderIsNotReadyBeforeEverybodyIsFound) {
  EXPECT_EQ(LookAfter(10s), Actions());
  EXPECT_FALSE(phases_.found_everybody());
}

// --- deadlines ----------------------------------------------------------------------------------------

TEST_F(RunPhasesTest, AStartMayTakeTheStartTimeoutAndFiveSeconds) {
  LookAfter(65s);
  EXPECT_EQ(phases_.phase(), Phase::kStarting);
  LookAfter(kInstant);
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_EQ(phases_.failure(), "not started within run.start_timeout_s = 60.0 s: nothing was heard of agent_2");
}

TEST_F(RunPhasesTest, TheStartTimeoutDoesNotApplyAfterTheStart) {
  Fly();
  for (int n = 0; n < 100; ++n) {
    ++view_.newest_tick;
    LookAfter(1s);
  }
  EXPECT_EQ(phases_.phase(), Phase::kFlying);
}

TEST_F(RunPhasesTest, AServerThatSaysNothingForTheAgentTimeoutAndFiveSecondsHasFailed) {
  Fly();
  LookAfter(7s);
  EXPECT_EQ(phases_.phase(), Phase::kFlying);
  LookAfter(kInstant);
  EXPECT_EQ(phases_.failure(), "nothing came from physics_server for 7.0 s");
  EXPECT_EQ(Collect(), Actions()) << "it will not report";
  EXPECT_EQ(phases_.phase(), Phase::kEnding);
}

TEST_F(RunPhasesTest, WhatTheRecordingLacksIsNamedIfNothingComes) {
  Fly();
  lacking_ = "/agent_2/command of tick 7";
  LookAfter(7s);
  LookAfter(kInstant);
  EXPECT_EQ(phases_.failure(),
            "nothing came from physics_server for 7.0 s, and the recording waits for /agent_2/command of tick 7");
}

TEST_F(RunPhasesTest, RecordedRowsCountAsProgress) {
  Fly();
  LookAfter(7s);
  ++view_.rows;
  LookAfter(kInstant);
  LookAfter(7s);
  EXPECT_EQ(phases_.phase(), Phase::kFlying);
}

TEST_F(RealtimeRunPhasesTest, TheLimitOfASilentServerIsOnePeriodLonger) {
  Fly();
  LookAfter(7010ms);
  EXPECT_EQ(phases_.phase(), Phase::kFlying);
  LookAfter(kInstant);
  EXPECT_EQ(phases_.failure(), "nothing came from physics_server for 7.01 s");
}

TEST_F(RunPhasesTest, RowsMayComeForFiveSecondsAfterTheServerIsDone) {
  FinishFlight(/*rows=*/9);
  EXPECT_EQ(phases_.phase(), Phase::kDraining);
  now_ += 5s;
  EXPECT_FALSE(phases_.gives_up(now_));
  now_ += kInstant;
  EXPECT_TRUE(phases_.gives_up(now_));
  view_.rows = 11;
  Look();
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_TRUE(phases_.in_order());
}

TEST_F(RealtimeRunPhasesTest, RowsMayComeForThreeSecondsAfterTheServerIsDone) {
  FinishFlight(/*rows=*/9);
  EXPECT_FALSE(phases_.gives_up(now_ + 3s));
  EXPECT_TRUE(phases_.gives_up(now_ + 3s + kInstant));
}

TEST_F(RunPhasesTest, ARecordingThatStaysShortFails) {
  FinishFlight(/*rows=*/8);
  now_ += 5s + kInstant;
  view_.gave_up = true;
  view_.rows = 9;
  Look();
  EXPECT_EQ(phases_.phase(), Phase::kDraining) << "it has grown";
  LookAfter(50ms);
  EXPECT_EQ(phases_.failure(), "the recording is not complete: 9 of 11 ticks");
}

TEST_F(RunPhasesTest, AServerThatIsDoneMayBeSilent) {
  FinishFlight(/*rows=*/9);
  LookAfter(100s);
  EXPECT_EQ(phases_.phase(), Phase::kDraining);
}

// --- signals ------------------------------------------------------------------------------------------

TEST_F(RunPhasesTest, ASignalBeforeTheFirstStateEndsTheRunAtOnce) {
  EXPECT_EQ(phases_.OnSignal(SIGINT, now_), Actions{.ask_to_stop = true});
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_EQ(phases_.signal(), SIGINT);
  EXPECT_EQ(Collect(), Actions()) << "nothing flew that could be reported";
  EXPECT_EQ(phases_.phase(), Phase::kEnding);
}

TEST_F(RunPhasesTest, ASignalDuringTheTicksStopsTheRunInOrder) {
  Fly();
  EXPECT_EQ(phases_.OnSignal(SIGINT, now_), Actions{.ask_to_stop = true});
  EXPECT_EQ(phases_.phase(), Phase::kFlying);
  view_ = {.newest_tick = 4, .rows = 5, .last_tick = 4};
  LookAfter(1s);
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_EQ(phases_.failure(), "");
  EXPECT_FALSE(phases_.in_order());
}

TEST_F(RunPhasesTest, AServerThatDoesNotStopWithinFiveSecondsIsNotWaitedFor) {
  Fly();
  phases_.OnSignal(SIGTERM, now_);
  LookAfter(5s);
  EXPECT_EQ(phases_.phase(), Phase::kFlying);
  LookAfter(kInstant);
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_EQ(phases_.failure(), "");
}

TEST_F(RunPhasesTest, TheSecondSignalKills) {
  Fly();
  phases_.OnSignal(SIGINT, now_);
  EXPECT_EQ(phases_.OnSignal(SIGINT, now_ + 1s), Actions{.kill = true});
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_EQ(Collect(), Actions());
  EXPECT_EQ(phases_.phase(), Phase::kEnding) << "a killed server reports nothing";
}

TEST_F(RunPhasesTest, TheSecondSignalKillsAlsoWhileRowsAreCollected) {
  FinishFlight(/*rows=*/11);
  EXPECT_EQ(phases_.OnSignal(SIGINT, now_), Actions{.ask_to_stop = true});
  EXPECT_EQ(phases_.OnSignal(SIGTERM, now_), Actions{.kill = true});
  EXPECT_EQ(phases_.signal(), SIGINT);
}

// --- children -----------------------------------------------------------------------------------------

TEST_F(RunPhasesTest, AChildThatEndsInAnyPhaseBeforeTheRunIsOverFailsItWithItsLastLines) {
  for (const Phase phase : {Phase::kStarting, Phase::kFlying, Phase::kDraining}) {
    RunPhases phases(RulesOf(0), now_);
    if (phase != Phase::kStarting) phases.Look({.newest_tick = 0}, now_);
    if (phase == Phase::kDraining) phases.Look({.newest_tick = 10, .rows = 3, .last_tick = 10}, now_);
    ASSERT_EQ(phases.phase(), phase);
    phases.OnExits({{"agent_2", std::nullopt, "was killed by signal 11 (Segmentation fault)"},
                    {"agent_3", 1, "exited with code 1"}},
                   now_);
    EXPECT_EQ(phases.phase(), Phase::kCollecting);
    EXPECT_EQ(phases.failure(),
              "agent_2 was killed by signal 11 (Segmentation fault)\n  agent_2 | agent_2 sighs\n"
              "agent_3 exited with code 1\n  agent_3 | agent_3 sighs");
  }
}

TEST_F(RunPhasesTest, TheErrorThatAChildPrintedIsTheHeadline) {
  Fly();
  printed_ = {"warning: it is windy", "error: tick 7: no command from agent 2", "  and no other"};
  Exits("physics_server", 1, "exited with code 1");
  EXPECT_EQ(phases_.failure(),
            "physics_server: tick 7: no command from agent 2 (exited with code 1)\n"
            "  physics_server | warning: it is windy\n  physics_server |   and no other");
}

TEST_F(RunPhasesTest, AChildThatEndsAfterTheRunIsNoFailure) {
  FinishFlight(/*rows=*/11);
  Exits("agent_1", 1, "exited with code 1");
  Collect();
  Exits("agent_2", 1, "exited with code 1");
  EXPECT_TRUE(phases_.in_order());
}

TEST_F(RunPhasesTest, ChildrenThatEndByASignalAreJudgedATenthOfASecondLater) {
  Fly();
  Exits("agent_1", 143, "exited with code 143");
  LookAfter(100ms);
  EXPECT_EQ(phases_.phase(), Phase::kFlying);
  EXPECT_EQ(phases_.OnSignal(SIGTERM, now_), Actions{.ask_to_stop = true});
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_EQ(phases_.failure(), "") << "the whole job was ended";
}

TEST_F(RunPhasesTest, AChildThatWasSignalledAloneIsTheFailure) {
  Fly();
  Exits("agent_1", 143, "exited with code 143");
  LookAfter(100ms + kInstant);
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_THAT(phases_.failure(), HasSubstr("agent_1 exited with code 143"));
}

TEST_F(RunPhasesTest, ASignalExplainsOnlyExitsByThatSignal) {
  Fly();
  Exits("agent_1", 143, "exited with code 143");
  Exits("agent_2", 1, "exited with code 1");
  phases_.OnSignal(SIGTERM, now_);
  EXPECT_EQ(phases_.failure(), "agent_2 exited with code 1\n  agent_2 | agent_2 sighs");
}

TEST_F(RunPhasesTest, AfterASignalChildrenThatEndByItHaveNotFailed) {
  Fly();
  phases_.OnSignal(SIGINT, now_);
  Exits("agent_1", 130, "exited with code 130");
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_EQ(phases_.failure(), "");
}

// --- failures -----------------------------------------------------------------------------------------

TEST_F(RunPhasesTest, TheFirstFailureIsTheReason) {
  Fly();
  phases_.Fail("the disk is full");
  phases_.Fail("something else");
  EXPECT_EQ(phases_.failure(), "the disk is full");
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
}

TEST_F(RunPhasesTest, AFailureWithoutAWordIsAFailureNevertheless) {
  Fly();
  phases_.Fail("");
  EXPECT_EQ(phases_.failure(), "something failed without a word");
  EXPECT_FALSE(phases_.in_order());
}

TEST_F(RunPhasesTest, AChildThatEndedBeforeTheFailureIsTheReason) {
  Fly();
  Exits("agent_1", 139, "exited with code 139");
  phases_.Fail("a reader has lost its writer");
  EXPECT_THAT(phases_.failure(), HasSubstr("agent_1 exited with code 139"));
}

TEST_F(RunPhasesTest, AViolationIsTheReasonEvenIfAnotherFailureIsNoticedFirst) {
  violation_ = "agent_2 reads /agent_5/state";
  Fly();
  phases_.Fail("the recording is not complete");
  EXPECT_EQ(phases_.failure(), "the wire differs from the graph: agent_2 reads /agent_5/state");
}

TEST_F(RunPhasesTest, AViolationFailsTheRunEvenIfItIsOver) {
  Fly();
  phases_.OnViolation("a stranger writes /agent_1/command");
  EXPECT_EQ(phases_.failure(), "the wire differs from the graph: a stranger writes /agent_1/command");
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
}

// --- the server's report ------------------------------------------------------------------------------

TEST_F(RunPhasesTest, AfterAFailureTheServerIsAskedToEndAndItsReportIsAwaited) {
  Fly();
  phases_.Fail("agent_1 died");
  EXPECT_EQ(Collect(), Actions{.ask_to_end = true});
  EXPECT_EQ(phases_.phase(), Phase::kReporting);
  LookAfter(3s);
  EXPECT_EQ(phases_.phase(), Phase::kReporting);
  view_.reported = true;
  Look();
  EXPECT_EQ(phases_.phase(), Phase::kEnding);
}

TEST_F(RunPhasesTest, AReportIsWaitedForNoLongerThanTenSeconds) {
  Fly();
  phases_.Fail("agent_1 died");
  Collect();
  LookAfter(10s);
  EXPECT_EQ(phases_.phase(), Phase::kReporting);
  LookAfter(kInstant);
  EXPECT_EQ(phases_.phase(), Phase::kEnding);
}

TEST_F(RunPhasesTest, AServerThatHasReportedIsNotAskedAgain) {
  Fly();
  phases_.Fail("agent_1 died");
  view_.reported = true;
  EXPECT_EQ(Collect(), Actions());
  EXPECT_EQ(phases_.phase(), Phase::kEnding);
}

TEST_F(RunPhasesTest, TheReportOfAServerThatExitedIsAwaitedForOneSecond) {
  Fly();
  Exits("physics_server", 1, "exited with code 1");
  EXPECT_EQ(Collect(), Actions()) << "it cannot be asked any more";
  Look();
  LookAfter(1s);
  EXPECT_EQ(phases_.phase(), Phase::kReporting);
  LookAfter(kInstant);
  EXPECT_EQ(phases_.phase(), Phase::kEnding);
}

TEST_F(RunPhasesTest, AServerThatIsKilledWhileItsReportIsAwaitedIsNotWaitedFor) {
  Fly();
  phases_.Fail("agent_1 died");
  Collect();
  Exits("physics_server", std::nullopt, "was killed by signal 9 (Killed)");
  Look();
  EXPECT_EQ(phases_.phase(), Phase::kEnding);
  EXPECT_EQ(phases_.failure(), "agent_1 died");
}

TEST_F(RunPhasesTest, ASignalEndsTheWaitForTheReport) {
  Fly();
  phases_.Fail("agent_1 died");
  Collect();
  EXPECT_EQ(phases_.OnSignal(SIGINT, now_), Actions());
  EXPECT_EQ(phases_.phase(), Phase::kEnding);
  EXPECT_EQ(phases_.signal(), 0) << "the run had failed before";
}

TEST_F(RunPhasesTest, APausedServerThatGivesSignsOfLifeIsNotSilent) {
  Fly();
  for (int k = 0; k < 100; ++k) {
    ++view_.server_words;
    LookAfter(6s);
    EXPECT_EQ(phases_.failure(), "") << k;
  }
  LookAfter(7001ms);
  EXPECT_EQ(phases_.failure(), "nothing came from physics_server for 7.0 s");
}

TEST_F(RunPhasesTest, ARequestToStopEndsTheRunInOrder) {
  Fly();
  EXPECT_EQ(phases_.OnRequestToStop(now_), (Actions{.ask_to_stop = true}));
  EXPECT_EQ(phases_.OnRequestToStop(now_), Actions{}) << "once";
  view_.newest_tick = 3;
  view_.last_tick = 3;
  view_.rows = 4;
  Look();
  EXPECT_EQ(phases_.phase(), Phase::kCollecting);
  EXPECT_TRUE(phases_.in_order());
  EXPECT_EQ(phases_.signal(), 0);
}

TEST_F(RunPhasesTest, AServerThatDoesNotStopWhenAskedToFailsTheRun) {
  Fly();
  phases_.OnRequestToStop(now_);
  LookAfter(5001ms);
  EXPECT_EQ(phases_.failure(), "asked to stop, physics_server did not within 5 s");
}

// --- losses ---------------------------------------------------------------------------------------------

TEST_F(RunPhasesTest, AnAgentThatDiesInFlightIsALossIfTheRunGoesOn) {
  goes_on_ = true;
  Fly();
  Exits("agent_2", std::nullopt, "was killed by signal 9 (Killed)");
  Look();
  EXPECT_EQ(phases_.phase(), Phase::kFlying);
  EXPECT_TRUE(phases_.in_order());
  const auto losses = phases_.TakeLosses();
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_EQ(losses[0].first, "agent_2");
  EXPECT_EQ(losses[0].second, "agent_2 was killed by signal 9 (Killed)\n  agent_2 | agent_2 sighs");
  EXPECT_TRUE(phases_.TakeLosses().empty());
}

TEST_F(RunPhasesTest, AnAgentThatDiesWhileTheRunIsStoppedIsALossToo) {
  goes_on_ = true;
  Fly();
  phases_.OnSignal(SIGINT, now_);
  Exits("agent_2", std::nullopt, "was killed by signal 9 (Killed)");
  EXPECT_EQ(phases_.phase(), Phase::kFlying);
  EXPECT_EQ(phases_.failure(), "");
  EXPECT_EQ(phases_.TakeLosses().size(), 1U);
}

TEST_F(RunPhasesTest, AnAgentThatDiesWhileTheLastRowsComeIsNoFailure) {
  goes_on_ = true;
  FinishFlight(/*rows=*/9);
  ASSERT_EQ(phases_.phase(), Phase::kDraining);
  Exits("agent_2", std::nullopt, "was killed by signal 9 (Killed)");
  Look();
  EXPECT_EQ(phases_.failure(), "");
  EXPECT_EQ(phases_.TakeLosses().size(), 1U);
}

TEST_F(RunPhasesTest, AnAgentThatDiesBeforeTheFirstTickOrAServerIsAFailure) {
  goes_on_ = true;
  Exits("agent_2", 1, "exited with code 1");
  Look();
  EXPECT_FALSE(phases_.in_order());
}

TEST_F(RunPhasesTest, AServerThatDiesIsAFailureAlsoIfTheRunGoesOnWithoutAgents) {
  goes_on_ = true;
  Fly();
  Exits("physics_server", std::nullopt, "was killed by signal 9 (Killed)");
  Look();
  EXPECT_THAT(phases_.failure(), testing::StartsWith("physics_server was killed by signal 9"));
}

}  // namespace
}  // namespace mascot
