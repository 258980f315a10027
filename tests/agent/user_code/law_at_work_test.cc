// What a user's law may do to its process, and what the process says of it.
#include "agent/user_code/law_at_work.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <iostream>

#include "tests/agent/laws/custom_law.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ExitedWithCode;
using ::testing::HasSubstr;
using ::testing::KilledBySignal;

/// Tests of laws that end their process. Each runs in a process of its own, which begins anew, as others have threads.
class LawAtWorkDeathTest : public testing::Test {
 protected:
  LawAtWorkDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

std::string InControl(const std::string& line) {
  return "import os, resource, signal, sys, time\ndef control(t, me, neighbours):\n  " + line + "\n  return 0, 0\n";
}

Experiment Limited(const std::string& python, const std::string& control = "") {
  const std::string timeout_s = control.empty() ? "0.5" : "100.0";  // of a limit of memory that is not what is tested
  return Load("[run]\nduration_s = 1.0\nagent_timeout_s = " + timeout_s + "\n[control]\n" + control +
              "[agents]\ncount = 1\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1]]\n[law]\nname = 'custom'\n" +
              "python = '''\n" + python + "'''\n");
}

/// The error of the first call of the law of agent 1; empty: none.
std::string FirstCall(const std::string& python, const std::string& control = "") {
  const Experiment experiment = Limited(python, control);
  Agent agent(experiment, 1);
  try {
    agent.Want(0, Motion{}, {});
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// --- what is refused --------------------------------------------------------------------------------

TEST(LawAtWork, MayNotEndOrChangeItsProcess) {
  for (const char* call : {"os._exit(0)",
                           "os.abort()",
                           "os.kill(os.getpid(), 9)",
                           "os.kill(0, 9)",
                           "os.kill(-1, 9)",
                           "os.kill(os.getppid(), 9)",
                           "os.killpg(os.getpgrp(), 9)",
                           "os.execv('/bin/true', ['true'])",
                           "os.execlp('true', 'true')",
                           "os.closerange(0, 1024)",
                           "os.close(2)",
                           "os.dup2(1, 2)",
                           "os.setsid()",
                           "os.setpgid(0, 0)",
                           "signal.signal(signal.SIGTERM, signal.SIG_IGN)",
                           "signal.raise_signal(signal.SIGKILL)",
                           "resource.setrlimit(resource.RLIMIT_NOFILE, (3, 3))",
                           "resource.prlimit(0, resource.RLIMIT_CPU, (1, 1))",
                           "os.chdir('/')",
                           "os.setuid(65534)",
                           "os.chroot('/tmp')",
                           "os.umask(0o777)",
                           "signal.alarm(1)",
                           "signal.pthread_kill(__import__('threading').get_ident(), 9)"})
    EXPECT_THAT(Failure(InControl(call)), AllOf(HasSubstr("tick 3: the law of agent 1 failed at t = "),
                                                HasSubstr("refused, because the process is not the law's alone")))
        << call;
  EXPECT_THAT(Failure(InControl("sys.exit(3)")), HasSubstr("SystemExit: 3"));
  EXPECT_THAT(Refusal(Three("name = 'custom'\npython = '''\nimport os\nos._exit(0)\n'''\n")),
              HasSubstr("law.python: expected Python, got RuntimeError: os._exit: refused, because the process"));
  EXPECT_THAT(Refusal(Three("name = 'custom'\npython = '''\nimport sys\nsys.exit()\n'''\n")),
              HasSubstr("law.python: expected Python, got SystemExit"));
}

TEST(LawAtWork, MayStartProcessesAndEndThose) {
  EXPECT_EQ(Failure("import os, signal, subprocess\ndef control(t, me, neighbours):\n"
                    "  sleeper = subprocess.Popen(['sleep', '1000'])\n  sleeper.terminate()\n"
                    "  assert sleeper.wait() == -signal.SIGTERM\n"
                    "  child = os.fork()\n  if child == 0: os._exit(7)\n"
                    "  assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7\n"
                    "  assert subprocess.run(['true']).returncode == 0\n"
                    "  fd = os.open('/dev/null', os.O_RDONLY)\n  os.close(fd)\n  return 0, 0\n"),
            "");
}

TEST(LawAtWork, ThatForksAndReturnsTwiceReturnsOnce) {
  const ScratchFolder folder;
  EXPECT_EQ(Failure("import os\ndef control(t, me, neighbours):\n  child = os.fork()\n  if child > 0:\n    open('" +
                    folder.File("child") + "', 'w').write(str(child))\n  return 0, 0\n"),
            "");
  EXPECT_FALSE(IsForkedByLaw());
  int status = -1;
  const pid_t child = std::stoi(ReadFile(folder.File("child")));
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "else it would have gone on with these tests";
}

// --- time -------------------------------------------------------------------------------------------

TEST(LawAtWork, TheTextHasTheTimeOfACall) {
  try {
    Limited("while True: pass\n");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("law.python: expected Python, got TimeoutError: took longer than 0.8 "
                                        "run.agent_timeout_s = 0.4 s"));
  }
}

TEST_F(LawAtWorkDeathTest, ATextThatDoesNotLetItselfBeInterruptedEndsTheProcessInWords) {
  const std::string words =
      "error: the law in .+ took longer than 0.8 run.agent_timeout_s = 0.4 s and cannot be interrupted: the process "
      "ends";
  EXPECT_EXIT(Limited("import time\ntime.sleep(1000)\n"), ExitedWithCode(1), ContainsRegex(words));
  EXPECT_EXIT(Limited("def spin():\n  while True: pass\nwhile True:\n  try: spin()\n  except BaseException: pass\n"),
              ExitedWithCode(1), ContainsRegex(words));
}

TEST_F(LawAtWorkDeathTest, SoDoesACall) {
  EXPECT_EXIT(FirstCall(InControl("time.sleep(1000)")), ExitedWithCode(1),
              HasSubstr("error: the law of agent 1 took longer than 0.8 run.agent_timeout_s = 0.4 s and cannot be "
                        "interrupted: the process ends\n"));
}

// --- memory -----------------------------------------------------------------------------------------

constexpr const char* kRecursion =
    "import sys\nsys.setrecursionlimit(10**9)\ndef deeper(n): return 1 + deeper(n + 1)\n"
    "def control(t, me, neighbours):\n  return deeper(0), 0\n";

TEST(LawAtWork, ThatTakesTooMuchMemoryFailsInWords) {
  EXPECT_THAT(FirstCall("def control(t, me, neighbours):\n  data = []\n"
                        "  while True: data.append(bytearray(b'x') * 100_000)\n",
                        "python_memory_mb = 300\n"),
              AllOf(HasSubstr("the law of agent 1 failed at t = 0.0 s\n"),
                    HasSubstr("MemoryError: needs more than control.python_memory_mb = 300")));
}

TEST_F(LawAtWorkDeathTest, ARecursionWithoutLimitEndsInWordsBeforeOrWhileItUnwinds) {
  EXPECT_EXIT(
      {
        std::cerr << FirstCall(kRecursion, "python_memory_mb = 300\n");
        _exit(1);
      },
      ExitedWithCode(1), HasSubstr("needs more than control.python_memory_mb = 300"));
}

TEST(LawAtWork, MayTakeTheMemoryThatItIsGranted) {
  const std::string law =
      "import numpy as np, time\ndef control(t, me, neighbours):\n  a = np.ones(25_000_000)\n"
      "  for _ in range(30): time.sleep(0.01)\n  return 0, 0\n";  // 200 MB
  EXPECT_EQ(FirstCall(law, "python_memory_mb = 1500\n"), "");
  EXPECT_THAT(FirstCall(law, "python_memory_mb = 200\n"), HasSubstr("needs more than control.python_memory_mb = 200"));
}

TEST_F(LawAtWorkDeathTest, OneThatTakesMuchMemoryInACallThatDoesNotReturnEndsTheProcessInWords) {
  EXPECT_EXIT(FirstCall("import numpy as np\ndef control(t, me, neighbours):\n  a = np.ones(2_000_000_000)\n"
                        "  return 0, 0\n",
                        "python_memory_mb = 200\n"),
              ExitedWithCode(1),
              HasSubstr("error: the law of agent 1 needs more than control.python_memory_mb = 200 and cannot be "
                        "interrupted: the process ends\n"));
}

// --- crashes ----------------------------------------------------------------------------------------

TEST_F(LawAtWorkDeathTest, ACrashIsNamedWithTheAgent) {
  EXPECT_EXIT(FirstCall("import ctypes\ndef control(t, me, neighbours):\n  ctypes.string_at(0)\n  return 0, 0\n"),
              KilledBySignal(SIGSEGV), HasSubstr("error: the law of agent 1 crashed: SIGSEGV\n"));
  EXPECT_EXIT(FirstCall("import ctypes\ndef control(t, me, neighbours):\n  ctypes.CDLL(None).abort()\n  return 0, 0\n"),
              KilledBySignal(SIGABRT), HasSubstr("error: the law of agent 1 crashed: SIGABRT\n"));
}

TEST_F(LawAtWorkDeathTest, AStackThatOverflowsIsNamedWithTheAgent) {
  EXPECT_EXIT(FirstCall("import sys\nsys.setrecursionlimit(10**9)\n"
                        "def deeper(x): return sorted([1, 2], key=deeper)\n"
                        "def control(t, me, neighbours):\n  deeper(0)\n  return 0, 0\n"),
              KilledBySignal(SIGSEGV), HasSubstr("error: the law of agent 1 crashed: SIGSEGV\n"));
}

TEST_F(LawAtWorkDeathTest, AnEndByCodeInCIsNamedWithTheAgent) {
  struct End {
    const char *call, *words;
    int code;  // of one that asks for 7
  };
  for (const auto& [call, words, code] : {End{"exit", "exit", 7}, End{"_exit", "_exit", 7}, End{"_Exit", "_exit", 7},
                                          End{"quick_exit", "quick_exit", 1}}) {
    SCOPED_TRACE(call);
    const std::string end = std::string("ctypes.CDLL(None).") + call;
    const std::string told = std::string(" has ended the process by ") + words + "()\n";
    EXPECT_EXIT(FirstCall("import ctypes\ndef control(t, me, neighbours):\n  " + end + "(0)\n  return 0, 0\n"),
                ExitedWithCode(1), HasSubstr("error: the law of agent 1" + told));
    EXPECT_EXIT(FirstCall("import ctypes\ndef control(t, me, neighbours):\n  " + end + "(7)\n  return 0, 0\n"),
                ExitedWithCode(code), HasSubstr("error: the law of agent 1" + told));
    EXPECT_EXIT(Limited("import ctypes\n" + end + "(0)\n"), ExitedWithCode(1),
                HasSubstr("error: the law in test.toml" + told));
  }
}

TEST_F(LawAtWorkDeathTest, AnEndByAThreadThatALawHasStartedIsNamed) {
  for (const std::string call : {"_exit", "exit", "quick_exit"}) {
    SCOPED_TRACE(call);
    const std::string in_a_thread = "import ctypes, threading\nthreading.Thread(target=ctypes.CDLL(None)." + call +
                                    ", args=[0]).start()\nthreading.Event().wait()\n";
    EXPECT_EXIT(Limited(in_a_thread), ExitedWithCode(1),
                HasSubstr("error: a law, or what it has called, has ended the process by " + call + "()\n"));
  }
}

}  // namespace
}  // namespace mascot
