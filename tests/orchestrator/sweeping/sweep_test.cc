// `orchestrator sweep`, end to end.
#include <gmock/gmock.h>

#include <map>
#include <sstream>

#include "tests/orchestrator/sweeping/sweep_table.h"
#include "tests/support/folders.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST_F(SweepTest, HasARowForEveryCombinationWithWhatUpMeasures) {
  const Ran ran = Sweep("--set law.p_gain=0.1:0.1:0.3 --set graph.topology=ring,path --seeds 4..5");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output, HasSubstr("12 runs: " + out_));
  const Table table(out_);
  ASSERT_THAT(table.rows, SizeIs(12));
  EXPECT_EQ(table.At(7, "run"), "7");
  EXPECT_EQ(table.At(7, "law.p_gain"), "0.2");
  EXPECT_EQ(table.At(7, "graph.topology"), "path");
  EXPECT_EQ(table.At(7, "run.seed"), "5");
  EXPECT_EQ(table.At(7, "error"), "");
  Up up(folder_, "up", config_,
        {"--engine", "inprocess", "--set", "law.p_gain=0.2", "--set", "graph.topology=path", "--seed", "5"});
  ASSERT_EQ(up.Wait(), 0);
  const auto summary = up.Summary();
  EXPECT_EQ(std::stod(table.At(7, "consensus.final_disagreement_m")), summary["consensus"]["final_disagreement_m"]);
  EXPECT_EQ(std::stod(table.At(7, "consensus.value_m.y")), summary["consensus"]["value_m"][1]);
  EXPECT_EQ(std::stod(table.At(7, "fidelity.rms_m")), summary["fidelity"]["rms_m"]);
  EXPECT_EQ(table.At(7, "consensus.predicted.stable"), "true");
  EXPECT_EQ(table.At(7, "formation.final_rms_m"), "") << "it was no formation";
  EXPECT_TRUE(std::filesystem::exists(folder_.File("sweep.png")));
}

TEST_F(SweepTest, GivesTheSameTableWhateverTheNumberOfProcesses) {
  const std::string words = "--random law.p_gain=0.1:1 --random law.beta=0.1:10:log --samples 12 --no-plot ";
  ASSERT_EQ(Sweep(words + "--jobs 1").exit_code, 0);
  const auto once = Table(out_).Repeatable();
  ASSERT_EQ(Sweep(words + "--jobs 4 --force").exit_code, 0);
  EXPECT_EQ(Table(out_).Repeatable(), once);
  EXPECT_FALSE(std::filesystem::exists(folder_.File("sweep.png")));
}

TEST_F(SweepTest, GoesOnAfterItWasKilledWithNoRowTwiceAndNoneHalf) {
  const std::string words = "--set law.p_gain=0.01:0.01:2.0 --no-plot";
  ASSERT_EQ(Sweep(words).exit_code, 0);
  const auto whole = Table(out_).Repeatable();
  ASSERT_THAT(whole, SizeIs(200));
  std::filesystem::remove(out_);
  {
    Running sweep(BuildFolder() + "/orchestrator",
                  {"sweep", config_, "--out", out_, "--set", "law.p_gain=0.01:0.01:2.0", "--no-plot"},
                  folder_.File("killed"));
    ASSERT_TRUE(Until([&] { return RowsSoFar(out_) > 5; }));
    SignalTo(sweep.pid(), SIGKILL);
    sweep.Wait();
  }
  const std::size_t there = Table(out_).rows.size();
  EXPECT_LT(there, 200u) << "it was killed on the way";
  const Ran ran = Sweep(words);
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output, HasSubstr(" of 200 runs are in the table"));
  EXPECT_EQ(Table(out_).Repeatable(), whole);
}

TEST_F(SweepTest, CanBeInterruptedAndSaysHowToGoOn) {
  Running sweep(BuildFolder() + "/orchestrator", {"sweep", config_, "--out", out_, "--seeds", "1..5000", "--no-plot"},
                folder_.File("interrupted"));
  ASSERT_TRUE(Until([&] { return RowsSoFar(out_) > 2; }));
  SignalTo(sweep.pid(), SIGINT);
  EXPECT_EQ(sweep.Wait(), 130);
  EXPECT_THAT(sweep.err(), HasSubstr(" of 5000 runs are in the table; the same command goes on with the others"));
}

TEST_F(SweepTest, CanBeInterruptedWhileItLooksForAValidRun) {
  Running sweep(BuildFolder() + "/orchestrator",
                {"sweep", config_, "--out", out_, "--set", "law.p_gain=-1", "--seeds", "1..1000000", "--force"},
                folder_.File("looks"));
  const std::string pid = std::to_string(sweep.pid());
  ASSERT_TRUE(Until([&] { return !ReadFile("/proc/" + pid + "/task/" + pid + "/children").empty(); })) << "no worker";
  SignalTo(sweep.pid(), SIGINT);
  EXPECT_EQ(sweep.Wait(), 130);
}

