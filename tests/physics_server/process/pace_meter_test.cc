#include "physics_server/process/pace_meter.h"

#include <gmock/gmock.h>

namespace mascot {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;

TEST(PaceMeter, KnowsNothingBeforeTheFirstTick) {
  const Pacing pacing = PaceMeter(100).Result();
  EXPECT_EQ(pacing.misses, 0u);
  EXPECT_THAT(pacing.tick_lateness_s, ElementsAre(0, 0, 0));
  EXPECT_THAT(pacing.command_age_s, ElementsAre(0, 0, 0));
}

TEST(PaceMeter, GivesMedian99thPercentileAndLargest) {
  PaceMeter meter(100);
  for (int i = 1000; i >= 1; --i) meter.AddTick(i * 1e-6);
  EXPECT_THAT(meter.Result().tick_lateness_s, ElementsAre(DoubleNear(500e-6, 3e-6), DoubleNear(990e-6, 6e-6), 1000e-6));
}

TEST(PaceMeter, CountsCommandsThatWereHeldAndHowLong) {
  PaceMeter meter(100);
  for (int i = 0; i < 97; ++i) meter.AddCommand(1, i, 0);
  for (const int age : {1, 2, 7}) meter.AddCommand(2, 97, age);
  const Pacing pacing = meter.Result();
  EXPECT_EQ(pacing.misses, 3u);
  EXPECT_THAT(pacing.command_age_s, ElementsAre(0, 0.02, 0.07));
}

TEST(PaceMeter, TellsWhoseCommandsWereLateAndWhen) {
  PaceMeter meter(100);
  for (const int tick : {10, 11, 60, 200}) meter.AddCommand(3, tick, 1);  // 50 ticks are 0.5 s
  meter.AddCommand(1, 20, 4);
  const std::vector<LateCommands> late = meter.Result().late;
  ASSERT_EQ(late.size(), 3u);
  const auto is = [&](std::size_t k, int agent, std::int64_t from, std::int64_t to, std::int64_t count) {
    EXPECT_EQ(late[k].agent, agent);
    EXPECT_EQ(late[k].ticks.from, from);
    EXPECT_EQ(late[k].ticks.to, to);
    EXPECT_EQ(late[k].ticks.count, count);
  };
  is(0, 3, 10, 60, 3);
  is(1, 1, 20, 20, 1);
  is(2, 3, 200, 200, 1);
}

TEST(PaceMeter, TellsOfTheFirstLateCommandsOnly) {
  PaceMeter meter(100);
  for (int k = 0; k < 1000; ++k) meter.AddCommand(1, 51 * k, 1);
  EXPECT_EQ(meter.Result().late.size(), kMaxLatesTold);
  EXPECT_EQ(meter.Result().misses, 1000u);
}

}  // namespace
}  // namespace mascot
