// Laws written in Python.
#include "tests/agent/laws/custom_law.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <thread>

#include "agent/agent.h"
#include "agent/user_code/law_output.h"
#include "base/utf8.h"
#include "tests/support/scratch.h"
#include "tests/support/three_agents.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// --- inputs and outputs -----------------------------------------------------------------------------

TEST(CustomLaw, ReturnsTwoOrThreeNumbersInAnyUsualForm) {
  const Eigen::Vector3d wanted(1, -2, 0);
  for (const char* value : {"(1, -2)", "[1.0, -2.0]", "(1, -2, 7)", "np.array([1, -2])", "np.array([1, -2, 3.5])",
                            "np.array([1, -2], dtype=np.float32)", "[np.float64(1), np.int64(-2)]"})
    EXPECT_EQ(Wants(std::string("import numpy as np\ndef control(t, me, neighbours):\n  return ") + value + "\n"),
              wanted)
        << value;
  EXPECT_EQ(Wants("def control(t, me, neighbours):\n  return 1, -2, 7\n", "axes = 'xyz'\n"), Eigen::Vector3d(1, -2, 7));
}

TEST(CustomLaw, ComputesWithWhatEveryProcessorHas) {
  EXPECT_EQ(Wants(R"(
import math
import numpy.core._multiarray_umath as numpy_core
def control(t, me, neighbours):
    dispatched = [f for f in numpy_core.__cpu_dispatch__ if numpy_core.__cpu_features__[f]]
    assert not dispatched, dispatched
    return 0, 0
)"),
            Eigen::Vector3d::Zero());
}

TEST(CustomLaw, SeesItselfAndItsNeighbours) {
  EXPECT_EQ(Wants(R"(
import numpy as np
def control(t, me, neighbours):
    assert t == 0.0 and isinstance(t, float)
    assert me.id == 1 and [j.id for j in neighbours] == [2, 3]
    assert [j.weight for j in neighbours] == [0.5, 1.0]
    assert all(isinstance(x, np.ndarray) and x.dtype == float for j in [me, *neighbours] for x in
               (j.position, j.velocity, j.acceleration, j.orientation, j.angular_velocity))
    assert list(me.position) == [0, 0, 1] and list(me.velocity) == [0, 0.25, 0]
    assert list(me.orientation) == [1, 0, 0, 0]
    assert list(neighbours[1].position) == [0, 2, 3] and list(neighbours[1].velocity) == [0.5, 0, 0]
    assert neighbours[0].age_s == 0.0 and me.age_s == 0.0
    assert neighbours[0].message is None and me.message is None
    assert "agent 3 at [0. 2. 3.]" == repr(neighbours[1])
    return sum(j.weight * (j.position - me.position) for j in neighbours)
)"),
            Eigen::Vector3d(0.5, 2, 0));
}

TEST(CustomLaw, MayChangeItsArraysWithoutChangingTheWorld) {
  Experiment experiment =
      Custom("def control(t, me, neighbours):\n  me.position += 5\n  neighbours[0].position[:] = 7\n  return 0, 0\n");
  Agent agent(experiment, 1);
  const Others others = Standing();
  Motion self;
  for (std::int64_t tick = 0; tick < 3; ++tick) agent.Want(tick, self, others.samples());
  EXPECT_EQ(self.p_WB, Eigen::Vector3d::Zero());
  EXPECT_EQ(others.two.p_WB, Eigen::Vector3d(1, 0, 2));
}

TEST(CustomLaw, StartsOnceWithItsParametersAndRemembersWhatItKeepsInMe) {
  Experiment experiment = Custom(R"(
def start(me, params):
    assert params == {"gain": 2.5, "names": ["a", "b"], "deep": {"on": True, "n": 3}}, params
    assert type(params["deep"]["n"]) is int
    me.count = params["gain"]
def control(t, me, neighbours):
    me.count += 1
    return me.count, 0
)",
                                 "params = { gain = 2.5, names = ['a', 'b'], deep = { on = true, n = 3 } }\n");
  Agent agent(experiment, 1);
  const Others others = Standing();
  EXPECT_EQ(agent.Want(0, Motion{}, others.samples()).a_law_W.x(), 3.5);
  EXPECT_EQ(agent.Want(1, Motion{}, others.samples()).a_law_W.x(), 4.5);
}