TEST_F(SweepTest, KeepsTheErrorOfARunThatFailsAndGoesOn) {
  WriteFile(
      config_,
      "[run]\nduration_s = 1.0\n[agents]\ncount = 2\n[law]\nname = 'custom'\nparams = { worst = 1.0 }\npython = '''\n"
      "def start(me, params):\n    me.worst = params['worst']\ndef control(t, me, neighbours):\n"
      "    return [1.0 / (me.worst - 2), 0.0]\n'''\n");
  const Ran ran = Sweep("--set law.params.worst=1.0:1.0:3.0 --no-plot");
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output, HasSubstr("3 runs: " + out_ + "\nfailed: 1 of 3 runs"));
  const Table table(out_);
  ASSERT_THAT(table.rows, SizeIs(3));
  EXPECT_EQ(table.At(0, "error"), "");
  EXPECT_THAT(table.At(1, "error"), HasSubstr("ZeroDivisionError"));
  EXPECT_THAT(ran.output, HasSubstr("failed: 1 of 3 runs\n  run 1: tick 0: the law of agent 1 failed at t = 0.0 s"));
  EXPECT_THAT(ran.output, HasSubstr("ZeroDivisionError: float division by zero\n")) << "the end of a long reason";
  EXPECT_EQ(table.At(1, "consensus.final_disagreement_m"), "");
  EXPECT_EQ(table.At(2, "error"), "");
}

TEST_F(SweepTest, HasColumnsOfMetricsInPythonOverTheArraysOfStatesNpz) {
  WriteFile(folder_.File("own.py"),
            "import hashlib\n\n\ndef fingerprint(run):\n    digest = hashlib.sha256()\n    for name in sorted(run):\n"
            "        digest.update(f'{name} {run[name].dtype} {run[name].shape}'.encode() + run[name].tobytes())\n"
            "    return int.from_bytes(digest.digest()[:6], 'big')\n\n\ndef _mean(x):\n    return x\n\n\n"
            "def half_time_s(run):\n    return None if run['position'][0, 0, 0] < 0 else run['t'][-1] / 2\n");
  const std::string words = "--set law.p_gain=0.1,0.2 --seeds 4..6 --metric " + folder_.File("own.py");
  const Ran ran = Sweep(words + " --plot half_time_s");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  const Table table(out_);
  EXPECT_THAT(Cells(table.columns.end() - 4, table.columns.end()),
              testing::ElementsAre("fingerprint", "half_time_s", "wall_s", "real_time_factor"));
  EXPECT_THAT(table.At(0, "half_time_s"), testing::AnyOf("1.0", ""));
  Up up(folder_, "up", config_, {"--engine", "inprocess", "--set", "law.p_gain=0.2", "--seed", "5"});
  ASSERT_EQ(up.Wait(), 0);
  const Ran numpy =
      Shell("cd '" + folder_.path().string() +
            "' && /usr/bin/python3 -c 'import numpy, own; print(float(own.fingerprint(dict(numpy.load(\"" +
            (up.path() / "states.npz").string() + "\")))))'");
  EXPECT_EQ(table.At(4, "fingerprint") + "\n", numpy.output);
  EXPECT_THAT(Sweep("--set law.p_gain=0.1,0.2 --seeds 4..6").output,
              HasSubstr("got another, which differs in the file of --metric (--force begins anew)"));
}

TEST_F(SweepTest, RefusesMetricsWithMistakesAndNamesTheLineOfThoseInARun) {
  const std::string file = folder_.File("own.py");
  const auto refuses = [&](const std::string& text, const std::string& message) {
    WriteFile(file, text);
    const Ran ran = Sweep("--seeds 1..2 --no-plot --metric " + file);
    EXPECT_EQ(ran.exit_code, 2) << ran.output;
    EXPECT_THAT(ran.output, HasSubstr("error: --metric: " + message));
    EXPECT_FALSE(std::filesystem::exists(out_));
  };
  refuses("def f(run:\n", "own.py:1: SyntaxError: '(' was never closed");
  refuses("def ticks(run):\n    return 1\n", "expected names that no other column has, got 'ticks'");
  WriteFile(file, "def f(run):\n    x = 0\n    return 1 / x\n");
  const Ran failed = Sweep("--seeds 1..2 --no-plot --metric " + file);
  EXPECT_EQ(failed.exit_code, 1) << failed.output;
  EXPECT_THAT(failed.output, HasSubstr("run 0 and 1 more: own.py:3: metric f: ZeroDivisionError: division by zero"));
  EXPECT_EQ(Table(out_).At(0, "error"), "own.py:3: metric f: ZeroDivisionError: division by zero");
}

TEST_F(SweepTest, SaysWhatDidNotSettleAndWritesStatistics) {
  const Ran ran =
      Sweep("--set law.p_gain=0.2,0.3 --set run.duration_s=2,30 --seeds 1..3 --plot consensus.settling_time_s");
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output,
              HasSubstr("not settled by the end: 6 of 12 runs (no consensus.settling_time_s), first run 0"));
  EXPECT_THAT(ran.output, HasSubstr("statistics over seeds: " + folder_.File("sweep.stats.csv")));
  const Table statistics(folder_.File("sweep.stats.csv"));
  const auto row = std::ranges::find_if(statistics.rows, [](const Cells& cells) {
    return cells[0] == "0.3" && cells[1] == "30" && cells[2] == "consensus.settling_time_s";
  });
  ASSERT_NE(row, statistics.rows.end());
  const Table table(out_);
  double sum = 0;
  for (std::size_t run = 9; run < 12; ++run) sum += std::stod(table.At(run, "consensus.settling_time_s"));
  EXPECT_NEAR(std::stod((*row)[6]), sum / 3, 1e-12);
  EXPECT_EQ((*row)[5], "0");
  const std::string before = ReadFile(folder_.File("sweep.stats.csv"));
  std::filesystem::remove(out_);
  Sweep("--set law.p_gain=0.2,0.3 --set run.duration_s=2,30 --seeds 1..3 --jobs 1 --no-plot");
  EXPECT_EQ(ReadFile(folder_.File("sweep.stats.csv")), before) << "the same bytes";
}

