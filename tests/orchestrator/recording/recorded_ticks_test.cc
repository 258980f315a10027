#include "orchestrator/recording/recorded_ticks.h"

#include <gmock/gmock.h>

#include <vector>

namespace mascot {
namespace {

std::vector<std::int64_t> All(const RecordedTicks& ticks) {
  std::vector<std::int64_t> all;
  for (std::int64_t row = 0; row < ticks.rows(); ++row) all.push_back(ticks.TickOf(row));
  return all;
}

TEST(RecordedTicks, AreEveryNthAndTheLast) {
  EXPECT_THAT(All({7, 1}), testing::ElementsAre(0, 1, 2, 3, 4, 5, 6));
  EXPECT_THAT(All({7, 3}), testing::ElementsAre(0, 3, 6));
  EXPECT_THAT(All({9, 3}), testing::ElementsAre(0, 3, 6, 8));
  EXPECT_THAT(All({2, 3}), testing::ElementsAre(0, 1));
  EXPECT_THAT(All({1, 3}), testing::ElementsAre(0));
  EXPECT_THAT(All({0, 3}), testing::ElementsAre());
}

TEST(RecordedTicks, FindTheRowOfEachTick) {
  for (const std::int64_t count : {1, 2, 3, 7, 8, 9, 10})
    for (const std::int64_t every : {1, 3, 4, 20}) {
      const RecordedTicks ticks(count, every);
      const std::vector<std::int64_t> all = All(ticks);
      for (std::int64_t tick = 0; tick < count; ++tick) {
        const auto after = std::ranges::upper_bound(all, tick);
        EXPECT_EQ(ticks.TickOf(ticks.RowAt(tick)), *(after - 1)) << tick << " of " << count << ", every " << every;
        EXPECT_EQ(ticks.Has(tick), *(after - 1) == tick) << tick << " of " << count << ", every " << every;
        EXPECT_EQ(ticks.TickAfter(tick), after == all.end() ? count : *after) << tick << " of " << count;
      }
      EXPECT_EQ(ticks.last(), count - 1);
      EXPECT_FALSE(ticks.Has(count));
    }
}

}  // namespace
}  // namespace mascot
