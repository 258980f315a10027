#include "system/left_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <filesystem>
#include <string>

#include "tests/support/scratch.h"

namespace mascot {
namespace {

TEST(LeftFile, HasWhatWasWritten) {
  const ScratchFolder folder;
  const std::string path = folder.File("words");
  {
    LeftFile file(path.c_str());
    file.Write("one, ");
    file.Write("two");
  }
  EXPECT_EQ(ReadFile(path), "one, two");
}

TEST(LeftFile, TakesNobodysPlace) {
  const ScratchFolder folder;
  const std::string path = folder.File("words"), link = folder.File("link"), target = folder.File("target");
  WriteFile(path, "earlier");
  std::filesystem::create_symlink(target, link);
  LeftFile(path.c_str()).Write("later");
  LeftFile(link.c_str()).Write("later");
  EXPECT_EQ(ReadFile(path), "earlier");
  EXPECT_FALSE(std::filesystem::exists(target));
}

TEST(LeftFile, ThatCannotBeWrittenWholeIsRemoved) {
  const ScratchFolder folder;
  const std::string path = folder.File("words");
  const auto before = ::signal(SIGXFSZ, SIG_IGN);
  rlimit unlimited{};
  getrlimit(RLIMIT_FSIZE, &unlimited);
  const rlimit small{10, unlimited.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  {
    LeftFile file(path.c_str());
    file.Write("{\"exit\": 1,");
    file.Write(" }");
  }
  setrlimit(RLIMIT_FSIZE, &unlimited);
  ::signal(SIGXFSZ, before);
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace mascot
