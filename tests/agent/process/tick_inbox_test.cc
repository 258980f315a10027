#include "agent/process/tick_inbox.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Peer = TickInbox::Peer;

constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
constexpr bool kRealtime = true;

Motion At(double x) {
  Motion motion;
  motion.p_WB.x() = x;
  return motion;
}

/// Inbox of agent 1. Keeps the last complete tick for the checks of the tests.
class Inbox {
 public:
  explicit Inbox(const std::vector<Peer>& peers, bool realtime = false, bool takes_actions = false)
      : inbox_(1, peers, realtime, takes_actions) {}

  /// Passes the state of a source (0: the agent itself) at `tick`, at x. Returns the tick that is complete; -1: none.
  std::int64_t State(std::size_t source, std::int64_t tick, double x = 0) {
    return Keep(inbox_.OnState(source, tick, At(x)));
  }
  /// Passes a message with one number.
  std::int64_t Message(std::size_t source, std::int64_t tick, double number) {
    return Keep(inbox_.OnMessage(source, tick, std::vector<double>{number}));
  }

  /// Passes an action of one number.
  std::int64_t Action(std::int64_t tick, double number) {
    return Keep(inbox_.OnAction(tick, std::vector<double>{number}));
  }
  /// Passes event number 1, which takes effect at `tick`.
  std::int64_t Killed(int agent, std::int64_t tick, bool unanswered) {
    return Keep(inbox_.OnEvent(1, {.tick = tick, .fault = Fault{.agent = agent, .unanswered = unanswered}}));
  }

  // Contents of the last complete tick.
  double self_x() const { return complete_.value().self->p_WB.x(); }
  std::vector<double> xs() const {
    std::vector<double> xs;
    for (const Sample& sample : complete_.value().samples) xs.push_back(sample.motion->p_WB.x());
    return xs;
  }
  /// The message of a peer; peers count from 0.
  std::vector<double> message(std::size_t peer) const {
    const std::span<const double> data = complete_.value().samples[peer].message;
    return {data.begin(), data.end()};
  }
  std::vector<double> action() const {
    const std::span<const double> data = complete_.value().action;
    return {data.begin(), data.end()};
  }
  std::int64_t message_age(std::size_t peer) const { return complete_.value().samples[peer].message_age; }

 private:
  std::int64_t Keep(const std::optional<TickInbox::CompleteTick>& complete) {
    if (!complete) return -1;
    complete_ = complete;
    return complete->tick;
  }

  TickInbox inbox_;
  std::optional<TickInbox::CompleteTick> complete_;
};

const std::vector<Peer> kNobody = {}, kOne = {{.id = 2}}, kTwo = {{.id = 2}, {.id = 5}},
                        kTalker = {{.id = 2, .sends_messages = true}};

// --- states ---------------------------------------------------------------------------------------------

TEST(TickInbox, CompletesATickWithItsLastStateInWhateverOrderTheyCome) {
  Inbox inbox(kTwo);
  std::vector<std::size_t> order = {0, 1, 2};
  std::int64_t tick = 0;
  do {
    EXPECT_EQ(inbox.State(order[0], tick), -1);
    EXPECT_EQ(inbox.State(order[1], tick), -1);
    EXPECT_EQ(inbox.State(order[2], tick), tick);
    ++tick;
  } while (std::ranges::next_permutation(order).found);
  EXPECT_EQ(tick, 6);
}

TEST(TickInbox, GivesTheMotionsOfThatTickInTheOrderOfThePeers) {
  Inbox inbox(kTwo);
  inbox.State(2, 0, 5.0);
  inbox.State(0, 0, 1.0);
  ASSERT_EQ(inbox.State(1, 0, 2.0), 0);
  EXPECT_EQ(inbox.self_x(), 1.0);
  EXPECT_THAT(inbox.xs(), ElementsAre(2.0, 5.0));
  inbox.State(2, 1, 5.1);
  inbox.State(1, 1, 2.1);
  ASSERT_EQ(inbox.State(0, 1, 1.1), 1);
  EXPECT_EQ(inbox.self_x(), 1.1);
  EXPECT_THAT(inbox.xs(), ElementsAre(2.1, 5.1));
}

TEST(TickInbox, WaitsOnlyForItsOwnStateWithoutNeighbours) {
  Inbox inbox(kNobody);
  for (std::int64_t tick = 0; tick < 3; ++tick) EXPECT_EQ(inbox.State(0, tick), tick);
  EXPECT_THAT(inbox.xs(), IsEmpty());
}