TEST(CustomLaw, SharesNothingBetweenAgentsOfOneProcess) {
  Experiment experiment =
      Custom("calls = []\ndef control(t, me, neighbours):\n  calls.append(me.id)\n  return len(calls), 0\n");
  Agent one(experiment, 1), two(experiment, 2);
  const Others others = Standing();
  one.Want(0, Motion{}, others.samples());
  EXPECT_EQ(one.Want(1, Motion{}, others.samples()).a_law_W.x(), 2);
  EXPECT_EQ(two.Want(0, Motion{}, {}).a_law_W.x(), 1);
}

TEST(CustomLaw, HasRandomNumbersOfItsOwnFromTheSeed) {
  const auto draw = [](const std::string& seed, int id) {
    Experiment experiment =
        LoadExperiment(Section::FromText("[run]\nduration_s = 1.0\nseed = " + seed +
                                             "\n[agents]\ncount = 3\n[graph]\nedges = []\n[law]\nname = 'custom'\n"
                                             "python = 'def control(t, me, neighbours): return me.rng.random(2)'\n",
                                         "test.toml"),
                       "test");
    return Agent(experiment, id).Want(0, Motion{}, {}).a_law_W;
  };
  EXPECT_EQ(draw("1", 1), draw("1", 1));
  EXPECT_NE(draw("1", 1), draw("1", 2));
  EXPECT_NE(draw("1", 1), draw("2", 1));
}

TEST(CustomLaw, MayWantAVelocity) {
  const std::string law = "def control(t, me, neighbours):\n  return 1.0, 0.5\n";
  Experiment experiment = Custom(law, "output = 'velocity'\n");
  const Others others = Standing();
  const Command command = Agent(experiment, 1).Want(0, Motion{}, others.samples());
  EXPECT_EQ(command.a_law_W, Eigen::Vector3d(2, 1, 0)) << "k_v = 2 times what is missing";
}

// --- messages ---------------------------------------------------------------------------------------

TEST(CustomLaw, SendsWhatMessageReturnsAndHearsWhatOthersSent) {
  Experiment experiment = Custom(R"(
import numpy as np
def control(t, me, neighbours):
    heard = [j.message for j in neighbours]
    assert heard[0] is None and list(heard[1]) == [4, 5]
    if t > 0:
        assert list(me.message) == [1, 2, 3]
    return 0, 0
def message(me):
    return np.array([1, 2, 3])
)");
  EXPECT_TRUE(experiment.agent(1).sends_messages);
  Agent agent(experiment, 1);
  Others others = Standing();
  others.said = {4, 5};
  agent.Want(0, Motion{}, others.samples());
  EXPECT_THAT(std::vector(agent.message().begin(), agent.message().end()), ElementsAre(1, 2, 3));
  agent.Want(1, Motion{}, others.samples());
}

TEST(CustomLaw, SendsNothingUnlessItDefinesMessageAndMaySayNothing) {
  EXPECT_FALSE(Custom("def control(t, me, neighbours): return 0, 0\n").agent(1).sends_messages);
  Experiment silent = Custom("def control(t, me, neighbours): return 0, 0\ndef message(me): return None\n");
  EXPECT_TRUE(silent.agent(1).sends_messages);
  Agent agent(silent, 1);
  agent.Want(0, Motion{}, Standing().samples());
  EXPECT_TRUE(agent.message().empty());
}

TEST(CustomLaw, IsRefusedIfItSaysTooMuchOrSomethingElse) {
  const std::string control = "def control(t, me, neighbours): return 0, 0\n";
  EXPECT_EQ(Failure(control + "def message(me): return [0] * 65\n").substr(0, 70),
            "tick 3: the law of agent 1 failed: message returned [0, 0, 0, 0, 0, 0,");
  EXPECT_THAT(Failure(control + "def message(me): return 'hello'\n"),
              HasSubstr("message returned 'hello', expected None or at most 64 numbers"));
}

// --- mistakes at check ------------------------------------------------------------------------------