TEST_F(SweepTest, DoesNotCallARunLateWhoseLawMakesNobodyAgree) {
  const std::string apart = "{name=\"waypoint\", waypoints_m=[[9, 9, 9]]}";
  const Ran alone = Sweep("--set 'law=" + apart + "' --seeds 1..2 --no-plot");
  EXPECT_EQ(alone.exit_code, 0) << alone.output;
  EXPECT_THAT(alone.output, Not(HasSubstr("settled")));
  const Ran beside = Sweep("--set 'law={name=\"consensus\", p_gain=0.3}," + apart +
                           "' --set run.duration_s=2,30 --plot consensus.settling_time_s --force --format svg");
  EXPECT_EQ(beside.exit_code, 0) << beside.output;
  EXPECT_THAT(beside.output, HasSubstr("not settled by the end: 1 of 2 runs whose law makes agents agree "));
  EXPECT_THAT(ReadFile(folder_.File("sweep.svg")), HasSubstr("<!-- 4 runs, 1 not settled (\u25b3) -->"));
}

TEST_F(SweepTest, KeepsTheMistakeOfAnImpossibleRunAsItsError) {
  const std::string mistake = "--set law.p_gain=fast: law.p_gain: expected a number in [0, 1000], got 'fast'";
  const std::string words = "--set law.p_gain=0.5,fast --no-plot";
  const Ran refused = Sweep(words);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("error: sweep: the first run with law.p_gain = fast: " + mistake +
                                        " (--force flies the other runs)"));
  EXPECT_FALSE(std::filesystem::exists(out_));
  const Ran ran = Sweep(words + " --force");
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(Table(out_).At(1, "error"), HasSubstr(mistake));
  EXPECT_EQ(Sweep(words).exit_code, 0) << "goes on with what --force has begun";
}

TEST_F(SweepTest, RefusesMisspeltKeysBeforeTheFirstRun) {
  const auto refuses = [&](const std::string& words, const std::string& text) {
    const Ran ran = Sweep(words + " --no-plot");
    EXPECT_EQ(ran.exit_code, 2) << ran.output;
    EXPECT_THAT(ran.output, HasSubstr("error: " + text));
    EXPECT_FALSE(std::filesystem::exists(out_));
  };
  refuses("--set law.pgain=0.1:0.1:100000", "--set law.pgain=0.1: law.pgain: unknown key (did you mean \"p_gain\"?)");
  refuses("--random lw.beta=0:1 --samples 100000", "--random lw.beta=0:1 (0.3721453822554983): lw: unknown key");
  refuses("--random law.beta=-2.0:-1e0 --samples 3",
          "--random law.beta=-2:-1 (-1.6278546177445017): law.beta: expected a number in [0, 1000], got -1.62785");
  refuses("--set graph.topology=ring,paht", "sweep: the first run with graph.topology = paht: ");
  refuses("--set law.p_gain=1:1000:2001", "sweep: the first run with law.p_gain = 2001: ");
}

TEST_F(SweepTest, RefusesSeveralSeedsIfNothingDependsOnThem) {
  const std::string words = "--set 'agents.position_m=[[0, 0, 1], [1, 1, 2], [2, 2, 3]]' --no-plot ";
  const Ran refused = Sweep(words + "--seeds 1..3 --set link.loss=0,1");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output,
              HasSubstr("error: sweep: expected one run.seed, because every seed gives the same run (nothing is drawn: "
                        "no places, edges, loss, jitter, noise, gusts or lies at random, no law that draws), got 3 "
                        "(--force flies them all)"));
  EXPECT_FALSE(std::filesystem::exists(out_));
  EXPECT_EQ(Sweep(words + "--seeds 1..3 --force").exit_code, 0);
  EXPECT_EQ(Sweep(words + "--seeds 1..3").exit_code, 0) << "goes on with what --force has begun";
  EXPECT_EQ(Sweep(words + "--seeds 1..3 --set link.loss=0,0.5 --force").exit_code, 0);
  std::filesystem::remove(out_);
  EXPECT_EQ(Sweep(words + "--seeds 1..3 --set link.loss=0,0.5").exit_code, 0) << "some runs depend on it";
  std::filesystem::remove(out_);
  EXPECT_EQ(Sweep(words + "--seeds 3").exit_code, 0);
}

