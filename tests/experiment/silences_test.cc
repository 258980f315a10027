#include "experiment/silences.h"

#include <gtest/gtest.h>

namespace mascot {
namespace {

Event Lost(int agent, std::int64_t tick, bool unanswered = false) {
  return {.tick = tick, .fault = Fault{.agent = agent, .unanswered = unanswered}};
}

TEST(Silences, LastFromTheLossToTheRestart) {
  Silences silences;
  EXPECT_TRUE(silences.empty());
  silences.Take(Lost(2, 10));
  silences.Take({.tick = 20, .restart = 2});
  silences.Take(Lost(2, 30, /*unanswered=*/true));
  EXPECT_FALSE(silences.empty());
  for (const auto& [tick, is_silent] :
       {std::pair(9, false), std::pair(10, true), std::pair(19, true), std::pair(20, false), std::pair(28, false),
        std::pair(29, true), std::pair(1000, true)})
    EXPECT_EQ(silences.Has(2, tick), is_silent) << tick;
  EXPECT_FALSE(silences.Has(1, 15));
}

TEST(Silences, ASecondLossChangesNothingAndARestartOfALivingAgentNeither) {
  Silences silences;
  silences.Take({.tick = 5, .restart = 1});
  silences.Take(Lost(1, 10));
  silences.Take(Lost(1, 15));
  silences.Take({.tick = 20, .restart = 1});
  EXPECT_FALSE(silences.Has(1, 5));
  EXPECT_TRUE(silences.Has(1, 12));
  EXPECT_FALSE(silences.Has(1, 20));
  silences.Take({.tick = 25, .fault = Fault{.agent = 1, .kind = FaultKind::kMute}});
  EXPECT_FALSE(silences.Has(1, 25)) << "it still answers";
}

}  // namespace
}  // namespace mascot
