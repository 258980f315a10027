// The runs of a folder: what is told of them, and which files go when a run is removed.
#include "orchestrator/recording/run_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiment/toml/section.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/recording/run_folder.h"
#include "system/folder_lock.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

class RunList : public ::testing::Test {
 protected:
  /// Makes a run folder as `up` leaves it. Returns its path.
  std::string Make(const std::string& name, const std::string& time, const std::string& summary) {
    const fs::path folder = fs::path(scratch_.File("runs")) / name / time;
    fs::create_directories(folder / "logs");
    WriteFile((folder / "config.toml").string(), "format = 1\n[run]\nname = '" + name + "'\n");
    WriteFile((folder / "summary.json").string(), summary);
    WriteFile((folder / "paths.png").string(), "12345");
    WriteFile((folder / "logs" / "orchestrator.log").string(), "");
    McapWriter(folder / "run.mcap").Close();
    return folder.string();
  }
  /// Moves the config.toml of a run so many hours into the past.
  static void Age(const std::string& run, int hours) {
    const fs::path config = fs::path(run) / "config.toml";
    fs::last_write_time(config, fs::last_write_time(config) - std::chrono::hours(hours));
  }
  std::string runs() const { return scratch_.File("runs"); }

  ScratchFolder scratch_;
};

TEST_F(RunList, TellsTheNewestFirst) {
  const std::string old = Make("leaderless", "2026-05-04_10-11-12", R"({"sim_s": 40.0, "exit": 0})");
  const std::string young = Make("coverage", "2026-05-05_10-11-12", R"({"sim_s": 1.5, "exit": 1})");
  Age(old, 2);
  Age(young, 1);
  NoteRun(young, "too slow by far");
  const std::vector<ListedRun> listed = ListRuns(runs());
  EXPECT_THAT(listed, ElementsAre(Field(&ListedRun::folder, young), Field(&ListedRun::folder, old)));
  EXPECT_EQ(listed[0].name, "coverage");
  EXPECT_EQ(listed[0].sim_s, 1.5);
  EXPECT_EQ(listed[0].exit, 1);
  EXPECT_EQ(listed[0].note, "too slow by far");
  EXPECT_EQ(listed[1].note, "");
  std::uint64_t bytes = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(old))
    bytes += entry.is_regular_file() ? entry.file_size() : 0;
  EXPECT_EQ(listed[1].bytes, bytes);
  EXPECT_THAT(ListRuns(young), ElementsAre(Field(&ListedRun::folder, young))) << "a run itself";
}

TEST_F(RunList, SaysNothingOfWhatItCannotRead) {
  const std::string run = Make("a", "b", "no JSON");
  WriteFile(run + "/config.toml", "[[[");
  const std::vector<ListedRun> listed = ListRuns(runs());
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_EQ(listed[0].name, "");
  EXPECT_EQ(listed[0].sim_s, std::nullopt);
  EXPECT_EQ(listed[0].exit, std::nullopt);
}

TEST_F(RunList, KnowsWhichRunIsAlive) {
  const std::string run = Make("a", "b", "");
  EXPECT_FALSE(ListRuns(runs())[0].is_alive);
  const FolderLock held(run);
  EXPECT_TRUE(ListRuns(runs())[0].is_alive);
  EXPECT_THAT([&] { RemoveRun(run); },
              ThrowsMessage<ConfigError>(testing::StartsWith(
                  run + ": expected a folder to which no run is writing, got that of the run 'a'")));
}

TEST_F(RunList, RemovesARunWithItsNoteAndEmptyFolders) {
  const std::string run = Make("a", "b", "");
  NoteRun(run, "a note");
  RemoveRun(run);
  EXPECT_FALSE(fs::exists(run));
  EXPECT_FALSE(fs::exists(fs::path(run).parent_path())) << "no other run had the name";
  EXPECT_THAT(ListRuns(runs()), IsEmpty());
}

TEST_F(RunList, KeepsFilesThatNoRunHasMade) {
  const std::string run = Make("a", "b", "");
  WriteFile(run + "/thesis.tex", "mine");
  RemoveRun(run);
  EXPECT_TRUE(fs::exists(fs::path(run) / "thesis.tex"));
  EXPECT_FALSE(fs::exists(fs::path(run) / "run.mcap"));
  EXPECT_THAT([&] { RemoveRun(run); }, ThrowsMessage<ConfigError>(run + ": expected a run folder"));
}

TEST_F(RunList, RemovesNothingFromAFolderThatNoRunHasMade) {
  const std::string folder = scratch_.File("mine");
  fs::create_directories(folder);
  WriteFile(folder + "/config.toml", "run.duration_s = 1\n");
  EXPECT_THAT(
      [&] { RemoveRun(folder); },
      ThrowsMessage<ConfigError>(folder + ": expected the files of an earlier run, got config.toml, which no run "
                                          "has made"));
  EXPECT_TRUE(fs::exists(fs::path(folder) / "config.toml"));
}

TEST_F(RunList, ChangesAndRemovesANote) {
  const std::string run = Make("a", "b", "");
  NoteRun(run, "one");
  NoteRun(run, "two");
  EXPECT_EQ(ListRuns(run)[0].note, "two");
  NoteRun(run, "");
  EXPECT_FALSE(fs::exists(fs::path(run) / kNoteFile));
  EXPECT_THAT([&] { NoteRun(run, std::string(5000, 'x')); },
              ThrowsMessage<ConfigError>("--note: expected at most 4096 letters"));
  EXPECT_THAT([&] { NoteRun(runs(), "one"); }, ThrowsMessage<ConfigError>(runs() + ": expected a run folder"));
}

TEST_F(RunList, NeedsAFolder) {
  EXPECT_THAT([&] { ListRuns(runs()); }, ThrowsMessage<ConfigError>(runs() + ": expected a folder with runs"));
}

}  // namespace
}  // namespace mascot
