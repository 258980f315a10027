// The waits of tests: a wait in vain ends, and says what it waited for.
#include "tests/support/waits.h"

#include <gmock/gmock.h>
#include <gtest/gtest-spi.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/orchestrator.h"
#include "tests/support/scratch.h"

namespace mascot::test {
namespace {

using namespace std::chrono_literals;
using ::testing::ThrowsMessage;

TEST(Waits, InVainEndAndSayWhatTheyWaitedFor) {
  EXPECT_FALSE(Until([] { return false; }, 1ms));
  EXPECT_NONFATAL_FAILURE(Await(
                              "rain", [] { return false; }, 1ms),
                          "waited 1 ms in vain for rain");
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  EXPECT_NONFATAL_FAILURE(AwaitInput(ends[0], "a word", 1ms), "waited 1 ms in vain for a word");
  for (const int end : ends) close(end);
}

TEST(Waits, ForAThreadThatNeverEndsEndTheTest) {
  EXPECT_DEATH(
      {
        const Deadline deadline("the other thread", 1ms);
        std::this_thread::sleep_for(kPatience);
      },
      "waited 1 ms in vain for the other thread");
}

TEST(Waits, AreOverWithWhatTheyWaitFor) {
  EXPECT_TRUE(Await("the second look", [looks = 0]() mutable { return ++looks == 2; }));
  const Deadline deadline("nothing");
  Running program("true", {}, ScratchFolder().path());
  EXPECT_EQ(program.Wait(), 0);
}

TEST(Waits, ForAProgramThatGoesOnKillItAndNameIt) {
  const ScratchFolder folder;
  Running program("sleep", {"1000"}, folder.File("sleep"));
  const pid_t pid = program.pid();
  int end = 0;
  EXPECT_NONFATAL_FAILURE(end = program.Wait(1ms), "waited 1 ms in vain for the end of: sleep 1000");
  EXPECT_EQ(end, -SIGKILL);
  EXPECT_EQ(kill(pid, 0), -1) << "it is there still";
}

TEST(Waits, ForACommandThatGoesOnKillAllOfItAndNameIt) {
  const ScratchFolder folder;
  const std::string command = "sleep 1000 & echo $! > '" + folder.File("pid") + "'; echo begun; wait";
  EXPECT_THAT([&] { Shell(command, 500ms); },
              ThrowsMessage<std::runtime_error>("waited 500 ms in vain for the end of: " + command +
                                                "\nuntil then it has printed:\nbegun\n"));
  const std::string pid = ReadFile(folder.File("pid"));
  EXPECT_TRUE(Until([&] { return ReadFile("/proc/" + pid.substr(0, pid.size() - 1) + "/cmdline").empty(); }));
}

}  // namespace
}  // namespace mascot::test
