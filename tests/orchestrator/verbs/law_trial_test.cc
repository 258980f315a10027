// Laws of users that cannot be repeated, and what else a short flight ahead of the run tells of them.
#include <gmock/gmock.h>

#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kUnrepeatable = "wants something else at t = ";
constexpr const char* kShares =
    ", which all laws in a process share: what an agent draws depends on which agents share";

class LawTrial : public testing::Test {
 protected:
  Ran Orchestrator(const std::string& words) const {
    return Shell("cd '" + scratch_.path().string() + "' && '" + BuildFolder() + "/orchestrator' " + words);
  }
  /// Writes an experiment with this law in Python.
  void Write(const std::string& python, const std::string& lines = "") const {
    WriteFile(scratch_.File("law.toml"),
              "[run]\nduration_s = 2.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[output]\nsave_plot = false\n"
              "[law]\nname = 'custom'\n" +
                  lines + "python = '''\n" + python + "'''\n");
  }
  /// What `check` prints of an experiment with this law.
  std::string Check(const std::string& python, const std::string& lines = "") const {
    Write(python, lines);
    const Ran ran = Orchestrator("check law.toml");
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
    return ran.output;
  }

  const ScratchFolder scratch_;
};

TEST_F(LawTrial, TellsOfRandomNumbersWithoutASeed) {
  for (const char* draws : {"numpy.random.default_rng().normal(size=3)", "random.Random().random(), 0",
                            "len(uuid.uuid4().hex.replace('0', '')), 0", "os.urandom(1)[0], os.urandom(1)[0]"})
    EXPECT_THAT(
        Check(std::string("import numpy, os, random, uuid\ndef control(t, me, neighbours):\n  return ") + draws + "\n"),
        AllOf(HasSubstr("warning: law: agent "), HasSubstr(kUnrepeatable), Not(HasSubstr(kShares)),
              HasSubstr("me.rng is each agent's own generator in Python, and run.seed seeds it")))
        << draws;
}

TEST_F(LawTrial, TellsOfAClock) {
  EXPECT_THAT(
      Check("import time\ndef control(t, me, neighbours):\n  return time.time(), 0\n"),
      HasSubstr("agent 1 wants something else at t = 0 s when the same start is flown again: its law draws "
                "random numbers without a seed, or asks a clock or the system, so that no run can be repeated"));
}

TEST_F(LawTrial, TellsOfGeneratorsThatAgentsShareAlsoIfTheyAreSeeded) {
  EXPECT_THAT(Check("import random\ndef control(t, me, neighbours):\n  return random.random(), 0\n"),
              AllOf(HasSubstr(kUnrepeatable), HasSubstr(std::string("warning: law: it draws from random") + kShares)));
  EXPECT_THAT(
      Check("import numpy\nnumpy.random.seed(1)\ndef control(t, me, neighbours):\n  return numpy.random.normal(), 0\n"),
      AllOf(Not(HasSubstr(kUnrepeatable)),
            HasSubstr(std::string("warning: law: it draws from numpy.random") + kShares)));
}

TEST_F(LawTrial, SaysNothingOfWhatCanBeRepeated) {
  EXPECT_THAT(Check("import numpy\ndef start(me, params):\n  me.own = numpy.random.default_rng(me.id)\n"
                    "def control(t, me, neighbours):\n  return me.rng.normal() + me.own.normal() + hash('a') % 7, 0\n"),
              Not(HasSubstr("warning: law")));
}

TEST_F(LawTrial, TellsOfParametersThatAreNotLookedUp) {
  const std::string law =
      "def start(me, params):\n  me.k = params.get('gain', 1)\ndef control(t, me, n):\n  return 0, 0\n";
  EXPECT_THAT(
      Check(law, "params = { gian = 3 }\n"),
      HasSubstr("warning: law.params.gian: the law has not looked it up, but \"gain\", which law.params does not "
                "have\n"));
  const Ran up = Orchestrator("up law.toml --engine inprocess --out run");
  EXPECT_THAT(up.output, HasSubstr("warning: law.params.gian: the law has not looked it up, but \"gain\""));
}

TEST_F(LawTrial, TellsOfALawThatFailsOrCrashes) {
  EXPECT_THAT(
      Check("def control(t, me, neighbours):\n  return 1 / (t < 0.3), 0\n"),
      HasSubstr("warning: law: it fails when its beginning is flown on ideal bodies: tick 30: the law of agent 1 "
                "failed at t = 0.3 s: ZeroDivisionError: division by zero\n"));
  EXPECT_THAT(Check("import ctypes\ndef control(t, me, neighbours):\n  if t > 0.3: getattr(ctypes.CDLL(None), "
                    "'raise')(9)\n  return 0, 0\n"),
              HasSubstr("warning: law: it fails when its beginning is flown on ideal bodies: the process that flew it "
                        "was killed by signal 9"));
}

TEST_F(LawTrial, EndsAtASignal) {
  Write("def control(t, me, neighbours):\n  if t > 0.1: open('" + scratch_.File("hangs") +
        "', 'w').close()\n  while t > 0.1: pass\n  return 0, 0\n");
  Running check(BuildFolder() + "/orchestrator", {"check", scratch_.File("law.toml")}, scratch_.File("check"));
  ASSERT_TRUE(Until([&] { return std::filesystem::exists(scratch_.File("hangs")); })) << check.err();
  check.Signal(SIGINT);
  EXPECT_EQ(check.Wait(), 130);
}

TEST_F(LawTrial, IsTheCauseThatVerifyNames) {
  Write("import numpy\nd = numpy.random.default_rng()\ndef control(t, me, neighbours):\n  return d.normal(), 0\n");
  ASSERT_EQ(Orchestrator("up law.toml --engine inprocess --out run --quiet").exit_code, 0);
  const Ran verified = Orchestrator("verify run");
  EXPECT_EQ(verified.exit_code, 1);
  EXPECT_THAT(verified.output,
              AllOf(HasSubstr("run.mcap: differs: /agent_1/command at tick 0"),
                    HasSubstr("\na likely cause: law: agent 1 wants something else at t = 0 s when the same start is "
                              "flown again: its law draws random numbers without a seed")));
}

TEST_F(LawTrial, IsNotMadeForLawsOfOurs) {
  WriteFile(scratch_.File("law.toml"), "run.duration_s = 1.0\nagents.count = 2\nlaw.name = 'consensus'\n");
  EXPECT_EQ(Orchestrator("check law.toml").exit_code, 0);
}

}  // namespace
}  // namespace mascot::test