TEST_F(SweepTest, FliesTheValuesOfKeysRowByRowWithZip) {
  const std::string words = "--set law.p_gain=0.1,0.2,0.4 --set law.beta=1,0.5,0.1 --seeds 4..5 ";
  const Ran ran = Sweep(words + "--zip --jobs 1");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output, HasSubstr("6 runs: " + out_));
  const Table table(out_);
  ASSERT_THAT(table.rows, SizeIs(6));
  EXPECT_THAT(Cells(table.rows[3].begin(), table.rows[3].begin() + 5),
              testing::ElementsAre("3", "0.2", "0.5", "5", ""));
  EXPECT_THAT(Table(folder_.File("sweep.stats.csv")).rows[2],
              testing::IsSupersetOf({testing::StrEq("0.4"), testing::StrEq("0.1"), testing::StrEq("2")}))
      << "statistics of a row over its seeds";
  const std::string picture = ReadFile(folder_.File("sweep.png")),
                    statistics = ReadFile(folder_.File("sweep.stats.csv"));
  EXPECT_THAT(picture, testing::StartsWith("\x89PNG"));

  EXPECT_THAT(Sweep(words + "--zip").output, HasSubstr("6 runs, none flown now: "));
  const Ran product = Sweep(words);
  EXPECT_EQ(product.exit_code, 2);
  EXPECT_THAT(product.output, HasSubstr("which differs in how values are combined: row by row there and each with each "
                                        "here (--force begins anew)"));
  ASSERT_EQ(Sweep(words + "--zip --force --jobs 3").exit_code, 0);
  EXPECT_EQ(Table(out_).Repeatable(), table.Repeatable());
  EXPECT_EQ(ReadFile(folder_.File("sweep.stats.csv")), statistics);
  EXPECT_EQ(ReadFile(folder_.File("sweep.png")), picture);
  ASSERT_EQ(Sweep(words + "--force").exit_code, 0);
  const auto every = Table(out_).Repeatable();
  ASSERT_THAT(every, SizeIs(18)) << "every combination";
  const Cells pair = table.Repeatable()[3];
  EXPECT_EQ(Cells(every[9].begin() + 1, every[9].end()), Cells(pair.begin() + 1, pair.end()))
      << "among which the same run has the same numbers";
}

TEST_F(SweepTest, RefusesWhatZipCannotTakeTogether) {
  const auto refuses = [&](const std::string& words, const std::string& text) {
    const Ran ran = Sweep(words + " --zip");
    EXPECT_EQ(ran.exit_code, 2) << ran.output;
    EXPECT_EQ(ran.output, "error: " + text + "\n");
    EXPECT_FALSE(std::filesystem::exists(out_));
  };
  refuses("--set law.p_gain=0.1,0.2,0.3 --set law.beta=1,2",
          "--zip: expected as many values of each key, got 3 of law.p_gain, 2 of law.beta");
  refuses("--set law.p_gain=0.1,0.2 --seeds 1..2",
          "--zip: expected at least 2 keys with --set KEY=VALUES of several values, got 1, law.p_gain");
  refuses("--set law.p_gain=0.1,0.2,-1 --set law.beta=1,2,3",
          "sweep: the first run with law.p_gain = -1, law.beta = 3: --set law.p_gain=-1: law.p_gain: expected a number "
          "in [0, 1000], got -1 (--force flies the other runs)");
}

TEST_F(SweepTest, FliesTheRowsOfATable) {
  const std::string plan = folder_.File("plan.csv"), words = "--plan " + plan + " ";
  WriteFile(plan, "law.p_gain,graph.topology,run.seed\n0.10,ring,4\n0.2,path,5\n0.2,ring,7\n");
  const Ran ran = Sweep(words + "--jobs 1");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  const Table table(out_);
  ASSERT_THAT(table.rows, SizeIs(3));
  EXPECT_THAT(Cells(table.rows[1].begin(), table.rows[1].begin() + 5),
              testing::ElementsAre("1", "0.2", "path", "5", ""));
  EXPECT_TRUE(std::filesystem::exists(folder_.File("sweep.png")));
  Up up(folder_, "up", config_,
        {"--engine", "inprocess", "--set", "law.p_gain=0.2", "--set", "graph.topology=path", "--seed", "5"});
  ASSERT_EQ(up.Wait(), 0);
  EXPECT_EQ(std::stod(table.At(1, "consensus.final_disagreement_m")),
            up.Summary()["consensus"]["final_disagreement_m"]);

  ASSERT_EQ(Sweep(words + "--force --jobs 3").exit_code, 0);
  EXPECT_EQ(Table(out_).Repeatable(), table.Repeatable());
  EXPECT_THAT(Sweep("--plan - < " + plan).output, HasSubstr("3 runs, none flown now: ")) << "from standard input";
  EXPECT_THAT(
      Sweep("--zip --set law.p_gain=0.1,0.2,0.2 --set graph.topology=ring,path,ring --set run.seed=4,5,7").output,
      HasSubstr("3 runs, none flown now: "))
      << "the same runs, typed";
  WriteFile(plan, "law.p_gain,graph.topology,run.seed\n0.10,ring,4\n0.2,path,5\n0.2,ring,8\n");
  EXPECT_THAT(Sweep(words).output, HasSubstr("which differs in --set run.seed: 4, 5, 7 there and 4, 5, 8 here"));

  WriteFile(plan, "law.p_gain\n0.1\n0.2\n");
  ASSERT_EQ(Sweep(words + "--seeds 4..6 --set graph.topology=path --force").exit_code, 0);
  const Table seeds(out_);
  ASSERT_THAT(seeds.rows, SizeIs(6));
  EXPECT_THAT(Cells(seeds.rows[4].begin() + 1, seeds.rows[4].begin() + 4), testing::ElementsAre("path", "0.2", "5"));
  EXPECT_EQ(seeds.At(4, "consensus.final_disagreement_m"), table.At(1, "consensus.final_disagreement_m"));
}

