#include "orchestrator/sweeping/plan/values.h"

#include <gmock/gmock.h>

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

TEST(PlainValue, OfANumberIsItsShortestForm) {
  for (const char* typed : {"0.1", "0.10", "1e-1", "+0.1", "0.1e0", "0.1_0"})
    EXPECT_EQ(PlainValue("law.p_gain", typed), "0.1") << typed;
  for (const char* typed : {"10", "10.0", "1_0", "0xa", "0xA", "0o12", "0b1010", "1e1", "+10"})
    EXPECT_EQ(PlainValue("law.p_gain", typed), "10") << typed;
  EXPECT_EQ(PlainValue("law.p_gain", "-0.0"), "0");
  EXPECT_EQ(PlainValue("law.p_gain", "123456789"), "123456789");
  EXPECT_EQ(PlainValue("law.p_gain", "0.30000000000000004"), "0.30000000000000004");
  EXPECT_EQ(PlainValue("law.p_gain", "1e-300"), "1e-300");
}

TEST(PlainValue, TellsIntegersFromOtherNumbersWhereTheKeyDoes) {
  EXPECT_EQ(PlainValue("agents.count", "0x4"), "4");
  EXPECT_EQ(PlainValue("agents.count", "4.0"), "4.0") << "a mistake, which the reader of the experiment finds";
  EXPECT_EQ(PlainValue("law.params.k", "1"), "1");
  EXPECT_EQ(PlainValue("law.params.k", "1.0"), "1.0") << "Python sees the difference";
}

TEST(PlainValue, OfAStringHasQuotesOnlyIfItNeedsThem) {
  for (const char* typed : {"ring", "\"ring\"", "'ring'", "\"\"\"ring\"\"\""})
    EXPECT_EQ(PlainValue("graph.topology", typed), "ring") << typed;
  EXPECT_EQ(PlainValue("run.name", "'a,b'"), "a,b") << "a comma is the table's business";
  EXPECT_EQ(PlainValue("run.name", "'1'"), "\"1\"") << "and not the number";
  EXPECT_EQ(PlainValue("run.name", "'true'"), "\"true\"");
  EXPECT_EQ(PlainValue("run.name", "''"), "\"\"");
  EXPECT_EQ(PlainValue("run.name", "'a\tb'"), "a\tb");
}

TEST(PlainValue, OfListsAndTablesIsPlainInside) {
  EXPECT_EQ(PlainValue("law.target_m", "[ 0x1,2.0, 3e0 ]"), "[1, 2, 3]");
  EXPECT_EQ(PlainValue("agents.position_m", "[[0,0,1.50],[1,1,1]]"), "[[0, 0, 1.5], [1, 1, 1]]");
  const char* plain = "{name = \"consensus\", p_gain = 1}";
  EXPECT_EQ(PlainValue("law", "{p_gain=1.0, name='consensus'}"), plain);
  EXPECT_EQ(PlainValue("law", "{ name = \"consensus\", p_gain = 0x1 }"), plain);
  EXPECT_EQ(PlainValue("law", "{name='custom', params={k=1.0, \"a b\"=1}}"),
            "{name = \"custom\", params = {\"a b\" = 1, k = 1.0}}");
  EXPECT_EQ(PlainValue("agents.override", "[{id=1, law={p_gain=1.0}}]"), "[{id = 1, law = {p_gain = 1}}]");
}

TEST(PlainValue, LeavesWhatIsNoValueAsItIsTyped) {
  for (const char* typed : {"1.2.3", "[1, 2", "0x", "2020-01-01", "1\nlaw.p_gain = 2"})
    EXPECT_EQ(PlainValue("law.p_gain", typed), typed);
}

TEST(PlainValue, IsItsOwn) {
  for (const char* typed : {"0.10", "ring", "'1'", "[1, 2.0]", "{a=1.0, b='x'}", "true", "inf", "1e300"})
    for (const char* key : {"law.p_gain", "law.params.k", "run.name", "law"}) {
      const std::string once = PlainValue(key, typed);
      EXPECT_EQ(PlainValue(key, once), once) << key;
    }
}

TEST(PlainNumbers, AreThoseOfTheKey) {
  EXPECT_THAT(PlainNumbers("law.p_gain", {0.5, 1, 1.5}), ElementsAre("0.5", "1", "1.5"));
  EXPECT_THAT(PlainNumbers("law.params.k", {0.5, 1}), ElementsAre("0.5", "1.0"));
}

TEST(PlainKeys, AreThoseOfADocument) {
  const Section document = Section::FromText("law = { name = 'consensus', p_gain = 1 }\nrun.seed = 0x10\n", "a.toml");
  EXPECT_THAT(PlainKeys(document.InTheFile()),
              ElementsAre(Pair("law.name", "\"consensus\""), Pair("law.p_gain", "1"), Pair("run.seed", "16")));
}

}  // namespace
}  // namespace mascot