TEST(TickInbox, CompletesATickOnceHoweverOftenItsStatesCome) {
  Inbox inbox(kTwo);
  for (const std::size_t source : {0, 1, 2}) inbox.State(source, 0);
  for (const std::size_t source : {0, 1, 2}) EXPECT_EQ(inbox.State(source, 0), -1) << source;
}

TEST(TickInbox, IgnoresADoubledState) {
  Inbox inbox(kTwo);
  inbox.State(0, 0, 1.0);
  inbox.State(1, 0, 2.0);
  EXPECT_EQ(inbox.State(1, 0, 99.0), -1) << "nor does it stand in for that of another";
  EXPECT_EQ(inbox.State(2, 0, 5.0), 0);
  EXPECT_THAT(inbox.xs(), ElementsAre(2.0, 5.0));
}

TEST(TickInbox, IgnoresALateState) {
  Inbox inbox(kTwo);
  for (const std::size_t source : {0, 1, 2}) inbox.State(source, 7);
  inbox.State(0, 8, 1.0);
  inbox.State(1, 8, 2.0);
  EXPECT_EQ(inbox.State(1, 7, 99.0), -1);
  EXPECT_EQ(inbox.State(0, 6, 99.0), -1);
  EXPECT_EQ(inbox.State(2, 8, 5.0), 8);
  EXPECT_EQ(inbox.self_x(), 1.0);
  EXPECT_THAT(inbox.xs(), ElementsAre(2.0, 5.0));
}

TEST(TickInbox, KeepsAStateOfALaterTickUntilItsTick) {
  Inbox inbox(kOne);
  EXPECT_EQ(inbox.State(1, 1, 2.1), -1);
  EXPECT_EQ(inbox.State(0, 0), -1) << "no state of tick 1 stands in for one of tick 0";
  EXPECT_EQ(inbox.State(0, 1), 1);
  EXPECT_THAT(inbox.xs(), ElementsAre(2.1));
}

TEST(TickInbox, IgnoresStatesOfInvalidTicks) {
  Inbox inbox(kOne);
  for (const std::int64_t tick : {std::int64_t{-1}, std::int64_t{-2}, kFirst})
    for (const std::size_t source : {0, 1}) EXPECT_EQ(inbox.State(source, tick), -1);
  inbox.State(0, 0);
  EXPECT_EQ(inbox.State(1, 0), 0);
}

// --- messages -------------------------------------------------------------------------------------------

TEST(TickInbox, WaitsInLockstepForTheMessageOfTheTickBefore) {
  Inbox inbox(kTalker);
  inbox.State(0, 0);
  EXPECT_EQ(inbox.State(1, 0), 0) << "nobody sent any before tick 0";
  EXPECT_THAT(inbox.message(0), IsEmpty());
  inbox.State(0, 1);
  EXPECT_EQ(inbox.State(1, 1), -1);
  EXPECT_EQ(inbox.Message(1, 0, 0.5), 1);
  EXPECT_THAT(inbox.message(0), ElementsAre(0.5));
  EXPECT_EQ(inbox.message_age(0), 1);
}

TEST(TickInbox, CompletesATickWithItsStatesIfTheMessageCameFirst) {
  Inbox inbox(kTalker);
  inbox.State(0, 0);
  inbox.State(1, 0);
  EXPECT_EQ(inbox.Message(1, 0, 0.5), -1);
  EXPECT_EQ(inbox.State(1, 1), -1);
  EXPECT_EQ(inbox.State(0, 1), 1);
  EXPECT_THAT(inbox.message(0), ElementsAre(0.5));
}

TEST(TickInbox, WaitsOnlyForMessagesOfAgentsThatSendThem) {
  Inbox inbox({{.id = 2}, {.id = 3, .sends_messages = true}, {.id = 4}});
  for (const std::size_t source : {0, 1, 2, 3}) inbox.State(source, 0);
  for (const std::size_t source : {0, 1, 2, 3}) EXPECT_EQ(inbox.State(source, 1), -1);
  EXPECT_EQ(inbox.Message(2, 0, 3.0), 1);
  EXPECT_THAT(inbox.message(0), IsEmpty());
  EXPECT_THAT(inbox.message(1), ElementsAre(3.0));
  EXPECT_THAT(inbox.message(2), IsEmpty());
}

