#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "orchestrator/searching/tuner.h"

namespace mascot {
namespace {

using Values = std::vector<std::optional<double>>;

TEST(Judged, IsTheMeanMedianOrWorstOfTheSeeds) {
  const Values values{4.0, 1.0, 10.0};
  EXPECT_EQ(Judged(values, OverSeeds::kMean, false), 5.0);
  EXPECT_EQ(Judged(values, OverSeeds::kMedian, false), 4.0);
  EXPECT_EQ(Judged(values, OverSeeds::kWorst, false), 10.0);
  EXPECT_EQ(Judged(values, OverSeeds::kWorst, true), 1.0) << "where the figure shall be largest";
  EXPECT_EQ(Judged({4.0, 1.0, 10.0, 2.0}, OverSeeds::kMedian, true), 3.0) << "half-way between the middle ones";
}

TEST(Judged, TakesARunWithoutAValueForWorseThanAnyOther) {
  for (const bool maximize : {false, true}) {
    EXPECT_EQ(Judged({1.0, std::nullopt, 3.0}, OverSeeds::kMean, maximize), std::nullopt);
    EXPECT_EQ(Judged({1.0, std::nullopt, 3.0}, OverSeeds::kWorst, maximize), std::nullopt);
    EXPECT_EQ(Judged({1.0, std::nullopt, 3.0}, OverSeeds::kMedian, maximize), maximize ? 1.0 : 3.0);
    EXPECT_EQ(Judged({1.0, std::nullopt}, OverSeeds::kMedian, maximize), std::nullopt);
  }
}

}  // namespace
}  // namespace mascot
