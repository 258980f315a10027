// `orchestrator tune`, end to end.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/orchestrator/sweeping/sweep_table.h"
#include "tests/support/folders.h"

namespace mascot::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class TuneTest : public SweepTest {
 protected:
  std::string TuneWords(const std::string& more) const {
    return BuildFolder() + "/orchestrator tune " + config_ + " --out " + out_ + " " + more;
  }
  Ran Tune(const std::string& more) const { return Shell(TuneWords(more)); }
  std::string Own() const { return folder_.File("own.py"); }
};

constexpr const char* kRate =
    "--metric consensus.predicted.rate_per_s --maximize --set run.duration_s=60 --random law.beta=0.1:10:log "
    "--no-plot ";

TEST_F(TuneTest, FindsTheDampingWithWhichTheSlowestModeIsFastest) {
  // s^2 + beta s + lambda p_gain of a complete graph of 3, all lambda = 3: -beta / 2 up to critical damping, beyond it
  // slower again.
  const std::string complete = "--set graph.topology=complete --set law.p_gain=0.3 ";
  const double critical = 2 * std::sqrt(3 * 0.3);
  const Ran ran = Tune(kRate + complete + "--budget 60");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  const Table table(out_);
  ASSERT_THAT(table.rows, SizeIs(60));
  double best = 0, beta = 0;
  for (std::size_t row = 0; row < 60; ++row) {
    const std::string rate = table.At(row, "consensus.predicted.rate_per_s");
    if (rate.empty() || std::stod(rate) <= best) continue;
    best = std::stod(rate);
    beta = std::stod(table.At(row, "law.beta"));
  }
  EXPECT_NEAR(beta, critical, 0.05 * critical) << "two decades are searched";
  EXPECT_LE(best, critical / 2);
  EXPECT_THAT(ran.output, AllOf(HasSubstr("best of 60 candidates: consensus.predicted.rate_per_s = "),
                                HasSubstr("fly it: orchestrator up " + config_ + " --set run.duration_s=60 --set "),
                                HasSubstr(" --set law.p_gain=0.3 --set law.beta=")));
}

TEST_F(TuneTest, BeginsWithTheValuesOfTheFileIfTheyMayBeChosen) {
  WriteFile(config_, ReadFile(config_) + "beta = 0.75\n");
  const Ran ran = Tune(kRate + std::string("--budget 3"));
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_EQ(Table(out_).At(0, "law.beta"), "0.75");
  EXPECT_THAT(ran.output, HasSubstr("file's own values"));
  const Ran without =
      Tune("--force --metric consensus.final_disagreement_m --random law.beta=1:2 --no-plot --budget 3");
  ASSERT_EQ(without.exit_code, 0) << without.output;
  EXPECT_NE(Table(out_).At(0, "law.beta"), "0.75");
  EXPECT_THAT(without.output, Not(HasSubstr("file's own values")));
}

TEST_F(TuneTest, TriesTheSameCandidatesWhateverTheNumberOfProcesses) {
  const std::string words =
      "--metric consensus.final_disagreement_m --random law.p_gain=0.1:1 --set graph.topology=ring,path,complete "
      "--budget 20 --no-plot ";
  ASSERT_EQ(Tune(words + "--jobs 1").exit_code, 0);
  const auto once = Table(out_).Repeatable();
  ASSERT_EQ(Tune(words + "--jobs 3 --force").exit_code, 0);
  EXPECT_EQ(Table(out_).Repeatable(), once);
  ASSERT_EQ(Tune(words + "--optimizer-seed 7 --force").exit_code, 0);
  EXPECT_NE(Table(out_).Repeatable(), once);
  ASSERT_EQ(Tune(words + "--batch 1 --force").exit_code, 0);
  EXPECT_NE(Table(out_).Repeatable(), once) << "each candidate is chosen by all before it";
}

