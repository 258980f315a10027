// JSON from sockets, files and pipes: whatever it holds, reading it ends in a value or in words.
#include "orchestrator/formats/outside_json.h"

#include <gmock/gmock.h>

#include <string>

#include "tests/support/repeated.h"

namespace mascot {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::string Nested(std::size_t levels, const std::string& open, const std::string& inner, const std::string& close) {
  return Repeated(levels, open) + inner + Repeated(levels, close);
}

std::string Refusal(const std::string& text, const JsonLimits& limits = {}) try {
  ReadJson<json>(text, limits);
  return "";
} catch (const JsonError& error) {
  return error.what();
}

TEST(OutsideJson, ReadsAsTheLibraryDoes) {
  EXPECT_EQ(ReadJson<json>(R"({"b": [1, 2.5, "x\u00e9"], "a": null})"),
            json({{"a", nullptr}, {"b", {1, 2.5, "x\u00e9"}}}));
  EXPECT_EQ(ReadJson<ordered_json>(R"({"b": 1, "a": 2})").dump(), R"({"b":1,"a":2})");
}

TEST(OutsideJson, RefusesWhatIsNestedTooDeeplyBeforeItIsBuilt) {
  const std::string words = "JSON with more than 64 lists and objects in each other";
  for (const std::size_t levels : {65u, 1'000u, 500'000u}) {
    EXPECT_EQ(Refusal(Nested(levels, "[", "", "]")), words);
    EXPECT_EQ(Refusal(Nested(levels, "[", "", "")), words) << "not even ended";
    EXPECT_EQ(Refusal(Nested(levels, R"({"a":)", "1", "}")), words);
    EXPECT_EQ(Refusal(Nested(levels, R"([{"a":)", "1", "}]")), words);
    EXPECT_EQ(
        Refusal(R"({"op":"setParameters","parameters":[{"name":"x","value":)" + Nested(levels, "[", "", "]") + "}]}"),
        words);
    EXPECT_EQ(JsonOrNull<ordered_json>(Nested(levels, "[", "", "]")), ordered_json());
  }
  EXPECT_EQ(Refusal(Nested(64, "[", "", "]")), "");
  EXPECT_EQ(Refusal("[" + Nested(500'000, "[],", "1", "") + "]"), "") << "beside each other, not in each other";
  EXPECT_EQ(Refusal("\"" + Repeated(500'000, "[") + "\""), "") << "a text";
  EXPECT_EQ(Refusal("[[]]", {.depth = 1}), "JSON with more than 1 lists and objects in each other");
}

TEST(OutsideJson, RefusesWhatIsTooLong) {
  EXPECT_EQ(Refusal("[1, 2]", {.bytes = 5}), "JSON of more than 5 bytes");
  EXPECT_EQ(Refusal("[1, 2]", {.bytes = 6}), "");
}

TEST(OutsideJson, SaysWhereTextIsNoJson) {
  EXPECT_EQ(Refusal(""), "text that is no JSON (byte 1)");
  EXPECT_EQ(Refusal("[1,"), "text that is no JSON (byte 4)");
  EXPECT_EQ(Refusal("{\"a\": 1} x"), "text that is no JSON (byte 10)");
  EXPECT_EQ(Refusal("\"\xff\""), "text that is no JSON (byte 2)");
  EXPECT_EQ(Refusal("[NaN]"), "text that is no JSON (byte 2)");
  EXPECT_EQ(Refusal("1e999"), "JSON with a number beyond those of a double");
  for (const char* text : {"", "[", "1e999", "\xff"}) EXPECT_TRUE(JsonOrNull<json>(text).is_null()) << text;
}

}  // namespace
}  // namespace mascot
