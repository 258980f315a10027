#include "experiment/toml/utf8.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace mascot {
namespace {

TEST(Utf8, LeavesValidTextAsItIs) {
  for (const std::string text : {"", "abc\n\t", "\xC3\xBC", "\xE2\x82\xAC", "\xF0\x9F\x9A\x81", "\xEF\xBF\xBD",
                                 "\xED\x9F\xBF", "\xEE\x80\x80", "\xF4\x8F\xBF\xBF"})
    EXPECT_EQ(Utf8(text), text);
  EXPECT_EQ(Utf8(std::string("a\0b", 3)), std::string("a\0b", 3));
}

TEST(Utf8, ReplacesEachBrokenCharacterByOne) {
  const std::string r = "\xEF\xBF\xBD";
  EXPECT_EQ(Utf8("a\xFF"
                 "b"),
            "a" + r + "b");            // never in UTF-8
  EXPECT_EQ(Utf8("\x80\xBF"), r + r);  // continuations of nothing
  EXPECT_EQ(Utf8("\xC3"), r);          // cut
  EXPECT_EQ(Utf8("\xE2\x82"), r);      // cut
  EXPECT_EQ(Utf8("\xF0\x9F\x9A"
                 "x"),
            r + "x");                                  // cut by the next character
  EXPECT_EQ(Utf8("\xC3\xC3\xBC"), r + "\xC3\xBC");     // cut by the next character
  EXPECT_EQ(Utf8("\xC0\xAF"), r + r);                  // overlong '/'
  EXPECT_EQ(Utf8("\xE0\x80\xAF"), r + r + r);          // overlong '/'
  EXPECT_EQ(Utf8("\xED\xA0\x80"), r + r + r);          // a surrogate
  EXPECT_EQ(Utf8("\xF4\x90\x80\x80"), r + r + r + r);  // beyond U+10FFFF
  EXPECT_EQ(Utf8("Gr\xFC\xDF"
                 "e in Latin-1"),
            "Gr" + r + r + "e in Latin-1");
}

TEST(Utf8, WhateverTheBytesAreIsTextThatJsonTakes) {
  for (unsigned a = 0; a < 256; ++a)
    for (unsigned b = 0; b < 256; ++b)
      for (const std::string end : {"", "\x80", "\x9F\x80", "\xBF\xBF\xBF"}) {
        const std::string text = Utf8(std::string{static_cast<char>(a), static_cast<char>(b)} + end);
        ASSERT_NO_THROW(nlohmann::json(text).dump()) << a << " " << b;
        ASSERT_EQ(Utf8(text), text);
      }
}

TEST(Utf8, IsCutBetweenCharacters) {
  EXPECT_EQ(CutUtf8("abcdef", 6), "abcdef");
  EXPECT_EQ(CutUtf8("abcdef", 5), "abcde");
  EXPECT_EQ(CutUtf8("abc\xC3\xBC", 4), "abc");
  EXPECT_EQ(CutUtf8("abc\xC3\xBC", 5), "abc\xC3\xBC");
  EXPECT_EQ(CutUtf8("ab\xF0\x9F\x9A\x81", 5), "ab");
  EXPECT_EQ(CutUtf8("\x80\x80\x80\x80\x80\x80", 5).size(), 5u) << "no UTF-8: cut anywhere, but cut";
}

}  // namespace
}  // namespace mascot
