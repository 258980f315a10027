#include "physics_server/timetable.h"

#include <gtest/gtest.h>

#include "tests/made_up_time.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;

TEST(Timetable, HasATickEveryPeriod) {
  const Timetable timetable(0.01, kStart);
  EXPECT_EQ(timetable.Due(0), kStart);
  EXPECT_EQ(timetable.Due(1), kStart + 10ms);
  EXPECT_EQ(timetable.Due(250), kStart + 2500ms);
}

TEST(Timetable, DoesNotAccumulateRoundingErrors) {
  const Timetable timetable(1.0 / 3, kStart);
  EXPECT_EQ(timetable.Due(1), kStart + 333333333ns);
  EXPECT_EQ(timetable.Due(3'000'000), kStart + 1'000'000s);
}

TEST(Timetable, StaysWhenATickIsLateByAPeriodOrLess) {
  Timetable timetable(0.01, kStart);
  timetable.OnTick(1, kStart + 10ms);
  timetable.OnTick(2, kStart + 25ms);
  timetable.OnTick(3, kStart + 40ms);
  EXPECT_EQ(timetable.Due(4), kStart + 40ms) << "that is made up for";
}

TEST(Timetable, MovesByAllOfADelayOfMoreThanAPeriod) {
  Timetable timetable(0.01, kStart);
  timetable.OnTick(1, kStart + 20ms + 1ns);
  EXPECT_EQ(timetable.Due(2), kStart + 30ms + 1ns) << "a whole period after tick 1 came";
  timetable.OnTick(2, kStart + 30ms + 1ns);
  EXPECT_EQ(timetable.Due(3), kStart + 40ms + 1ns) << "and not again for the same delay";
}

TEST(Timetable, FallsBehindByAsMuchAtEveryTickThatIsTooLate) {
  Timetable timetable(0.01, kStart);
  for (std::int64_t tick = 1; tick <= 100; ++tick) timetable.OnTick(tick, kStart + tick * 30ms);
  EXPECT_EQ(timetable.Due(101), kStart + 100 * 30ms + 10ms);
}

}  // namespace
}  // namespace mascot
