#include "orchestrator/sweeping/table/side_by_side.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiment/toml/section.h"
#include "tests/support/repeated.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class SideBySideTest : public ::testing::Test {
 protected:
  /// Makes a run folder; returns its path.
  std::string Run(const std::string& name, const std::string& config, const std::string& summary) const {
    std::filesystem::create_directories(folder_.path() / name);
    WriteFile(folder_.File(name + "/config.toml"), config);
    WriteFile(folder_.File(name + "/summary.json"), summary);
    return folder_.File(name);
  }
  ScratchFolder folder_;
};

TEST_F(SideBySideTest, HasAColumnForEachRunAndALineForEachDifferenceAndFigure) {
  const std::string a = Run("slow", "[run]\nseed = 1\n[law]\np_gain = 0.5\nbeta = 1.0\n",
                            R"({"exit": 0, "consensus": {"settling_time_s": 12.5, "final_disagreement_m": 0.1},
                                "laws": {"containment": {}}})");
  const std::string b =
      Run("fast", "[run]\nseed = 1\n[law]\np_gain = 2.0\nname = 'x'\n",
          R"({"exit": 1, "consensus": {"settling_time_s": null, "final_disagreement_m": 1234.5678}})");
  EXPECT_EQ(SideBySide({a + "/", b}).Text(),
            "                          slow     fast\n"
            "set differently\n"
            "  law.beta                   1        -\n"
            "  law.name                   -      \"x\"\n"
            "  law.p_gain               0.5        2\n"
            "measured and predicted\n"
            "  exit                       0        1\n"
            "  final disagreement (m)   0.1  1234.57\n"
            "  settling time (s)       12.5        -\n");
}

TEST_F(SideBySideTest, SaysSoIfTheExperimentsAreTheSame) {
  const std::string a = Run("a", "[run]\nseed = 1\n", R"({"control": {"effort": 2.0}})");
  const std::string b = Run("b", "[run]\nseed = 1\n", R"({"control": {"effort": 3.0}})");
  EXPECT_THAT(SideBySide({a, b}).Text(),
              HasSubstr("\nthe same experiment\nmeasured and predicted\n  control effort (m²/s³)  2  3\n"));
}

TEST_F(SideBySideTest, NamesRunsWithoutTheFoldersThatTheyShare) {
  const std::string a = Run("slow/1", "", R"({"exit": 0})"), b = Run("fast/2", "", R"({"exit": 0})");
  EXPECT_THAT(SideBySide({a + "/", b}).Text(), HasSubstr("  slow/1  fast/2\n"));
  EXPECT_THAT(SideBySide({a, a}).Text(), HasSubstr("  1  1\n"));
}

TEST_F(SideBySideTest, IsJsonWithListsByRun) {
  const std::string a = Run("a", "[law]\np_gain = 0.5\n", R"({"safety": {"collisions": 3}, "links": {"lost": 1}})");
  const std::string b = Run("b", "[law]\nname = 'x'\n", R"({"safety": {"collisions": 0}})");
  const auto json = nlohmann::json::parse(SideBySide({a, b}).JsonText());
  EXPECT_EQ(json["runs"], nlohmann::json({a, b}));
  EXPECT_EQ(json["config"], nlohmann::json::parse(R"({"law.p_gain": [0.5, null], "law.name": [null, "x"]})"));
  EXPECT_EQ(json["summary"], nlohmann::json::parse(R"({"safety.collisions": [3, 0], "links.lost": [1, null]})"));
}

TEST_F(SideBySideTest, RefusesWhatIsNoRun) {
  const std::string a = Run("a", "", "{}"), broken = Run("b", "", "{");
  std::filesystem::create_directories(folder_.path() / "empty");
  const std::string empty = folder_.File("empty");
  EXPECT_THAT(
      [&] {
        SideBySide({a, empty});
      },
      ThrowsMessage<ConfigError>(empty + ": expected the folder of a finished run, got no summary.json"));
  std::filesystem::remove(folder_.File("a/config.toml"));
  EXPECT_THAT([&] { SideBySide({a}); },
              ThrowsMessage<ConfigError>(a + ": expected the folder of a finished run, got no config.toml"));
  EXPECT_THAT([&] { SideBySide({broken}); },
              ThrowsMessage<ConfigError>(broken + "/summary.json: expected JSON, got text that is no JSON (byte 2)"));
  const std::string deep = Run("c", "", "{\"laws\": " + Repeated(500'000, "[") + Repeated(500'000, "]") + "}");
  EXPECT_THAT([&] { SideBySide({deep}); },
              ThrowsMessage<ConfigError>(
                  deep + "/summary.json: expected JSON, got JSON with more than 64 lists and objects in each other"));
}

}  // namespace
}  // namespace mascot