TEST_F(SweepTest, SaysWhereATableIsWrongBeforeAnythingFlies) {
  const std::string plan = folder_.File("plan.csv");
  const auto refuses = [&](const std::string& text, const std::string& words, const std::string& mistakes) {
    WriteFile(plan, text);
    const Ran ran = Sweep("--plan " + plan + " " + words);
    EXPECT_EQ(ran.exit_code, 2) << ran.output;
    EXPECT_EQ(ran.output, "error: " + mistakes + "\n");
    EXPECT_FALSE(std::filesystem::exists(out_));
  };
  refuses("law.p_gain,law.beta,graph.topology\n0.1,1,ring\n0.2,fast,ring\n-3,1,rnig\n0.1,2,ring\n", "",
          plan + ":3:2: law.beta: expected a number in [0, 1000], got 'fast'\nerror: " + plan +
              ":4:1: law.p_gain: expected a number in [0, 1000], got -3\nerror: " + plan +
              ":4:3: graph.topology: expected one of complete, ring, path, star, wheel, binary_tree, directed_ring, "
              "directed_path, directed_star, directed_tree, got 'rnig' (did you mean \"ring\"?)");
  refuses("law.p_gain,law.bta\n0.1,1\n0.2,1\n0.3,1\n", "",
          plan + ":2:2: law.bta: unknown key (did you mean \"beta\"?) (and in 2 more rows)");
  refuses("law.p_gain\n1\n\"2\n", "",
          plan + ":3:1: expected quotes around a whole cell, and in it two for each one, got no second quote");
  refuses("law.p_gain,law.beta\n1,2\n1\n", "", plan + ":3:1: expected 2 cells, as there are keys, got 1");
  refuses("law.p_gain\n1\n2\n", "--set law.beta=1,2",
          "--set: expected one value of a key beside the rows of " + plan + ", got 'law.beta=1,2'");
  refuses("law.p_gain,run.seed\n1,1\n2,2\n", "--seeds 1..2",
          "--seeds: expected no column run.seed in " + plan + ", which gives each run its seed, got both");
  refuses("law.p_gain,law.beta\n1,1\n2,2\n", "--zip",
          "--zip: expected no --plan, because a row of " + plan + " is a run already");
  std::string many = "law.p_gain\n", mistakes;
  for (int gain = -22; gain < 0; ++gain) many.append(std::to_string(gain)).append("\n");
  for (int row = 0; row < 20; ++row)
    mistakes += (row == 0 ? "" : "\nerror: ") + plan + ":" + std::to_string(row + 2) +
                ":1: law.p_gain: expected a number in [0, 1000], got " + std::to_string(row - 22);
  refuses(many, "", mistakes + "\nerror: sweep: 2 more mistakes");
  const Ran both = Shell(BuildFolder() + "/orchestrator sweep - --plan - < " + config_);
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_EQ(both.output, "error: --plan: expected another input than CONFIG, got <stdin> for both\n");
  EXPECT_EQ(Sweep("--plan ''").exit_code, 2);
  const Ran nothing = Sweep("--plan " + folder_.File("none.csv"));
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_EQ(nothing.output, "error: " + folder_.File("none.csv") + ": cannot be read: No such file or directory\n");

  WriteFile(plan, "law.p_gain,law.beta\n1,1\n2,fast\n");
  const Ran forced = Sweep("--force --no-plot --plan " + plan);
  EXPECT_EQ(forced.exit_code, 0) << forced.output;
  EXPECT_EQ(Table(out_).At(0, "error"), "");
  EXPECT_EQ(Table(out_).At(1, "error"), plan + ":3:2: law.beta: expected a number in [0, 1000], got 'fast'");
}

TEST_F(SweepTest, RefusesSeedsOfATableThatChangeNothing) {
  const std::string plan = folder_.File("plan.csv");
  const std::string words = "--no-plot --set 'agents.position_m=[[0, 0, 1], [1, 1, 2], [2, 2, 3]]' --plan " + plan;
  WriteFile(plan, "law.p_gain,run.seed\n0.1,1\n0.2,2\n");
  EXPECT_EQ(Sweep(words).exit_code, 0) << "no two runs differ in their seed alone";
  WriteFile(plan, "law.p_gain,run.seed\n0.1,1\n0.2,2\n0.1,3\n");
  const Ran refused = Sweep(words);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("no law that draws), got 3 (--force flies them all)"));
}

