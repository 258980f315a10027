#include "orchestrator/sweep_file.h"

#include <gmock/gmock.h>

#include "experiment/section.h"
#include "tests/scratch.h"

namespace mascot {
namespace {

using ::testing::ThrowsMessage;

const SweepFile::Cells kColumns = {"run", "law.beta", "error"};

class SweepFileTest : public ::testing::Test {
 protected:
  std::string Text() const { return ReadFile(path_); }
  ScratchFolder folder_;
  std::string path_ = folder_.File("sweep.csv");
};

TEST_F(SweepFileTest, HoldsRowsAsTheyCome) {
  SweepFile file(path_, kColumns, "plan", false);
  file.Add(2, {"0.5", ""});
  EXPECT_EQ(Text(), "run,law.beta,error\n2,0.5,\n") << "on the disk at once";
  file.Add(0, {"0.1", "a, \"b\"\nc"});
  EXPECT_EQ(Text(), "run,law.beta,error\n2,0.5,\n0,0.1,\"a, \"\"b\"\" c\"\n");
  file.Sort();
  EXPECT_EQ(Text(), "run,law.beta,error\n0,0.1,\"a, \"\"b\"\" c\"\n2,0.5,\n");
}

TEST_F(SweepFileTest, GoesOnWhereItEndedAtWhateverByteItWasCut) {
  {
    SweepFile file(path_, kColumns, "plan", false);
    for (std::size_t run = 0; run < 3; ++run) file.Add(run, {"0.5", "some words"});
  }
  const std::string whole = Text();
  const std::string header = "run,law.beta,error\n";
  for (std::size_t bytes = header.size(); bytes <= whole.size(); ++bytes) {
    WriteFile(path_, whole.substr(0, bytes));
    SweepFile file(path_, kColumns, "plan", false);
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
    SweepFile file(path_, kColumns, "plan", false);
    file.Add(0, {"0.5", "no such thing"});
    file.Add(1, {"0.5", "the process was killed by signal 9 (Killed)"});
  }
  const SweepFile file(path_, kColumns, "plan", false);
  EXPECT_TRUE(file.Has(0));
  EXPECT_FALSE(file.Has(1)) << "it is flown again";
}

TEST_F(SweepFileTest, IsNotMixedWithAnotherSweep) {
  { SweepFile file(path_, kColumns, "plan", false); }
  EXPECT_THAT(
      [&] { SweepFile(path_, kColumns, "other plan", false); },
      ThrowsMessage<ConfigError>("--out " + path_ +
                                 ": expected a new file, or one of this very sweep, got another (--force begins "
                                 "anew)"));
  WriteFile(path_, "something else\n");
  EXPECT_THAT([&] { SweepFile(path_, kColumns, "plan", false); },
              ThrowsMessage<ConfigError>("--out " + path_ + ": expected the columns of this sweep, got others"));
  WriteFile(path_, "run,law.beta,error\nx,1,\n");
  EXPECT_THAT(
      [&] { SweepFile(path_, kColumns, "plan", false); },
      ThrowsMessage<ConfigError>("--out " + path_ + ": expected rows that begin with a run's number, got 'x,1,\n'"));
  SweepFile anew(path_, kColumns, "plan", true);
  EXPECT_EQ(Text(), "run,law.beta,error\n");
}

TEST_F(SweepFileTest, SaysThatItCannotBeWritten) {
  EXPECT_THROW(SweepFile(folder_.File("nowhere/sweep.csv"), kColumns, "plan", false), std::runtime_error);
}

}  // namespace
}  // namespace mascot
