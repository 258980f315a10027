#include "system/log_file.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>

#include <filesystem>
#include <stdexcept>
#include <vector>

#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::ThrowsMessage;

class LogFileTest : public testing::Test {
 protected:
  LogFile Open(const std::string& path) {
    return {path, [this](const std::string& words) { told_.push_back(words); }};
  }

  ScratchFolder folder_;
  std::vector<std::string> told_;
};

TEST_F(LogFileTest, HasEveryTextAtOnceAndNothingOfAnEarlierOne) {
  const std::string path = folder_.File("a.log");
  WriteFile(path, "of yesterday, and longer than what follows\n");
  LogFile log = Open(path);
  EXPECT_EQ(ReadFile(path), "");
  log.Write("one\n");
  log.Write("two");
  EXPECT_EQ(ReadFile(path), "one\ntwo");
  EXPECT_THAT(told_, IsEmpty());
}

TEST_F(LogFileTest, ThatMeetsALimitEndsThereWithoutAGapAndSaysSoOnce) {
  const auto before = ::signal(SIGXFSZ, SIG_IGN);
  rlimit unlimited{};
  getrlimit(RLIMIT_FSIZE, &unlimited);
  const std::string path = folder_.File("a.log");
  LogFile log = Open(path);
  const rlimit small{10, unlimited.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  log.Write("12345678\n");
  log.Write("abcdefgh\n");
  setrlimit(RLIMIT_FSIZE, &unlimited);
  log.Write("of later\n");
  ::signal(SIGXFSZ, before);
  EXPECT_EQ(ReadFile(path), "12345678\na");
  EXPECT_THAT(told_, ElementsAre("cannot write " + path +
                                 ": File too large: this log ends here, and what would follow is lost"));
}

TEST_F(LogFileTest, OnAFullDiskSaysSoOnce) {
  LogFile log = Open("/dev/full");
  log.Write("one\n");
  log.Write("two\n");
  EXPECT_THAT(told_, ElementsAre("cannot write /dev/full: No space left on device: this log ends here, and what would "
                                 "follow is lost"));
}

TEST_F(LogFileTest, FollowsNoLink) {
  const std::string path = folder_.File("a.log"), target = folder_.File("target");
  WriteFile(target, "mine");
  std::filesystem::create_symlink(target, path);
  EXPECT_THAT([&] { Open(path); },
              ThrowsMessage<std::runtime_error>("cannot write " + path + ": Too many levels of symbolic links"));
  EXPECT_EQ(ReadFile(target), "mine");
}

}  // namespace
}  // namespace mascot
