// `orchestrator sweep --shard`, `--slurm` and `sweep merge`, end to end. A real Slurm: slurm_test.py.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/orchestrator/sweeping/sweep_table.h"
#include "tests/support/folders.h"

namespace mascot::test {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

class SweepShards : public SweepTest {
 protected:
  /// Flies all shares of `words`.
  void FlyShares(int of, const std::string& words) const {
    for (int number = of; number >= 1; --number) {
      const Ran ran = Sweep(words + " --shard " + std::to_string(number) + "/" + std::to_string(of));
      ASSERT_EQ(ran.exit_code, 0) << ran.output;
    }
  }
  Ran Merge(const std::string& words) const {
    return Shell("cd " + folder_.path().string() + " && " + BuildFolder() + "/orchestrator sweep merge " + words);
  }
  std::string Folder(const std::string& name) const { return folder_.File(name); }
};

TEST_F(SweepShards, MakeTogetherTheTableOfTheWholeSweep) {
  WriteFile(Folder("own.py"), "def path_length(run):\n    return float(abs(run['position']).sum())\n");
  const std::string words =
      "--set law.name=consensus,velocity_consensus --set law.p_gain=0.2,-1 --seeds 1..3 --set agents.count=4 --force "
      "--metric " +
      Folder("own.py");
  ASSERT_EQ(Sweep(words).exit_code, 0);
  const std::string whole = Folder("whole.csv"), statistics = ReadFile(Folder("sweep.stats.csv"));
  const auto pictures = ReadFile(Folder("sweep.png"));
  std::filesystem::rename(out_, whole);
  std::filesystem::remove(Folder("sweep.stats.csv"));
  FlyShares(4, words);
  const Ran merged = Merge("sweep.csv");
  ASSERT_EQ(merged.exit_code, 0) << merged.output;
  EXPECT_THAT(merged.output, StartsWith("12 runs of 4 tables: sweep.csv\nfailed: 6 of 12 runs\n"));
  EXPECT_THAT(merged.output, HasSubstr("statistics over seeds: sweep.stats.csv\n"));
  EXPECT_EQ(Table(out_).columns, Table(whole).columns);
  EXPECT_EQ(Table(out_).Repeatable(), Table(whole).Repeatable());
  EXPECT_EQ(ReadFile(Folder("sweep.stats.csv")), statistics);
  EXPECT_EQ(Merge("sweep.csv --no-plot --quiet").output, "") << "merged again";
  EXPECT_EQ(Merge("sweep.*-of-4.csv --out again.csv --no-plot --quiet").output, "");
  EXPECT_EQ(Table(Folder("again.csv")).rows, Table(out_).rows);
}

TEST_F(SweepShards, SayWhatTheyAreAndWhatComesNext) {
  const Ran ran = Sweep("--seeds 1..7 --shard 2/3");
  EXPECT_THAT(ran.output, EndsWith("share 2/3, 2 of 7 runs: " + Folder("sweep.2-of-3.csv") +
                                   "\nwhen all shares are there: orchestrator sweep merge " +
                                   Folder("sweep.*-of-3.csv") + " --out " + out_ + "\n"));
  EXPECT_THAT(Table(Folder("sweep.2-of-3.csv")).rows, ElementsAre(SizeIs(testing::Gt(2)), SizeIs(testing::Gt(2))));
  EXPECT_EQ(Table(Folder("sweep.2-of-3.csv")).rows[1][0], "4");
  EXPECT_FALSE(std::filesystem::exists(out_));
  EXPECT_FALSE(std::filesystem::exists(Folder("sweep.2-of-3.stats.csv")));
  const Ran again = Sweep("--seeds 1..7 --shard 2/3");
  EXPECT_THAT(again.output, HasSubstr("share 2/3, 2 of 7 runs, none flown now: "));
}

TEST_F(SweepShards, AreThoseOfTheTasksOfAJobArray) {
  const std::string task =
      "SLURM_ARRAY_TASK_ID=3 SLURM_ARRAY_TASK_MIN=1 SLURM_ARRAY_TASK_MAX=4 SLURM_ARRAY_TASK_COUNT=4 ";
  EXPECT_EQ(Shell(task + Words("--seeds 1..8")).exit_code, 0);
  EXPECT_THAT(Table(Folder("sweep.3-of-4.csv")).rows, SizeIs(2));
  EXPECT_EQ(Shell(task + Words("--seeds 1..8 --shard 1/2")).exit_code, 0) << "--shard counts more";
  EXPECT_THAT(Table(Folder("sweep.1-of-2.csv")).rows, SizeIs(4));
  const Ran lost = Shell("SLURM_ARRAY_TASK_ID=3 " + Words("--seeds 1..8"));
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_THAT(lost.output, HasSubstr("error: --shard: expected I/N, because the tasks of this job array are not "
                                     "numbered one after another"));
}

TEST_F(SweepShards, GoOnAfterASignal) {
  for (const auto& [signal, code] : {std::pair{SIGUSR1, 138}, std::pair{SIGTERM, 143}}) {
    const std::string table = Folder("sweep.1-of-2.csv");
    Running sweep(BuildFolder() + "/orchestrator",
                  {"sweep", config_, "--out", out_, "--seeds", "1..5000", "--shard", "1/2"}, Folder("interrupted"));
    const std::size_t before = RowsSoFar(table);
    ASSERT_TRUE(Until([&] { return RowsSoFar(table) > before + 2; }));
    SignalTo(sweep.pid(), signal);
    EXPECT_EQ(sweep.Wait(), code);
    EXPECT_THAT(sweep.err(), HasSubstr(" of 2500 runs are in the table; the same command goes on with the others"));
  }
}

TEST_F(SweepShards, OfAMillionRunsBeginAtOnce) {
  const Ran ran = Sweep("--seeds 1..1000000 --shard 7/500000");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output, HasSubstr("share 7/500000, 2 of 1000000 runs: "));
}

