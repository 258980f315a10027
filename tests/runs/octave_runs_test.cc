// Whole runs of laws in MATLAB's language, by the real programs. These tests need Octave.
#include <gmock/gmock.h>
#include <signal.h>

#include <string>
#include <vector>

#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// An experiment whose law has this text; agents hear each other.
std::string OctaveRun(const ScratchFolder& folder, const std::string& text, const std::string& agents = "count = 2\n",
                      const std::string& more = "") {
  WriteFile(folder.File("law.toml"), "[run]\nduration_s = 1.0\n[agents]\n" + agents +
                                         "[graph]\ntopology = 'complete'\n[output]\nsave_plot = false\n" + more +
                                         "[law]\nname = 'octave'\noctave = '''\n" + text + "'''\n");
  return folder.File("law.toml");
}

/// A process with these words in its command line, or 0.
pid_t Octave(const Running& up, const std::string& of = "") {
  const pid_t agent = of.empty() ? up.pid() : ChildOf(up.pid(), of);
  return agent > 0 ? ChildOf(agent, "mascot_driver") : 0;
}

bool HasEnded(pid_t pid) {
  return Await("the end of Octave", [&] {
    return kill(pid, 0) != 0 || ReadFile("/proc/" + std::to_string(pid) + "/stat").find(") Z ") != std::string::npos;
  });
}

const std::string kTalks =
    "function [a, message] = control(t, me, neighbours, params)\n  persistent calls;\n  if isempty(calls)\n    calls = "
    "0;\n"
    "  end\n  calls = calls + 1;\n  a = -me.velocity + 0.1 * randn(3, 1) + 0.001 * calls * me.id;\n"
    "  for j = neighbours\n    if !isempty(j.message)\n      a = a + 0.01 * j.message;\n    end\n  end\n"
    "  message = me.position;\nend\n";

TEST(OctaveRuns, HaveTheSameBytesInBothEnginesBundledAndAgain) {
  const ScratchFolder folder;
  const std::string file =
      OctaveRun(folder, kTalks, "count = 4\n", "[[events]]\nat_s = 0.5\nset = { 'law.params.gain' = 2 }\n");
  const auto flown = [&](const std::string& name, std::vector<std::string> more) {
    Up up(folder, name, file, std::move(more));
    EXPECT_EQ(up.Wait(), 0) << up.err();
    return up.File("states.npz");
  };
  const std::string dds = flown("dds", {});
  EXPECT_FALSE(dds.empty());
  EXPECT_TRUE(flown("inprocess", {"--engine", "inprocess"}) == dds);
  EXPECT_TRUE(flown("bundled", {"--set", "network.agents_per_process=2"}) == dds);
  EXPECT_FALSE(flown("seed", {"--engine", "inprocess", "--set", "run.seed=7"}) == dds);
}

TEST(OctaveRuns, ThatFailSayAgentTickTimeAndPlace) {
  const ScratchFolder folder;
  const std::string file = OctaveRun(folder,
                                     "function a = control(t, me, neighbours)\n  a = [0 0];\n"
                                     "  if t > 0.5 && me.id == 2\n    a = neighbours(7).position;\n  end\nend\n");
  for (const std::string engine : {"dds", "inprocess"}) {
    Up up(folder, engine, file, {"--engine", engine});
    EXPECT_EQ(up.Wait(), 1);
    EXPECT_THAT(up.err(), AllOf(HasSubstr("tick 51: the law of agent 2 failed at t = 0.51 s"),
                                HasSubstr("law.toml:15:"), HasSubstr("out of bound")));
    EXPECT_EQ(up.Summary()["exit"], 1);
  }
}

TEST(OctaveRuns, PrintWithTheAgentsName) {
  const ScratchFolder folder;
  Up up(folder, "run",
        OctaveRun(folder,
                  "function a = control(t, me, n)\n  a = [0 0];\n  if t == 0\n    "
                  "printf('here I am\\n');\n  end\nend\n"));
  EXPECT_EQ(up.Wait(), 0);
  EXPECT_THAT(up.err(), AllOf(HasSubstr("[agent_1] here I am\n"), HasSubstr("[agent_2] here I am\n")));
}

TEST(OctaveRuns, LeaveNoOctaveBehindWhenTheOrchestratorOrTheAgentIsKilled) {
  const std::string hangs =
      "function a = control(t, me, n)\n  a = [0 0];\n  if t > 0.1\n    printf('I hang\\n'); fflush(stdout);\n"
      "    while true\n    end\n  end\nend\n";
  for (const std::string engine : {"dds", "inprocess"}) {
    for (const bool agent : {false, true}) {
      if (agent && engine == "inprocess") continue;
      SCOPED_TRACE(engine + (agent ? ", agent" : ", orchestrator"));
      const ScratchFolder folder;
      Up up(folder, "run", OctaveRun(folder, hangs, "count = 1\n"),
            {"--engine", engine, "--set", "run.agent_timeout_s=1000"});
      ASSERT_TRUE(Await("the law to hang", [&] { return up.Said("I hang"); }));
      const std::string process = engine == "dds" ? "--id 1 " : "";
      const pid_t octave = Octave(up, process);
      ASSERT_GT(octave, 0);
      if (agent)
        SignalTo(up.Child("agent_1"), SIGKILL);
      else
        up.Signal(SIGKILL);
      EXPECT_TRUE(HasEnded(octave));
      up.Wait();
    }
  }
}

TEST(OctaveRuns, AreSweptByWorkers) {
  const ScratchFolder folder;
  const std::string file = OctaveRun(folder, kTalks);
  const Ran sweep = Shell("'" + BuildFolder() + "/orchestrator' sweep '" + file +
                          "' --seeds 1..4 --jobs 2 --no-plot --out '" + folder.File("sweep.csv") + "' 2>&1");
  EXPECT_EQ(sweep.exit_code, 0) << sweep.output;
  EXPECT_EQ(CountOf("\n", ReadFile(folder.File("sweep.csv"))), 5U);
}

TEST(OctaveRuns, MayHaveTheLawForOneAgentAloneAndForAPhase) {
  const ScratchFolder folder;
  const std::string octave = "name = 'octave'\noctave = 'function a = control(t, me, n), a = [0 1]; end'\n";
  WriteFile(folder.File("law.toml"),
            "[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\n"
            "position_m = [[0, 0, 1], [5, 0, 1]]\n[graph]\ntopology = 'complete'\n"
            "[law]\nname = 'consensus'\n[[law.schedule]]\nat_s = 0.5\n" +
                octave + "[[agents.override]]\nid = 2\n[agents.override.law]\n" + octave);
  std::string states;
  for (const std::string engine : {"dds", "inprocess"}) {
    Up up(folder, engine, folder.File("law.toml"), {"--engine", engine});
    EXPECT_EQ(up.Wait(), 0) << up.err();
    EXPECT_TRUE(states.empty() || states == up.File("states.npz"));
    states = up.File("states.npz");
    EXPECT_GT(up.Summary()["ticks"], 0);
  }
}

}  // namespace
}  // namespace mascot::test
