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

#include "tests/support/folders.h"
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

/// The text of a call in Python, up to the bracket that ends it.
std::string_view CallAt(std::string_view text, std::size_t begin) {
  int open = 0;
  for (std::size_t at = begin; at < text.size(); ++at) {
    open += (text[at] == '(') - (text[at] == ')');
    if (text[at] == ')' && open == 0) return text.substr(begin, at + 1 - begin);
  }
  return text.substr(begin);
}

/// What waits in a file without a deadline, or may.
std::vector<std::string> EndlessWaits(const std::filesystem::path& file) {
  const std::string text = ReadFile(file);
  std::vector<std::string> found;
  const auto each = [&](const char* words, auto&& is_endless) {
    for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
      if (is_endless(at)) found.push_back(text.substr(at, 60));
  };
  const auto always = [](std::size_t) { return true; };
  const auto without_limit = [&](std::size_t at) {
    const std::string_view call = CallAt(text, at);
    return call.find("timeout=") == std::string_view::npos && call.find("LIMIT_S") == std::string_view::npos;
  };
  if (file.extension() == ".cc" || file.extension() == ".h") {
    for (const char* words : {"this_thread::yield", "this_thread::sleep_for", "popen("}) each(words, always);
    for (const char* words : {" waitpid(", ":waitpid("})
      each(words, [&](std::size_t at) { return CallAt(text, at).find("WNOHANG") == std::string_view::npos; });
  }
  if (file.extension() == ".py")
    for (const char* words : {"subprocess.run(", "subprocess.check_", "subprocess.call(", ".communicate(", "up.wait("})
      each(words, without_limit);
  if (file.extension() == ".mjs" && file.filename() != "waits.mjs") each("test} from \"node:test\"", always);
  return found;
}

TEST(Waits, HaveADeadlineInAllTests) {
  // These give the others their deadlines; the stranger is a program that a test ends.
  const std::vector<std::string> apart = {"waits.h", "waits_test.cc", "scratch.h", "cyclone_note.cc"};
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SourceFolder() + "/tests")) {
    if (!entry.is_regular_file()) continue;
    if (std::ranges::find(apart, entry.path().filename().string()) != apart.end()) continue;
    if (entry.path().string().find("node_modules") != std::string::npos) continue;
    ++files;
    EXPECT_THAT(EndlessWaits(entry.path()), ::testing::IsEmpty()) << entry.path();
  }
  EXPECT_GT(files, 100);
}

TEST(Running, EndsAProgramThatTheTestHasStopped) {
  const ScratchFolder folder;
  pid_t pid = 0;
  {
    const Running program("sleep", {"1000"}, folder.File("sleep"));
    pid = program.pid();
    program.Signal(SIGSTOP);
  }
  EXPECT_NE(kill(pid, 0), 0);
}

}  // namespace
}  // namespace mascot::test