TEST(CustomLaw, SyntaxErrorsNameFileLineAndColumn) {
  EXPECT_EQ(LawRefusal("name = 'custom'\npython = '''\ndef control(t, me, neighbours):\n  return (1, 2\n'''\n"),
            "test.toml:13:10: law.python: expected Python, got SyntaxError: '(' was never closed");
  EXPECT_EQ(LawRefusal("name = 'custom'\npython = '''def control(t, me, neighbours) return 1, 2'''\n"),
            "test.toml:11:32: law.python: expected Python, got SyntaxError: expected ':'");
}

TEST(CustomLaw, ErrorsOfItsTopLevelNameTheLine) {
  EXPECT_EQ(
      LawRefusal("name = 'custom'\npython = '''\nimport numpy as np\nx = np.nothing\n'''\n"),
      "test.toml:13:1: law.python: expected Python, got AttributeError: module 'numpy' has no attribute 'nothing'");
}

TEST(CustomLaw, MustDefineControl) {
  EXPECT_EQ(LawRefusal("name = 'custom'\npython = 'x = 1'\n"),
            "test.toml:11:1: law.python: expected a function control, got none");
  EXPECT_EQ(LawRefusal("name = 'custom'\nstyle = 'mascot'\npython = 'def control(t, me, neighbours): return 0, 0'\n"),
            "test.toml:12:1: law.python: expected a function control_user, got none");
}

TEST(CustomLaw, MustTakeTheArgumentsThatItWillBeGiven) {
  const auto refusal = [](const std::string& python, const std::string& lines = "") {
    return LawRefusal("name = 'custom'\n" + lines + "python = '''\n\n" + python + "\n'''\n");
  };
  EXPECT_EQ(refusal("def control(t, me): return 0, 0"),
            "test.toml:13:1: law.python: expected control(t, me, neighbours), got control(t, me)");
  EXPECT_EQ(refusal("control = lambda: 0"),
            "test.toml:13:1: law.python: expected control(t, me, neighbours), got control()");
  EXPECT_EQ(refusal("def control(t, me, neighbours, *, gain): return 0, 0"),
            "test.toml:13:1: law.python: expected control(t, me, neighbours), got control(t, me, neighbours, *, gain)");
  const std::string control = "control = lambda t, me, neighbours: (0, 0)\n";
  EXPECT_EQ(refusal(control + "def start(me): pass"),
            "test.toml:14:1: law.python: expected start(me, params), got start(me)");
  EXPECT_EQ(refusal(control + "def message(): return None"),
            "test.toml:14:1: law.python: expected message(me), got message()");
  EXPECT_EQ(refusal("def control_user(pos_x, vel_x, i): return 0, 0", "style = 'mascot'\n"),
            "test.toml:14:1: law.python: expected control_user(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, "
            "leader), got control_user(pos_x, vel_x, i)");
  EXPECT_EQ(refusal("def control(*everything): return 0, 0"), "");
  EXPECT_EQ(refusal("def control(t, me, neighbours, gain=1): return 0, 0"), "");
}

TEST(CustomLaw, ComesFromOnePlace) {
  EXPECT_EQ(LawRefusal("name = 'custom'\n"), "folder/test.toml:9:1: law: expected one of python, file, got none");
  EXPECT_EQ(LawRefusal("name = 'custom'\npython = 'x'\nfile = 'law.py'\n"),
            "folder/test.toml:12:8: law.file: expected one of python, file, got both");
  EXPECT_EQ(
      LawRefusal("name = 'custom'\nfile = 'nowhere.py'\n"),
      "folder/test.toml:11:8: law.file: expected a readable file, got folder/nowhere.py: cannot be read: No such file "
      "or directory");
}

TEST(CustomLaw, RefusesParametersThatAreNoTableAndMessagesItCannotSend) {
  const std::string python = "python = 'def control(t, me, neighbours): return 0, 0'\n";
  EXPECT_EQ(LawRefusal("name = 'custom'\nparams = 3\n" + python),
            "folder/test.toml:11:10: law.params: expected a table, got a number");
  EXPECT_EQ(LawRefusal("name = 'custom'\nmessages = true\n" + python),
            "folder/test.toml:11:12: law.messages: expected a law that defines message(me), got none");
}

// --- mistakes while it runs -------------------------------------------------------------------------

