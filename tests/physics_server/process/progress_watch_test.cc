#include "physics_server/process/progress_watch.h"

#include <gtest/gtest.h>

#include "tests/support/made_up_time.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;

TEST(ProgressWatch, AllowsTheLimitAndNoMore) {
  ProgressWatch watch(5s);
  EXPECT_FALSE(watch.IsOverdue(0, kT0));
  EXPECT_FALSE(watch.IsOverdue(0, kT0 + 5s));
  EXPECT_TRUE(watch.IsOverdue(0, kT0 + 5s + 1ns));
}

TEST(ProgressWatch, CountsFromTheFirstLook) {
  ProgressWatch watch(5s);
  EXPECT_FALSE(watch.IsOverdue(-1, kT0 + 1h)) << "nobody looked before";
  EXPECT_FALSE(watch.IsOverdue(-1, kT0 + 1h + 5s));
  EXPECT_TRUE(watch.IsOverdue(-1, kT0 + 1h + 6s));
}

TEST(ProgressWatch, StartsAgainWithEveryChange) {
  ProgressWatch watch(5s);
  watch.IsOverdue(0, kT0);
  EXPECT_FALSE(watch.IsOverdue(1, kT0 + 4s));
  EXPECT_FALSE(watch.IsOverdue(1, kT0 + 9s));
  EXPECT_TRUE(watch.IsOverdue(1, kT0 + 9s + 1ns));
  EXPECT_FALSE(watch.IsOverdue(0, kT0 + 10s)) << "back is a change, too";
  EXPECT_FALSE(watch.IsOverdue(0, kT0 + 15s));
}

TEST(ProgressWatch, ARestDoesNotCount) {
  ProgressWatch watch(5s);
  watch.IsOverdue(0, kT0);
  watch.Rest();
  EXPECT_FALSE(watch.IsOverdue(0, kT0 + 1h));
  EXPECT_TRUE(watch.IsOverdue(0, kT0 + 1h + 6s));
}

TEST(ProgressWatch, AddsTheGraceOfTheLookToTheLimit) {
  ProgressWatch watch(5s);
  watch.IsOverdue(7, kT0);
  EXPECT_FALSE(watch.IsOverdue(7, kT0 + 15s, 10s));
  EXPECT_TRUE(watch.IsOverdue(7, kT0 + 15s + 1ns, 10s));
  EXPECT_TRUE(watch.IsOverdue(7, kT0 + 6s)) << "the next look has no grace";
}

}  // namespace
}  // namespace mascot
