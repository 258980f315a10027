#include "physics_server/pace_meter.h"

#include <gmock/gmock.h>

namespace mascot {
namespace {

using ::testing::ElementsAre;

TEST(PaceMeter, KnowsNothingBeforeTheFirstTick) {
  const Pacing pacing = PaceMeter().Result(0.01);
  EXPECT_EQ(pacing.misses, 0u);
  EXPECT_THAT(pacing.tick_lateness_s, ElementsAre(0, 0, 0));
  EXPECT_THAT(pacing.command_age_s, ElementsAre(0, 0, 0));
}

TEST(PaceMeter, GivesMedian99thPercentileAndLargest) {
  PaceMeter meter;
  for (int i = 1000; i >= 1; --i) meter.AddTick(i * 1e-6);
  EXPECT_THAT(meter.Result(0.01).tick_lateness_s, ElementsAre(500e-6, 990e-6, 1000e-6));
}

TEST(PaceMeter, CountsCommandsThatWereHeldAndHowLong) {
  PaceMeter meter;
  for (int i = 0; i < 97; ++i) meter.AddCommand(0);
  for (const int age : {1, 2, 7}) meter.AddCommand(age);
  const Pacing pacing = meter.Result(0.01);
  EXPECT_EQ(pacing.misses, 3u);
  EXPECT_THAT(pacing.command_age_s, ElementsAre(0, 0.02, 0.07));
}

}  // namespace
}  // namespace mascot