TEST_F(TuneTest, GoesOnAfterItWasKilledAndWithALargerBudgetAsIfItHadNotEnded) {
  const std::string words = "--metric consensus.final_disagreement_m --random law.p_gain=0.1:1 --seeds 1..3 --no-plot ";
  ASSERT_EQ(Tune(words + "--budget 30").exit_code, 0);
  const auto whole = Table(out_).Repeatable();
  ASSERT_THAT(whole, SizeIs(90));
  std::filesystem::remove(out_);
  ASSERT_EQ(Tune(words + "--budget 11").exit_code, 0) << "the second batch is not flown whole";
  EXPECT_THAT(Table(out_).rows, SizeIs(33));
  {
    Running tune("/bin/sh", {"-c", "exec " + TuneWords(words + "--budget 30")}, folder_.File("killed"));
    ASSERT_TRUE(Until([&] { return RowsSoFar(out_) > 40; }));
    SignalTo(tune.pid(), SIGKILL);
    tune.Wait();
  }
  const Ran ran = Tune(words + "--budget 30");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_EQ(Table(out_).Repeatable(), whole);
}

TEST_F(TuneTest, CanBeInterruptedAndSaysHowToGoOn) {
  Running tune("/bin/sh", {"-c", "exec " + TuneWords(kRate + std::string("--budget 5000"))},
               folder_.File("interrupted"));
  ASSERT_TRUE(Until([&] { return RowsSoFar(out_) > 10; }));
  SignalTo(tune.pid(), SIGINT);
  EXPECT_EQ(tune.Wait(), 130);
  EXPECT_THAT(tune.err(), HasSubstr("interrupted; the same command goes on with what is in " + out_));
}

TEST_F(TuneTest, JudgesByAMetricOfTheUserOverSeeds) {
  WriteFile(Own(), "def length_m(run):\n    return 1\n\n\ndef wanted(run):\n    return float(run['t'][-1]) * 3\n");
  const Ran ran =
      Tune("--metric " + Own() + ":wanted --set run.duration_s=3,1,2 --seeds 1..2 --over-seeds worst --budget 12");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output, AllOf(HasSubstr(": wanted = 3"), HasSubstr("  run.duration_s = 1\n")));
  EXPECT_THAT(Table(out_).rows, SizeIs(6)) << "a candidate that is proposed again is not flown again";
  EXPECT_TRUE(std::filesystem::exists(folder_.File("sweep.png")));
  EXPECT_THAT(Tune("--metric " + Own() + " --set run.duration_s=3,1,2 --budget 3 --no-plot --force").output,
              HasSubstr(": length_m = 1"));
}

TEST_F(TuneTest, TakesARunWithoutAValueForTheWorst) {
  const std::string slow = "--metric consensus.settling_time_s --set law.p_gain=0.0001,0.0002 --budget 4 --no-plot";
  const Ran ran = Tune(slow);
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_THAT(
      ran.output,
      HasSubstr("error: tune: expected a value of consensus.settling_time_s for some candidate, got none of 2"));
  const Ran drawn = Shell(SourceFolder() + "/scripts/plot_tuning.py " + out_ + " " + folder_.File("x.png") +
                          " consensus.settling_time_s law.p_gain");
  EXPECT_EQ(drawn.exit_code, 1);
  EXPECT_EQ(drawn.output, "error: " + out_ + ": no candidate has a consensus.settling_time_s\n");
}

TEST_F(TuneTest, RefusesTheTableOfAnotherSearch) {
  const std::string words = "--metric consensus.final_disagreement_m --no-plot --budget 2 ";
  ASSERT_EQ(Tune(words + "--random law.p_gain=0.1:1").exit_code, 0);
  const Ran other = Tune(words + "--random law.p_gain=0.1:2");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, AllOf(HasSubstr("one of this very sweep, got another, which differs in the search: "),
                                  HasSubstr("--random law.p_gain=0.1:1, "), HasSubstr("--random law.p_gain=0.1:2, ")));
  const Ran sweep = Sweep("--set law.p_gain=0.1,0.2");
  EXPECT_EQ(sweep.exit_code, 2);
  EXPECT_THAT(sweep.output, HasSubstr("and nothing here (--force begins anew)"));
  EXPECT_EQ(Tune(words + "--random law.p_gain=0.1:1").exit_code, 0) << "the table is as it was";
}