TEST(CustomLaw, ExceptionsShowTheTracebackAgentTickAndTime) {
  const std::string text =
      Failure("def help(x):\n  return 1 / x\ndef control(t, me, neighbours):\n  return help(0), 1\n");
  EXPECT_THAT(text,
              AllOf(HasSubstr("tick 3: the law of agent 1 failed at t = 0.03 s\nTraceback (most recent call last):\n"),
                    HasSubstr("File \"test.toml\", line 15, in control\n    return help(0), 1"),
                    HasSubstr("File \"test.toml\", line 13, in help\n    return 1 / x"),
                    ::testing::EndsWith("ZeroDivisionError: division by zero")));
}

TEST(CustomLaw, WhatCameBackIsShownIfItIsWrong) {
  const auto returning = [](const std::string& value) {
    return Failure("import numpy as np\ndef control(t, me, neighbours):\n  return " + value + "\n");
  };
  const std::string start = "tick 3: the law of agent 1 failed at t = 0.03 s: control returned ";
  EXPECT_EQ(returning("None"), start + "None, expected 3 numbers or 2 (has it no return?)");
  EXPECT_EQ(returning("(1, 2, 3, 4)"), start + "(1, 2, 3, 4), expected 3 numbers or 2 (x, y)");
  EXPECT_EQ(returning("5.0"), start + "5.0, expected 3 numbers or 2 (x, y)");
  EXPECT_EQ(returning("'ab'"), start + "'ab', expected 3 numbers or 2 (x, y)");
  EXPECT_EQ(returning("np.zeros((3, 1))"),
            start + "array([[0.],\n       [0.],\n       [0.]]), expected 3 numbers or 2 (x, y)");
  EXPECT_EQ(returning("(1j, 0)"), start + "(1j, 0), expected 3 numbers or 2 (x, y)");
  EXPECT_EQ(returning("np.array(['1', '2'])"),
            start + "array(['1', '2'], dtype='<U1'), expected 3 numbers or 2 (x, y)");
  EXPECT_EQ(returning("np.zeros(2, dtype='datetime64[s]')"),
            start +
                "array(['1970-01-01T00:00:00', '1970-01-01T00:00:00'],\n      dtype='datetime64[s]'), expected 3 "
                "numbers or 2 (x, y)");
  EXPECT_EQ(returning("(float('nan'), 0)"), start + "(nan, 0), expected finite numbers");
  EXPECT_EQ(returning("np.array([0, np.inf, 0])"), start + "array([ 0., inf,  0.]), expected finite numbers");
}

TEST(CustomLaw, WhatCannotShowItselfIsShownByItsType) {
  const std::string bad = "class Bad:\n  def __repr__(self): return 1 / 0\n";
  EXPECT_EQ(
      Failure(bad + "def control(t, me, neighbours): return Bad()\n"),
      "tick 3: the law of agent 1 failed at t = 0.03 s: control returned an object of type Bad, expected 3 numbers "
      "or 2 (x, y)");
  EXPECT_EQ(Failure(bad + "def control(t, me, neighbours): return 0, 0\ndef message(me): return Bad()\n"),
            "tick 3: the law of agent 1 failed: message returned an object of type Bad, expected None or at most 64 "
            "numbers");
}

TEST(CustomLaw, WhatCameBackIsCutBetweenCharacters) {
  const std::string failure = Failure("def control(t, me, neighbours): return 'x' + 150 * '\xC3\xBC'\n");
  EXPECT_EQ(failure, Plain(failure)) << "half a character was left";
  EXPECT_THAT(failure, HasSubstr("\xC3\xBC..., expected 3 numbers or 2"));
}

TEST(CustomLaw, TextThatUtf8CannotSayIsEscaped) {
  EXPECT_THAT(Failure("def control(t, me, neighbours):\n  print('\\udcff')\n  raise ValueError('\\udcfe')\n"),
              ::testing::EndsWith("ValueError: \\udcfe"));
  EXPECT_THAT(Failure("def control(t, me, neighbours): return '\\udcff'\n"),
              HasSubstr("control returned '\\udcff', expected 3 numbers or 2"));
}

