#include "experiment/toml/section.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include "tests/support/repeated.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Section Text(const std::string& text, std::vector<Override> overrides = {}) {
  return Section::FromText(text, "a.toml", overrides);
}

/// The mistakes that `read` finds in `text`.
std::vector<std::string> Mistakes(const std::string& text, const std::function<void(Section&)>& read,
                                  std::vector<Override> overrides = {}) {
  try {
    Section section = Text(text, std::move(overrides));
    read(section);
    section.ThrowIfWrong();
  } catch (const ConfigError& error) {
    return error.mistakes();
  }
  return {};
}

std::vector<std::string> SyntaxMistakes(const std::string& text) {
  return Mistakes(text, [](Section&) {});
}

class SectionFile : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_.File(name); }
  std::string Refusal(const std::string& name) const {
    try {
      Section::FromFile(Path(name));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  ScratchFolder folder_;
};

// --- values -----------------------------------------------------------------------------------------

TEST(Section, ReadsEveryKindOfValue) {
  Section root =
      Text("n = 0.5\nwhole = 2\ni = -3\nb = false\ns = 'x'\nl = ['p', 'q']\nv = [1, 2.5, 3]\nm = [[1, 2], []]\n");
  EXPECT_EQ(root.Number("n", 0, 1), 0.5);
  EXPECT_EQ(root.Number("whole", 0, 10), 2.0);
  EXPECT_EQ(root.Integer("i", -5, 5), -3);
  EXPECT_FALSE(root.Boolean("b", true));
  EXPECT_EQ(root.Text("s"), "x");
  EXPECT_THAT(root.Texts("l", {}), ElementsAre("p", "q"));
  EXPECT_EQ(root.Vector3("v", 0, 5), Eigen::Vector3d(1, 2.5, 3));
  EXPECT_THAT(root.Numbers("v", 0, 5), ElementsAre(1, 2.5, 3));
  EXPECT_THAT(root.Rows("m", 0, 5), ElementsAre(ElementsAre(1, 2), IsEmpty()));
  root.Done();
  EXPECT_NO_THROW(root.ThrowIfWrong());
}

TEST(Section, GivesTheFallbackOfAnAbsentKey) {
  Section root = Text("");
  EXPECT_EQ(root.Number("n", 0, 1, 0.25), 0.25);
  EXPECT_EQ(root.Integer("i", 0, 9, 4), 4);
  EXPECT_TRUE(root.Boolean("b", true));
  EXPECT_EQ(root.Text("s", "default"), "default");
  EXPECT_THAT(root.Texts("l", std::vector<std::string>{"*"}), ElementsAre("*"));
  EXPECT_THAT(root.Points("p", 0, 1), IsEmpty());
  EXPECT_THAT(root.Children("t"), IsEmpty());
  EXPECT_EQ(root.Child("c").Number("n", 0, 1, 0.5), 0.5);
  EXPECT_NO_THROW(root.ThrowIfWrong());
}

TEST(Section, SaysWhatKindOfValueStandsThere) {
  Section root = Text("a = 1\nb = 1.0\nc = 'x'\nd = true\ne = []\nf = {}\ng = 2024-01-31\n");
  EXPECT_EQ(root.Kind("a"), "number");
  EXPECT_EQ(root.Kind("b"), "number");
  EXPECT_EQ(root.Kind("c"), "string");
  EXPECT_EQ(root.Kind("d"), "boolean");
  EXPECT_EQ(root.Kind("e"), "list");
  EXPECT_EQ(root.Kind("f"), "table");
  EXPECT_EQ(root.Kind("g"), "date or time");
  EXPECT_EQ(root.Kind("h"), "");
}

// --- rows -------------------------------------------------------------------------------------------

constexpr std::string_view kColours[] = {"red", "green"};
constexpr Key kInnerRows[] = {key::Number("depth_m", Above(0, 5), "").Required()};
constexpr Key kRows[] = {
    key::Number("gain", {0, 10}, "").Default("2.5"),
    key::Integer("count", 1, 9, "").Default("3"),
    key::Boolean("flag", "").Default("true"),
    key::Text("word", "").Default("\"hello\""),
    key::OneOf("colour", kColours, "").Default("\"green\""),
    key::Texts("names", "").Default("[\"a\", \"b\"]"),
    key::Vector3("place_m", {-1, 1}, "").Default("[0, 0.5, 1]"),
    key::Numbers("times_s", {0, 1}, ""),
    key::Rows("rows", {0, 1}, ""),
    key::Points("points_m", {0, 1}, ""),
    key::Table("inner", kInnerRows, ""),
    key::Tables("many", kInnerRows, ""),
    key::OneOf("domain", kColours, "").Or(ValueKind::kInteger).Default("\"red\""),
    key::Number("broken", {0, 1}, "").Default("\"no number\""),
};

Section TextWithRows(const std::string& text) {
  Section section = Text(text);
  section.Use(kRows);
  return section;
}

TEST(SectionRows, SayTheDefaults) {
  Section root = TextWithRows("");
  EXPECT_EQ(root.Number("gain"), 2.5);
  EXPECT_EQ(root.Integer("count"), 3);
  EXPECT_TRUE(root.Boolean("flag"));
  EXPECT_EQ(root.Text("word"), "hello");
  EXPECT_EQ(root.OneOf("colour"), "green");
  EXPECT_THAT(root.Texts("names"), ElementsAre("a", "b"));
  EXPECT_EQ(root.Vector3("place_m"), Eigen::Vector3d(0, 0.5, 1));
  EXPECT_THAT(root.Numbers("times_s"), IsEmpty());
  EXPECT_THAT(root.Rows("rows"), IsEmpty());
  EXPECT_THAT(root.Points("points_m"), IsEmpty());
  EXPECT_NO_THROW(root.ThrowIfWrong());
  EXPECT_THAT(root.Resolved(), HasSubstr("gain = 2.5\ncount = 3\nflag = true\nword = \"hello\"\ncolour = \"green\"\n"
                                         "names = [\"a\", \"b\"]\nplace_m = [0.0, 0.5, 1.0]\n"));
}

TEST(SectionRows, SayTheRanges) {
  const auto read = [](Section& root) {
    root.Use(kRows);
    root.Number("gain");
    root.Integer("count");
    root.OneOf("colour");
    root.Vector3("place_m");
    root.Numbers("times_s");
    root.Rows("rows");
    root.Points("points_m");
    root.Child("inner").Number("depth_m");
  };
  EXPECT_THAT(Mistakes("gain = 11\ncount = 0\ncolour = 'gren'\nplace_m = [0, 0, 2]\ntimes_s = [2]\nrows = [[2]]\n"
                       "points_m = [[0, 0, 2]]\ninner.depth_m = 0\n",
                       read),
              ElementsAre("a.toml:1:8: gain: expected a number in [0, 10], got 11",
                          "a.toml:2:9: count: expected an integer in [1, 9], got 0",
                          "a.toml:3:10: colour: expected one of red, green, got 'gren' (did you mean \"green\"?)",
                          "a.toml:4:18: place_m[2]: expected a number in [-1, 1], got 2",
                          "a.toml:5:12: times_s[0]: expected a number in [0, 1], got 2",
                          "a.toml:6:10: rows[0][0]: expected a number in [0, 1], got 2",
                          "a.toml:7:20: points_m[0][2]: expected a number in [0, 1], got 2",
                          "a.toml:8:17: inner.depth_m: expected a number in (0, 5], got 0"));
}

TEST(SectionRows, ReachIntoTablesAndTheirLists) {
  Section root = TextWithRows("inner.depth_m = 1\n[[many]]\ndepth_m = 2\n[[many]]\n");
  EXPECT_EQ(root.Child("inner").Number("depth_m"), 1);
  std::vector<Section> many = root.Children("many");
  EXPECT_EQ(many[0].Number("depth_m"), 2);
  many[1].Number("depth_m");  // required
  EXPECT_THROW(root.ThrowIfWrong(), ConfigError);
}

TEST(SectionRows, LeaveUnstatedDefaultsToTheReader) {
  Section root = TextWithRows("");
  EXPECT_EQ(root.Number("gain", 7.0), 7);
  EXPECT_EQ(root.Text("word", "other"), "other");
}

TEST(SectionRows, MayNameTwoKindsOfValue) {
  EXPECT_EQ(TextWithRows("domain = 7\n").Integer("domain", 0, 9), 7);
  EXPECT_EQ(TextWithRows("").OneOf("domain"), "red");
}

TEST(SectionRows, ThatAreMissingOrImpossibleAreProgrammingErrors) {
  Section root = TextWithRows("");
  EXPECT_THROW(root.Number("unheard_of"), std::logic_error);
  EXPECT_THROW(root.Number("broken"), std::logic_error);
}

// --- mistakes ---------------------------------------------------------------------------------------

TEST(Section, SaysWhereWhatExpectedAndGot) {
  const auto read = [](Section& root) { root.Child("law").Number("p_gain", 0, 100); };
  EXPECT_THAT(Mistakes("[law]\np_gain =  'fast'\n", read),
              ElementsAre("a.toml:2:11: law.p_gain: expected a number in [0, 100], got 'fast'"));
}

TEST(Section, PutsAMissingKeyAtItsTable) {
  const auto read = [](Section& root) { root.Child("run").Positive("duration_s", 1e6); };
  EXPECT_THAT(Mistakes("\n[run]\n", read),
              ElementsAre("a.toml:2:1: run.duration_s: expected a number in (0, 1e+06], got nothing"));
  EXPECT_THAT(Mistakes("", read),
              ElementsAre("a.toml:1:1: run.duration_s: expected a number in (0, 1e+06], got nothing"));
}

TEST(Section, RefusesNumbersThatAreNotFinite) {
  const auto read = [](Section& root) { root.Number("x", -1, 1); };
  EXPECT_THAT(Mistakes("x = nan\n", read), ElementsAre("a.toml:1:5: x: expected a finite number in [-1, 1], got nan"));
  EXPECT_THAT(Mistakes("x = -inf\n", read),
              ElementsAre("a.toml:1:5: x: expected a finite number in [-1, 1], got -inf"));
}

TEST(Section, RefusesTheOpenEndOfARange) {
  const auto read = [](Section& root) { root.Positive("x", 10); };
  EXPECT_THAT(Mistakes("x = 0\n", read), ElementsAre("a.toml:1:5: x: expected a number in (0, 10], got 0"));
  EXPECT_THAT(Mistakes("x = 10\n", read), IsEmpty());
}

TEST(Section, RefusesIntegersThatADoubleWouldRound) {
  const auto read = [](Section& root) { root.Number("x", -1e300, 1e300); };
  EXPECT_THAT(Mistakes("x = 9007199254740992\n", read), IsEmpty());
  EXPECT_THAT(Mistakes("x = 9007199254740993\n", read), SizeIs(1));
  EXPECT_THAT(Mistakes("x = -9223372036854775808\n", read), SizeIs(1));
}

TEST(Section, RefusesFloatsForIntegers) {
  const auto read = [](Section& root) { root.Integer("x", 0, 9); };
  EXPECT_THAT(Mistakes("x = 4.0\n", read), ElementsAre("a.toml:1:5: x: expected an integer in [0, 9], got 4.0"));
  EXPECT_THAT(Mistakes("x = 9223372036854775807\n", read),
              ElementsAre("a.toml:1:5: x: expected an integer in [0, 9], got 9223372036854775807"));
}

TEST(Section, NamesThePlaceInsideAListOfLists) {
  const auto read = [](Section& root) { root.Child("agents").Points("position_m", -10, 10); };
  EXPECT_THAT(Mistakes("[agents]\nposition_m = [[0, 0, 11], [1, 2], 3]\n", read),
              ElementsAre("a.toml:2:22: agents.position_m[0][2]: expected a number in [-10, 10], got 11",
                          "a.toml:2:27: agents.position_m[1]: expected three numbers in [-10, 10], got a list of 2",
                          "a.toml:2:35: agents.position_m[2]: expected three numbers in [-10, 10], got 3"));
}

TEST(Section, NamesThePlaceInsideAListOfTables) {
  const auto read = [](Section& root) {
    for (Section& child : root.Child("agents").Children("override")) child.Integer("id", 1, 3);
  };
  EXPECT_THAT(Mistakes("[[agents.override]]\nid = 9\n[[agents.override]]\n", read),
              ElementsAre("a.toml:2:6: agents.override[0].id: expected an integer in [1, 3], got 9",
                          "a.toml:3:1: agents.override[1].id: expected an integer in [1, 3], got nothing"));
}

TEST(Section, OffersTheNearestOfTheNamesItListsOrNone) {
  constexpr std::string_view kNames[] = {"complete", "ring"};
  const auto read = [&](Section& root) { root.OneOf("topology", kNames, "ring"); };
  EXPECT_THAT(
      Mistakes("topology = 'rnig'\n", read),
      ElementsAre("a.toml:1:12: topology: expected one of complete, ring, got 'rnig' (did you mean \"ring\"?)"));
  EXPECT_THAT(Mistakes("topology = 'cube'\n", read),
              ElementsAre("a.toml:1:12: topology: expected one of complete, ring, got 'cube'"));
  EXPECT_THAT(Mistakes("topology = 3\n", read),
              ElementsAre("a.toml:1:12: topology: expected one of complete, ring, got 3"));
}

TEST(Section, PointsAtUnknownKeys) {
  const auto read = [](Section& root) {
    Section graph = root.Child("graph");
    graph.Has("neighbours");
    graph.Done();
    root.Done();
  };
  EXPECT_THAT(Mistakes("[graph]\nneigbours = 1\n\n[weather]\n", read),
              ElementsAre("a.toml:2:1: graph.neigbours: unknown key (did you mean \"neighbours\"?)",
                          "a.toml:4:2: weather: unknown key"));
}

TEST(Section, OffersTheKeyWhoseUnitWasForgotten) {
  const auto read = [](Section& root) {
    root.Number("max_acceleration_m_per_s2", 0, 1, 0.0);
    root.Done();
  };
  EXPECT_THAT(Mistakes("max_acceleration = 1\n", read),
              ElementsAre("a.toml:1:1: max_acceleration: unknown key (did you mean \"max_acceleration_m_per_s2\"?)"));
}

TEST(Section, FindsAllMistakesOfADocumentInItsOrderAndEachOnce) {
  const auto read = [](Section& root) {
    for (int agent = 0; agent < 3; ++agent) root.Child("law").Number("beta", 0, 1);
    root.Child("run").Integer("seed", 0, 9);
    root.Number("x", 0, 1);
  };
  EXPECT_THAT(Mistakes("x = 2\n[run]\nseed = 'a'\n[law]\nbeta = 5\n", read),
              ElementsAre("a.toml:1:5: x: expected a number in [0, 1], got 2",
                          "a.toml:3:8: run.seed: expected an integer in [0, 9], got 'a'",
                          "a.toml:5:8: law.beta: expected a number in [0, 1], got 5"));
}

TEST(Section, StopsListingMistakesAtAHundred) {
  std::string text = "x = [";
  for (int i = 0; i < 1000; ++i) text += "'a', ";
  const auto mistakes = Mistakes(text + "]\n", [](Section& root) { root.Numbers("x", 0, 1); });
  ASSERT_THAT(mistakes, SizeIs(101));
  EXPECT_EQ(mistakes.back(), "a.toml:1:506: too many mistakes: this one and others are left out");
}

TEST(Section, SaysNothingAboutTheKeysOfAValueThatIsNotATable) {
  const auto read = [](Section& root) {
    Section run = root.Child("run");
    run.Positive("duration_s", 10);
    run.Done();
    EXPECT_TRUE(run.Wrong("duration_s"));
  };
  EXPECT_THAT(Mistakes("run = 3\n", read), ElementsAre("a.toml:1:7: run: expected a table, got 3"));
}

TEST(Section, WantsAListWhereTablesRepeat) {
  const auto read = [](Section& root) { EXPECT_THAT(root.Child("agents").Children("override"), IsEmpty()); };
  EXPECT_THAT(Mistakes("[agents.override]\nid = 1\n", read),
              ElementsAre("a.toml:1:1: agents.override: expected a list of tables ([[agents.override]]), got a table"));
}

TEST(Section, RemembersWhichKeysAreWrong) {
  Section root = Text("a = 'x'\nb = 1\nc = { d = 'x' }\n");
  root.Number("a", 0, 1);
  root.Number("b", 0, 1);
  Section c = root.Child("c");
  c.Number("d", 0, 1);
  EXPECT_TRUE(root.Wrong("a"));
  EXPECT_FALSE(root.Wrong("b"));
  EXPECT_TRUE(root.Wrong("c"));
  EXPECT_TRUE(root.Wrong(""));
  EXPECT_TRUE(c.Wrong("d"));
}

TEST(Section, GoesOnWithALegalValueAfterAMistake) {
  Section root = Text("a = 'x'\nb = 7\nc = -7\n");
  EXPECT_EQ(root.Number("a", 2, 3), 2);
  EXPECT_EQ(root.Number("b", 0, 1, 0.5), 0.5);
  EXPECT_GT(root.Positive("c", 10), 0);
  EXPECT_EQ(root.Vector3("a", 0, 1), Eigen::Vector3d::Zero());
}

TEST(Section, ReportsMistakesFoundByItsReaders) {
  const auto read = [](Section& root) {
    Section graph = root.Child("graph");
    graph.Rows("laplacian", -9, 9);
    graph.FailRow("laplacian", 1, "expected a row that sums to 0, got a sum of 1");
    graph.Fail("edges", "expected something, got nothing");
    graph.Fail("", "expected better, got this");
  };
  EXPECT_THAT(Mistakes("[graph]\nlaplacian = [\n  [0],\n  [1]]\n", read),
              ElementsAre("a.toml:1:1: graph.edges: expected something, got nothing",
                          "a.toml:1:1: graph: expected better, got this",
                          "a.toml:4:3: graph.laplacian[1]: expected a row that sums to 0, got a sum of 1"));
}

TEST(Section, KeepsMessagesOnOneReadableLine) {
  const auto read = [](Section& root) {
    root.Number("x", 0, 1);
    root.Done();
  };
  EXPECT_THAT(
      Mistakes("x = \"a\\nb\"\n\"c\\nd\" = 1\n", read),
      ElementsAre("a.toml:1:5: x: expected a number in [0, 1], got 'a\\nb'", "a.toml:2:1: \"c\\nd\": unknown key"));
  EXPECT_THAT(Mistakes("x = '" + std::string(1000, 'y') + "'\n", read),
              ElementsAre("a.toml:1:5: x: expected a number in [0, 1], got '" + std::string(60, 'y') + "...'"));
}

// --- text that is not TOML --------------------------------------------------------------------------

TEST(Section, PlacesMistakesInsideAFreeValue) {
  const auto fail = [](const std::string& inner) {
    return Mistakes("[law]\nparams = { gain = 'fast', limits = [1, 2] }\n", [&](Section& root) {
      Section law = root.Child("law");
      law.Free("params");
      law.FailInside("params", inner, "expected\tsense, got none");
      EXPECT_TRUE(law.Wrong("params"));
    });
  };
  EXPECT_THAT(fail("gain"), ElementsAre("a.toml:2:19: law.params.gain: expected\\tsense, got none"));
  EXPECT_THAT(fail("limits[1]"), ElementsAre("a.toml:2:36: law.params.limits[1]: expected\\tsense, got none"));
  EXPECT_THAT(fail("absent"), ElementsAre("a.toml:2:10: law.params.absent: expected\\tsense, got none"));
}

TEST(Section, LocatesSyntaxErrors) {
  EXPECT_THAT(SyntaxMistakes("a = 1\nb 2\n"),
              ElementsAre("a.toml:2:3: while parsing key-value pair: expected '=', saw '2'"));
  EXPECT_THAT(SyntaxMistakes("a = ring\n"),
              ElementsAre("a.toml:1:5: while parsing value: could not determine value type (a string needs quotes)"));
  EXPECT_THAT(SyntaxMistakes("a = 1\nb = \"\xff\"\n"), ElementsAre("a.toml:2:5: expected UTF-8 text, got other bytes"));
  EXPECT_THAT(SyntaxMistakes("a = in\n"),
              ElementsAre("a.toml:1:7: while parsing floating-point: expected 'inf', saw 'in\\n'"));
  EXPECT_THAT(SyntaxMistakes(std::string("a = 1\n\0", 7)), ElementsAre(HasSubstr("a.toml:2:1: ")));
}

TEST(Section, RefusesKeysThatWouldRunTheParserOutOfStack) {
  std::string key = "a";
  for (int i = 0; i < 1000000; ++i) key += ".a";
  const auto refusal = ElementsAre("a.toml:2:1: expected a key of at most 32 parts, got more");
  EXPECT_THAT(SyntaxMistakes("# \"\n" + key + " = 1\n"), refusal);
  EXPECT_THAT(SyntaxMistakes("# '\n[" + key + "]\n"), refusal);
  EXPECT_THAT(SyntaxMistakes("s = '''\"'''''\n" + key + " = 1\n"), refusal);
  EXPECT_THAT(SyntaxMistakes("s = \"\\\"#\"\n" + key + " = 1\n"), refusal);
}

TEST(Section, RefusesValuesThatWouldRunTheParserOrUsOutOfStack) {
  const std::string many_parts = "a" + Repeated(31, ".a") + " = ";
  const auto refusal = ElementsAre("a.toml:2:1: expected at most 64 lists and tables in each other, got more");
  for (const std::size_t levels : {65u, 100'000u}) {
    EXPECT_THAT(SyntaxMistakes("\nx = " + Repeated(levels, "[")), refusal);
    EXPECT_THAT(SyntaxMistakes("\nx = " + Repeated(levels, "[") + Repeated(levels, "]")), refusal);
    EXPECT_THAT(SyntaxMistakes("\nx = " + Repeated(levels, "{ a = ") + "1" + Repeated(levels, "}")), refusal);
    EXPECT_THAT(SyntaxMistakes("\nx = " + Repeated(levels, "[{ \"#\" = ")), refusal);
    EXPECT_THAT(SyntaxMistakes("\n" + Repeated(levels, "[") + "a" + Repeated(levels, "]")), refusal);
    // Keys with dots are tables in each other, too: toml++ does not count them.
    EXPECT_THAT(SyntaxMistakes("\nx = " + Repeated(levels, "{ " + many_parts)), refusal);
  }
  EXPECT_THAT(SyntaxMistakes("x = " + Repeated(64, "[") + Repeated(64, "]")), IsEmpty());
  EXPECT_THAT(SyntaxMistakes("x = " + Repeated(64, "{ a = ") + "1.5" + Repeated(64, "}")), IsEmpty());
  EXPECT_THAT(
      SyntaxMistakes("x = [" + Repeated(1000, "[1.5, [2.5]], { a.b = 1.5 }, ") + "]\n" + Repeated(1000, "[[y]]\n")),
      IsEmpty());
}

TEST(Section, AnOverrideOrAnEventOfManyLevelsIsRefusedInWords) {
  const std::string deep = Repeated(100'000, "[") + Repeated(100'000, "]");
  const std::vector<Override> overrides{{.key = "x", .value = deep}};
  EXPECT_THAT([&] { Section::FromText("", "a.toml", overrides); },
              testing::ThrowsMessage<ConfigError>(HasSubstr("x: expected a TOML value, got '[[[")));
  EXPECT_THAT(
      [&] { Section::FromInlineTable("set = { x = " + deep + " }", "event"); },
      testing::ThrowsMessage<ConfigError>("event:1:1: expected at most 64 lists and tables in each other, got more"));
}

TEST(Section, CountsDotsInKeysOnly) {
  const std::string dots(100, '.');
  EXPECT_THAT(SyntaxMistakes("# " + dots + "\na = '" + dots + "'\nb = \"\"\"\n" + dots + "\n\"\"\"\n"), IsEmpty());
  EXPECT_THAT(SyntaxMistakes("a = [" +
                             [] {
                               std::string list;
                               for (int i = 0; i < 100; ++i) list += "1.5, ";
                               return list;
                             }() +
                             "]\n"),
              IsEmpty());
}

// --- overrides --------------------------------------------------------------------------------------

TEST(Section, TakesValuesOfTheCommandLineOverThoseOfTheFile) {
  Section root = Text("[law]\np_gain = 1.0\n", {{"law.p_gain", "0.5"}, {"law.list", "[1, 2]"}, {"run.seed", "7"}});
  Section law = root.Child("law");
  EXPECT_EQ(law.Number("p_gain", 0, 1), 0.5);
  EXPECT_THAT(law.Numbers("list", 0, 9), ElementsAre(1, 2));
  EXPECT_EQ(root.Child("run").Integer("seed", 0, 9), 7);
}

TEST(Section, TakesAWordOfTheCommandLineAsAString) {
  Section root = Text("", {{"a", "ring"}, {"b", "'ring'"}, {"c", "my run"}});
  EXPECT_EQ(root.Text("a"), "ring");
  EXPECT_EQ(root.Text("b"), "ring");
  EXPECT_EQ(root.Text("c"), "my run");
}

TEST(Section, NamesTheCommandLineInItsMistakes) {
  const auto read = [](Section& root) {
    root.Child("run").Positive("duration_s", 10);
    Section law = root.Child("law");
    law.Number("p_gain", 0, 100, 1);
    law.Done();
    root.Done();
  };
  const std::string file = "[run]\nduration_s = 1\n[law]\np_gain = 1\n";
  EXPECT_THAT(Mistakes(file, read, {{"law.p_gain", "fast"}}),
              ElementsAre("--set law.p_gain=fast: law.p_gain: expected a number in [0, 100], got 'fast'"));
  EXPECT_THAT(Mistakes(file, read, {{"law.pgain", "1"}, {"run.duration_s", "-1"}}),
              ElementsAre("--set law.pgain=1: law.pgain: unknown key (did you mean \"p_gain\"?)",
                          "--set run.duration_s=-1: run.duration_s: expected a number in (0, 10], got -1"));
  EXPECT_THAT(Mistakes("", read, {{"law.p_gain", "1"}}),
              ElementsAre("a.toml:1:1: run.duration_s: expected a number in (0, 10], got nothing"));
}

TEST(Section, RefusesMalformedOverrides) {
  const auto read = [](Section&) {};
  EXPECT_THAT(Mistakes("a = 1\n", read, {{"a", "[1"}}), ElementsAre("--set a=[1: a: expected a TOML value, got '[1'"));
  EXPECT_THAT(Mistakes("a = 1\n", read, {{"a", ""}}), ElementsAre("--set a=: a: expected a TOML value, got ''"));
  const auto hint = [&](const char* value) {
    const std::string mistake = Mistakes("a = 1\n", read, {{"a", value}}).at(0), begin = "a: expected a TOML value";
    const std::size_t at = mistake.find(begin) + begin.size();
    return mistake.substr(at, mistake.rfind(", got '") - at);
  };
  for (const char* text : {"1.2.3.4", "../x", "/agent_1/state", "- 1"})
    EXPECT_EQ(hint(text), " (text that does not begin with a letter needs quotes)") << text;
  for (const char* number : {".5", "5.", "-.5", "007"})
    EXPECT_EQ(hint(number), " (a number has no zeros in front, and digits on both sides of its point)") << number;
  for (const char* number : {"1e400", "-1e400", "99999999999999999999"})
    EXPECT_EQ(hint(number), " (the number is too large)") << number;
  for (const char* open : {"'a", "\"a", "{a=1"}) EXPECT_EQ(hint(open), "") << open;
  EXPECT_THAT(Mistakes("a = 1\n", read, {{"a", "1\nb = 2"}}),
              ElementsAre("--set a=1\\nb = 2: a: expected a TOML value, got '1\\nb = 2'"));
  EXPECT_THAT(Mistakes("a = 1\n", read, {{"a.b", "1"}}),
              ElementsAre("--set a.b=1: a: expected a table to set b in, got 1"));
  EXPECT_THAT(Mistakes("a = 1\n", read, {{"a..b", "1"}}),
              ElementsAre("--set a..b=1: expected a dotted key such as law.p_gain or agents.override[0].start_s, got "
                          "'a..b'"));
  for (const char* key :
       {"[0]", "a[", "a[0", "a[0]b", "a[-1]", "a[x]", "a[00]", "a[01]", "a.[0]", "a[0].", "a[99999999999999999999]"})
    EXPECT_THAT(Mistakes("a = [1]\n", read, {{key, "1"}}), ElementsAre(HasSubstr(": expected a dotted key"))) << key;
}

TEST(Section, OverridesReachIntoLists) {
  const auto read = [](Section& root) {
    EXPECT_THAT(root.Child("law").Points("waypoints_m", -100, 100),
                ElementsAre(Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(20, 0, 3)));
    std::vector<Section> overrides = root.Child("agents").Children("override");
    ASSERT_EQ(overrides.size(), 2);
    EXPECT_EQ(overrides[0].Integer("id", 1, 9), 1);
    EXPECT_EQ(overrides[1].Integer("id", 1, 9), 2);
    EXPECT_EQ(overrides[1].Number("start_s", 0, 9), 5);
    EXPECT_EQ(overrides[0].Child("law").Number("p_gain", 0, 9), 0.5);
  };
  const std::string file =
      "law.waypoints_m = [[0, 0, 1], [20, 0, 1]]\n[[agents.override]]\nid = 1\n[[agents.override]]\nid = 2\n"
      "start_s = 1\n";
  const std::vector<Override> set = {
      {"law.waypoints_m[1][2]", "3"}, {"agents.override[1].start_s", "5"}, {"agents.override[0].law.p_gain", "0.5"}};
  EXPECT_THAT(Mistakes(file, read, set), IsEmpty());
}

TEST(Section, AKeyOfAnotherTableIsOfferedItsPlace) {
  const auto read = [](Section& root) {
    Section run = root.Child("run"), law = root.Child("law");
    run.Integer("seed", 0, 9, 1);
    law.Number("beta", 0, 9, 1.0);
    Section inner = law.Child("inner");
    inner.Number("depth", 0, 9, 1.0);
    for (Section& each : root.Children("list")) each.Number("width", 0, 9, 1.0);
    inner.Done();
    run.Done();
    law.Done();
    root.Done();
  };
  EXPECT_THAT(Mistakes("[law]\nseed = 3\n[run]\ndepth = 1\n", read),
              ElementsAre("a.toml:2:1: law.seed: unknown key (did you mean \"run.seed\"?)",
                          "a.toml:4:1: run.depth: unknown key (did you mean \"law.inner.depth\"?)"));
  EXPECT_THAT(Mistakes("", read, {{"beta", "1"}}),
              ElementsAre("--set beta=1: beta: unknown key (did you mean \"law.beta\"?)"));
  EXPECT_THAT(Mistakes("[[list]]\n[law]\nwidth = 3\nsede = 1\nbeat = 1\n", read),
              ElementsAre("a.toml:3:1: law.width: unknown key", "a.toml:4:1: law.sede: unknown key",
                          "a.toml:5:1: law.beat: unknown key (did you mean \"beta\"?)"))
      << "not of lists, and what is near in the same table comes first";
}

TEST(Section, AKeyOfTheCommandLineTakesThePlaceOfOthersOfTheFile) {
  const auto read_one = [](std::string_view wanted, double value) {
    return [wanted, value](Section& root) {
      root.TakeOneOf({"a", "b", "c"});
      for (const std::string_view key : {"a", "b", "c"}) EXPECT_EQ(root.Has(key), key == wanted) << key;
      EXPECT_EQ(root.Number(wanted, 0, 9), value);
      EXPECT_EQ(root.InTheFile().size(), 1U);
      root.Done();
    };
  };
  EXPECT_THAT(Mistakes("a = 1\n", read_one("b", 2), {{"b", "2"}}), IsEmpty());
  EXPECT_THAT(Mistakes("a = 1\nb = 3\n", read_one("c", 2), {{"c", "2"}}), IsEmpty());
  EXPECT_THAT(Mistakes("a = 1\n", read_one("a", 2), {{"a", "2"}}), IsEmpty());
  const auto has = [](std::vector<std::string> wanted) {
    return [wanted](Section& root) {
      root.TakeOneOf({"a", "b", "c"});
      std::vector<std::string> keys;
      for (const char* key : {"a", "b", "c"})
        if (root.Has(key)) keys.emplace_back(key);
      EXPECT_EQ(keys, wanted);
    };
  };
  Mistakes("a = 1\nb = 2\n", has({"a", "b"}));
  Mistakes("c = 1\n", has({"a", "b"}), {{"a", "1"}, {"b", "2"}});
}

TEST(Section, OverridesTakeKeysOut) {
  const auto read = [](Section& root) {
    EXPECT_FALSE(root.Has("a"));
    EXPECT_FALSE(root.Child("law").Has("gain"));
    EXPECT_EQ(root.Child("law").Number("damping", 0, 9), 2);
  };
  const auto removed = [](const std::string& key) { return Override{.key = key, .value = "", .removes = true}; };
  EXPECT_THAT(Mistakes("a = 1\nlaw = { gain = 1, damping = 2 }\n", read,
                       {removed("a"), removed("law.gain"), removed("law.gain"), removed("graph.edges")}),
              IsEmpty());
}

TEST(Section, RefusesPlacesOutsideAList) {
  const auto read = [](Section&) {};
  const std::string file = "a = [1, 2]\n[[b]]\nc = 1\n";
  EXPECT_THAT(Mistakes(file, read, {{"a[2]", "1"}}),
              ElementsAre("--set a[2]=1: a: expected a place in a list of 2, got [2]"));
  EXPECT_THAT(Mistakes(file, read, {{"b[1].c", "1"}}),
              ElementsAre("--set b[1].c=1: b: expected a place in a list of 1, got [1]"));
  EXPECT_THAT(Mistakes(file, read, {{"b[0].c[0]", "1"}}),
              ElementsAre("--set b[0].c[0]=1: b[0].c: expected a list to set [0] in, got 1"));
  EXPECT_THAT(Mistakes(file, read, {{"b.c", "1"}}),
              ElementsAre("--set b.c=1: b: expected a table to set c in, got a list of 1"));
  EXPECT_THAT(Mistakes(file, read, {{"d[0]", "1"}}),
              ElementsAre("--set d[0]=1: d: expected a list to set [0] in, got nothing"));
}

// --- what was read ----------------------------------------------------------------------------------

std::string ReadAll(Section root) {
  Section run = root.Child("run");
  run.Text("name", "x");
  run.Number("duration_s", 0, 1e9, 40);
  run.Integer("seed", 0, 9, 1);
  run.Boolean("flag", true);
  Section agents = root.Child("agents");
  agents.Points("position_m", -1e30, 1e30);
  Section random = agents.Child("random");
  random.Vector3("min_m", -9, 9, Eigen::Vector3d(0, 0.1, 1));
  for (Section& child : agents.Children("override")) {
    child.Integer("id", 1, 9);
    child.Child("gains").Number("kp", 0, 9, 0.5);
  }
  Section graph = root.Child("graph");
  graph.Rows("edges", 0, 9);
  root.Child("record").Texts("topics", std::vector<std::string>{"*"});
  root.ThrowIfWrong();
  return root.Resolved();
}

TEST(Section, WritesOutWhatWasReadDefaultsIncluded) {
  EXPECT_EQ(ReadAll(Text("[graph]\nedges = [[1, 2], [2, 1, 0.5]]\n[[agents.override]]\nid = 2\n")),
            "[run]\n"
            "name = \"x\"\n"
            "duration_s = 40.0\n"
            "seed = 1\n"
            "flag = true\n"
            "\n"
            "[agents]\n"
            "random = { min_m = [0.0, 0.1, 1.0] }\n"
            "\n"
            "[[agents.override]]\n"
            "id = 2\n"
            "gains = { kp = 0.5 }\n"
            "\n"
            "[graph]\n"
            "edges = [[1, 2], [2, 1, 0.5]]\n"
            "\n"
            "[record]\n"
            "topics = [\"*\"]\n");
}

TEST(Section, WritesOutTheSameAgainWhenThatIsRead) {
  std::string points = "[[0.1, 1e-300, -0.0]";
  for (int i = 0; i < 20; ++i) points += ", [" + std::to_string(i) + ", 1e22, 0.30000000000000004]";
  const std::string text =
      "run.name = \"quote \\\" back \\\\ line \\n bell \\u0007 \xc3\xa9\"\nagents.position_m = " + points +
      "]\n[[agents.override]]\nid = 1\n[[agents.override]]\nid = 3\ngains.kp = 1\n";
  const std::string once = ReadAll(Text(text));
  EXPECT_EQ(ReadAll(Text(once)), once);
  EXPECT_EQ(Text(once).Child("run").Text("name"), "quote \" back \\ line \n bell \a \xc3\xa9");
}

TEST(Section, WritesOutTheWholeDocumentFromAnyOfItsTables) {
  Section root = Text("a = 1\n");
  root.Integer("a", 0, 9);
  Section child = root.Child("b");
  child.Integer("c", 0, 9, 2);
  EXPECT_EQ(child.Resolved(), "a = 1\n\n[b]\nc = 2\n");
}

TEST(ShortestFloat, ReadsBackAsTheSameNumberAndIsAFloat) {
  EXPECT_EQ(ShortestFloat(40), "40.0");
  EXPECT_EQ(ShortestFloat(0.1), "0.1");
  EXPECT_EQ(ShortestFloat(1e6), "1e+06");
  EXPECT_EQ(ShortestFloat(-0.0), "-0.0");
  for (const double value : {1.0 / 3, 0.1 + 0.2, 5e-324, std::numeric_limits<double>::max(), -123456.789})
    EXPECT_EQ(std::strtod(ShortestFloat(value).c_str(), nullptr), value);
}

TEST(DidYouMean, OffersOnlySimilarWords) {
  constexpr std::string_view kNames[] = {"position_m", "topology", "seed"};
  EXPECT_EQ(DidYouMean("positoin_m", kNames), "position_m");
  EXPECT_EQ(DidYouMean("Topology", kNames), "topology");
  EXPECT_EQ(DidYouMean("sed", kNames), "seed");
  EXPECT_EQ(DidYouMean("gravity", kNames), std::nullopt);
  EXPECT_EQ(DidYouMean("", kNames), std::nullopt);
  EXPECT_EQ(DidYouMean(std::string(1 << 20, 'x'), kNames), std::nullopt);
}

// --- files ------------------------------------------------------------------------------------------

TEST_F(SectionFile, NamesThePathAsItWasTyped) {
  std::ofstream(Path("a file.toml")) << "x = 2\n";
  const auto previous = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  Section root = Section::FromFile("./a file.toml");
  std::filesystem::current_path(previous);
  root.Number("x", 0, 1);
  try {
    root.ThrowIfWrong();
    FAIL() << "no mistake noted";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "./a file.toml:1:5: x: expected a number in [0, 1], got 2");
  }
}

/// Resolved path of `key` in a file in `folder` with this line, "key = value".
std::string PathSaidIn(const std::string& folder, const std::string& line) {
  Section section = Section::FromText(line, folder + "/a.toml");
  const std::string path = section.PathOfFile("key");
  EXPECT_THAT(section.Resolved(), ::testing::Eq("key = \"" + path + "\"\n"));
  return path;
}

TEST_F(SectionFile, LooksForFilesBesideItselfAndKeepsAbsolutePaths) {
  std::filesystem::create_directory(Path("sub"));
  std::filesystem::create_directory_symlink("sub", Path("link"));
  const std::string folder = std::filesystem::canonical(folder_.path()).string();
  EXPECT_EQ(PathSaidIn(folder, "key = 'law.so'"), folder + "/law.so");
  EXPECT_EQ(PathSaidIn(folder + "/sub", "key = '../none/./law.so'"), folder + "/none/law.so");
  EXPECT_EQ(PathSaidIn(folder, "key = 'link/law.so'"), folder + "/sub/law.so") << "found at its own place";
  EXPECT_EQ(PathSaidIn(folder, "key = '/nowhere/law.so'"), "/nowhere/law.so");
}

TEST_F(SectionFile, LooksForFilesOfTheCommandLineInTheCurrentFolder) {
  const Override given{"key", "'law.so'"};
  Section section = Section::FromText("", "/nowhere/a.toml", {&given, 1});
  EXPECT_EQ(section.PathOfFile("key"), (std::filesystem::current_path() / "law.so").string());
}

TEST(Section, RefusesInvalidPaths) {
  const auto read = [](Section& root) { root.PathOfFile("key"); };
  EXPECT_THAT(Mistakes("", read), ElementsAre("a.toml:1:1: key: expected the path of a file, got nothing"));
  EXPECT_THAT(Mistakes("key = ''", read), ElementsAre("a.toml:1:7: key: expected the path of a file, got ''"));
  EXPECT_THAT(Mistakes("key = 3", read), ElementsAre("a.toml:1:7: key: expected the path of a file, got 3"));
  EXPECT_THAT(Mistakes("key = \"a\\nb\"", read),
              ElementsAre("a.toml:1:7: key: expected the path of a file, got 'a\\nb'"));
}

TEST_F(SectionFile, RefusesAnythingButAReadableFile) {
  std::filesystem::create_directory(Path("folder"));
  std::filesystem::create_symlink(Path("nowhere"), Path("dangling"));
  ASSERT_EQ(::mkfifo(Path("fifo").c_str(), 0600), 0);
  EXPECT_EQ(Refusal("absent"), Path("absent") + ": cannot be read: No such file or directory");
  EXPECT_EQ(Refusal("folder"), Path("folder") + ": is a directory");
  EXPECT_EQ(Refusal("dangling"), Path("dangling") + ": cannot be read: No such file or directory");
  EXPECT_EQ(Refusal("fifo"), Path("fifo") + ": is not a regular file");
}

TEST_F(SectionFile, RefusesVeryLargeFiles) {
  std::ofstream(Path("large.toml")) << "# large\n";
  std::filesystem::resize_file(Path("large.toml"), (16u << 20) + 1);
  EXPECT_EQ(Refusal("large.toml"), Path("large.toml") + ": is larger than 16 MiB");
}

}  // namespace
}  // namespace mascot
