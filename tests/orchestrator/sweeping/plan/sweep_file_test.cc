#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "experiment/toml/section.h"
#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/table/table.h"
#include "tests/support/scratch.h"
#include "tests/support/strict_csv.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const SweepFile::Cells kSweepColumns = {"run", "law.beta", "error"};

class SweepFileTest : public ::testing::Test {
 protected:
  std::string Text() const { return ReadFile(path_); }
  ScratchFolder folder_;
  std::string path_ = folder_.File("sweep.csv");
};

TEST_F(SweepFileTest, ContainsRowsInTheOrderInWhichTheyCome) {
  SweepFile file(path_, kSweepColumns, "plan", false);
  file.Add(2, {"0.5", ""});
  EXPECT_EQ(Text(), "run,law.beta,error\n2,0.5,\n") << "on the disk at once";
  file.Add(0, {"0.1", "a, \"b\"\nc"});
  EXPECT_EQ(Text(), "run,law.beta,error\n2,0.5,\n0,0.1,\"a, \"\"b\"\" c\"\n");
  file.Sort();
  EXPECT_EQ(Text(), "run,law.beta,error\n0,0.1,\"a, \"\"b\"\" c\"\n2,0.5,\n");
}

TEST_F(SweepFileTest, GoesOnWhereItEndedAtWhateverByteItWasCut) {
  {
    SweepFile file(path_, kSweepColumns, "plan", false);
    for (std::size_t run = 0; run < 3; ++run) file.Add(run, {"0.5", "some words"});
  }
  const std::string whole = Text();
  const std::string header = "run,law.beta,error\n";
  for (std::size_t bytes = header.size(); bytes <= whole.size(); ++bytes) {
    WriteFile(path_, whole.substr(0, bytes));
    SweepFile file(path_, kSweepColumns, "plan", false);
    const std::size_t line = std::string("0,0.5,some words\n").size();
    ASSERT_EQ(file.rows(), (bytes - header.size()) / line) << bytes;
    for (std::size_t run = 0; run < 3; ++run)
      if (!file.Has(run)) file.Add(run, {"0.5", "some words"});
    file.Sort();
    ASSERT_EQ(Text(), whole) << bytes;
  }
}

TEST_F(SweepFileTest, ForgetsRunsWhoseProcessDied) {
  {
    SweepFile file(path_, kSweepColumns, "plan", false);
    file.Add(0, {"0.5", "no such thing"});
    file.Add(1, {"0.5", "the process was killed by signal 9 (Killed)"});
  }
  const SweepFile file(path_, kSweepColumns, "plan", false);
  EXPECT_TRUE(file.Has(0));
  EXPECT_FALSE(file.Has(1)) << "it is flown again";
}

TEST_F(SweepFileTest, IsNotMixedWithAnotherSweep) {
  SweepFile(path_, kSweepColumns, "plan", false).Add(0, {"0.5", ""});
  EXPECT_THAT(
      [&] { SweepFile(path_, kSweepColumns, "other plan", false); },
      ThrowsMessage<ConfigError>("--out " + path_ +
                                 ": expected a new file, or one of this very sweep, got another (--force begins "
                                 "anew)"));
  const auto differs = [](const std::string& theirs) { return theirs == "plan" ? "a word" : ""; };
  EXPECT_THAT([&] { SweepFile(path_, kSweepColumns, "other plan", false, differs); },
              ThrowsMessage<ConfigError>(HasSubstr("got another, which differs in a word (--force begins anew)")));
  {
    const SweepFile same(path_, kSweepColumns, "the same in other words", false, [](const auto&) { return ""; });
    EXPECT_EQ(same.rows(), 1u);
  }
  SweepFile(path_, kSweepColumns, "plan", true).Add(0, {"0.5", ""});
  WriteFile(path_, "something else\n");
  EXPECT_THAT([&] { SweepFile(path_, kSweepColumns, "plan", false); },
              ThrowsMessage<ConfigError>(path_ + ": expected the columns of this sweep, got others"));
  SweepFile anew(path_, kSweepColumns, "plan", true);
  EXPECT_EQ(Text(), "run,law.beta,error\n");
}

TEST_F(SweepFileTest, DoesNotReplaceAFileThatIsNotItsTable) {
  WriteFile(path_, "a person's own table\n");
  EXPECT_THAT(
      [&] { SweepFile(path_, kSweepColumns, "plan", false); },
      ThrowsMessage<ConfigError>(HasSubstr(": expected a new file, or one of this very sweep, got another, without the "
                                           "sweep.csv.plan that says what it is of (--force")));
  EXPECT_EQ(Text(), "a person's own table\n");
  EXPECT_FALSE(std::filesystem::exists(path_ + ".plan"));
  EXPECT_THAT([&] { SweepFile("/dev/null", kSweepColumns, "plan", true); },
              ThrowsMessage<ConfigError>("--out /dev/null: expected a file, got something else"));
}

TEST_F(SweepFileTest, ReplacesATableWithoutRows) {
  WriteFile(path_, "run,law.beta,error\n");  // as after a kill before the plan is written
  EXPECT_NO_THROW(SweepFile(path_, kSweepColumns, "plan", false));
}

TEST_F(SweepFileTest, DropsAnIncompleteLastRow) {
  SweepFile(path_, kSweepColumns, "plan", false).Add(7, {"0.5", ""});
  WriteFile(path_, "run,law.beta,error\n0,0.5,\n3,0.5,\"an error, the process too\"\n1,0.5,");
  SweepFile file(path_, kSweepColumns, "plan", false);
  EXPECT_EQ(file.rows(), 2);
  EXPECT_TRUE(file.Has(0));
  EXPECT_TRUE(file.Has(3)) << "it failed by itself";
}