TEST_F(SweepTest, FliesLawsSideBySideEachWithTheKeysThatItHas) {
  WriteFile(config_,
            "[run]\nduration_s = 1.0\n[agents]\ncount = 3\n[graph]\ntopology = 'ring'\n[law]\nname = "
            "'consensus'\nbeta = 0.7\n");
  const Ran ran = Sweep("--set law.name=consensus,velocity_consensus --set law.p_gain=0.1,0.2 --seeds 1..2 --no-plot");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output, HasSubstr("sweep: law.name = velocity_consensus: without law.beta, which it does not have"));
  const Table table(out_);
  ASSERT_THAT(table.rows, SizeIs(8));
  for (std::size_t row = 0; row < 8; ++row) EXPECT_EQ(table.At(row, "error"), "");
  EXPECT_EQ(table.At(4, "law.name"), "velocity_consensus");
  EXPECT_NE(table.At(0, "control.effort"), table.At(4, "control.effort"));
  const Ran refused = Sweep("--set law.name=consensus,velocity_consensus --set law.beta=0.1,0.2 --no-plot --force");
  EXPECT_EQ(refused.exit_code, 0) << refused.output;
  EXPECT_THAT(Table(out_).At(2, "error"), HasSubstr("law.beta: unknown key"))
      << "a key of several values is not left out";
}

TEST_F(SweepTest, HasTheFiguresOfEveryLawThatARunEndsWith) {
  const std::string team = "[run]\nduration_s = 1.0\n[agents]\ncount = 3\n[graph]\ntopology = 'ring'\n";
  const std::string coverage = "{name=\"coverage\", region_m=[[-5, -5], [5, -5], [5, 5], [-5, 5]]}";
  const auto points_with_cost = [&](const std::string& words) {
    const Ran ran = Sweep(words + " --seeds 1..2 --no-plot --force");
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
    Cells points;
    for (const Cells& cells : Table(folder_.File("sweep.stats.csv")).rows)
      if (std::ranges::count(cells, "laws.coverage.cost_end_m2") == 1) points.push_back(cells[0]);
    return points;
  };
  WriteFile(config_, team);
  EXPECT_THAT(points_with_cost("--set 'law={name=\"velocity_consensus\"}," + coverage + "'"), SizeIs(1)) << "of 2 laws";
  EXPECT_EQ(Table(out_).At(1, "laws.coverage.cost_end_m2"), "") << "the other law's run";
  EXPECT_NE(Table(out_).At(2, "laws.coverage.cost_end_m2"), "");

  WriteFile(config_, team + "[[agents.override]]\nid = 3\nlaw = " + coverage + "\n");
  EXPECT_THAT(points_with_cost("--set law.name=consensus,velocity_consensus"),
              testing::ElementsAre("consensus", "velocity_consensus"))
      << "an agent's own law";

  WriteFile(config_,
            team + "[[law.schedule]]\nat_s = 0.5\nname = 'coverage'\nregion_m = [[-5, -5], [5, -5], [0, 5]]\n");
  EXPECT_THAT(points_with_cost("--set run.duration_s=0.5:0.5:1"), testing::ElementsAre("1"))
      << "a phase that the shorter run does not reach";
}

TEST_F(SweepTest, FliesTheLawTablesThatTheDocumentShows) {
  const std::string text = ReadFile(SourceFolder() + "/docs/sweep.md");
  const auto begin = text.find("--set 'law={"), end = text.find('`', begin);
  ASSERT_NE(end, text.npos);
  const Ran ran = Sweep(text.substr(begin, end - begin) + " --no-plot");
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output, HasSubstr("2 runs: "));
}

TEST_F(SweepTest, RefusesWhatCannotBeSwept) {
  const auto refuses = [&](const std::string& words, const std::string& text) {
    const Ran ran = Sweep(words);
    EXPECT_EQ(ran.exit_code, 2) << ran.output;
    EXPECT_THAT(ran.output, HasSubstr(text));
    EXPECT_FALSE(std::filesystem::exists(out_));
  };
  refuses("--set law.p_gain=slow,fast", "error: --set law.p_gain=slow: law.p_gain: expected a number in [0, 1000]");
  refuses("--set run.mode=realtime", "error: sweep: expected run.mode = \"lockstep\", got \"realtime\"");
  refuses("--seeds 1..2 --plot consensus.final_disagreement",
          "error: --plot: expected a column of the table, such as consensus.final_disagreement_m, got "
          "'consensus.final_disagreement' (did you mean \"consensus.final_disagreement_m\"?)");
  refuses("--seeds 1..2 --plot settling_time_s", "got 'settling_time_s' (did you mean \"consensus.settling_time_s\"?)");
  refuses("--seeds 1..2 --plot wall_s",
          "error: --plot: expected a column of which there are statistics, got 'wall_s', which depends on the machine");
  refuses("--seeds 5..1", "error: --seeds: expected a..b or a,b,... of integers from 0 on, got '5..1'");
  refuses("--random law.p_gain=0:1 --samples 0", "error: --samples: ");
  refuses("--samples 3", "error: --samples requires --random");
  refuses("--random law.p_gain=0:1", "error: --random requires --samples");
  refuses("--set law.p_gain=1,2 --set law.beta=1,2 --set law.v_gain=0,1 --plot consensus.rate_per_s",
          "error: --plot: expected at most 2 keys of several values to draw over, got 3");
  refuses("--plot consensus.rate_per_s", "error: --plot: expected at least 2 runs to draw, got 1");
  refuses("--set law.p_gain=1,2 --set law.p_gain=3", "error: sweep: expected each key once, got law.p_gain again");
  refuses("--set law.p_gain=1,2 --set 'law={name=\"consensus\"}'",
          "error: sweep: expected each key once, got law and law.p_gain");
  refuses("--random law.p_gain=-1e308:1e308 --samples 2",
          "error: --random: expected a range that a double can span, got 'law.p_gain=-1e308:1e308'");
  out_ = folder_.File("a.png");
  refuses("--seeds 1..2",
          "error: --out: expected the table's file, such as sweep.csv, got '" + out_ + "', the picture's");
}

