// MASCOT as users have it: installed, with plug-in laws built against the installation.

#include <gmock/gmock.h>

#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;

namespace fs = std::filesystem;

void ExpectDone(const std::string& command) {
  const Ran ran = Shell(command);
  EXPECT_EQ(ran.exit_code, 0) << command << "\n" << ran.output;
}

std::string Quoted(const fs::path& path) { return "'" + path.string() + "'"; }

/// Installs this build into a temporary folder, and copies the example of docs/plugin_law.md out of the installation.
struct Installed {
  Installed() {
    ExpectDone(MASCOT_CMAKE " --install '" + BuildFolder() + "' --prefix " + Quoted(prefix));
    fs::copy(prefix / "share/mascot/examples/plugin_law", example);
  }

  /// Starts the installed `orchestrator up CONFIG --out folder/name`.
  std::unique_ptr<Running> Up(const fs::path& config, const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> words{"up", config.string(), "--out", folder.File(name)};
    words.insert(words.end(), more.begin(), more.end());
    return std::make_unique<Running>((prefix / "bin/orchestrator").string(), words, folder.File(name));
  }
  nlohmann::json Summary(const std::string& name) const {
    return nlohmann::json::parse(ReadFile(folder.File(name + "/summary.json")));
  }

  ScratchFolder folder;
  fs::path prefix = folder.path() / "prefix";
  fs::path example = folder.path() / "example";
};

/// Builds the example with its CMakeLists.txt and the compiler of this build.
void BuildWithCmake(const Installed& installed) {
  const fs::path build = installed.example / "build";
  ExpectDone(MASCOT_CMAKE " -S " + Quoted(installed.example) + " -B " + Quoted(build) +
             " -DCMAKE_CXX_COMPILER='" MASCOT_CXX "' -DCMAKE_PREFIX_PATH=" + Quoted(installed.prefix));
  ExpectDone(MASCOT_CMAKE " --build " + Quoted(build));
}

/// Builds a law without CMake, as in docs/plugin_law.md.
void BuildByHand(const Installed& installed, const fs::path& source, const std::string& more_options,
                 const fs::path& library) {
  const fs::path include = installed.prefix / "include";
  ExpectDone("'" MASCOT_CXX "' -std=c++20 -O2 -shared -fPIC " + more_options + " -I " + Quoted(include) + " -I " +
             Quoted(include / "mascot") + " -I '" MASCOT_EIGEN "' " + Quoted(source) + " -o " + Quoted(library));
}

/// The source of the law in docs/plugin_law.md.
std::string DocumentedLaw() {
  const std::string text = ReadFile(SourceFolder() + "/docs/plugin_law.md");
  const std::string opening = "```cpp\n";
  const auto begin = text.find(opening);
  const auto end = text.find("```\n", begin + 1);
  if (begin == text.npos || end == text.npos) throw std::runtime_error("docs/plugin_law.md shows no law");
  return text.substr(begin + opening.size(), end - begin - opening.size());
}

/// The example's five agents start far apart and meet at the mean of their initial positions, (-2, -7), within the
/// bound of the law.
void ExpectTheyMeet(const nlohmann::json& summary) {
  EXPECT_NEAR(summary["consensus"]["value_m"][0].get<double>(), -2, 0.01);
  EXPECT_NEAR(summary["consensus"]["value_m"][1].get<double>(), -7, 0.01);
  EXPECT_LT(summary["consensus"]["final_disagreement_m"].get<double>(), 0.1);
  EXPECT_EQ(summary["control"]["saturated_fraction"], 0.0);
}

TEST(Install, BuildsTheExampleLawAndFliesItInBothEngines) {
  const Installed installed;
  BuildWithCmake(installed);
  const fs::path config = installed.example / "plugin_law.toml";
  auto dds = installed.Up(config, "dds", {});
  ASSERT_EQ(dds->Wait(), 0) << dds->err();
  auto inprocess = installed.Up(config, "inprocess", {"--engine", "inprocess"});
  ASSERT_EQ(inprocess->Wait(), 0) << inprocess->err();
  const std::string recording = ReadFile(installed.folder.File("dds/run.mcap"));
  EXPECT_FALSE(recording.empty());
  EXPECT_TRUE(recording == ReadFile(installed.folder.File("inprocess/run.mcap"))) << "run.mcap differs";
  EXPECT_TRUE(fs::exists(installed.folder.File("dds/paths.png"))) << "plot.py is found beside the programs";
  ExpectTheyMeet(installed.Summary("dds"));
}

TEST(Install, TakesLawsThatWereBuiltWithoutCmakeIfTheyFit) {
  const Installed installed;
  const fs::path config = installed.example / "plugin_law.toml";
  const fs::path library = installed.folder.path() / "libbyhand.so";
  const auto fly = [&](const std::string& name, const std::string& gains) {
    return installed.Up(config, name,
                        {"--engine", "inprocess", "--duration-s", "1", "--set", "output.save_plot=false", "--set",
                         "law.library='" + library.string() + "'", "--set", "law.params={ " + gains + " }"});
  };
  BuildByHand(installed, installed.example / "bounded_consensus.cc", "", library);
  auto by_hand = fly("by_hand", "p_gain = 0.1");
  EXPECT_EQ(by_hand->Wait(), 0) << by_hand->err();

  WriteFile(installed.folder.File("documented.cc"), DocumentedLaw());
  BuildByHand(installed, installed.folder.File("documented.cc"), "", library);
  auto documented = fly("documented", "gain = 0.1");
  EXPECT_EQ(documented->Wait(), 0) << documented->err();

  BuildByHand(installed, installed.example / "bounded_consensus.cc", "-DEIGEN_MAX_STATIC_ALIGN_BYTES=32", library);
  auto misaligned = fly("misaligned", "p_gain = 0.1");
  EXPECT_EQ(misaligned->Wait(), 2);
  EXPECT_THAT(misaligned->err(), HasSubstr("law.library: expected a library compiled as this program was, got "));
  EXPECT_FALSE(fs::exists(installed.folder.File("misaligned"))) << "nothing was started";
}

TEST(Install, HasHeadersAtTheirEarlierPlacesToo) {
  const Installed installed;
  std::string includes;
  for (const char* header : {"agent/law.h", "agent/plugin_params.h", "experiment/motion.h", "experiment/toml/value.h"})
    includes += "#include \"mascot/" + std::string(header) + "\"\n";
  WriteFile(installed.folder.File("earlier.cc"), includes + DocumentedLaw());
  BuildByHand(installed, installed.folder.File("earlier.cc"), "", installed.folder.path() / "libearlier.so");
}

}  // namespace
}  // namespace mascot::test