TEST(TickInbox, KeepsTheMessageOfAPeerThatIsOneAnswerAhead) {
  Inbox inbox({{.id = 2, .sends_messages = true}, {.id = 3}});
  for (const std::size_t source : {0, 1, 2}) inbox.State(source, 0);
  inbox.Message(1, 0, 0.5);
  inbox.State(0, 1);
  inbox.State(1, 1);
  EXPECT_EQ(inbox.Message(1, 1, 1.5), -1) << "2 has answered tick 1 already";
  EXPECT_EQ(inbox.State(2, 1), 1);
  EXPECT_THAT(inbox.message(0), ElementsAre(0.5)) << "what it sent before tick 1";
  inbox.State(0, 2);
  inbox.State(2, 2);
  EXPECT_EQ(inbox.State(1, 2), 2);
  EXPECT_THAT(inbox.message(0), ElementsAre(1.5));
}

TEST(TickInbox, IgnoresADoubledAndALateMessage) {
  Inbox inbox(kTalker);
  for (std::int64_t tick = 0; tick <= 2; ++tick) {
    inbox.State(0, tick);
    inbox.State(1, tick);
    inbox.Message(1, tick, 0.5 + static_cast<double>(tick));
  }
  EXPECT_EQ(inbox.Message(1, 2, 99.0), -1) << "doubled";
  EXPECT_EQ(inbox.Message(1, 0, 99.0), -1) << "late, of the same parity";
  inbox.State(0, 3);
  EXPECT_EQ(inbox.State(1, 3), 3);
  EXPECT_THAT(inbox.message(0), ElementsAre(2.5));
  EXPECT_EQ(inbox.Message(1, 2, 99.0), -1) << "no tick is complete twice";
}

TEST(TickInbox, DoesNotAcceptAnotherMessageForTheAwaitedOneInLockstep) {
  Inbox inbox(kTalker);
  inbox.State(0, 5);
  inbox.State(1, 5);
  for (const std::int64_t tick : {2, 3, 5, 6}) EXPECT_EQ(inbox.Message(1, tick, 99.0), -1) << tick;
  Inbox other(kTalker);
  other.State(0, 5);
  other.State(1, 5);
  EXPECT_EQ(other.Message(1, 4, 4.5), 5);
}

TEST(TickInbox, CountsAnEmptyMessageAsAMessage) {
  TickInbox inbox(1, kTalker, /*realtime=*/false);
  inbox.OnState(0, 1, At(0));
  inbox.OnState(1, 1, At(0));
  const auto complete = inbox.OnMessage(1, 0, {});
  ASSERT_TRUE(complete);
  EXPECT_THAT(complete->samples[0].message, IsEmpty());
}

TEST(TickInbox, IgnoresMessagesOfInvalidTicks) {
  TickInbox inbox(1, kTalker, kRealtime);
  Motion slowing_down;
  slowing_down.a_WB = {-1, -2, -3};
  EXPECT_FALSE(inbox.OnState(1, 0, slowing_down));
  for (const std::int64_t tick : {std::int64_t{-1}, std::int64_t{-2}, std::int64_t{-3}, kFirst, kFirst + 1})
    EXPECT_FALSE(inbox.OnMessage(1, tick, {})) << tick;
  const auto complete = inbox.OnState(0, 0, Motion());
  ASSERT_TRUE(complete);
  EXPECT_EQ(complete->samples[0].motion->a_WB, slowing_down.a_WB) << "what lies before the messages";
  EXPECT_THAT(complete->samples[0].message, IsEmpty());
}

// --- real time ------------------------------------------------------------------------------------------

TEST(TickInbox, GoesOnInRealTimeWithoutAMessage) {
  Inbox inbox(kTalker, kRealtime);
  for (std::int64_t tick = 0; tick < 3; ++tick) {
    inbox.State(0, tick);
    EXPECT_EQ(inbox.State(1, tick), tick);
    EXPECT_THAT(inbox.message(0), IsEmpty());
  }
}