TEST_F(SweepShards, AreMergedOnlyIfTheyAreAllThereAndOfOneSweepAndBuild) {
  FlyShares(3, "--seeds 1..7");
  const auto refusal = [&](const std::string& words) {
    const Ran ran = Merge(words);
    EXPECT_EQ(ran.exit_code, 2) << ran.output;
    EXPECT_FALSE(std::filesystem::exists(out_));
    return ran.output;
  };
  EXPECT_EQ(refusal("sweep.1-of-3.csv sweep.3-of-3.csv"),
            "error: sweep merge: expected every one of the 7 runs, got none of 1, 4 (the command of a share flies what "
            "it lacks)\n");
  EXPECT_EQ(refusal("sweep.1-of-3.csv sweep.1-of-3.csv"),
            "error: sweep merge: expected each run in one table, got run 0 in sweep.1-of-3.csv and in "
            "sweep.1-of-3.csv\n");
  EXPECT_EQ(refusal("nothing.csv"),
            "error: sweep merge: expected the table of a share, or of shares called nothing.*-of-2.csv, got "
            "nothing.csv, which is not there\n");
  EXPECT_EQ(refusal("small.toml --out sweep.csv"),
            "error: sweep merge: expected tables of shares, each with its .plan beside it, got small.toml\n");
  EXPECT_EQ(refusal("sweep.csv --out sweep.2-of-3.csv --force"),
            "error: sweep merge: expected --out FILE that is none of the shares, got sweep.2-of-3.csv\n");
  ASSERT_EQ(mkfifo(Folder("pipe.csv").c_str(), 0600), 0);
  std::filesystem::copy(Folder("sweep.1-of-3.csv.plan"), Folder("pipe.csv.plan"));
  const Ran pipe = Merge("pipe.csv sweep.2-of-3.csv sweep.3-of-3.csv --out sweep.csv");
  EXPECT_EQ(pipe.exit_code, 1);
  EXPECT_EQ(pipe.output, "error: pipe.csv: cannot be read: not a regular file\n");
  std::filesystem::copy(Folder("sweep.1-of-3.csv"), Folder("one"));
  std::filesystem::copy(Folder("sweep.1-of-3.csv.plan"), Folder("one.plan"));
  EXPECT_EQ(refusal("one"),
            "error: sweep merge: expected --out FILE, because these tables are not called as shares of "
            "one table\n");
  EXPECT_THAT(refusal("sweep.csv --plot nothing"),
              HasSubstr("error: --plot: expected a column of the table, such as "));

  out_ = Folder("other.csv");
  FlyShares(3, "--seeds 2..8");
  out_ = Folder("sweep.csv");
  EXPECT_EQ(refusal("sweep.csv other.csv --out sweep.csv"),
            "error: sweep merge: expected shares of one sweep, got sweep.1-of-3.csv (there) and other.1-of-3.csv "
            "(here), which differ in --seeds: 1, 2, 3, 4, 5, 6, 7 there and 2, 3, 4, 5, 6, 7, 8 here\n");

  const std::string plan = ReadFile(Folder("sweep.2-of-3.csv.plan"));
  std::string older = plan;
  older.replace(older.find("build ") + 6, 4, "0000");
  WriteFile(Folder("sweep.2-of-3.csv.plan"), older);
  const std::string builds = refusal("sweep.csv");
  EXPECT_THAT(builds, StartsWith("error: sweep merge: expected shares by one build, got "));
  EXPECT_THAT(builds, EndsWith(" (sweep.2-of-3.csv)\n"));
  const Ran further = Sweep("--seeds 1..7 --shard 2/3");
  EXPECT_EQ(further.exit_code, 2);
  EXPECT_THAT(further.output, HasSubstr("sweep.2-of-3.csv: expected a table of this build, "));
  EXPECT_THAT(further.output, EndsWith(" (--force begins anew)\n"));

  WriteFile(Folder("sweep.2-of-3.csv.plan"), plan);
  std::string rows = ReadFile(Folder("sweep.2-of-3.csv"));
  rows.replace(rows.find("\n1,") + 1, 1, "9");
  WriteFile(Folder("sweep.2-of-3.csv"), rows);
  EXPECT_EQ(refusal("sweep.csv"), "error: sweep.2-of-3.csv:2: run: expected a number of a run below 7, got '9'\n");
}

