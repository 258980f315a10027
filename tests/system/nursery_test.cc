// Copies of one process of the program `agent`.
#include "system/nursery.h"

#include <gmock/gmock.h>

#include <map>

#include "system/children.h"
#include "system/descendants.h"
#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const Children::Patience kPatient{.limit_s = 60, .go_on = [] { return true; }};

class Nursery : public testing::Test {
 protected:
  void SetUp() override {
    AdoptDescendants();
    signal(SIGPIPE, SIG_IGN);  // as the orchestrator does
  }
  Children::CopyOf Copy(const std::string& process, const std::vector<std::string>& arguments) const {
    return {process, arguments, folder_.File(process + ".log")};
  }

  /// A program of these lines of sh.
  std::string Script(const std::string& lines) const {
    const std::string path = folder_.File("script");
    WriteFile(path, "#!/bin/sh\n" + lines + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }

  ScratchFolder folder_;
  ChildLogs logs_{[](const std::string&, const std::string&) {}, [](const std::string&) {}};
  Children children_{logs_};
};

TEST_F(Nursery, MakesChildrenOfOursWithArgumentsAndLogsOfTheirOwn) {
  const std::vector<pid_t> ids =
      children_.SpawnCopies(BuildFolder() + "/agent",
                            {Copy("helps", {"--help"}), Copy("refuses", {"--id", "3", "--domain", "none"})}, kPatient);
  ASSERT_EQ(ids.size(), 2);
  EXPECT_NE(ids[0], ids[1]);
  std::map<std::string, std::string> ends;
  Await("the end of both", [&] {
    for (const Exit& exit : children_.Reap()) ends[exit.process] = exit.Text();
    return ends.size() == 2;
  });
  EXPECT_EQ(ends["helps"], "exited with code 0");
  EXPECT_EQ(ends["refuses"], "exited with code 2");
  for (const char* process : {"helps", "refuses"}) logs_.LastLines(process);
  EXPECT_THAT(ReadFile(folder_.File("helps.log")), HasSubstr("MASCOT agent: hears its neighbours"));
  EXPECT_THAT(ReadFile(folder_.File("refuses.log")), HasSubstr("error: --domain: "));
}

TEST_F(Nursery, OfAProgramThatMakesNoCopiesIsAnError) {
  EXPECT_THAT(
      [&] {
        children_.SpawnCopies("/bin/true", {Copy("a", {}), Copy("b", {})}, kPatient);
      },
      ThrowsMessage<std::runtime_error>("cannot start /bin/true 2 times: it exited with code 0"));
  EXPECT_THAT([&] { children_.SpawnCopies("/no/agent", {Copy("c", {})}, kPatient); },
              ThrowsMessage<std::runtime_error>("cannot start /no/agent: No such file or directory"));
}

TEST_F(Nursery, ThatHangsIsWaitedForNoLongerThanOneMay) {
  const std::string hangs = Script("exec sleep 1000");
  EXPECT_THAT([&] { children_.SpawnCopies(hangs, {Copy("a", {})}, {.limit_s = 0.05, .go_on = [] { return true; }}); },
              ThrowsMessage<std::runtime_error>("cannot start " + hangs +
                                                " 1 times: it has not made its copies within 0.05 s"));
  EXPECT_THAT(children_.SpawnCopies(hangs, {Copy("b", {})}, {.limit_s = 60, .go_on = [] { return false; }}),
              testing::IsEmpty());
  EXPECT_TRUE(children_.empty());
}

TEST_F(Nursery, MayPrintWhatItLikes) {
  const std::string talks = Script("echo 1 2 3\nexec " + BuildFolder() + "/agent \"$@\"");
  ASSERT_EQ(children_.SpawnCopies(talks, {Copy("talks", {"--help"})}, kPatient).size(), 1);
  Await("its end", [&] { return !children_.Reap().empty(); });
  logs_.LastLines("talks");
  EXPECT_THAT(ReadFile(folder_.File("talks.log")), testing::StartsWith("1 2 3\nMASCOT agent: hears"));
}

TEST_F(Nursery, AnOrderThatEndsTooEarlyIsRefused) {
  const Ran ran = Shell("printf '0\\0002\\0001' | '" + BuildFolder() + "/agent' --nursery '       '");
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_THAT(ran.output, HasSubstr("error: --nursery: an order that ends too early"));
}

}  // namespace
}  // namespace mascot::test