TEST_F(TuneTest, RefusesWhatItCannotSearch) {
  const std::string words = "--metric consensus.final_disagreement_m --budget 3 ";
  const std::pair<std::string, std::string> kMistakes[] = {
      {words, "tune: expected a key to choose values of, --random KEY=MIN:MAX or --set KEY=V1,V2,..., got none"},
      {words + "--set run.seed=1,2", "tune: expected --seeds for several values of run.seed, got --set"},
      {words + "--set law.name=consensus,rendezvous",
       "tune: expected one law, got several values of law.name (orchestrator sweep compares laws)"},
      {words + "--random law.beta=-3:-1",
       "--random law.beta=-3:-1 (-1.9023729921453505): law.beta: expected a number in "},
      {words + "--random law.p_gain=2:1", "--random: expected key=min:max with min <= max"},
      {words + "--random law.betta=1:2", "law.betta: unknown key (did you mean \"beta\"?)"},
      {"--metric settling_time_s --budget 3 --random law.beta=1:2",
       "--metric: expected a column of the table, such as consensus.final_disagreement_m, got 'settling_time_s' (did "
       "you "
       "mean \"consensus.settling_time_s\"?)"},
      {"--metric wall_s --budget 3 --random law.beta=1:2",
       "--metric: expected a column of which there are statistics, got 'wall_s', which depends on the machine"},
      {"--metric " + Own() + " --budget 3 --random law.beta=1:2",
       Own() + ": cannot be read: No such file or directory"},
      {"--metric x --budget 0 --random law.beta=1:2", "--budget: Value 0 not in range 1 to 100000"},
      {words + "--random law.beta=1:2 --over-seeds worst", "--over-seeds requires --seeds"},
  };
  for (const auto& [more, message] : kMistakes) {
    const Ran ran = Tune(more);
    EXPECT_EQ(ran.exit_code, 2) << more;
    EXPECT_THAT(ran.output, HasSubstr(message));
  }
  WriteFile(Own(),
            "METRICS = ['a', 'b']\ndef a(run):\n    return 1\ndef b(run):\n    return 2\ndef c(run):\n    return 3\n");
  const Ran ran = Tune("--metric " + Own() + ":c --budget 3 --random law.beta=1:2");
  EXPECT_EQ(ran.exit_code, 2);
  EXPECT_THAT(ran.output, HasSubstr("--metric: expected one of the metrics of the file (a, b), got 'c'"));
  EXPECT_FALSE(std::filesystem::exists(out_));
}

TEST_F(TuneTest, EndsWithItsOptimiser) {
  Running tune("/bin/sh", {"-c", "exec " + TuneWords(kRate + std::string("--budget 50000"))}, folder_.File("alone"));
  ASSERT_TRUE(Until([&] { return RowsSoFar(out_) > 10; }));
  ASSERT_EQ(Shell("pkill -9 -P " + std::to_string(tune.pid()) + " -f optimizer.py").exit_code, 0);
  EXPECT_EQ(tune.Wait(), 1);
  EXPECT_THAT(tune.err(), HasSubstr("error: the optimiser was killed by signal 9 (Killed)"));
}

TEST(Optimizer, SaysWhichPackageItNeeds) {
  const Ran ran = Shell(
      "/usr/bin/python3 -c \"import runpy, sys; sys.modules['optuna'] = None; "
      "runpy.run_path('" +
      SourceFolder() + "/scripts/optimizer.py', run_name='__main__')\"");
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_THAT(ran.output, HasSubstr("error: tune needs Optuna (Debian: apt-get install python3-optuna): "));
}

}  // namespace
}  // namespace mascot::test
