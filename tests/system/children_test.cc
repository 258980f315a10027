// Child processes and their output, tested with programs that every system has.
#include "system/children.h"

#include <gmock/gmock.h>

#include <chrono>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/scratch.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using test::Await;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;
using testing::ThrowsMessage;

class ChildrenTest : public testing::Test {
 protected:
  void Spawn(const std::string& process, const std::string& script) {
    children_.Spawn(process, "/bin/sh", {"-c", script}, folder_.File(process + ".log"));
  }
  void Take(const std::string& process, const std::string& line) {
    const std::lock_guard lock(mutex_);
    lines_.emplace_back(process, line);
  }
  std::vector<std::pair<std::string, std::string>> lines() {
    const std::lock_guard lock(mutex_);
    return lines_;
  }
  void AwaitLines(std::size_t count) {
    Await(std::to_string(count) + " lines", [&] { return lines().size() >= count; });
  }
  /// Waits for `count` exits.
  std::vector<Exit> AwaitExits(std::size_t count) {
    std::vector<Exit> exits;
    Await(std::to_string(count) + " exits", [&] {
      const std::vector<Exit> more = children_.Reap();
      exits.insert(exits.end(), more.begin(), more.end());
      return exits.size() >= count;
    });
    return exits;
  }

  ScratchFolder folder_;
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::string>> lines_;
  ChildLogs logs_{[this](const std::string& process, const std::string& line) { Take(process, line); },
                  [this](const std::string& words) { Take("", words); }};
  Children children_{logs_};
};

TEST_F(ChildrenTest, EveryLineGoesToTheSinkAndToTheLogOfItsProcess) {
  Spawn("agent_1", "echo one; echo two >&2; printf three");
  Spawn("agent_2", "echo other");
  EXPECT_THAT(AwaitExits(2), SizeIs(2));
  EXPECT_THAT(logs_.LastLines("agent_1"), ElementsAre("one", "two", "three"));
  EXPECT_THAT(logs_.LastLines("agent_2"), ElementsAre("other"));
  EXPECT_THAT(lines(), testing::UnorderedElementsAre(Pair("agent_1", "one"), Pair("agent_1", "two"),
                                                     Pair("agent_1", "three"), Pair("agent_2", "other")));
  EXPECT_EQ(ReadFile(folder_.File("agent_1.log")), "one\ntwo\nthree\n");
  EXPECT_EQ(ReadFile(folder_.File("agent_2.log")), "other\n");
}

TEST_F(ChildrenTest, OnlyTheLastTenLinesAreKept) {
  Spawn("agent_1", "for i in 1 2 3 4 5 6 7 8 9 10 11 12; do echo $i; done");
  AwaitExits(1);
  EXPECT_THAT(logs_.LastLines("agent_1"), ElementsAre("3", "4", "5", "6", "7", "8", "9", "10", "11", "12"));
}

TEST_F(ChildrenTest, WhatIsNoUtf8IsReplacedInLinesAndKeptInTheLog) {
  Spawn("agent_1", "printf 'Gr\\374n \\303\\274\\n'");
  AwaitExits(1);
  EXPECT_THAT(logs_.LastLines("agent_1"), ElementsAre("Gr\xEF\xBF\xBDn \xC3\xBC"));
  EXPECT_EQ(ReadFile(folder_.File("agent_1.log")), "Gr\374n \xC3\xBC\n");
}

TEST_F(ChildrenTest, WhatActsOnATerminalIsEscapedInLinesAndKeptInTheLog) {
  Spawn("agent_1", "printf '\\033[31mred\\342\\200\\256\\r\\n'");
  AwaitExits(1);
  EXPECT_THAT(logs_.LastLines("agent_1"), ElementsAre("\\u001b[31mred\\u202e\\r"));
  EXPECT_EQ(ReadFile(folder_.File("agent_1.log")), "\033[31mred\u202e\r\n");
}

TEST_F(ChildrenTest, ALineThatIsNotOverIsInTheLogAtOnce) {
  Spawn("agent_1", "printf 'step 1 ...'; exec sleep 1000");
  EXPECT_TRUE(Await("the line in the log", [&] { return ReadFile(folder_.File("agent_1.log")) == "step 1 ..."; }));
  EXPECT_THAT(lines(), IsEmpty()) << "it may go on";
}

