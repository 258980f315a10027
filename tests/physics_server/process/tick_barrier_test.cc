#include "physics_server/process/tick_barrier.h"

#include <gmock/gmock.h>

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(TickBarrier, WaitsForEveryAgent) {
  TickBarrier barrier(3);
  barrier.Open(0);
  EXPECT_FALSE(barrier.Answer(2, 0));
  EXPECT_FALSE(barrier.Answer(1, 0));
  EXPECT_THAT(barrier.Late(), Not(IsEmpty()));
  EXPECT_TRUE(barrier.Answer(3, 0));
  EXPECT_THAT(barrier.Late(), IsEmpty());
}

TEST(TickBarrier, NamesTheAgentsThatAreLate) {
  TickBarrier barrier(4);
  barrier.Open(7);
  EXPECT_THAT(barrier.Late(), ElementsAre(1, 2, 3, 4));
  barrier.Answer(2, 7);
  barrier.Answer(4, 7);
  EXPECT_THAT(barrier.Late(), ElementsAre(1, 3));
  barrier.Answer(1, 7);
  barrier.Answer(3, 7);
  EXPECT_THAT(barrier.Late(), IsEmpty());
}

TEST(TickBarrier, IgnoresASecondAnswer) {
  TickBarrier barrier(2);
  barrier.Open(0);
  EXPECT_FALSE(barrier.Answer(1, 0));
  EXPECT_FALSE(barrier.Answer(1, 0));
  EXPECT_THAT(barrier.Late(), Not(IsEmpty()));
  EXPECT_TRUE(barrier.Answer(2, 0));
  EXPECT_FALSE(barrier.Answer(2, 0)) << "the tick is announced complete once";
}

TEST(TickBarrier, IgnoresAnAnswerToAnotherTick) {
  TickBarrier barrier(1);
  barrier.Open(5);
  EXPECT_FALSE(barrier.Answer(1, 4));
  EXPECT_FALSE(barrier.Answer(1, 6));
  EXPECT_THAT(barrier.Late(), ElementsAre(1));
  EXPECT_TRUE(barrier.Answer(1, 5)) << "a wrong answer does not stand in for the right one";
}

TEST(TickBarrier, WaitsAgainForEveryAgentWhenTheNextTickOpens) {
  TickBarrier barrier(2);
  for (std::int64_t tick = 0; tick < 3; ++tick) {
    barrier.Open(tick);
    EXPECT_THAT(barrier.Late(), ElementsAre(1, 2));
    EXPECT_FALSE(barrier.Answer(1, tick));
    EXPECT_TRUE(barrier.Answer(2, tick));
  }
}

TEST(TickBarrier, DoesNotWaitForAgentsThatAreExcluded) {
  TickBarrier barrier(3);
  barrier.Open(0);
  barrier.Exclude(2);
  barrier.Exclude(2);
  EXPECT_TRUE(barrier.Excludes(2));
  EXPECT_THAT(barrier.Late(), ElementsAre(1, 3));
  EXPECT_FALSE(barrier.Answer(2, 0)) << "its answers do not count";
  EXPECT_FALSE(barrier.Answer(1, 0));
  EXPECT_TRUE(barrier.Answer(3, 0));
  barrier.Open(1);
  EXPECT_FALSE(barrier.Answer(1, 1));
  EXPECT_FALSE(barrier.IsComplete());
  barrier.Exclude(3);
  EXPECT_TRUE(barrier.IsComplete());
  barrier.Include(2);
  barrier.Open(2);
  EXPECT_FALSE(barrier.Answer(1, 2));
  EXPECT_TRUE(barrier.Answer(2, 2));
}

TEST(TickBarrier, AnAgentThatAnsweredBeforeItWasExcludedHasAnswered) {
  TickBarrier barrier(2);
  barrier.Open(0);
  EXPECT_FALSE(barrier.Answer(1, 0));
  barrier.Exclude(1);
  EXPECT_FALSE(barrier.IsComplete());
  EXPECT_TRUE(barrier.Answer(2, 0));
}

}  // namespace
}  // namespace mascot