TEST_F(SweepTest, IsComparedRunByRunByAVerbOfItsOwn) {
  const auto compare = [&](const std::string& words) {
    return Shell(BuildFolder() + "/orchestrator compare " + words);
  };
  std::string runs;
  for (const char* gain : {"0.2", "0.4"}) {
    Up up(folder_, std::string("gain_") + gain, config_,
          {"--engine", "inprocess", "--set", std::string("law.p_gain=") + gain});
    ASSERT_EQ(up.Wait(), 0);
    runs += up.path().string() + " ";
  }
  const Ran table = compare(runs + "--plot " + folder_.File("pictures"));
  EXPECT_EQ(table.exit_code, 0) << table.output;
  EXPECT_THAT(table.output, testing::ContainsRegex("gain_0.2 +gain_0.4\nset differently\n  law.p_gain +0.2 +0.4\n"));
  EXPECT_TRUE(std::filesystem::exists(folder_.File("pictures/disagreement.png")));
  const Ran json = compare(runs + "--json");
  EXPECT_EQ(nlohmann::json::parse(json.output)["config"]["law.p_gain"], nlohmann::json({0.2, 0.4}));
  const Ran newest = Shell("cd '" + folder_.path().string() + "' && mkdir runs && mv gain_0.2 gain_0.4 runs && touch " +
                           "-d 2020-01-01 runs/gain_0.2/config.toml && mkdir other && cp -r runs/gain_0.2 other && " +
                           BuildFolder() + "/orchestrator compare other latest");
  EXPECT_THAT(newest.output, HasSubstr("other/gain_0.2  runs/gain_0.4\n")) << "found as by the other verbs";
  const Ran nowhere = compare(folder_.File("other") + " latest");
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_EQ(nowhere.output, "error: latest: expected the newest run in the folder runs, which is not here\n");
  const Ran one = compare(folder_.File("runs"));
  EXPECT_EQ(one.exit_code, 2);
  EXPECT_EQ(one.output, "error: compare: expected at least 2 runs, got 1\n");
}

TEST_F(SweepTest, DoesNotGoOnWithAnotherLaw) {
  const auto law = [&](const std::string& gain) {
    WriteFile(folder_.File("law.py"), "def control(t, me, neighbours):\n    return [" + gain + ", 0.0]\n");
  };
  WriteFile(config_, "[run]\nduration_s = 1.0\n[agents]\ncount = 2\n[law]\nname = 'custom'\nfile = 'law.py'\n");
  law("0.1");
  ASSERT_EQ(Sweep("--seeds 1..2 --no-plot").exit_code, 0);
  EXPECT_EQ(Sweep("--seeds 1..2 --no-plot").exit_code, 0) << "the same";
  law("0.2");
  const Ran other = Sweep("--seeds 1..2 --no-plot");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, HasSubstr("expected a new file, or one of this very sweep, got another"));
}

TEST_F(SweepTest, KeepsApartTheFilesOfTablesWhoseNamesDifferBehindADot) {
  for (const char* name : {"gain.v1", "gain.v2", "gain.csv"}) {
    out_ = folder_.File(name);
    const Ran ran =
        Sweep("--seeds 1..2 --set run.duration_s=1" + std::string(out_.ends_with("v1") ? "" : " --no-plot"));
    ASSERT_EQ(ran.exit_code, 0) << ran.output;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.File("gain.png")));
  for (const char* name :
       {"gain.v1.stats.csv", "gain.v1.png", "gain.v2.stats.csv", "gain.stats.csv", "gain.v1", "gain.v1.plan"})
    EXPECT_TRUE(std::filesystem::exists(folder_.File(name))) << name;
}

TEST_F(SweepTest, RefusesATableThatAnotherSweepIsWriting) {
  Running sweep(BuildFolder() + "/orchestrator", {"sweep", config_, "--out", out_, "--seeds", "1..5000", "--no-plot"},
                folder_.File("first"));
  ASSERT_TRUE(Until([&] { return RowsSoFar(out_) > 2; }));
  for (const char* words : {"--seeds 1..5000 --no-plot", "--seeds 1..2 --no-plot --force"}) {
    const Ran second = Sweep(words);
    EXPECT_EQ(second.exit_code, 2) << second.output;
    EXPECT_THAT(second.output, HasSubstr("error: --out " + out_ +
                                         ": expected a table of this sweep's own, got one "
                                         "that another is writing"));
  }
  SignalTo(sweep.pid(), SIGINT);
  EXPECT_EQ(sweep.Wait(), 130) << "the first is not disturbed";
}