TEST(CustomLaw, ThatTriesUntilItWorksIsEndedToo) {
  for (const std::string except : {"except Exception", "except"}) {
    Experiment experiment = LoadExperiment(
        Section::FromText(
            "[run]\nduration_s = 1.0\nagent_timeout_s = 0.1\n[agents]\ncount = 1\n[law]\nname = 'custom'\n"
            "python = '''\ncaught = 0\ndef control(t, me, neighbours):\n  global caught\n"
            "  while caught < 3:\n    try:\n      me.x = 0\n      while True: me.x += 1\n    " +
                except + ":\n      caught += 1\n  return caught, 0\n'''\n",
            "test.toml"),
        "test");
    Agent agent(experiment, 1);
    if (except == "except")
      EXPECT_EQ(agent.Want(0, Motion{}, {}).a_law_W.x(), 3) << "each of them is told again";
    else
      EXPECT_THAT([&] { agent.Want(0, Motion{}, {}); }, ThrowsMessage<std::runtime_error>(HasSubstr("TimeoutError: ")));
  }
}

TEST(CustomLaw, WhoseTextHangsIsRefused) {
  EXPECT_EQ(
      [] {
        try {
          LoadExperiment(
              Section::FromText("[run]\nduration_s = 1.0\nstart_timeout_s = 0.1\n[agents]\ncount = 1\n[law]\nname = "
                                "'custom'\npython = '''\nwhile True: pass\n'''\n",
                                "test.toml"),
              "test");
        } catch (const ConfigError& error) {
          return std::string(error.what());
        }
        return std::string();
      }(),
      "test.toml:9:1: law.python: expected Python, got TimeoutError: took longer than run.start_timeout_s = 0.1 s");
}

TEST(CustomLaw, OfOneAgentIsRefusedByItsOwnKey) {
  EXPECT_EQ(LawRefusal("[[agents.override]]\nid = 2\n[agents.override.law]\nname = 'custom'\npython = '''\n"
                       "def control(t, me, neighbours):\n  return me.position +\n'''\n"),
            "test.toml:16:23: agents.override[0].law.python: expected Python, got SyntaxError: invalid syntax");
}

TEST(CustomLaw, ThatHangsIsEndedAtTheLineWhereItHangs) {
  Experiment experiment = LoadExperiment(
      Section::FromText("[run]\nduration_s = 1.0\nagent_timeout_s = 0.1\n[agents]\ncount = 1\n[law]\nname = 'custom'\n"
                        "python = '''\ndef control(t, me, neighbours):\n  while True:\n    pass\n'''\n",
                        "test.toml"),
      "test");
  Agent agent(experiment, 1);
  EXPECT_THAT([&] { agent.Want(0, Motion{}, {}); },
              ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr("tick 0: the law of agent 1 failed at t = 0.0 s\n"),
                        ::testing::ContainsRegex("line (10|11), in control"),
                        ::testing::EndsWith("TimeoutError: took longer than 0.8 run.agent_timeout_s = 0.08 s"))));
}

TEST(CustomLaw, ThatHangsIsEndedThoughAnotherOfItsProcessEnds) {
  const ScratchFolder folder;
  Experiment experiment = LoadExperiment(
      Section::FromText("[run]\nduration_s = 1.0\nagent_timeout_s = 0.5\n[agents]\ncount = 2\n[graph]\nedges = "
                        "[]\n[law]\nname = 'custom'\n"
                        "python = '''\nimport time\ndef control(t, me, neighbours):\n  if me.id == 1:\n    open('" +
                            folder.File("hangs") +
                            "', 'w').close()\n    end = time.monotonic() + 20\n"
                            "    while time.monotonic() < end: pass\n  return 0, 0\n'''\n",
                        "test.toml"),
      "test");
  Agent hangs(experiment, 1), ends(experiment, 2);
  std::thread other([&] {  // as in a process with several agents: another thread, which takes turns
    test::Await("the law that hangs", [&] { return std::filesystem::exists(folder.File("hangs")); });
    ends.Want(0, Motion{}, {});
  });
  EXPECT_THAT([&] { hangs.Want(0, Motion{}, {}); }, ThrowsMessage<std::runtime_error>(HasSubstr("TimeoutError: ")));
  const test::Deadline deadline("the thread of the other agent");
  other.join();
}

