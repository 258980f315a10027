#include "system/new_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <filesystem>
#include <string>

#include "tests/support/scratch.h"

namespace mascot {
namespace {

TEST(NewFile, HasWhatWasWritten) {
  const ScratchFolder folder;
  const std::string path = folder.File("words");
  {
    NewFile file(path.c_str());
    file.Write("one, ");
    file.Write("two");
  }
  EXPECT_EQ(ReadFile(path), "one, two");
}

TEST(NewFile, TakesNobodysPlace) {
  const ScratchFolder folder;
  const std::string path = folder.File("words"), link = folder.File("link"), target = folder.File("target");
  WriteFile(path, "earlier");
  std::filesystem::create_symlink(target, link);
  NewFile(path.c_str()).Write("later");
  NewFile(link.c_str()).Write("later");
  EXPECT_EQ(ReadFile(path), "earlier");
  EXPECT_FALSE(std::filesystem::exists(target));
}

TEST(NewFile, ThatCannotBeWrittenWholeIsRemoved) {
  const ScratchFolder folder;
  const std::string path = folder.File("words");
  const auto before = ::signal(SIGXFSZ, SIG_IGN);
  rlimit unlimited{};
  getrlimit(RLIMIT_FSIZE, &unlimited);
  const rlimit small{10, unlimited.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  {
    NewFile file(path.c_str());
    file.Write("{\"exit\": 1,");
    file.Write(" }");
  }
  setrlimit(RLIMIT_FSIZE, &unlimited);
  ::signal(SIGXFSZ, before);
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace mascot