TEST_F(SweepFileTest, NamesTheLineAndTheColumnOfWhatNoSweepHasWritten) {
  const SweepFile::Cells columns = {"run", "law.beta", "error", "sim_s"};
  const SweepPlan plan({.sets = {"law.beta=0.5,0.7"}, .randoms = {}, .samples = 1, .seeds = ""});
  const auto refusal = [&](const std::string& rows) -> std::string {
    std::filesystem::remove(path_);
    SweepFile(path_, columns, "plan", true, {}, &plan).Add(0, {"0.5", "", "1.0"});
    WriteFile(path_, "run,law.beta,error,sim_s\n0,0.5,,1.0\n" + rows);
    try {
      const SweepFile file(path_, columns, "plan", false, {}, &plan);
    } catch (const ConfigError& error) {
      const std::string text = error.what();
      EXPECT_TRUE(text.starts_with(path_ + ":3: ")) << text;
      return text.substr(std::min(text.size(), path_.size() + 4));
    }
    return "";
  };
  EXPECT_EQ(refusal("1,0.7,,\n"), "");
  EXPECT_EQ(refusal("1,0.7,,inf\n"), "");
  EXPECT_EQ(refusal("1,0.7,an error,\n"), "");
  EXPECT_EQ(refusal("1,0.7,\n"), "expected 4 cells, got 3");
  EXPECT_EQ(refusal("1,0.7,,1.0,2\n"), "expected 4 cells, got 5");
  EXPECT_EQ(refusal("\n"), "expected 4 cells, got 1");
  EXPECT_EQ(refusal("x,0.7,,1.0\n"), "run: expected a number of a run below 2, got 'x'");
  EXPECT_EQ(refusal("2,0.7,,1.0\n"), "run: expected a number of a run below 2, got '2'");
  EXPECT_EQ(refusal("-1,0.7,,1.0\n"), "run: expected a number of a run below 2, got '-1'");
  EXPECT_EQ(refusal("0,0.5,,1.0\n"), "run: expected each run once, got 0 again");
  EXPECT_EQ(refusal("1,0.5,,1.0\n"), "law.beta: expected 0.7, which run 1 of this sweep has, got '0.5'");
  EXPECT_EQ(refusal("1,0.7,,fast\n"), "sim_s: expected a number, true, false or nothing, got 'fast'");
  EXPECT_EQ(refusal("1,0.7,,1.0\r\n"), "sim_s: expected a number, true, false or nothing, got '1.0\\r'");
  EXPECT_EQ(refusal("1,\"0.7\",,1.0\n"),
            "expected cells as a sweep writes them, got other quotes or a carriage return");
}

/// Opens the table in another process, since locks are held by processes. Returns 0 if it opens, 2 if it is locked.
int OpenedElsewhere(const std::string& path) {
  const pid_t pid = fork();
  if (pid == 0) {
    try {
      const SweepFile other(path, kSweepColumns, "plan", true);
      _exit(0);
    } catch (const ConfigError& error) {
      const std::string expected = ": expected a table of this sweep's own, got one that another is writing";
      _exit(error.what() == "--out " + path + expected ? 2 : 3);
    }
  }
  const int status = test::AwaitEndOf(pid, "a process that opens a table");
  return WEXITSTATUS(status);
}

TEST_F(SweepFileTest, IsWrittenByOneSweepAtATime) {
  {
    const SweepFile file(path_, kSweepColumns, "plan", false);
    EXPECT_EQ(OpenedElsewhere(path_), 2);
  }
  EXPECT_EQ(OpenedElsewhere(path_), 0);
}

TEST_F(SweepFileTest, FollowsLinks) {
  WriteFile(folder_.File("table.csv"), "");
  std::filesystem::create_symlink(folder_.File("table.csv"), path_);
  SweepFile(path_, kSweepColumns, "plan", false).Add(0, {"0.5", ""});
  EXPECT_TRUE(std::filesystem::is_symlink(path_));
  EXPECT_EQ(ReadFile(folder_.File("table.csv")), "run,law.beta,error\n0,0.5,\n");
}

TEST_F(SweepFileTest, IsReadByAStrictReaderWhateverStandsInItsCells) {
  const SweepFile::Cells columns = {"run", "law.params.\"a,b\"", "error", "c\"d"};
  SweepFile file(path_, columns, "plan", false);
  file.Add(0, {"'x, \"y\"'", "a\nb\r, c", "0.5"});
  file.Add(1, {"\"", "", "true"});
  file.Sort();
  const std::vector<SweepFile::Cells> rows = {columns, {"0", "'x, \"y\"'", "a b , c", "0.5"}, {"1", "\"", "", "true"}};
  EXPECT_EQ(StrictCsv(Text()), rows) << "a row is one line";
  std::vector<SweepFile::Cells> read{columns};
  file.ForEachRow([&](const SweepFile::Cells& cells) { read.push_back(cells); });
  EXPECT_EQ(read, rows);
}

TEST_F(SweepFileTest, SaysThatItCannotBeWritten) {
  EXPECT_THROW(SweepFile(folder_.File("nowhere/sweep.csv"), kSweepColumns, "plan", false), std::runtime_error);
}

}  // namespace
}  // namespace mascot
