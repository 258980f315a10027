#include "system/build.h"

#include <gmock/gmock.h>

namespace mascot {
namespace {

TEST(Build, IsToldFromOthersByWhatTheLinkerMadeOfIt) {
  EXPECT_THAT(BuildText(), testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+, build [0-9a-f]{16,64}"));
  EXPECT_EQ(BuildText(), BuildText());
}

}  // namespace
}  // namespace mascot
