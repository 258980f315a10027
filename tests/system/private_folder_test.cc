#include "system/private_folder.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>

#include "system/spawn.h"
#include "tests/support/scratch.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

/// Lets private folders be made in a scratch folder.
class PrivateFolderTest : public testing::Test {
 protected:
  PrivateFolderTest() {
    if (const char* before = std::getenv("TMPDIR")) before_ = before;
    setenv("TMPDIR", scratch_.path().c_str(), 1);
  }
  ~PrivateFolderTest() override {
    if (before_.empty())
      unsetenv("TMPDIR");
    else
      setenv("TMPDIR", before_.c_str(), 1);
  }
  std::ptrdiff_t Count() const { return std::distance(fs::directory_iterator(scratch_.path()), {}); }

  std::string before_;
  const ScratchFolder scratch_;
};

TEST_F(PrivateFolderTest, HasFilesThatOnlyItsUserReads) {
  const PrivateFolder folder;
  folder.Write("deep/er/x", "bytes");
  EXPECT_EQ(ReadFile(folder.path() / "deep/er/x"), "bytes");
  struct stat info {};
  ASSERT_EQ(stat(folder.path().c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0700U);
  ASSERT_EQ(stat((folder.path() / "deep/er/x").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0400U);
  folder.Write("tool", "#!/bin/sh\n", /*is_executable=*/true);
  ASSERT_EQ(stat((folder.path() / "tool").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0500U);
}

TEST_F(PrivateFolderTest, GoesWithItsObject) {
  { const PrivateFolder folder; }
  EXPECT_EQ(Count(), 0);
}

TEST_F(PrivateFolderTest, StaysForTheProcessWhenACopyOfItEnds) {
  auto folder = std::make_unique<PrivateFolder>();
  Fork([&] { folder.reset(); }).Reap();
  EXPECT_TRUE(fs::exists(folder->path()));
}

TEST_F(PrivateFolderTest, OfAProcessThatWasKilledIsSwept) {
  ChildProcess child = Fork([] {
    const PrivateFolder folder;
    folder.Write("x", "");
    pause();
  });
  test::Await("its file, which is written once the folder is locked", [&] {
    const auto folders = fs::directory_iterator(scratch_.path());
    return std::any_of(begin(folders), end(folders),
                       [](const auto& folder) { return fs::exists(folder.path() / "x"); });
  });
  SweepPrivateFolders();
  EXPECT_EQ(Count(), 1) << "it is in use";
  child.Signal(SIGKILL);
  child.Reap();
  EXPECT_EQ(Count(), 1);
  SweepPrivateFolders();
  EXPECT_EQ(Count(), 0);
}

TEST_F(PrivateFolderTest, IsAllThatIsSwept) {
  fs::create_directory(scratch_.path() / "mascot-other");
  WriteFile(scratch_.File("mascot-files-x"), "");  // no folder
  fs::create_directory_symlink("mascot-other", scratch_.path() / "mascot-files-link");
  SweepPrivateFolders();
  EXPECT_EQ(Count(), 3);
}

TEST_F(PrivateFolderTest, IsInTmpIfTmpdirIsNoFolder) {
  setenv("TMPDIR", "/nowhere", 1);
  const PrivateFolder folder;
  EXPECT_EQ(folder.path().parent_path(), "/tmp");
}

}  // namespace
}  // namespace mascot
