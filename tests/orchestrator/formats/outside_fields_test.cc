// Fields of what another process says: of the right kind and in range, or named.
#include "orchestrator/formats/outside_fields.h"

#include <gmock/gmock.h>

#include <string>

#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

using Object = nlohmann::ordered_json;
using ::testing::HasSubstr;

/// What is wrong with the field "it" of {"it": `value`}.
template <class Read>
std::string MistakeIn(const std::string& value, const Read& read) {
  const Object object = ReadJson<Object>(value.empty() ? "{}" : "{\"it\": " + value + "}");
  OutsideFields fields(object);
  read(fields);
  EXPECT_EQ(fields.are_good(), fields.mistake().empty());
  return fields.mistake();
}

TEST(OutsideFields, IntegersAreInRange) {
  const auto read = [](OutsideFields& fields) {
    const std::int64_t number = fields.Integer("it", -1, 9);
    EXPECT_TRUE(-1 <= number && number <= 9);
  };
  for (const char* good : {"-1", "0", "9"}) EXPECT_EQ(MistakeIn(good, read), "");
  const std::string expected = "expected an integer in [-1, 9] as \"it\", got ";
  EXPECT_EQ(MistakeIn("", read), expected + "nothing");
  for (const char* wrong : {"10", "-2", "1.0", "1.5", "\"1\"", "null", "true", "9223372036854775807",
                            "18446744073709551615", "-9223372036854775808", "\"\\u001b[31m\""})
    EXPECT_EQ(MistakeIn(wrong, read), expected + wrong);
  EXPECT_EQ(MistakeIn("18446744073709551616", read), expected + "1.8446744073709552e+19");
  EXPECT_EQ(MistakeIn("[1]", read), expected + "a list");
  EXPECT_EQ(MistakeIn("{}", read), expected + "an object");
  EXPECT_EQ(MistakeIn("\"" + std::string(1000, 'x') + "\"", read), expected + "a longer text");
}

TEST(OutsideFields, NumbersAreInRange) {
  const auto read = [](OutsideFields& fields) { EXPECT_GE(fields.Number("it", 0, 1e6), 0); };
  for (const char* good : {"0", "0.5", "1e6", "1000000"}) EXPECT_EQ(MistakeIn(good, read), "");
  for (const char* wrong : {"-1e-9", "1e7", "1e308", "\"0\"", "null", "[0]"})
    EXPECT_THAT(MistakeIn(wrong, read), HasSubstr("expected a number in [0, 1e+06] as \"it\", got "));
}

TEST(OutsideFields, TextsBooleansAndListsAreOfTheirKindAndLength) {
  const auto text = [](OutsideFields& fields) { EXPECT_LE(fields.Text("it", 3).size(), 3U); };
  EXPECT_EQ(MistakeIn("\"abc\"", text), "");
  EXPECT_EQ(MistakeIn("\"abcd\"", text), "expected a text of at most 3 bytes as \"it\", got \"abcd\"");
  EXPECT_EQ(MistakeIn("7", text), "expected a text of at most 3 bytes as \"it\", got 7");
  const auto boolean = [](OutsideFields& fields) { fields.Boolean("it"); };
  EXPECT_EQ(MistakeIn("true", boolean), "");
  EXPECT_EQ(MistakeIn("1", boolean), "expected true or false as \"it\", got 1");
  const auto list = [](OutsideFields& fields) { EXPECT_LE(fields.List("it", 2).size(), 2U); };
  EXPECT_EQ(MistakeIn("[1, []]", list), "");
  EXPECT_EQ(MistakeIn("[1, 2, 3]", list), "expected a list of at most 2 values as \"it\", got a list");
  EXPECT_EQ(MistakeIn("{\"0\": 1}", list), "expected a list of at most 2 values as \"it\", got an object");
}

TEST(OutsideFields, TheFirstMistakeIsKept) {
  const Object object = {{"a", 1}, {"b", "x"}};
  OutsideFields fields(object);
  EXPECT_EQ(fields.Integer("a", 0, 1), 1);
  fields.Boolean("b");
  fields.Integer("c", 0, 1);
  EXPECT_EQ(fields.mistake(), "expected true or false as \"b\", got \"x\"");
  EXPECT_THROW(fields.Require(), JsonError);
  EXPECT_TRUE(fields.Has("b"));
  EXPECT_FALSE(fields.Has("c"));
}

TEST(ObjectOrNothing, IsAnObjectInUtf8ThatIsNotDeep) {
  EXPECT_TRUE(ObjectOrNothing("{\"a\": [[[1]]]}"));
  EXPECT_FALSE(ObjectOrNothing("[1]"));
  EXPECT_FALSE(ObjectOrNothing(std::string(20, '[') + std::string(20, ']')));
  EXPECT_FALSE(ObjectOrNothing("{\"a\": " + std::string(20, '[') + std::string(20, ']') + "}"));
  EXPECT_FALSE(ObjectOrNothing("{\"a\": \"\xc3\"}"));
  EXPECT_FALSE(ObjectOrNothing("{\"a\": NaN}"));
  EXPECT_FALSE(ObjectOrNothing("{} {}"));
}

}  // namespace
}  // namespace mascot