TEST_F(SweepShards, AreNotMergedIntoAnotherTable) {
  FlyShares(2, "--seeds 1..4");
  WriteFile(out_, "my own table\n");
  const Ran ran = Merge("sweep.csv --out sweep.csv sweep.1-of-2.csv sweep.2-of-2.csv");
  EXPECT_EQ(ran.exit_code, 2) << "each share is named twice";
  const Ran other = Merge("sweep.*-of-2.csv");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, HasSubstr("expected a new file, or one of this very sweep, got another"));
  EXPECT_EQ(ReadFile(out_), "my own table\n");
  EXPECT_EQ(Merge("sweep.*-of-2.csv --force --no-plot").exit_code, 0);
  EXPECT_THAT(Table(out_).rows, SizeIs(4));
}

TEST_F(SweepShards, BecomeTheTasksOfAJobArray) {
  const std::string folder = Folder("it's here");
  std::filesystem::create_directory(folder);
  const std::string enter = "cd \"" + folder + "\" && ";
  const std::string sweep = enter + BuildFolder() + "/orchestrator sweep " + config_ + " --out s.csv --seeds 1..9 ";
  const Ran ran =
      Shell(sweep + "--slurm --tasks 3 --jobs 2 --slurm-option --partition=long --slurm-option --time=9:00");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_EQ(ran.output, "9 runs in 3 tasks: s.sbatch\nsubmit it: sbatch s.sbatch\n");
  const std::string script = ReadFile(folder + "/s.sbatch");
  EXPECT_THAT(script, HasSubstr("#SBATCH --partition=long\n#SBATCH --time=9:00\n"));
  EXPECT_FALSE(std::filesystem::exists(folder + "/s.csv"));
  for (const char* task : {"1", "2", "3"})
    EXPECT_THAT(
        Shell("SLURM_ARRAY_TASK_ID=" + std::string(task) + " bash '" + Folder("it'\\''s here") + "/s.sbatch'").output,
        HasSubstr("share " + std::string(task) + "/3, 3 of 9 runs: s." + task + "-of-3.csv\n"));
  EXPECT_EQ(Shell(enter + BuildFolder() + "/orchestrator sweep merge s.csv --no-plot").exit_code, 0);
  EXPECT_THAT(Table(folder + "/s.csv").rows, SizeIs(9));
}

TEST_F(SweepShards, HaveTheRowsOfZipAndOfATable) {
  WriteFile(Folder("plan.csv"), "law.p_gain,graph.topology\n0.1,ring\n0.2,path\n0.3,ring\n");
  const std::pair<const char*, std::string> sweeps[] = {
      {"zip", "--zip --set law.p_gain=0.1,0.2,0.3 --set graph.topology=ring,path,ring --seeds 1..2"},
      {"table", "--plan " + Folder("plan.csv") + " --seeds 1..2"}};
  for (const auto& [name, words] : sweeps) {
    out_ = Folder(name + std::string(".csv"));
    ASSERT_EQ(Sweep(words).exit_code, 0);
    const Table whole(out_);
    const std::string statistics = ReadFile(Folder(name + std::string(".stats.csv")));
    const std::string picture = ReadFile(Folder(name + std::string(".png")));
    for (const char* ending : {".csv", ".csv.plan", ".stats.csv", ".png"})
      std::filesystem::remove(Folder(name + std::string(ending)));
    FlyShares(2, words);
    std::filesystem::rename(Folder("plan.csv"), Folder("away"));  // `sweep merge` needs no more than the tables
    const Ran merged = Merge(name + std::string(".csv"));
    std::filesystem::rename(Folder("away"), Folder("plan.csv"));
    ASSERT_EQ(merged.exit_code, 0) << merged.output;
    EXPECT_EQ(Table(out_).Repeatable(), whole.Repeatable());
    EXPECT_EQ(ReadFile(Folder(name + std::string(".stats.csv"))), statistics);
    EXPECT_EQ(ReadFile(Folder(name + std::string(".png"))), picture);
  }
  EXPECT_EQ(Table(Folder("zip.csv")).Repeatable(), Table(Folder("table.csv")).Repeatable());
}

