// Assembly of rows from samples in any order, without DDS.
#include "orchestrator/engines/dds/row_window.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "orchestrator/recording/row_codec.h"

namespace mascot {
namespace {

using testing::ThrowsMessage;

constexpr std::size_t kClock = 0, kState1 = 1, kCommand1 = 2, kState2 = 3, kCommand2 = 4;
constexpr std::int64_t kLastTick = 99;

/// Two agents, ticks 0 to 99, a window of 16 ticks.
RowWindow::Rules Rules(bool realtime = false, bool doubts = false) {
  return {.topics = {Topic::Clock(), Topic::State(1), Topic::Command(1), Topic::State(2), Topic::Command(2)},
          .agents = 2,
          .last_tick = kLastTick,
          .realtime = realtime,
          .ticks = 16,
          .patience = 8,
          .batch = 4,
          .doubts = doubts};
}

/// A window, and the number of samples sent on each topic.
class RowWindowTest : public testing::Test {
 protected:
  explicit RowWindowTest(bool realtime = false, bool doubts = false) : window_(Rules(realtime, doubts)), sent_(5, 0) {}

  /// Passes the next sample of a topic; its bytes are tick and topic.
  bool Send(std::size_t topic, std::int64_t tick) {
    const std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(tick), static_cast<std::uint8_t>(topic)};
    window_.CheckSequence(topic, ++sent_[topic]);
    return window_.Take(topic, tick, bytes);
  }
  bool SendTick(std::int64_t tick) {
    bool wake = false;
    for (std::size_t topic = 0; topic < sent_.size(); ++topic) wake |= Send(topic, tick);
    return wake;
  }
  bool Next(bool give_up = false) { return window_.Next(give_up, row_); }