TEST_F(ChildrenTest, ALineWithoutEndIsTakenInPieces) {
  Spawn("agent_1", "printf '%05000d' 1; exec sleep 1000");
  AwaitLines(1);
  EXPECT_THAT(lines(), ElementsAre(Pair("agent_1", std::string(4096, '0'))));
  children_.Kill();
  EXPECT_THAT(logs_.LastLines("agent_1"), ElementsAre(std::string(4096, '0'), std::string(903, '0') + "1"));
  EXPECT_EQ(ReadFile(folder_.File("agent_1.log")), std::string(4999, '0') + "1\n");
}

TEST_F(ChildrenTest, ALongLineIsCutBetweenCharacters) {
  Spawn("agent_1", "printf '%04095d\\303\\274\\n' 0");
  AwaitExits(1);
  EXPECT_THAT(logs_.LastLines("agent_1"), ElementsAre(std::string(4095, '0'), "\xC3\xBC"));
}

TEST_F(ChildrenTest, AnExitSaysItsCodeOrItsSignal) {
  Spawn("polite", "exit 3");
  const std::vector<Exit> polite = AwaitExits(1);
  ASSERT_THAT(polite, SizeIs(1));
  EXPECT_EQ(polite[0].process, "polite");
  EXPECT_EQ(polite[0].Text(), "exited with code 3");
  Spawn("killed", "kill -SEGV $$");
  const std::vector<Exit> killed = AwaitExits(1);
  ASSERT_THAT(killed, SizeIs(1));
  EXPECT_EQ(killed[0].Text(), "was killed by signal 11 (Segmentation fault)");
}

TEST_F(ChildrenTest, AChildThatIgnoresSigtermIsKilled) {
  Spawn("deaf", "trap '' TERM; echo up; while :; do :; done");
  AwaitLines(1);
  children_.Stop(50ms);
  EXPECT_THAT(children_.Reap(), IsEmpty());
  EXPECT_TRUE(children_.WaitAll(0ms));
}

TEST_F(ChildrenTest, AChildThatHandlesSigtermEndsByItself) {
  Spawn("orderly", "trap 'echo down; exit 0' TERM; echo up; while :; do :; done");
  AwaitLines(1);
  children_.Stop(test::kPatience);
  EXPECT_THAT(logs_.LastLines("orderly"), ElementsAre("up", "down"));
}

TEST_F(ChildrenTest, ItIsKnownWhenASignalHasKilledOne) {
  Spawn("one", "exit 137");
  AwaitExits(1);
  EXPECT_FALSE(children_.killed_at()) << "it has ended by itself";
  const auto before = std::chrono::steady_clock::now();
  Spawn("one", "kill -9 $$");
  AwaitExits(1);
  ASSERT_TRUE(children_.killed_at());
  EXPECT_GE(*children_.killed_at(), before);
  EXPECT_LE(*children_.killed_at(), std::chrono::steady_clock::now());
}

TEST_F(ChildrenTest, AChildThatIsKilledFromHereCountsAsKilled) {
  Spawn("one", "exec sleep 1000");
  children_.Kill("one");
  EXPECT_TRUE(children_.killed_at());
}

TEST_F(ChildrenTest, AProgramThatIsNotThereIsNamed) {
  EXPECT_THAT([&] { children_.Spawn("agent_1", "/nowhere/agent", {}, folder_.File("agent_1.log")); },
              ThrowsMessage<std::runtime_error>("cannot start /nowhere/agent: No such file or directory"));
}

TEST_F(ChildrenTest, ALogOnAFullDiskSaysSoOnceAndLinesAreStillPassedOn) {
  children_.Spawn("agent_1", "/bin/sh", {"-c", "echo one; echo two; sleep 0.05; echo three"}, "/dev/full");
  AwaitExits(1);
  EXPECT_THAT(logs_.LastLines("agent_1"), ElementsAre("one", "two", "three"));
  const std::string words =
      "cannot write /dev/full: No space left on device: this log ends here, and what would follow is lost";
  EXPECT_THAT(lines(), testing::UnorderedElementsAre(Pair("agent_1", "one"), Pair("agent_1", "two"),
                                                     Pair("agent_1", "three"), Pair("", words)));
}

TEST_F(ChildrenTest, ALogThatCannotBeWrittenIsNamed) {
  EXPECT_THAT(
      [&] {
        children_.Spawn("agent_1", "/bin/sh", {"-c", "true"}, "/nowhere/agent_1.log");
      },
      ThrowsMessage<std::runtime_error>("cannot write /nowhere/agent_1.log: No such file or directory"));
}

}  // namespace
}  // namespace mascot
