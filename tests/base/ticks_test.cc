#include "base/ticks.h"

#include <gtest/gtest.h>

namespace mascot {
namespace {

TEST(Ticks, AreRoundedUpOrDownButForRoundingErrors) {
  EXPECT_EQ(TicksRoundedUp(0.021, 100), 3);
  EXPECT_EQ(TicksRoundedDown(0.029, 100), 2);
  EXPECT_EQ(TicksRoundedUp(0.07, 100), 7) << "0.07 * 100 is a little more than 7";
  EXPECT_EQ(TicksRoundedDown(0.29, 100), 29) << "0.29 * 100 is a little less than 29";
  EXPECT_EQ(TicksRoundedUp(0, 100), 0);
}

TEST(Ticks, OfAPeriodAreAtLeastOne) {
  EXPECT_EQ(PeriodInTicks(0.5, 100), 50);
  EXPECT_EQ(PeriodInTicks(0.021, 100), 3);
  EXPECT_EQ(PeriodInTicks(0.01, 100), 1);
  EXPECT_EQ(PeriodInTicks(0.001, 100), 1);
  EXPECT_EQ(PeriodInTicks(0, 100), 1) << "of a fault without a period";
}

}  // namespace
}  // namespace mascot