  RowWindow window_;
  std::vector<std::int64_t> sent_;
  Row row_{2};
};

class RealtimeRowWindowTest : public RowWindowTest {
 protected:
  RealtimeRowWindowTest() : RowWindowTest(/*realtime=*/true) {}
};

// --- rows ---------------------------------------------------------------------------------------------

TEST_F(RowWindowTest, ARowIsReadyWithItsLastSample) {
  for (const std::size_t topic : {kCommand2, kState1, kClock, kCommand1}) {
    Send(topic, 0);
    EXPECT_FALSE(Next());
  }
  Send(kState2, 0);
  ASSERT_TRUE(Next());
  EXPECT_EQ(row_.tick, 0);
  EXPECT_EQ(row_.clock, (Row::Bytes{0, kClock}));
  EXPECT_EQ(row_.states[1], (Row::Bytes{0, kState2}));
  EXPECT_EQ(row_.commands[0], (Row::Bytes{0, kCommand1}));
  EXPECT_FALSE(Next());
  EXPECT_EQ(window_.rows(), 1);
}

TEST_F(RowWindowTest, RowsComeInTickOrderWhicheverTopicsRunAhead) {
  std::mt19937 random(7);
  std::int64_t taken = 0;
  while (window_.rows() < 100) {
    std::vector<std::size_t> topics;
    for (std::size_t topic = 0; topic < sent_.size(); ++topic)
      if (sent_[topic] < std::min<std::int64_t>(window_.rows() + 16, 100)) topics.push_back(topic);
    const std::size_t topic = topics[random() % topics.size()];
    Send(topic, sent_[topic]);
    while (Next()) {
      EXPECT_EQ(row_.tick, taken);
      EXPECT_EQ(row_.states[0], (Row::Bytes{static_cast<std::uint8_t>(taken), kState1}));
      EXPECT_EQ(row_.commands[1], (Row::Bytes{static_cast<std::uint8_t>(taken), kCommand2}));
      ++taken;
    }
  }
  EXPECT_EQ(window_.lost(), 0u);
  EXPECT_EQ(window_.newest_tick(), 99);
}

TEST_F(RowWindowTest, InLockstepARowWaitsForItsCommandsForEver) {
  for (std::int64_t tick = 0; tick < 16; ++tick)
    for (const std::size_t topic : {kClock, kState1, kState2, kCommand1}) Send(topic, tick);
  EXPECT_FALSE(Next());
  EXPECT_FALSE(Next(/*give_up=*/true));
}

// --- when to take rows --------------------------------------------------------------------------------

TEST_F(RowWindowTest, ABatchOfCompleteRowsIsToBeTaken) {
  EXPECT_FALSE(SendTick(0));
  EXPECT_FALSE(SendTick(1));
  EXPECT_FALSE(SendTick(2));
  EXPECT_TRUE(SendTick(3));
  while (Next()) continue;
  EXPECT_FALSE(SendTick(4)) << "taken ones do not count";
}

TEST_F(RowWindowTest, TheLastTickIsToBeTakenAtOnce) {
  for (std::int64_t tick = 0; tick < 99; ++tick) {
    SendTick(tick);
    ASSERT_TRUE(Next());
  }
  EXPECT_TRUE(Send(kState1, 99));
}

// --- lost samples -------------------------------------------------------------------------------------

TEST_F(RowWindowTest, ASampleThatIsMissingFailsTheRecording) {
  Send(kState1, 0);
  EXPECT_THAT(
      [&] { window_.CheckSequence(kState1, 3); },
      ThrowsMessage<std::runtime_error>("the recording is not complete: /agent_1/state: sample 3 came after sample 1"));
  EXPECT_EQ(window_.lost(), 1u);
}

TEST_F(RowWindowTest, ASampleThatComesTwiceFailsTheRecording) {
  Send(kCommand2, 0);
  EXPECT_THAT([&] { window_.CheckSequence(kCommand2, 1); },
              ThrowsMessage<std::runtime_error>(
                  "the recording is not complete: /agent_2/command: sample 1 came after sample 1"));
}

TEST_F(RowWindowTest, ATickThatComesTwiceFailsTheRecording) {
  SendTick(0);
  ASSERT_TRUE(Next());
  Send(kCommand2, 1);
  EXPECT_THAT([&] { Send(kCommand2, 1); },
              ThrowsMessage<std::runtime_error>("the recording is not complete: /agent_2/command: tick 1 came twice"));
  Send(kState1, 2);
  EXPECT_THAT([&] { Send(kState1, 2); },
              ThrowsMessage<std::runtime_error>("the recording is not complete: /agent_1/state: tick 2 came twice"));
}

TEST_F(RowWindowTest, TheLastTickOfTheWindowIsTakenAndTheNextOneFails) {
  EXPECT_NO_THROW(Send(kState1, 15));
  EXPECT_THAT([&] { Send(kState1, 16); },
              ThrowsMessage<std::runtime_error>("the recorder was overrun: tick 16 came while tick 0 was not written"));
}

TEST_F(RowWindowTest, ASampleWhoseRowWasTakenIsLost) {
  SendTick(0);
  ASSERT_TRUE(Next());
  EXPECT_FALSE(Send(kCommand1, 0));
  EXPECT_EQ(window_.lost(), 1u);
}

TEST_F(RowWindowTest, ASampleOfANegativeTickIsLost) {
  EXPECT_FALSE(Send(kCommand1, -1));
  EXPECT_EQ(window_.lost(), 1u);
  EXPECT_EQ(window_.newest_tick(), -1);
}

// --- real time ----------------------------------------------------------------------------------------

TEST_F(RealtimeRowWindowTest, ARowWithoutACommandIsReadyAfterThePatience) {
  for (const std::size_t topic : {kClock, kState1, kState2, kCommand2}) Send(topic, 0);
  for (std::int64_t tick = 1; tick < 8; ++tick) {
    EXPECT_FALSE(SendTick(tick) && tick < 4);
    EXPECT_FALSE(Next()) << tick;
  }
  EXPECT_TRUE(Send(kClock, 8)) << "worth looking";
  ASSERT_TRUE(Next());
  EXPECT_TRUE(row_.commands[0].empty());
  EXPECT_FALSE(row_.commands[1].empty());
}

TEST_F(RealtimeRowWindowTest, AtTheEndARowWithoutACommandIsReadyAtOnce) {
  for (const std::size_t topic : {kClock, kState1, kState2}) Send(topic, 0);
  EXPECT_FALSE(Next());
  ASSERT_TRUE(Next(/*give_up=*/true));
  EXPECT_TRUE(row_.commands[0].empty());
}

TEST_F(RealtimeRowWindowTest, ARowWithoutAStateIsNeverReady) {
  for (const std::size_t topic : {kClock, kState1, kCommand1, kCommand2}) Send(topic, 0);
  EXPECT_FALSE(Next(/*give_up=*/true));
}

TEST_F(RealtimeRowWindowTest, CommandsThatWereOverwrittenAreCountedAndStatesMayNotBe) {
  Send(kCommand1, 0);
  EXPECT_NO_THROW(window_.CheckSequence(kCommand1, 4));
  EXPECT_EQ(window_.lost(), 2u);
  Send(kState1, 0);
  EXPECT_THROW(window_.CheckSequence(kState1, 3), std::runtime_error);
}

TEST_F(RealtimeRowWindowTest, ACommandIsNotTakenForAnotherTicks) {
  SendTick(0);
  ASSERT_TRUE(Next());
  for (std::int64_t tick = 1; tick < 40; ++tick) {  // all slots are used again, with what rows left in them
    for (const std::size_t topic : {kClock, kState1, kState2}) Send(topic, tick);
    ASSERT_TRUE(Next(/*give_up=*/true));
    EXPECT_EQ(row_.tick, tick);
    EXPECT_TRUE(row_.commands[0].empty()) << tick;
  }
}

// --- agents that are lost -------------------------------------------------------------------------------

class LostAgentsTest : public RowWindowTest {
 protected:
  explicit LostAgentsTest(bool doubts = false) : RowWindowTest(/*realtime=*/false, doubts) {}