// --- the published testbed's laws -------------------------------------------------------------------

const char* kPublished = R"(
import numpy as np
def control_user(pos_x, vel_x, acc_x, pos_y, vel_y, acc_y, i, num_agent, leader):
    assert num_agent == 3 and len(pos_x) == 3
    if i == leader:
        return 0.0, 0.0
    return pos_x[i + 1] - pos_x[i] - vel_x[i], pos_y[i + 1] - pos_y[i] - vel_y[i]
)";

TEST(CustomLaw, OfThePublishedTestbedCountsAgentsFromZero) {
  EXPECT_EQ(Wants(kPublished, "style = 'mascot'\n"), Eigen::Vector3d(1, -0.25, 0));
  EXPECT_EQ(Wants(kPublished, "style = 'mascot'\nleader = 1\n"), Eigen::Vector3d(0, 0, 0));
}

TEST(CustomLaw, OfThePublishedTestbedThatPeeksIsExposed) {
  Experiment experiment = Custom(kPublished, "style = 'mascot'\n");
  Agent two(experiment, 2);  // has no neighbours
  EXPECT_THAT(
      [&] { two.Want(7, Motion{}, {}); },
      ThrowsMessage<std::runtime_error>(
          "tick 7: the law of agent 2 failed at t = 0.07 s: control_user returned (nan, nan), expected finite numbers; "
          "entries of agents that i = 1 does not hear are NaN, and it hears nobody (counted from 0)"));
}

TEST(CustomLaw, OfThePublishedTestbedIsToldOfPeekingOnlyIfItsNumbersAreMissing) {
  EXPECT_EQ(Failure("def control_user(px, vx, ax, py, vy, ay, i, n, leader): return 1e400, 0\n", "style = 'mascot'\n"),
            "tick 3: the law of agent 1 failed at t = 0.03 s: control_user returned (inf, 0), expected finite numbers");
}

// --- what it prints ---------------------------------------------------------------------------------

TEST(CustomLaw, AnExceptionOfManyMegabytesIsCut) {
  const std::string failure = Failure("def control(t, me, neighbours):\n  raise RuntimeError('z' * 50_000_000)\n");
  EXPECT_LT(failure.size(), 50'000U);
  EXPECT_THAT(failure, HasSubstr("RuntimeError: zzz"));
}

TEST(CustomLaw, PrintsToStandardErrorInWholeLinesAndNotIfMuted) {
  Experiment experiment =
      Custom("def control(t, me, neighbours):\n  print('at', t, end='')\n  print(' s')\n  return 0, 0\n");
  Agent agent(experiment, 2);
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  agent.Want(5, Motion{}, {});
  {
    const SuppressedLawOutput suppressed;
    agent.Want(6, Motion{}, {});
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "at 0.05 s\n");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

/// What a law with this first statement prints in one call.
std::string Printed(const std::string& statement) {
  Experiment experiment = Custom("def control(t, me, neighbours):\n  " + statement + "\n  return 0, 0\n");
  Agent agent(experiment, 2);
  testing::internal::CaptureStderr();
  agent.Want(0, Motion{}, {});
  return testing::internal::GetCapturedStderr();
}

TEST(CustomLaw, PrintsALineThatIsNotOverWhenItIsFlushedOrLong) {
  EXPECT_EQ(Printed("print('.', end='')"), "");
  EXPECT_EQ(Printed("print('.', end='', flush=True)"), "..") << "the first had waited";
  EXPECT_EQ(Printed("print(5000 * '-', end='')"), std::string(5000, '-'));
  EXPECT_EQ(Printed("print('whole\\nnot', end='')"), "whole\n");
  EXPECT_EQ(Printed("print(\"'s line\")"), "not's line\n");
}

TEST(CustomLaw, PrintsALineThatIsNotOverAtTheEndOfTheProcess) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // Python does not survive a fork
  EXPECT_EXIT(
      {
        Agent(Custom("def control(t, me, neighbours):\n  print('last words', end='')\n  return 0, 0\n"), 2)
            .Want(0, Motion{}, {});
        std::exit(0);
      },
      testing::ExitedWithCode(0), "last words");
}

}  // namespace
}  // namespace mascot
