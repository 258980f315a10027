// Files of a law, law.data and FMUs, in whole runs: over DDS and in one process, again from a recording, after a kill.
#include <gmock/gmock.h>

#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

namespace fs = std::filesystem;

/// An experiment with a law that reads a file of 3 MB. Temporary files of its runs are in a folder of this test.
class RunWithData : public testing::Test {
 protected:
  RunWithData() {
    fs::create_directory(temporary_);
    setenv("TMPDIR", temporary_.c_str(), 1);
    std::string bytes(3'000'000, '\0');
    for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<char>(k * k >> 7);
    WriteFile(scratch_.File("w.bin"), bytes);
    Write("");
  }
  ~RunWithData() override { unsetenv("TMPDIR"); }

  /// Writes the experiment; `first` is what the law does first at each call.
  void Write(const std::string& first) const {
    WriteFile(scratch_.File("law.toml"),
              "[run]\nduration_s = 0.5\n[agents]\ncount = 3\nmodel = 'double_integrator'\n[graph]\ntopology = 'ring'\n"
              "[output]\nsave_plot = false\n"
              "[law]\nname = 'custom'\ndata = ['w.bin']\npython = '''\nimport os, time\nimport numpy as np\n"
              "W = np.fromfile(DATA['w.bin'], dtype=np.uint8)\ndef control(t, me, neighbours):\n    " +
                  first + "\n    return W[int(t * 1e6)] / 300, W.sum() % 7 / 10, me.random.normal()\n'''\n");
  }
  Ran Orchestrator(const std::string& words) const {
    return Shell("cd '" + scratch_.path().string() + "' && '" + BuildFolder() + "/orchestrator' " + words);
  }
  bool IsSwept() const { return fs::is_empty(temporary_); }

  const ScratchFolder scratch_;
  const std::string temporary_ = scratch_.File("tmp");
};

TEST_F(RunWithData, IsTheSameOnBothEnginesAndAgainWithoutTheFile) {
  Write("pass");
  ASSERT_EQ(Orchestrator("up law.toml --engine inprocess --quiet --out one").exit_code, 0);
  const Ran dds = Orchestrator("up law.toml --quiet --out dds");
  ASSERT_EQ(dds.exit_code, 0) << dds.output;
  const std::string recording = ReadFile(scratch_.File("one/run.mcap"));
  EXPECT_TRUE(recording == ReadFile(scratch_.File("dds/run.mcap")));
  WriteFile(scratch_.File("w.bin"), "another");
  for (const char* words : {"verify dds", "up one/config.toml --engine inprocess --quiet --out again",
                            "sweep one/config.toml --set run.seed=1,2 --no-plot --quiet --out s.csv"}) {
    const Ran ran = Orchestrator(words);
    EXPECT_EQ(ran.exit_code, 0) << words << "\n" << ran.output;
  }
  EXPECT_TRUE(recording == ReadFile(scratch_.File("again/run.mcap")));
  EXPECT_TRUE(IsSwept());
}

TEST_F(RunWithData, LeavesNoCopiesWhenProcessesAreKilled) {
  for (const char* engine : {"dds", "inprocess"}) {
    SCOPED_TRACE(engine);
    Write("if t > 0.1: print('hangs', flush=True); time.sleep(1000)");
    Up up(scratch_, "run", scratch_.File("law.toml"), {"--engine", engine, "--force"});
    ASSERT_TRUE(Until([&] { return up.Said("hangs"); })) << up.err();
    EXPECT_FALSE(IsSwept());
    up.Signal(SIGKILL);
    EXPECT_EQ(up.Wait(), -SIGKILL);
    EXPECT_TRUE(Until([&] { return IsSwept(); }));
  }
  Write("if t > 0.1: os.kill(os.getpid(), 0) or __import__('ctypes').string_at(0)");
  EXPECT_EQ(Orchestrator("up law.toml --quiet --out crashed").exit_code, 1);
  EXPECT_TRUE(Until([&] { return IsSwept(); }));
}

TEST_F(RunWithData, LeavesNoFilesOfAnFmu) {
  WriteFile(scratch_.File("fmu.toml"),
            "[run]\nduration_s = 0.5\n[agents]\ncount = 3\nmodel = 'double_integrator'\n[graph]\ntopology = 'ring'\n"
            "[output]\nsave_plot = false\n[law]\nname = 'fmu'\nfile = '" +
                BuildFolder() + "/tests/fmus/law_fmi2.fmu'\n");
  for (const char* words :
       {"check fmu.toml", "up fmu.toml --engine inprocess --quiet --out one", "up fmu.toml --quiet --out dds",
        "sweep fmu.toml --set run.seed=1,2 --no-plot --quiet --out s.csv", "verify one"}) {
    const Ran ran = Orchestrator(words);
    EXPECT_EQ(ran.exit_code, 0) << words << "\n" << ran.output;
    EXPECT_TRUE(IsSwept()) << words;
  }
}

}  // namespace
}  // namespace mascot::test