TEST_F(SweepTest, DoesNotMixTwoSweepsInOneTable) {
  ASSERT_EQ(Sweep("--seeds 1..2 --no-plot").exit_code, 0);
  const std::string before = ReadFile(out_);
  const Ran other = Sweep("--seeds 1..3 --no-plot");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, HasSubstr("expected a new file, or one of this very sweep, got another, which differs in "
                                      "--seeds: 1, 2 there and 1, 2, 3 here (--force begins anew)"));
  EXPECT_EQ(ReadFile(out_), before);
  EXPECT_EQ(Sweep("--seeds 1..3 --no-plot --force").exit_code, 0);
  EXPECT_THAT(Table(out_).rows, SizeIs(3));
}

TEST_F(SweepTest, DrawsColoursForWordsAndMarksRunsThatDidNotSettle) {
  for (const char* words :
       {"--set graph.topology=ring,path --set law.p_gain=0.1,0.2 --seeds 1..2 --plot consensus.settling_time_s "
        "--set run.duration_s=20",
        "--set graph.topology=ring,path --set law.axes=xy,xyz --seeds 1..2",
        "--set law.p_gain=0.01,1 --set law.beta=1,2 --set run.duration_s=20 --plot consensus.settling_time_s",
        "--seeds 1..3 --plot consensus.settling_time_s --set law.p_gain=1 --set run.duration_s=8"}) {
    std::filesystem::remove(folder_.File("sweep.png"));
    const Ran ran = Sweep(std::string(words) + " --force");
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
    EXPECT_THAT(ReadFile(folder_.File("sweep.png")), testing::StartsWith("\x89PNG")) << words;
  }
}

TEST_F(SweepTest, DrawsForAPaperAndDrawsAgain) {
  const Ran paper = Sweep("--set law.p_gain=0.1,0.2 --seeds 1..2 --force --format pdf,svg --size column");
  EXPECT_EQ(paper.exit_code, 0) << paper.output;
  EXPECT_THAT(paper.output,
              HasSubstr("\npicture: " + folder_.File("sweep.pdf") + "\npicture: " + folder_.File("sweep.svg") + "\n"));
  EXPECT_THAT(ReadFile(folder_.File("sweep.pdf")), testing::StartsWith("%PDF"));
  const std::string svg = ReadFile(folder_.File("sweep.svg"));
  EXPECT_THAT(svg, HasSubstr("width=\"252pt\"")) << "3.5 inches";
  const Ran again = Sweep("--set law.p_gain=0.1,0.2 --seeds 1..2 --format svg --size column");
  EXPECT_THAT(again.output, HasSubstr("going on: 4 of 4 runs are in the table"));
  EXPECT_EQ(ReadFile(folder_.File("sweep.svg")), svg) << "drawn again from the table, to the same bytes";
  const Ran unknown = Sweep("--set law.p_gain=0.1,0.2 --seeds 1..2 --format gif");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output,
              HasSubstr("error: --format: expected one or more of png, pdf, svg, with commas between, got 'gif'"));
  EXPECT_THAT(unknown.output, testing::Not(HasSubstr("going on"))) << "before any run";
}

TEST_F(SweepTest, DrawsCurvesMapsAndHistograms) {
  for (const char* words :
       {"--seeds 1..4", "--set law.p_gain=0.1:0.1:0.4", "--set graph.topology=ring,path --seeds 1..2",
        "--set law.p_gain=0.1:0.1:0.3 --set law.beta=0.5,1.0",
        "--set law.p_gain=0.01,0.1,1 --set law.beta=0.5",  // with a log axis, as the next one
        "--set law.p_gain=0.01,0.1,1 --set law.beta=0.5,1.0",
        "--random law.p_gain=0.1:1 --random law.beta=0.5:2 --samples 6"}) {
    std::filesystem::remove(folder_.File("sweep.png"));
    const Ran ran = Sweep(std::string(words) + " --force");
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
    EXPECT_THAT(ReadFile(folder_.File("sweep.png")), testing::StartsWith("\x89PNG")) << words;
  }
  // Values range from rounding errors to metres.
  WriteFile(config_,
            "[run]\nduration_s = 100.0\n[agents]\ncount = 5\nmodel = 'double_integrator'\n[graph]\nrandom = { "
            "kind = 'erdos_renyi', p = 0.8 }\n");
  EXPECT_EQ(Sweep("--seeds 1..30 --force").exit_code, 0);
  const Ran nothing = Sweep("--seeds 1..2 --force --plot consensus.predicted.minmax_time_s");
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.output, HasSubstr("error: " + out_ + ": no run has a consensus.predicted.minmax_time_s"));
}

TEST_F(SweepTest, CountsWholeRowsOfATableThatGrows) {
  EXPECT_EQ(RowsSoFar(out_), 0u) << "there is none";
  for (const auto& [text, rows] : {std::pair("a,b", 0u), {"a,b\n", 0u}, {"a,b\n1,", 0u}, {"a,b\n1,2\n3", 1u}}) {
    WriteFile(out_, text);
    EXPECT_EQ(RowsSoFar(out_), rows) << text;
  }
}

}  // namespace
}  // namespace mascot::test
