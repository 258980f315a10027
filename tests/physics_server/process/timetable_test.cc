#include "physics_server/process/timetable.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/made_up_time.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;

TEST(Timetable, HasATickEveryPeriod) {
  const Timetable timetable(0.01, kT0);
  EXPECT_EQ(timetable.Due(0), kT0);
  EXPECT_EQ(timetable.Due(1), kT0 + 10ms);
  EXPECT_EQ(timetable.Due(250), kT0 + 2500ms);
}

TEST(Timetable, DoesNotAccumulateRoundingErrors) {
  const Timetable timetable(1.0 / 3, kT0);
  EXPECT_EQ(timetable.Due(1), kT0 + 333333333ns);
  EXPECT_EQ(timetable.Due(3'000'000), kT0 + 1'000'000s);
}

TEST(Timetable, HasNoTickButTheFirstIfThePeriodIsForEver) {
  for (const double period_s : {1e12, 1e300, std::numeric_limits<double>::infinity()}) {
    const Timetable timetable(period_s, kT0);
    EXPECT_EQ(timetable.Due(0), kT0);
    EXPECT_GT(timetable.Due(1), kT0 + 24h * 365);
    EXPECT_GT(timetable.Due(1'000'000), kT0 + 24h * 365);
  }
}

TEST(Timetable, StaysWhenATickIsLateByAPeriodOrLess) {
  Timetable timetable(0.01, kT0);
  timetable.OnTick(1, kT0 + 10ms);
  timetable.OnTick(2, kT0 + 25ms);
  timetable.OnTick(3, kT0 + 40ms);
  EXPECT_EQ(timetable.Due(4), kT0 + 40ms) << "that is made up for";
}

TEST(Timetable, MovesByAllOfADelayOfMoreThanAPeriod) {
  Timetable timetable(0.01, kT0);
  timetable.OnTick(1, kT0 + 20ms + 1ns);
  EXPECT_EQ(timetable.Due(2), kT0 + 30ms + 1ns) << "a whole period after tick 1 came";
  timetable.OnTick(2, kT0 + 30ms + 1ns);
  EXPECT_EQ(timetable.Due(3), kT0 + 40ms + 1ns) << "and not again for the same delay";
}

TEST(Timetable, FallsBehindByAsMuchAtEveryTickThatIsTooLate) {
  Timetable timetable(0.01, kT0);
  for (std::int64_t tick = 1; tick <= 100; ++tick) timetable.OnTick(tick, kT0 + tick * 30ms);
  EXPECT_EQ(timetable.Due(101), kT0 + 100 * 30ms + 10ms);
}

}  // namespace
}  // namespace mascot
