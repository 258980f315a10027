// tests/bad_configs: each `<name>.toml` contains a mistake (a few contain several). `<name>.expected` contains the
// expected error text, one line per mistake, with FILE in place of the path.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "agent/laws/laws.h"
#include "tests/experiment/bad_config.h"
#include "tests/support/folders.h"
#include "tests/support/param_name.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> Corpus() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(test::SourceFolder() + "/tests/bad_configs"))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string Refusal(const fs::path& path) {
  try {
    LoadExperiment(Section::FromFile(path.string()), path.stem().string());
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

class BadConfig : public ::testing::TestWithParam<fs::path> {};

TEST_P(BadConfig, IsRefusedWithTheExpectedWords) {
  std::ifstream file(fs::path(GetParam()).replace_extension(".expected"));
  ASSERT_TRUE(file) << "no .expected beside " << GetParam();
  const std::string expected{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_EQ(test::Anonymous(Refusal(GetParam()), GetParam().string()) + "\n", expected);
}

INSTANTIATE_TEST_SUITE_P(Corpus, BadConfig, ::testing::ValuesIn(Corpus()),
                         [](const auto& row) { return test::ParamName(row.param.stem().string()); });

TEST(BadConfigs, AreManyAndEachHasItsExpectation) {
  EXPECT_GE(Corpus().size(), 100u);
  for (const auto& entry : fs::directory_iterator(test::SourceFolder() + "/tests/bad_configs"))
    EXPECT_TRUE(fs::exists(fs::path(entry.path()).replace_extension(".toml"))) << entry.path();
}

TEST(BadConfigs, SayWhereWhatExpectedAndGotOnEveryLine) {
  for (const fs::path& path : Corpus()) {
    std::istringstream refusal(test::Anonymous(Refusal(path), path.string()));
    for (std::string line; std::getline(refusal, line);)
      EXPECT_THAT(line, testing::ContainsRegex("^FILE:[0-9]+:[0-9]+: .*(expected|unknown key|while parsing)")) << path;
  }
}

TEST(BadConfigs, ThatAreNotFilesAreRefused) {
  const ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  fs::create_directory(folder / "folder.toml");
  fs::create_symlink(folder / "nowhere.toml", folder / "dangling.toml");
  ASSERT_EQ(::mkfifo((folder / "fifo.toml").c_str(), 0600), 0);
  EXPECT_EQ(Refusal(folder / "folder.toml"), (folder / "folder.toml").string() + ": is a directory");
  EXPECT_EQ(Refusal(folder / "dangling.toml"),
            (folder / "dangling.toml").string() + ": cannot be read: No such file or directory");
  EXPECT_EQ(Refusal(folder / "fifo.toml"), (folder / "fifo.toml").string() + ": is not a regular file");
  EXPECT_EQ(Refusal(folder / "absent.toml"),
            (folder / "absent.toml").string() + ": cannot be read: No such file or directory");
}

}  // namespace
}  // namespace mascot