TEST(TickInbox, GivesTheLastMessageThatWasSentBeforeTheTickInRealTime) {
  Inbox inbox(kTalker, kRealtime);
  EXPECT_EQ(inbox.Message(1, 0, 0.5), -1);
  inbox.State(0, 4);
  EXPECT_EQ(inbox.State(1, 4), 4);
  EXPECT_THAT(inbox.message(0), ElementsAre(0.5)) << "ticks 1 to 3 were missed";
  EXPECT_EQ(inbox.message_age(0), 4);
  inbox.Message(1, 3, 3.5);
  inbox.Message(1, 6, 6.5);
  inbox.State(0, 5);
  EXPECT_EQ(inbox.State(1, 5), 5);
  EXPECT_THAT(inbox.message(0), ElementsAre(3.5)) << "what it sends at tick 6 is not known at tick 5";
  inbox.State(0, 6);
  EXPECT_EQ(inbox.State(1, 6), 6);
  EXPECT_THAT(inbox.message(0), ElementsAre(3.5)) << "nor at tick 6";
  EXPECT_EQ(inbox.message_age(0), 3);
  inbox.State(0, 7);
  EXPECT_EQ(inbox.State(1, 7), 7);
  EXPECT_THAT(inbox.message(0), ElementsAre(6.5));
}

TEST(TickInbox, DoesNotAnswerATickThatTheNextOneOvertookInRealTime) {
  Inbox inbox(kTwo, kRealtime);
  inbox.State(0, 0);
  inbox.State(1, 0);
  inbox.State(0, 1);
  EXPECT_EQ(inbox.State(2, 0), -1) << "the agent itself is at tick 1";
  EXPECT_EQ(inbox.State(1, 1), -1);
  EXPECT_EQ(inbox.State(2, 1), 1);
}

TEST(TickInbox, DoesNotAnswerWithStatesOfDifferentTicksInRealTime) {
  Inbox inbox(kTwo, kRealtime);
  inbox.State(0, 3);
  inbox.State(1, 4);
  EXPECT_EQ(inbox.State(2, 3), -1);
  inbox.State(2, 4);
  EXPECT_EQ(inbox.State(0, 4), 4);
}

// --- lost peers -----------------------------------------------------------------------------------------

TEST(TickInbox, WaitsForNoMessageOfAPeerThatIsLost) {
  for (const bool unanswered : {false, true}) {
    Inbox inbox({{.id = 2, .sends_messages = true}, {.id = 3, .sends_messages = true}});
    for (const std::size_t source : {0, 1}) inbox.State(source, 0);
    ASSERT_EQ(inbox.State(2, 0), 0);
    inbox.Message(2, 0, 0.5);
    for (const std::size_t source : {0, 1, 2}) inbox.State(source, 1);
    // Killed at tick 1: what it said with its answer to tick 0 comes, unless it has not answered that.
    EXPECT_EQ(inbox.Killed(2, 1, unanswered), unanswered ? 1 : -1);
    if (!unanswered) {
      EXPECT_EQ(inbox.Message(1, 0, 0.25), 1);
    }
    inbox.Message(2, 1, 0.5);
    for (const std::size_t source : {0, 1}) inbox.State(source, 2);
    EXPECT_EQ(inbox.State(2, 2), 2);
  }
}

// --- actions --------------------------------------------------------------------------------------------

TEST(TickInbox, ATickOfAnAgentThatTakesActionsWaitsForItsOwn) {
  for (const bool realtime : {false, kRealtime}) {
    Inbox inbox(kOne, realtime, /*takes_actions=*/true);
    inbox.State(0, 0);
    EXPECT_EQ(inbox.State(1, 0), -1);
    EXPECT_EQ(inbox.Action(0, 0.5), 0);
    EXPECT_THAT(inbox.action(), ElementsAre(0.5));
    EXPECT_EQ(inbox.Action(1, 1.5), -1) << "it may come first";
    EXPECT_EQ(inbox.Action(0, 9), -1) << "a late one is ignored";
    inbox.State(0, 1);
    EXPECT_EQ(inbox.State(1, 1), 1);
    EXPECT_THAT(inbox.action(), ElementsAre(1.5));
  }
}

TEST(TickInbox, InRealTimeATickWhoseActionIsLateIsMissed) {
  Inbox inbox(kNobody, kRealtime, /*takes_actions=*/true);
  EXPECT_EQ(inbox.State(0, 0), -1);
  EXPECT_EQ(inbox.State(0, 1), -1);
  EXPECT_EQ(inbox.Action(0, 0.5), -1);
  EXPECT_EQ(inbox.Action(1, 1.5), 1);
}

TEST(TickInbox, AnAgentThatIsLostIsGivenNoActions) {
  Inbox inbox(kNobody, false, /*takes_actions=*/true);
  inbox.Killed(1, 0, false);
  EXPECT_EQ(inbox.State(0, 0), 0);
}

}  // namespace
}  // namespace mascot
