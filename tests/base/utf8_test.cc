#include "base/utf8.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "experiment/toml/section.h"

namespace mascot {
namespace {

TEST(Utf8, LeavesPlainTextAsItIs) {
  for (const std::string text : {"", "abc\n\t", "\xC3\xBC", "\xE2\x82\xAC", "\xF0\x9F\x9A\x81", "\xEF\xBF\xBD",
                                 "\xED\x9F\xBF", "\xEE\x80\x80", "\xF4\x8F\xBF\xBF", "\xC2\xA0", "\u200d\u2010\u2027"})
    EXPECT_EQ(Plain(text), text);
}

TEST(Utf8, ReplacesEachBrokenCharacterByOne) {
  const std::string r = "\xEF\xBF\xBD";
  EXPECT_EQ(Plain("a\xFF"
                  "b"),
            "a" + r + "b");             // never in UTF-8
  EXPECT_EQ(Plain("\x80\xBF"), r + r);  // continuations of nothing
  EXPECT_EQ(Plain("\xC3"), r);          // cut
  EXPECT_EQ(Plain("\xE2\x82"), r);      // cut
  EXPECT_EQ(Plain("\xF0\x9F\x9A"
                  "x"),
            r + "x");                                   // cut by the next character
  EXPECT_EQ(Plain("\xC3\xC3\xBC"), r + "\xC3\xBC");     // cut by the next character
  EXPECT_EQ(Plain("\xC0\xAF"), r + r);                  // overlong '/'
  EXPECT_EQ(Plain("\xC0\x9B"), r + r);                  // overlong escape
  EXPECT_EQ(Plain("\xE0\x80\xAF"), r + r + r);          // overlong '/'
  EXPECT_EQ(Plain("\xED\xA0\x80"), r + r + r);          // a surrogate
  EXPECT_EQ(Plain("\xF4\x90\x80\x80"), r + r + r + r);  // beyond U+10FFFF
  EXPECT_EQ(Plain("\x9B[31m"), r + "[31m");             // the control sequence introducer of terminals with 8 bits
  EXPECT_EQ(Plain("Gr\xFC\xDF"
                  "e in Latin-1"),
            "Gr" + r + r + "e in Latin-1");
}

TEST(Utf8, EscapesWhatActsOnOtherTextAndNothingElse) {
  EXPECT_EQ(Plain("\x1b[31mred\x1b]0;title\x07"), "\\u001b[31mred\\u001b]0;title\\u0007");
  EXPECT_EQ(Plain("50 %\r100 %\b\x7f\x0b\x0c"), "50 %\\r100 %\\u0008\\u007f\\u000b\\u000c");
  EXPECT_EQ(Plain(std::string("a\0b", 3)), "a\\u0000b");
  EXPECT_EQ(PlainLine("a\n\tb\r\n"), "a\\n\\tb\\r\\n");
  const auto is_unfit = [](unsigned code) {
    return (code < 0x20 && code != '\n' && code != '\t') || (code >= 0x7f && code < 0xa0) || code == 0x061c ||
           code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
  };
  for (unsigned code = 0; code < 0x3000; ++code) {
    std::string text;
    if (code < 0x80) {
      text = {static_cast<char>(code)};
    } else if (code < 0x800) {
      text = {static_cast<char>(0xc0 | code >> 6), static_cast<char>(0x80 | (code & 0x3f))};
    } else {
      text = {static_cast<char>(0xe0 | code >> 12), static_cast<char>(0x80 | (code >> 6 & 0x3f)),
              static_cast<char>(0x80 | (code & 0x3f))};
    }
    if (!is_unfit(code))
      EXPECT_EQ(Plain(text), text) << code;
    else
      EXPECT_EQ(nlohmann::json::parse('"' + Plain(text) + '"'), text) << "JSON reads it back: " << code;
  }
}

TEST(Utf8, WhateverTheBytesAreIsTextThatJsonTakes) {
  for (unsigned a = 0; a < 256; ++a)
    for (unsigned b = 0; b < 256; ++b)
      for (const std::string end : {"", "\x80", "\x9F\x80", "\xBF\xBF\xBF"}) {
        const std::string text = Plain(std::string{static_cast<char>(a), static_cast<char>(b)} + end);
        ASSERT_NO_THROW(nlohmann::json(text).dump()) << a << " " << b;
        ASSERT_EQ(Plain(text), text);
      }
}

TEST(Utf8, KnowsWhichCharacterIsNotOver) {
  EXPECT_EQ(UnfinishedUtf8(""), 0u);
  EXPECT_EQ(UnfinishedUtf8("abc"), 0u);
  EXPECT_EQ(UnfinishedUtf8("abc\xC3"), 1u);
  EXPECT_EQ(UnfinishedUtf8("abc\xE2\x80"), 2u);
  EXPECT_EQ(UnfinishedUtf8("\xF0\x9F\x9A"), 3u);
  for (const char* text : {"\xC3\xBC", "\xE2\x82\xAC", "\xF0\x9F\x9A\x81", "\x80", "\x80\x80\x80\x80", "\xFF", "\xC0",
                           "\xE0\x80", "\xED\xA0", "\xF4\x90", "\xE2x"})
    EXPECT_EQ(UnfinishedUtf8(text), 0u) << "never more than it is";
}

TEST(Utf8, IsCutBetweenCharacters) {
  EXPECT_EQ(CutUtf8("abcdef", 6), "abcdef");
  EXPECT_EQ(CutUtf8("abcdef", 5), "abcde");
  EXPECT_EQ(CutUtf8("abc\xC3\xBC", 4), "abc");
  EXPECT_EQ(CutUtf8("abc\xC3\xBC", 5), "abc\xC3\xBC");
  EXPECT_EQ(CutUtf8("ab\xF0\x9F\x9A\x81", 5), "ab");
  EXPECT_EQ(CutUtf8("\x80\x80\x80\x80\x80\x80", 5).size(), 5u) << "no UTF-8: cut anywhere, but cut";
}

TEST(Utf8, IsShortenedBetweenCharactersAndSaysSo) {
  EXPECT_EQ(Shortened("abcdef", 6), "abcdef");
  EXPECT_EQ(Shortened("abc\xC3\xBC", 4), "abc...");
}

TEST(ConfigError, ShortensAMistakeThatQuotesMuch) {
  const std::string longer(1'000'000, 'x');
  for (const std::string& toml : {"name = '" + longer + "'", longer + " = 1"}) {
    try {
      Section section = Section::FromText(toml, "test.toml");
      section.Number("name", 0, 1, 0);
      section.Fail("name", "got '" + longer + "'");
      section.Done();
      section.ThrowIfWrong();
      FAIL() << "it was taken";
    } catch (const ConfigError& error) {
      EXPECT_LT(std::string(error.what()).size(), 100'000U);
      EXPECT_EQ(std::string(error.what()).substr(0, 10), "test.toml:");
    }
  }
}

TEST(Utf8, MistakesInExperimentsAreFitToBePrinted) {
  const std::string bad = "\x1b[31m\xE2\x80\xAE\xFF";
  try {
    Section section =
        Section::FromText("\"k\\u001b\\u202e\" = 1\nname = \"x\\u001b\\u2028\"\n[\"t\\u009b\"]\n\"\\u200f\" = 1\n",
                          "dir" + bad + "\n/a.toml");
    section.Number("name", 0, 1);
    section.Child("t\u009b").Done();
    section.Done();
    section.ThrowIfWrong();
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(Plain(error.what()), error.what());
    EXPECT_EQ(error.mistakes().size(), 3u);
    for (const std::string& mistake : error.mistakes()) {
      EXPECT_EQ(PlainLine(mistake), mistake);
      EXPECT_TRUE(mistake.starts_with("dir\\u001b[31m\\u202e\xEF\xBF\xBD\\n/a.toml:")) << mistake;
    }
  }
  EXPECT_EQ(Plain(ConfigError({"a" + bad}).what()), ConfigError({"a" + bad}).what());
}

}  // namespace
}  // namespace mascot
