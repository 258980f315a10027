// The folder of a run, and what --force may remove.
#include "orchestrator/recording/run_folder.h"

#include <gmock/gmock.h>

#include "agent/laws/laws.h"
#include "orchestrator/formats/mcap/writer.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::ThrowsMessage;
using testing::UnorderedElementsAre;

class RunFolderTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }

  void Write(const std::string& name, const std::string& text = "a person's own") const {
    fs::create_directories((folder_ / name).parent_path());
    WriteFile(folder_ / name, text);
  }
  void WriteRecording(const std::string& name) const { McapWriter{(folder_ / name).string()}.Close(); }
  /// What a run leaves.
  void WriteRun() const {
    Write("config.toml", experiment_.resolved);
    for (const char* name :
         {"summary.json", "summary.json.part", "states.npz", "error.png", "error.png.part", "graph.svg", "safety.pdf",
          "law_curve.csv", "curve.png", "paths.pgf", "position.csv", "logs/agents_1-50.log", "logs/agent_3.log",
          "logs/physics_server.log", "logs/orchestrator.log"})
      Write(name);
    WriteRecording("run.mcap");
  }
  void Force() const { RunFolder(folder_.string(), experiment_, /*force=*/true); }
  /// Names of the files in the folder.
  std::vector<std::string> Files() const {
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      if (!entry.is_directory()) files.push_back(entry.path().lexically_relative(folder_).string());
    return files;
  }
  std::string Refusal(const std::string& names) const {
    return "--out " + folder_.string() + ": expected the files of an earlier run, got " + names +
           ", which no run has made (--force replaces nothing else)";
  }
  void ExpectRefusal(const std::string& names) const {
    const auto before = Files();
    EXPECT_THAT([&] { Force(); }, ThrowsMessage<ConfigError>(Refusal(names)));
    EXPECT_EQ(Files(), before);
  }

  const ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path() / "run";
  Experiment experiment_ = LoadExperiment(
      Section::FromText("[run]\nduration_s = 1.0\n[agents]\ncount = 1\n[record]\nfile = 'flight.mcap'\n", "a.toml"),
      "a");
};

TEST_F(RunFolderTest, ForceRemovesWhatARunHasMade) {
  WriteRun();
  Force();
  EXPECT_THAT(Files(), IsEmpty());
}

TEST_F(RunFolderTest, ForceKeepsWhatIsNotOfARun) {
  WriteRun();
  for (const char* name :
       {"notes.txt", "config.toml~", "film.mp4", "error.bmp", "logs/mail.log", "logs/agent_x.log", "logs/agent_1.txt"})
    Write(name);
  WriteRecording("another.mcap");
  Force();
  EXPECT_THAT(Files(), UnorderedElementsAre("notes.txt", "config.toml~", "film.mp4", "error.bmp", "logs/mail.log",
                                            "logs/agent_x.log", "logs/agent_1.txt", "another.mcap"));
}

TEST_F(RunFolderTest, ForceTouchesNothingInAFolderThatNoRunHasMade) {
  Write("config.toml", "[run]\nduration_s = 1.0\n");
  Write("summary.json");
  Write("logs/agent_1.log");
  Write("logs/mail.log");
  ExpectRefusal("config.toml, logs/agent_1.log, summary.json");
  WriteRecording("run.mcap");  // a copy of one
  ExpectRefusal("config.toml, logs/agent_1.log, run.mcap, summary.json");
}

TEST_F(RunFolderTest, AResolvedExperimentAloneIsNoRun) {
  Write("config.toml", experiment_.resolved);
  ExpectRefusal("config.toml");
  Write("run.mcap", "a person's own");
  ExpectRefusal("config.toml, run.mcap");
}

TEST_F(RunFolderTest, ForceReplacesOnlyRecordingsOfRuns) {
  WriteRun();
  Write("flight.mcap", "a person's own");
  ExpectRefusal("flight.mcap");
  WriteRecording("flight.mcap");
  Force();
  EXPECT_THAT(Files(), IsEmpty());
}

TEST_F(RunFolderTest, ForceFollowsNoLinks) {
  WriteRun();
  fs::create_directory(scratch_.path() / "elsewhere");
  WriteFile(scratch_.File("elsewhere/agent_1.log"), "a person's own");
  fs::remove_all(folder_ / "logs");
  fs::create_directory_symlink(scratch_.path() / "elsewhere", folder_ / "logs");
  fs::remove(folder_ / "summary.json");
  fs::create_symlink("/nowhere", folder_ / "summary.json");
  ExpectRefusal("logs, summary.json");
}

TEST_F(RunFolderTest, ForceInAFolderWithOtherNamesJustWritesThere) {
  Write("notes.txt");
  Write("logs/mail.log");
  Force();
  EXPECT_THAT(Files(), UnorderedElementsAre("notes.txt", "logs/mail.log"));
}

TEST_F(RunFolderTest, WithoutForceAFolderMustBeEmpty) {
  Write("notes.txt");
  EXPECT_THAT([&] { RunFolder(folder_.string(), experiment_, false); },
              ThrowsMessage<ConfigError>("--out " + folder_.string() +
                                         ": expected a new or empty folder, got one with files in it (--force replaces "
                                         "those of an earlier run, and keeps others)"));
}

TEST_F(RunFolderTest, AFolderToWhichARunIsWritingIsNobodyElses) {
  const auto refused = [&](const std::string& run) {
    for (const bool force : {false, true})
      EXPECT_THAT([&] { RunFolder(folder_.string(), experiment_, force); },
                  ThrowsMessage<ConfigError>("--out " + folder_.string() +
                                             ": expected a folder to which no run is writing, got that of " + run +
                                             " (process " + std::to_string(getpid()) + ")"));
  };
  {
    const RunFolder ours(folder_.string(), experiment_, /*force=*/false);
    refused("a run");
    WriteRun();
    const auto before = Files();
    refused("the run 'a'");
    EXPECT_EQ(Files(), before);
  }
  Force();
  EXPECT_THAT(Files(), IsEmpty());
}

}  // namespace
}  // namespace mascot
