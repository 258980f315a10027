#include "base/number.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace mascot {
namespace {

TEST(Number, IsAllOfATextOrNothing) {
  EXPECT_EQ(NumberFrom<int>("-12"), -12);
  EXPECT_EQ(NumberFrom<double>("1.5e3"), 1500);
  for (const char* text : {"", " 1", "1 ", "+1", "1x", "x", "0x1", "1,5"}) {
    EXPECT_FALSE(NumberFrom<int>(text)) << text;
    EXPECT_FALSE(NumberFrom<double>(text)) << text;
  }
}

TEST(Number, FitsItsType) {
  EXPECT_EQ(NumberFrom<std::uint8_t>("255"), 255);
  EXPECT_FALSE(NumberFrom<std::uint8_t>("256"));
  EXPECT_FALSE(NumberFrom<std::uint8_t>("-1"));
  EXPECT_FALSE(NumberFrom<int>("1.0"));
  EXPECT_FALSE(NumberFrom<double>("1e999"));
  EXPECT_EQ(NumberFrom<double>("inf"), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace mascot
