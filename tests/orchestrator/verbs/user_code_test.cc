// Which verbs run code that somebody has put into an experiment or a recording: a law in Python, a law in a shared
// library, a host's launch command. Each of them leaves a trace here, a file, when it runs.
#include <gmock/gmock.h>

#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

namespace fs = std::filesystem;

using ::testing::HasSubstr;

/// A run that was recorded, and where its code leaves a trace.
class RunWithCode : public ::testing::TestWithParam<const char*> {
 protected:
  RunWithCode() {
    const bool in_python = std::string(GetParam()) == "Python";
    if (!in_python) fs::copy(BuildFolder() + "/tests/plugins/libtracing.so", scratch_.File("libtracing.so"));
    trace_ = scratch_.File(in_python ? "trace" : "libtracing.so.loaded");
    WriteFile(config_,
              "[run]\nduration_s = 0.5\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\n" +
                  (in_python ? "name = 'custom'\npython = '''\nopen('" + trace_ +
                                   "', 'w').close()\n\ndef control(t, me, neighbours):\n    return [0, 0, 0]\n'''\n"
                             : "name = 'plugin'\nlibrary = 'libtracing.so'\n"));
    Up up(scratch_, "run", config_, {"--engine", "inprocess"});
    EXPECT_EQ(up.Wait(), 0) << up.err();
    EXPECT_TRUE(LeftATrace());
  }

  /// Whether the code has run since this was asked last.
  bool LeftATrace() const { return fs::remove(trace_); }
  Ran Orchestrator(const std::string& words) const {
    return Shell("cd '" + scratch_.path().string() + "' && '" + BuildFolder() + "/orchestrator' " + words);
  }

  ScratchFolder scratch_;
  std::string config_ = scratch_.File("two.toml");
  std::string trace_;
};

INSTANTIATE_TEST_SUITE_P(UserCode, RunWithCode, ::testing::Values("Python", "SharedLibrary"),
                         [](const auto& run) { return std::string(run.param); });

TEST_P(RunWithCode, VerbsThatFlyOrCheckRunIt) {
  for (const char* words : {"verify run", "check two.toml",
                            "up run/config.toml --engine inprocess --out again --quiet "
                            "--set output.save_plot=false"}) {
    const Ran ran = Orchestrator(words);
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
    EXPECT_TRUE(LeftATrace()) << words;
  }
}

TEST_P(RunWithCode, VerbsThatLookDoNotRunIt) {
  for (const char* words :
       {"info run", "graph two.toml", "graph run/config.toml --json", "plot run", "export run --format csv",
        "export run --format mat --out run.mat", "compare run run", "recover run/run.mcap --out again.mcap", "ps"}) {
    const Ran ran = Orchestrator(words);
    EXPECT_EQ(ran.exit_code, 0) << words << ": " << ran.output;
    EXPECT_FALSE(LeftATrace()) << words;
  }
}

TEST_P(RunWithCode, TheViewOfARecordingDoesNotRunIt) {
  Running view(BuildFolder() + "/orchestrator", {"view", scratch_.File("run"), "--at", "127.0.0.1:0"},
               scratch_.File("view"));
  ASSERT_TRUE(Await("the view", [&] { return view.Said("http://") || view.IsOver(); })) << view.err();
  view.Signal(SIGINT);
  EXPECT_EQ(view.Wait(), 130) << view.err();
  EXPECT_FALSE(LeftATrace());
}

// Somebody's config.toml stands beside his recording.
TEST(UserCode, VerifyStartsNoLaunchCommandUnlessTold) {
  const ScratchFolder scratch;
  const std::string trace = scratch.File("launched");
  WriteFile(scratch.File("two.toml"),
            "[run]\nduration_s = 0.5\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\nname = 'consensus'\n");
  Up up(scratch, "run", scratch.File("two.toml"), {"--engine", "inprocess", "--set", "output.save_data=false"});
  ASSERT_EQ(up.Wait(), 0) << up.err();
  const std::string config = up.path() / "config.toml";
  WriteFile(config, ReadFile(config) +
                        "\n[[hosts]]\nname = 'lab'\nagents = '2'\naddress = '127.0.0.1'\nlaunch = ['touch', '" + trace +
                        "']\n");
  const std::string verify = "'" + BuildFolder() + "/orchestrator' verify --engine dds '" + up.path().string() + "'";
  const Ran without = Shell(verify);
  EXPECT_EQ(without.exit_code, 0) << without.output;
  EXPECT_FALSE(fs::exists(trace));
  const Ran with = Shell(verify + " --hosts");
  EXPECT_EQ(with.exit_code, 1) << with.output;
  EXPECT_THAT(with.output, HasSubstr("host_lab"));
  EXPECT_TRUE(fs::exists(trace));
}

}  // namespace
}  // namespace mascot::test
