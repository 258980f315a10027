// What follows a run: the exit code of the process and the one in summary.json are the same, whatever fails.
#include "orchestrator/report/ending.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <stdexcept>

#include "agent/laws/laws.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

class EndingTest : public testing::Test {
 protected:
  int End(int exit) {
    testing::internal::CaptureStderr();
    const int code = EndRun(folder_, exit, ending_);
    said_ = testing::internal::GetCapturedStderr();
    return code;
  }
  std::string Written() const { return ReadFile(folder_.File("summary.json")); }
  /// From now on summary.json cannot be written.
  void Block() const { std::filesystem::create_directories(folder_.File("summary.json.part/x")); }

  const ScratchFolder scratch_;
  const RunFolder folder_{
      scratch_.File("run"),
      LoadExperiment(Section::FromText("[run]\nduration_s = 1.0\n[agents]\ncount = 1\n", "a.toml"), "a"), false};
  Ending ending_{.summary = [](std::optional<int> exit) { return exit ? std::to_string(*exit) : std::string("null"); },
                 .draw =
                     [this] {
                       EXPECT_EQ(Written(), "null") << "not known yet";
                       return 0;
                     },
                 .print = [this](const std::string& summary) { printed_ = summary; }};
  std::string printed_, said_;
};

TEST_F(EndingTest, TheRunsExitCodeIsWrittenPrintedAndReturned) {
  for (const int exit : {0, 1, 130}) {
    EXPECT_EQ(End(exit), exit);
    EXPECT_EQ(Written(), std::to_string(exit));
    EXPECT_EQ(printed_, std::to_string(exit));
    EXPECT_EQ(said_, "");
  }
}

TEST_F(EndingTest, PicturesThatFailFailTheRun) {
  ending_.draw = []() -> int { throw std::runtime_error("no pictures"); };
  EXPECT_EQ(End(0), 1);
  EXPECT_EQ(said_, "error: no pictures\n");
  EXPECT_EQ(Written(), "1");
  EXPECT_EQ(End(143), 143) << "that came first";
}

TEST_F(EndingTest, AnInterruptionWhileDrawingIsTheExitCode) {
  ending_.draw = [] { return 130; };
  EXPECT_EQ(End(0), 130);
  EXPECT_EQ(Written(), "130");
}

TEST_F(EndingTest, ASummaryThatCannotBePrintedFailsTheRun) {
  ending_.print = [](const std::string&) { throw std::runtime_error("no stdout"); };
  EXPECT_EQ(End(0), 1);
  EXPECT_EQ(said_, "error: no stdout\n");
  EXPECT_EQ(Written(), "1");
}

TEST_F(EndingTest, ASummaryThatCannotBeWrittenAgainStatesNoExitCode) {
  ending_.draw = [this] {
    Block();
    return 0;
  };
  EXPECT_EQ(End(0), 1);
  EXPECT_EQ(said_, "error: cannot create " + folder_.File("summary.json.part").string() + ": Is a directory\n");
  EXPECT_EQ(Written(), "null");
  EXPECT_EQ(printed_, "1");
}

TEST_F(EndingTest, ASummaryThatCanBeNeitherWrittenNorPrintedIsNotThere) {
  ending_.print = [this](const std::string&) {
    Block();
    throw std::runtime_error("no stdout");
  };
  EXPECT_EQ(End(0), 1);
  EXPECT_FALSE(std::filesystem::exists(folder_.File("summary.json")));
}

TEST_F(EndingTest, AFullDiskIsNamedAndLeavesNoHalfFile) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{4096, before.rlim_max};  // the error's words fit into a file, the first summary does not
  ending_.summary = [](std::optional<int> exit) { return exit ? std::to_string(*exit) : std::string(5000, ' '); };
  ::setrlimit(RLIMIT_FSIZE, &small);
  ending_.draw = [this, &before] {
    ::setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_FALSE(std::filesystem::exists(folder_.File("summary.json")));
    return 0;
  };
  EXPECT_EQ(End(0), 1);
  EXPECT_EQ(said_, "error: cannot write " + folder_.File("summary.json.part").string() + ": File too large\n");
  EXPECT_EQ(Written(), "1") << "there was space again";
}

}  // namespace
}  // namespace mascot