TEST_F(SweepShards, OfZipAndOfATableAreTasksOfAJobArray) {
  WriteFile(Folder("my plan.csv"), "law.p_gain\n0.1\n0.2\n");
  ASSERT_EQ(Sweep("--plan '" + Folder("my plan.csv") + "' --slurm").exit_code, 0);
  EXPECT_THAT(ReadFile(Folder("sweep.sbatch")), HasSubstr("--plan '" + Folder("my plan.csv") + "'"));
  ASSERT_EQ(Sweep("--set law.p_gain=1,2 --set law.beta=1,2 --zip --slurm").exit_code, 0);
  EXPECT_THAT(ReadFile(Folder("sweep.sbatch")), HasSubstr(" --zip "));
  ASSERT_EQ(Shell("SLURM_ARRAY_TASK_ID=1 bash " + Folder("sweep.sbatch")).exit_code, 0);
  EXPECT_THAT(Table(Folder("sweep.1-of-1.csv")).rows, SizeIs(2));
  const Ran pipe = Shell("cat '" + Folder("my plan.csv") + "' | " + Words("--plan - --slurm"));
  EXPECT_EQ(pipe.exit_code, 2);
  EXPECT_EQ(pipe.output, "error: --slurm: expected a file, which each task of the job array reads, got <stdin>\n");
}

TEST_F(SweepShards, ATaskWhoseTimeIsUpIsQueuedAgain) {
  WriteFile(Folder("scontrol"), "#!/bin/sh\necho \"$@\" > " + Folder("asked") + "\n");
  std::filesystem::permissions(Folder("scontrol"), std::filesystem::perms::owner_all);
  ASSERT_EQ(Sweep("--seeds 1..5000 --slurm --tasks 1").exit_code, 0);
  const std::string table = Folder("sweep.1-of-1.csv");
  Running task("env",
               {"PATH=" + folder_.path().string() + ":/usr/bin:/bin", "SLURM_ARRAY_TASK_ID=1", "SLURM_ARRAY_JOB_ID=42",
                "bash", Folder("sweep.sbatch")},
               Folder("task"));
  ASSERT_TRUE(Until([&] { return RowsSoFar(table) > 2; }));
  SignalTo(task.pid(), SIGUSR1);
  EXPECT_EQ(task.Wait(), 138);
  EXPECT_EQ(ReadFile(Folder("asked")), "requeue 42_1\n");
  EXPECT_THAT(task.err(), HasSubstr(" of 5000 runs are in the table"));
}

TEST_F(SweepShards, RefuseOptionsThatDoNotBelongTogether) {
  const std::pair<std::string, std::string> refused[] = {
      {"--seeds 1..9 --slurm --shard 1/2",
       "--slurm: expected no --shard, because each task of the job array has its own"},
      {"--seeds 1..9 --slurm --force",
       "--slurm: expected no --force, because a task that is queued again goes on with what is there"},
      {"--seeds 1..9 --slurm --tasks 10", "--tasks: expected at most 9, one for each run, got 10"},
      {"--seeds 1..9 --shard 3/2", "--shard: expected I/N with 1 <= I <= N <= 1000000, got '3/2'"},
      {"--seeds 1..9 --tasks 2", "--tasks requires --slurm"},
      {"--seeds 1..9 --submit", "--submit requires --slurm"},
      {"--seeds 1..9 --slurm-option x", "--slurm-option requires --slurm"},
      {"--set law.p_gian=1,2 --slurm", "law.p_gian"}};
  for (const auto& [words, text] : refused) {
    const Ran ran = Sweep(words);
    EXPECT_EQ(ran.exit_code, 2) << words;
    EXPECT_THAT(ran.output, HasSubstr("error: ")) << words;
    EXPECT_THAT(ran.output, HasSubstr(text)) << words;
    EXPECT_FALSE(std::filesystem::exists(Folder("sweep.sbatch"))) << words;
  }
  const Ran none = Shell(BuildFolder() + "/orchestrator sweep");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_EQ(none.output, "error: sweep: expected CONFIG, an experiment file, or merge FILE...\n");
  const Ran away = Shell("PATH= " + Words("--seeds 1..9 --slurm --submit"));
  EXPECT_EQ(away.exit_code, 1);
  EXPECT_THAT(away.output, EndsWith("error: cannot start sbatch: No such file or directory\n"));
}

}  // namespace
}  // namespace mascot::test