  /// Event number `number`: agent 2 is lost at `tick`, or comes back.
  void Lose(std::int64_t tick, int number, bool unanswered = false) {
    window_.TakeEvent({.tick = tick, .fault = Fault{.agent = 2, .unanswered = unanswered}}, kBytes, number);
  }
  void Restart(std::int64_t tick, int number) { window_.TakeEvent({.tick = tick, .restart = 2}, kBytes, number); }
  void SendAllBut(std::size_t left_out, std::int64_t tick, std::int64_t events = 0) {
    for (std::size_t topic = 0; topic < sent_.size(); ++topic)
      if (topic != left_out) SendWith(topic, tick, events);
  }
  void SendWith(std::size_t topic, std::int64_t tick, std::int64_t events) {
    window_.CheckSequence(topic, ++sent_[topic]);
    window_.Take(topic, tick, std::vector<std::uint8_t>{1}, topic == kState1 || topic == kState2 ? events : 0);
  }
  const std::vector<std::uint8_t> kBytes{7};
};

TEST_F(LostAgentsTest, RowsLackTheirCommandsUntilTheyComeBack) {
  SendTick(0);
  ASSERT_TRUE(Next());
  SendAllBut(kCommand2, 1, 1);
  EXPECT_FALSE(Next()) << "the event has not come";
  Lose(1, 1);
  EXPECT_TRUE(window_.IsLost(2));
  ASSERT_TRUE(Next());
  EXPECT_TRUE(row_.commands[1].empty());
  EXPECT_FALSE(row_.commands[0].empty());
  EXPECT_EQ(row_.events.size(), 1U);
  Restart(2, 2);
  EXPECT_FALSE(window_.IsLost(2));
  SendAllBut(kCommand2, 2, 2);
  EXPECT_FALSE(Next());
  SendWith(kCommand2, 2, 0);
  ASSERT_TRUE(Next());
  EXPECT_FALSE(row_.commands[1].empty());
}

TEST_F(LostAgentsTest, ARowMayWaitForTheEventOfTheNextTick) {
  SendAllBut(kCommand2, 0);
  EXPECT_FALSE(Next());
  Lose(1, 1, /*unanswered=*/true);
  ASSERT_TRUE(Next());
  EXPECT_TRUE(row_.commands[1].empty());
}

/// Agents may be lost in reality.
class DoubtfulAgentsTest : public LostAgentsTest {
 protected:
  DoubtfulAgentsTest() : LostAgentsTest(/*doubts=*/true) {}
};

TEST_F(DoubtfulAgentsTest, WhatComesTooLateIsLeftOut) {
  SendTick(0);
  EXPECT_FALSE(Next()) << "it may be that this command has not reached the server";
  Lose(1, 1, /*unanswered=*/true);
  SendAllBut(kCommand2, 1, 1);
  ASSERT_TRUE(Next());
  EXPECT_TRUE(row_.commands[1].empty());
}

TEST_F(DoubtfulAgentsTest, ARowWaitsForTheStatesOfTheNextTick) {
  SendTick(0);
  EXPECT_FALSE(Next());
  EXPECT_FALSE(Next());
  SendAllBut(kCommand2, 1);
  ASSERT_TRUE(Next());
  EXPECT_FALSE(row_.commands[1].empty());
}

TEST_F(DoubtfulAgentsTest, TheLastRowWaitsForNothing) {
  for (std::int64_t tick = 0; tick < kLastTick; ++tick) {
    SendTick(tick);
    EXPECT_EQ(Next(), tick > 0);
  }
  SendTick(kLastTick);
  EXPECT_TRUE(Next());
  EXPECT_TRUE(Next());
}

TEST_F(DoubtfulAgentsTest, RowsWaitForNothingOnceTheServerHasToldItsLastTick) {
  SendTick(0);
  EXPECT_FALSE(Next());
  window_.Settle();
  EXPECT_TRUE(Next());
}

TEST_F(LostAgentsTest, WhatARowWaitsForIsNamed) {
  EXPECT_EQ(window_.Lacking(), "") << "for its tick";
  SendAllBut(kCommand2, 0);
  EXPECT_EQ(window_.Lacking(), "/agent_2/command of tick 0");
  Lose(1, 1);
  EXPECT_EQ(window_.Lacking(), "/agent_2/command of tick 0") << "it has answered that tick";
  Send(kCommand2, 0);
  EXPECT_EQ(window_.Lacking(), "");
  ASSERT_TRUE(Next());
  SendAllBut(kCommand2, 1);
  EXPECT_EQ(window_.Lacking(), "") << "it is lost";
}

TEST_F(LostAgentsTest, ARowThatWasTakenWithAnAnswerThatTheServerLacksIsAnError) {
  SendTick(0);
  ASSERT_TRUE(Next());
  EXPECT_THAT([&] { Lose(1, 1, /*unanswered=*/true); },
              ThrowsMessage<std::runtime_error>("the recording is not complete: it has a command of agent 2 at tick 0, "
                                                "which has not reached the physics server"));
}

// --- actions --------------------------------------------------------------------------------------------

/// Both agents take actions.
class ActionsWindowTest : public testing::Test {
 protected:
  enum : std::size_t { kAction1 = 5, kAction2 = 6 };
  static RowWindow::Rules WithActions(bool realtime) {
    RowWindow::Rules rules = Rules(realtime);
    rules.topics.insert(rules.topics.end(), {Topic::Action(1), Topic::Action(2)});
    return rules;
  }
  /// Whether the loop is to be woken by one of these samples.
  static bool Send(RowWindow& window, std::int64_t tick, const std::vector<std::size_t>& topics,
                   std::int64_t events = 0) {
    bool wake = false;
    for (const std::size_t topic : topics)
      wake |= window.Take(topic, tick, std::vector<std::uint8_t>{static_cast<std::uint8_t>(topic)},
                          topic == kState1 ? events : 0);
    return wake;
  }
  static const std::vector<std::size_t> kStates;
  RowWindow window_{WithActions(false)}, realtime_{WithActions(true)};
  Row row_{2};
};
const std::vector<std::size_t> ActionsWindowTest::kStates{kClock, kState1, kState2};

TEST_F(ActionsWindowTest, AreDueWithAllStatesOfTheTickAndItsEvents) {
  EXPECT_FALSE(Send(window_, 0, {kClock, kState1}));
  EXPECT_FALSE(window_.HasStates(0));
  EXPECT_TRUE(Send(window_, 0, {kState2}));
  EXPECT_TRUE(window_.HasStates(0));
  EXPECT_FALSE(window_.HasStates(1));
  EXPECT_FALSE(Send(window_, 1, kStates, /*events=*/1));
  EXPECT_FALSE(window_.HasStates(1));
  EXPECT_TRUE(window_.TakeEvent({.tick = 1}, std::vector<std::uint8_t>{7}, 1));
  EXPECT_TRUE(window_.HasStates(1));
}

TEST_F(ActionsWindowTest, ARowHasThemAndWaitsUntilAllAreTaken) {
  Send(window_, 0, kStates);
  Send(window_, 0, {kAction1, kAction2, kCommand1, kCommand2});
  EXPECT_FALSE(window_.Next(false, row_));
  window_.EndActions(0);
  ASSERT_TRUE(window_.Next(false, row_));
  EXPECT_EQ(row_.actions[0], (Row::Bytes{kAction1}));
  EXPECT_EQ(row_.actions[1], (Row::Bytes{kAction2}));
}

TEST_F(ActionsWindowTest, OfAnAgentThatIsLostAreLeftOut) {
  Send(window_, 0, kStates);
  Send(window_, 0, {kAction1, kAction2, kCommand1});
  window_.EndActions(0);
  EXPECT_FALSE(window_.Next(false, row_));
  window_.TakeEvent({.tick = 1, .fault = Fault{.agent = 2, .unanswered = true}}, std::vector<std::uint8_t>{7}, 1);
  EXPECT_TRUE(window_.IsSilent(Topic::Action(2), 1));
  ASSERT_TRUE(window_.Next(false, row_));
  EXPECT_FALSE(row_.actions[0].empty());
  EXPECT_TRUE(row_.actions[1].empty());
}

TEST_F(ActionsWindowTest, InRealTimeThatWereNotAnsweredAreLeftOut) {
  Send(realtime_, 0, kStates);
  Send(realtime_, 0, {kAction1, kAction2, kCommand1});
  realtime_.EndActions(0);
  ASSERT_TRUE(realtime_.Next(/*give_up=*/true, row_));
  EXPECT_FALSE(row_.actions[0].empty());
  EXPECT_TRUE(row_.actions[1].empty());
}

}  // namespace
}  // namespace mascot
