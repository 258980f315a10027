// Faults in runs over DDS, with the real processes: each is detected, reported by name, and cleaned up after.

#include <gmock/gmock.h>
#include <sys/syscall.h>

#include <cstring>
#include <sstream>

#include "bus/shared_memory.h"
#include "bus/wire.h"
#include "orchestrator/engines/dds/machine/domain_lock.h"
#include "orchestrator/formats/mcap/reader.h"
#include "tests/support/folders.h"
#include "tests/support/intruder.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;

/// Starts a run that would last longer than any test.
Up Endless(const ScratchFolder& folder, std::vector<std::string> more = {}) {
  more.insert(more.end(), {"--duration-s", "100000"});
  return Up(folder, "run", Config("leaderless"), more);
}

/// The DDS domain that `up` prints. `said`: what it printed.
int DomainIn(const std::string& said) {
  const std::size_t at = said.find("domain ");
  return at == said.npos ? kNoDomain : std::stoi(said.substr(at + 7));
}

/// Waits until no shared memory of a run is left: its janitor, or another test, may be just about to remove some.
/// `said`: what the run's `up` printed.
testing::AssertionResult NothingIsLeft(const std::string& said) {
  const int domain = DomainIn(said);
  if (Until([&] { return StaleSharedMemory(domain).empty(); })) return testing::AssertionSuccess();
  return testing::AssertionFailure() << StaleSharedMemory(domain).front() << " was left";
}

testing::AssertionResult NothingIsLeft(const Running& up) { return NothingIsLeft(up.err()); }

bool IsGone(pid_t pid) {
  return Until([&] {
    return kill(pid, 0) != 0 || ReadFile("/proc/" + std::to_string(pid) + "/stat").find(") Z ") != std::string::npos;
  });
}

TEST(Faults, ADyingAgentEndsTheRunByNameAndSignal) {
  ScratchFolder folder;
  Up up = Endless(folder);
  ASSERT_TRUE(Flies(up));
  SignalTo(up.Child("agent_3"), SIGKILL);
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), HasSubstr("error: agent_3 was killed by signal 9 (Killed)"));
  EXPECT_EQ(up.Summary()["exit"], 1);
  EXPECT_THAT(up.Summary()["failure"].get<std::string>(), HasSubstr("agent_3 was killed"));
  EXPECT_THAT(up.Info(), HasSubstr("the run ended early, recorded without a gap\ncomplete: yes\n"));
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, ADyingServerEndsTheRunByName) {
  ScratchFolder folder;
  Up up = Endless(folder);
  ASSERT_TRUE(Flies(up));
  SignalTo(up.Child("physics_server"), SIGSEGV);
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), HasSubstr("error: physics_server was killed by signal 11 (Segmentation fault)"));
  EXPECT_TRUE(up.Summary()["safety"]["collisions"].is_null()) << "it knew, and did not tell";
  EXPECT_TRUE(NothingIsLeft(up));
}

/// Matches an error that names agent 2. Others may be named too: if agent 2 is stopped while it holds a shared-memory
/// lock of the server's queue, the agents behind it cannot answer.
auto NamesAgentTwo() {
  return testing::ContainsRegex(
      "error: physics_server: tick [0-9]+: no command from agents? (1, |1-)?2(-[0-9]+|(, [0-9]+)*) within "
      "run.agent_timeout_s "
      "= 0.5 s");
}

TEST(Faults, ASilentAgentIsNamedAfterTheTimeout) {
  ScratchFolder folder;
  Up up = Endless(folder, {"--set", "run.agent_timeout_s=0.5"});
  ASSERT_TRUE(Flies(up));
  SignalTo(up.Child("agent_2"), SIGSTOP);
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), NamesAgentTwo());
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, NobodyOutlivesAKilledOrchestrator) {
  ScratchFolder folder;
  Up up = Endless(folder);
  ASSERT_TRUE(Flies(up));
  const pid_t server = up.Child("physics_server"), agent = up.Child("agent_1");
  ASSERT_GT(server, 0);
  ASSERT_GT(agent, 0);
  up.Signal(SIGKILL);
  EXPECT_EQ(up.Wait(), -SIGKILL);
  EXPECT_TRUE(IsGone(server));
  EXPECT_TRUE(IsGone(agent));
  EXPECT_TRUE(NothingIsLeft(up));
  const McapContents recording = ReadMcap(up.path() / "run.mcap");  // the recording is readable
  EXPECT_FALSE(recording.complete);
}

/// Whether no run holds the lock of a DDS domain.
bool IsFree(int domain) try {
  const DomainLock lock(domain);
  return true;
} catch (const std::runtime_error&) {
  return false;
}

/// A moment of a run: what the orchestrator has just written.
struct Moment {
  std::string name, written;
};

void PrintTo(const Moment& moment, std::ostream* out) { *out << moment.name; }

class Orphaned : public testing::TestWithParam<Moment> {};

TEST_P(Orphaned, RunsClearUpAfterAnOrchestratorThatWasKilled) {
  ScratchFolder folder;
  const std::string program = BuildFolder() + "/orchestrator";
  // It dies by its own write (tests/preload/killed_at.cc): a signal from here would come later, or too late.
  const std::string preload = "LD_PRELOAD=" + BuildFolder() + "/tests/preload/libkilled_at.so";
  Running up(
      "env",
      {preload, "MASCOT_KILLED=orchestrator", "MASCOT_KILLED_AT=" + GetParam().written, program, "up",
       Config("leaderless"), "--duration-s", "2", "--out", folder.File("run"), "--set", "output.save_plot=false"},
      folder.File("up"));
  EXPECT_EQ(up.Wait(), -SIGKILL) << "it has never written " << GetParam().written << "; it ended by itself";
  EXPECT_TRUE(Until([&] { return IsFree(DomainIn(up.err())); })) << "some process still lives";
  EXPECT_TRUE(NothingIsLeft(up));
}

INSTANTIATE_TEST_SUITE_P(At, Orphaned,
                         testing::Values(Moment{"Spawning", "domain "}, Moment{"Matching", "handed out"},
                                         Moment{"Flying", "x real time"}, Moment{"Ending", "request: end"}),
                         NamedAsPrinted<Moment>);

/// A command in which leaving the DDS domain never ends, for processes with the name `process`.
std::string Hanging(const std::string& process, const std::string& command) {
  return "MASCOT_HANGS=" + process + " LD_PRELOAD='" + BuildFolder() + "/tests/preload/libhang_at_end.so' exec '" +
         BuildFolder() + "/" + process + "' " + command;
}

/// `up` for so long, with results in folder/run, whose orchestrator says so and hangs when it leaves its domain.
Running UpThatCannotLeave(const ScratchFolder& folder, const std::string& duration_s) {
  return Running("/bin/sh",
                 {"-c", Hanging("orchestrator", "up " + Config("leaderless") + " --duration-s " + duration_s +
                                                    " --out " + folder.File("run") + " --set output.save_plot=false")},
                 folder.File("up"));
}

TEST(Faults, ResultsAreWrittenBeforeTheDomainIsLeftAndASignalEndsALeavingThatHangs) {
  ScratchFolder folder;
  Running up = UpThatCannotLeave(folder, "0.5");
  ASSERT_TRUE(Until([&] { return up.Said("leaving the domain hangs"); }));
  const auto summary = [&] { return nlohmann::json::parse(ReadFile(folder.File("run/summary.json"))); };
  EXPECT_EQ(summary()["ticks"], 50);
  EXPECT_TRUE(summary()["exit"].is_null()) << "it is not known yet";
  EXPECT_TRUE(ReadMcap(folder.File("run/run.mcap")).complete);
  EXPECT_TRUE(std::filesystem::exists(folder.File("run/states.npz")));
  up.Signal(SIGTERM);
  EXPECT_EQ(up.Wait(), 0) << "that is what it had decided";
  EXPECT_EQ(summary()["exit"], 0);
  EXPECT_THAT(up.err(), HasSubstr("orchestrator: the DDS library does not end: leaving by force\n"));
  EXPECT_THAT(up.out(), HasSubstr("results "));
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, WhoeverFliesWithAProcessThatWasKilledDoesNotLeaveByTheLibrary) {
  ScratchFolder folder;
  Running up = UpThatCannotLeave(folder, "1000");
  ASSERT_TRUE(Flies(up));
  SignalTo(ChildOf(up.pid(), "--id 2 "), SIGKILL);
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), HasSubstr("error: agent_2 was killed by signal 9 (Killed)"));
  EXPECT_THAT(up.err(), testing::Not(HasSubstr("leaving")));
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, AProcessThatWasStartedByHandLeavesWithinItsTime) {
  ScratchFolder folder;
  Running agent("/bin/sh", {"-c", Hanging("agent", "--id 3 --loopback --domain 101 --wait-s 1")}, folder.File("agent"));
  EXPECT_EQ(agent.Wait(), 1);
  EXPECT_THAT(agent.err(), HasSubstr("error: no experiment came within 1 s"));
  EXPECT_THAT(agent.err(), HasSubstr("agent_3: the DDS library does not end: leaving by force\n"));
  SweepSharedMemory(101);  // no run has this domain, so that no other process removes its ports
}

TEST(Faults, NotEvenAStoppedAgentOutlivesAKilledOrchestrator) {
  ScratchFolder folder;
  Up up = Endless(folder);
  ASSERT_TRUE(Flies(up));
  const pid_t agent = up.Child("agent_2");
  ASSERT_GT(agent, 0);
  SignalTo(agent, SIGSTOP);
  up.Signal(SIGKILL);
  EXPECT_EQ(up.Wait(), -SIGKILL);
  EXPECT_TRUE(IsGone(agent));
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, DamagedDatagramsEndARunInWordsAndWithResultsOrNotAtAll) {
  if (geteuid() != 0) GTEST_SKIP() << "packet sockets are not allowed here";
  ScratchFolder folder;
  Up up = Endless(folder, {"--set", "network.transport=udp", "--set", "run.agent_timeout_s=0.5"});
  ASSERT_TRUE(Flies(up));
  Running attacker(SourceFolder() + "/tests/flip_bits.py", {std::to_string(DomainOf(up)), "--seed", "1"},
                   folder.File("attacker"));
  const pid_t pid = up.pid();
  const auto has_ended = [&] {
    return ReadFile("/proc/" + std::to_string(pid) + "/stat").find(") Z ") != std::string::npos;
  };
  ASSERT_TRUE(Until([&] { return has_ended() || attacker.Said("1000 datagrams forged"); })) << attacker.err();
  up.Signal(SIGINT);  // in case it still flies
  EXPECT_THAT(up.Wait(), testing::AnyOf(1, 130)) << up.err();
  EXPECT_EQ(up.Summary()["failure"].is_null(), up.Summary()["exit"] == 130);
  EXPECT_TRUE(NothingIsLeft(up));
}

/// Writes an experiment whose law is this Python text. Returns its path.
std::string Python(const ScratchFolder& folder, int agents, const std::string& text, const std::string& more = "") {
  WriteFile(folder.File("law.toml"), "[run]\nduration_s = 1.0\n[agents]\ncount = " + std::to_string(agents) +
                                         "\n[output]\nsave_plot = false\n" + more +
                                         "[law]\nname = 'custom'\npython = '''\n" + text + "'''\n");
  return folder.File("law.toml");
}

TEST(Faults, NoLawThatHangsOutlivesAKilledOrchestrator) {
  ScratchFolder folder;
  const std::string law =
      "import time\ndef control(t, me, neighbours):\n  if t > 0.1:\n    print('I hang', flush=True)\n"
      "    time.sleep(1000)\n  return [0, 0]\n";
  Up up(folder, "run", Python(folder, 2, law));
  ASSERT_TRUE(Until([&] { return up.Said("[agent_1] I hang"); }));
  const pid_t agent = up.Child("agent_1");
  ASSERT_GT(agent, 0);
  up.Signal(SIGKILL);
  EXPECT_EQ(up.Wait(), -SIGKILL);
  EXPECT_TRUE(IsGone(agent));
  EXPECT_TRUE(NothingIsLeft(up));
}

/// A law that starts processes in three ways, and writes their ids to a file of `folder`.
std::string StartingProcesses(const ScratchFolder& folder) {
  return "import os, subprocess\ndef start(me, params):\n  pids = '" + folder.File("pids") +
         "'\n  helper = subprocess.Popen(['sleep', '1000'], start_new_session=True)\n"
         "  child = os.fork()\n  if child == 0:\n    __import__('time').sleep(1000)\n"
         "  open(pids, 'a').write(f'{helper.pid} {child}\\n')\n"
         "  os.system(f'setsid sh -c \"echo \\$\\$ >> {pids}; exec sleep 1000\" > /dev/null 2>&1 &')\n"
         "def control(t, me, neighbours):\n  return [0, 0]\n";
}

TEST(Faults, WhatALawHasStartedEndsWithTheRun) {
  for (const char* engine : {"dds", "inprocess"}) {
    SCOPED_TRACE(engine);
    const ScratchFolder folder;  // over DDS laws are also made by the metrics, in the orchestrator
    Up up(folder, "run", Python(folder, 1, StartingProcesses(folder)), {"--engine", engine});
    EXPECT_EQ(up.Wait(), 0) << up.err();
    int started = 0;
    std::istringstream pids(ReadFile(folder.File("pids")));
    for (pid_t pid = 0; pids >> pid; ++started) EXPECT_TRUE(IsGone(pid)) << pid;
    EXPECT_GE(started, 3);
    EXPECT_TRUE(NothingIsLeft(up));
  }
}

TEST(Faults, WhatALawHasForkedDoesNotOutliveAKilledOrchestrator) {
  const ScratchFolder folder;
  const std::string law =
      "import os, subprocess, time\ndef start(me, params):\n"
      "  helper = subprocess.Popen(['sleep', '1000'], start_new_session=True)\n  child = os.fork()\n"
      "  if child == 0: time.sleep(1000)\n  print('started', helper.pid, child, flush=True)\n"
      "def control(t, me, neighbours):\n  if t > 0.1: time.sleep(1)\n  return [0, 0]\n";
  Up up(folder, "run", Python(folder, 1, law, "fidelity = false\n"));
  std::istringstream words(RestOfLine(up, "[agent_1] started "));
  pid_t helper = 0, child = 0;
  words >> helper >> child;
  up.Signal(SIGKILL);
  EXPECT_EQ(up.Wait(), -SIGKILL);
  EXPECT_TRUE(IsGone(helper));
  EXPECT_TRUE(IsGone(child));
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, WhatALawHasStartedBySystemDoesNotOutliveAKilledOrchestratorEither) {
  for (const char* engine : {"dds", "inprocess"}) {
    SCOPED_TRACE(engine);
    const ScratchFolder folder;
    const std::string law = "import os, time\ndef start(me, params):\n  os.system('setsid sleep 1000 & echo $! >> " +
                            folder.File("pids") +
                            "')\ndef control(t, me, neighbours):\n  if t > 0.1: time.sleep(1)\n  return [0, 0]\n";
    Up up(folder, "run", Python(folder, 1, law, "fidelity = false\n"), {"--engine", engine});
    pid_t sleeper = 0;
    ASSERT_TRUE(Until([&] {
      std::istringstream pids(ReadFile(folder.File("pids")));
      return static_cast<bool>(pids >> sleeper);
    })) << up.err();
    ASSERT_TRUE(Until([&] { return up.Said("t = 0.00"); })) << up.err();
    up.Signal(SIGKILL);
    EXPECT_EQ(up.Wait(), -SIGKILL);
    EXPECT_TRUE(IsGone(sleeper));
    ASSERT_TRUE(Until([&] { return up.File("summary.json").ends_with("}\n"); }));
    EXPECT_THAT(up.File("summary.json"), HasSubstr("the orchestrator was killed (SIGKILL"));
  }
}

const std::string kExitGroup = "ctypes.CDLL(None).syscall(" + std::to_string(SYS_exit_group) + ", 0)";

TEST(Faults, WhateverALawDoesToTheOneProcessOfARunThereIsASummaryThatSaysWhy) {
  struct Try {
    const char* act;
    int end;
    nlohmann::json exit;
    const char* words;
  };
  const Try tries[] = {
      {"ctypes.string_at(0)", -SIGSEGV, 128 + SIGSEGV,
       "the law of agent 2 crashed: SIGSEGV; the process has ended amid"},
      {"ctypes.CDLL(None)['raise'](7)", -SIGBUS, 128 + SIGBUS, "the law of agent 2 crashed: SIGBUS"},
      {"threading.Thread(target=lambda: ctypes.string_at(0)).start(); time.sleep(100)", -SIGSEGV, 128 + SIGSEGV,
       "this process crashed: SIGSEGV"},
      {"time.sleep(100)", 1, 1, "the law of agent 2 took longer than 0.8 run.agent_timeout_s = 0.8 s and cannot be"},
      {"ctypes.CDLL(None).exit(0)", 1, 1, "the law of agent 2 has ended the process by exit()"},
      {"threading.Thread(target=lambda: ctypes.CDLL(None).exit(0)).start(); time.sleep(100)", 1, 1,
       "a law, or what it has called, has ended the process by exit()"},
      {"ctypes.CDLL(None)._exit(0)", 1, 1, "the law of agent 2 has ended the process by _exit()"},
      {kExitGroup.c_str(), 0, nullptr, "the orchestrator was killed (SIGKILL: by somebody, or for"},
      {"ctypes.CDLL(None).kill(os.getpid(), 9)", -SIGKILL, nullptr, "the orchestrator was killed (SIGKILL"}};
  for (const Try& each : tries) {
    SCOPED_TRACE(each.act);
    const ScratchFolder folder;
    const std::string law = std::string("import ctypes, os, threading, time\ndef control(t, me, neighbours):\n") +
                            "  if me.id == 2 and t > 0.1:\n    " + each.act + "\n  return 0, 0\n";
    Up up(folder, "run", Python(folder, 3, law, "fidelity = false\n"),
          {"--set", "run.agent_timeout_s=1.0", "--engine", "inprocess"});
    EXPECT_EQ(up.Wait(), each.end) << up.err();
    ASSERT_TRUE(Until([&] { return up.File("summary.json").ends_with("}\n"); }));
    const auto summary = nlohmann::json::parse(up.File("summary.json"));
    EXPECT_EQ(summary["exit"], each.exit);
    EXPECT_THAT(summary["failure"].get<std::string>(), HasSubstr(each.words));
    EXPECT_EQ(summary["agents"], 3);
    EXPECT_FALSE(summary.contains("ticks")) << "nobody knows";
  }
}

TEST(Faults, WhateverALawDoesToItsProcessThereIsASummaryThatNamesTheAgent) {
  const std::pair<const char*, const char*> tries[] = {
      {"os._exit(0)", "the law of agent 2 failed at t = "},
      {"sys.exit()", "the law of agent 2 failed at t = "},
      {"os.kill(os.getpid(), 9)", "the law of agent 2 failed at t = "},
      {"ctypes.string_at(0)", "agent_2: the law of agent 2 crashed: SIGSEGV"},
      {"ctypes.CDLL(None)._exit(0)", "agent_2: the law of agent 2 has ended the process by _exit()"},
      {kExitGroup.c_str(), "agent_2 exited with code 0"}};
  for (const auto& [act, words] : tries) {
    SCOPED_TRACE(act);
    const ScratchFolder folder;
    const std::string law = std::string("import ctypes, os, sys\ndef control(t, me, neighbours):\n") +
                            "  if me.id == 2 and t > 0.1:\n    " + act + "\n  return 0, 0\n";
    Up up(folder, "run", Python(folder, 3, law, "fidelity = false\n"), {"--set", "run.agent_timeout_s=1.0"});
    EXPECT_EQ(up.Wait(), 1);
    EXPECT_EQ(up.Summary()["exit"], 1);
    EXPECT_THAT(up.Summary()["failure"].get<std::string>(), HasSubstr(words));
    EXPECT_TRUE(NothingIsLeft(up));
  }
}

// What its process still needs descriptors for, the shared memory of a run on one host does not.
TEST(Faults, ALawThatClosesAllDescriptorsLeavesASummary) {
  const ScratchFolder folder;
  const std::string law =
      "import ctypes\ndef control(t, me, neighbours):\n  if me.id == 2 and t > 0.1:\n"
      "    [ctypes.CDLL(None).close(fd) for fd in range(1024)]\n  return 0, 0\n";
  Up up(folder, "run", Python(folder, 3, law, "fidelity = false\n"), {"--set", "run.agent_timeout_s=1.0"});
  const int exit = up.Wait();
  EXPECT_EQ(up.Summary()["exit"], exit);
  if (exit != 0) {
    EXPECT_THAT(up.Summary()["failure"].get<std::string>(), HasSubstr("2"));
  }
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, WhatALawPrintsMayBeNoText) {
  ScratchFolder folder;
  const std::string law =
      "import os\ndef control(t, me, neighbours):\n  if t > 0.1:\n    os.write(2, b'Gr\\xfc\\xdfe\\n')\n"
      "    raise ValueError('no')\n  return 0, 0\n";
  Up up(folder, "run", Python(folder, 1, law, "fidelity = false\n"));
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.Summary()["failure"].get<std::string>(), AllOf(HasSubstr("agent_1 | Gr\xEF\xBF\xBD\xEF\xBF\xBD"
                                                                          "e\n"),
                                                                HasSubstr("ValueError: no")));
  EXPECT_EQ(up.Summary()["exit"], 1);
}

TEST(Faults, ALawThatFailsOnIdealBodiesAloneMayFailInAnyLanguage) {
  ScratchFolder folder;  // a quadrotor tilts; the ideal body does not
  const std::string law =
      "def control(t, me, neighbours):\n"
      "  if t > 0.5 and abs(me.orientation[2]) < 1e-9:\n    return 'x' + 150 * '\xC3\xBC'\n  return 1, 0\n";
  Up up(folder, "run", Python(folder, 1, law), {"--engine", "inprocess"});
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.Summary()["fidelity"]["failure"].get<std::string>(), HasSubstr("\xC3\xBC..., expected 3 numbers"));
}

TEST(Faults, ASlowLawIsNoFault) {
  ScratchFolder folder;  // for 64 rows, the metrics spend over a second in the laws of all agents
  const std::string law = "import time\ndef control(t, me, neighbours):\n  time.sleep(0.01)\n  return [0, 0]\n";
  Up up(folder, "run", Python(folder, 4, law), {"--set", "run.agent_timeout_s=1.0"});
  EXPECT_EQ(up.Wait(), 0) << up.err();
}

TEST(Faults, ALawThatIsSlowInTheMetricsIsNoFault) {
  ScratchFolder folder;  // a row takes 1.2 s in the metrics; meanwhile the server is a whole window ahead
  const std::string law =
      "import os, time\ndef control(t, me, neighbours):\n"
      "  if t < 0.015 and 'orchestrator' in os.readlink('/proc/self/exe'):\n    time.sleep(0.3)\n  return [0, 0]\n";
  Up up(folder, "run", Python(folder, 4, law), {"--set", "run.agent_timeout_s=0.5"});
  EXPECT_EQ(up.Wait(), 0) << up.err();
}

TEST(Faults, ASilentServerIsNamed) {
  ScratchFolder folder;
  Up up = Endless(folder, {"--set", "run.agent_timeout_s=0.5"});
  ASSERT_TRUE(Flies(up));
  SignalTo(up.Child("physics_server"), SIGSTOP);
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), HasSubstr("error: nothing came from physics_server for 5.5 s"));
  EXPECT_TRUE(up.Summary()["safety"]["collisions"].is_null());
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, ASignalToTheWholeJobIsNoFailure) {
  ScratchFolder folder;
  Up up = Endless(folder);
  ASSERT_TRUE(Flies(up));
  std::vector<pid_t> others;  // looked up first: the run may end between signals; pid 0 is our own group
  for (const char* process : {"agent_2", "agent_3", "agent_4", "physics_server"}) others.push_back(up.Child(process));
  SignalTo(up.Child("agent_1"), SIGTERM);
  up.Signal(SIGTERM);
  for (const pid_t other : others) SignalTo(other, SIGTERM);
  EXPECT_EQ(up.Wait(), 128 + SIGTERM) << up.err();
  EXPECT_TRUE(up.Summary()["failure"].is_null());
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, AnAgentEndedAloneIsAFailure) {
  ScratchFolder folder;
  Up up = Endless(folder);
  ASSERT_TRUE(Flies(up));
  SignalTo(up.Child("agent_1"), SIGTERM);
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), HasSubstr("error: agent_1 exited with code 143"));
}

struct Interruption {
  int signal;
  int exit;
};

void PrintTo(const Interruption& interruption, std::ostream* out) {
  *out << "SIG" << sigabbrev_np(interruption.signal);
}

class Interrupted : public testing::TestWithParam<Interruption> {};

TEST_P(Interrupted, RunsEndInOrderWithACompleteRecording) {
  ScratchFolder folder;
  Up up = Endless(folder);
  ASSERT_TRUE(Flies(up));
  up.Signal(GetParam().signal);
  EXPECT_EQ(up.Wait(), GetParam().exit);
  const McapContents recording = ReadMcap(up.path() / "run.mcap");
  EXPECT_TRUE(recording.complete) << recording.damage;
  EXPECT_EQ(recording.messages, 9 * (up.Summary()["ticks"].get<std::uint64_t>() + 1));
  EXPECT_THAT(up.Info(), HasSubstr("the run ended early, recorded without a gap\ncomplete: yes\n"));
  EXPECT_EQ(up.Summary()["samples"]["lost"], 0);
  EXPECT_THAT(ReadFile(up.path() / "logs/orchestrator.log"), HasSubstr("physics_server is done, tick"));
  EXPECT_TRUE(NothingIsLeft(up));
}

INSTANTIATE_TEST_SUITE_P(BySignal, Interrupted,
                         testing::Values(Interruption{SIGINT, 130}, Interruption{SIGTERM, 143},
                                         Interruption{SIGUSR1, 138}),
                         NamedAsPrinted<Interruption>);

TEST(Faults, ASecondCtrlCKillsWhatDoesNotStop) {
  ScratchFolder folder;
  Up up = Endless(folder, {"--set", "run.agent_timeout_s=1000"});
  ASSERT_TRUE(Flies(up));
  SignalTo(up.Child("agent_2"), SIGSTOP);  // now the run cannot stop in order
  up.Signal(SIGINT);
  ASSERT_TRUE(Until([&] { return up.Said("once more to kill"); }));
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, ACtrlCThatCannotStopInOrderKeepsWhatTheServerMeasured) {
  ScratchFolder folder;
  Up up = Endless(folder, {"--set", "run.agent_timeout_s=1000"});
  ASSERT_TRUE(Flies(up));
  SignalTo(up.Child("agent_2"), SIGSTOP);
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
  EXPECT_EQ(up.Summary()["safety"]["collisions"], 0);
  EXPECT_EQ(up.Summary()["wire"]["matches_graph"], true);
}

TEST(Faults, ASecondCtrlCKillsALawThatHangsInOneProcess) {
  ScratchFolder folder;
  WriteFile(folder.File("hangs.toml"),
            "[run]\nduration_s = 4.0\n[agents]\ncount = 2\n[law]\nname = 'custom'\npython = '''\nimport time\n"
            "def control(t, me, neighbours):\n  if t > 2.5:\n    print('asleep')\n    time.sleep(1000)\n"
            "  return 0, 0\n'''\n");
  Up up(folder, "run", folder.File("hangs.toml"), {"--engine", "inprocess", "--set", "output.fidelity=false"});
  ASSERT_TRUE(Until([&] { return up.Said("asleep"); })) << up.err();
  up.Signal(SIGINT);
  ASSERT_TRUE(Until([&] { return up.Said("once more to kill"); }));
  EXPECT_TRUE(Until([&] { return ReadMcap(up.path() / "run.mcap").messages > 0; }))
      << "the files are written though it hangs";
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
}

TEST(Faults, ACtrlCBeforeTheFirstTickEndsToo) {
  ScratchFolder folder;
  Up up = Endless(folder, {"--set", "agents.override=[{id = 1, host = \"external\"}]"});
  ASSERT_TRUE(Until([&] { return up.Said("waiting for: agent --id 1"); }));
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, AnAgentThatNeverComesIsNamedAfterTheStartTimeout) {
  ScratchFolder folder;
  Up up =
      Endless(folder, {"--set", "agents.override=[{id = 2, host = \"external\"}]", "--set", "run.start_timeout_s=2.0"});
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), HasSubstr("not ready within run.start_timeout_s = 2.0 s: agent 2"));
  EXPECT_THAT(up.err(), testing::ContainsRegex("still waiting: nothing was heard of agent_2\n"
                                               "waiting for: agent --id 2 --domain [0-9]+\n"))
      << "somebody who comes late is told what to type";
  EXPECT_TRUE(NothingIsLeft(up));
}

TEST(Faults, AnAgentThatWaitsForParticipantsThatDoNotComeFliesAllTheSame) {
  ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"),
        {"--duration-s", "0.2", "--set", "agents.override=[{id = 1, host = \"external\"}]"});
  ASSERT_TRUE(Until([&] { return up.Said("waiting for: agent --id 1"); }));
  Running agent(BuildFolder() + "/agent", {"--id", "1", "--domain", std::to_string(DomainOf(up)), "--awaits", "1000"},
                folder.File("agent"));
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_EQ(agent.Wait(), 0) << agent.err();
}

TEST(Faults, AnAgentThatWaitsForParticipantsEndsByASignal) {
  ScratchFolder folder;
  Running agent(BuildFolder() + "/agent", {"--id", "1", "--domain", "231", "--loopback", "--awaits", "1000"},
                folder.File("agent"));
  const std::string threads = "/proc/" + std::to_string(agent.pid()) + "/task";
  ASSERT_TRUE(Until([&] { return std::distance(std::filesystem::directory_iterator(threads), {}) > 3; }))
      << "it has joined the domain";
  agent.Signal(SIGINT);
  EXPECT_EQ(agent.Wait(), 130) << agent.err();
}

TEST(Faults, AFullDiskFailsTheRun) {
  ScratchFolder folder;
  for (const std::string engine : {"dds", "inprocess"}) {
    const Ran run = Shell("ulimit -f 4000; '" + BuildFolder() + "/orchestrator' up " + Config("leaderless") +
                          " --duration-s 400 --set output.save_plot=false --set output.save_data=false --engine " +
                          engine + " --out " + folder.File(engine));
    EXPECT_EQ(run.exit_code, 1) << run.output;
    EXPECT_THAT(run.output, HasSubstr("error: cannot write " + folder.File(engine + "/run.mcap") + ": File too large"));
    EXPECT_GT(nlohmann::json::parse(ReadFile(folder.File(engine + "/summary.json")))["ticks"], 0);
    EXPECT_TRUE(NothingIsLeft(run.output));
  }
}

TEST(Faults, StatesThatDoNotFitOnTheDiskFailTheRun) {
  ScratchFolder folder;
  const Ran run =
      Shell("ulimit -f 4000; '" + BuildFolder() + "/orchestrator' up " + Config("leaderless") +
            " --duration-s 400 --set output.save_plot=false --set 'record.topics=[]' --engine inprocess --out " +
            folder.File("run"));
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_THAT(run.output, HasSubstr("error: cannot write " + folder.File("run/states.npz.part") + ": File too large"));
  EXPECT_TRUE(std::filesystem::exists(folder.File("run/run.mcap")));
  EXPECT_FALSE(std::filesystem::exists(folder.File("run/states.npz.part")));
}

TEST(Faults, ALogThatCannotBeWrittenIsSaidAndTheRunGoesOn) {
  ScratchFolder folder;
  const std::string law = "def control(t, me, neighbours):\n  print('x' * 60000, flush=True)\n  return [0, 0]\n";
  const Ran run = Shell("ulimit -f 4000; '" + BuildFolder() + "/orchestrator' up " + Python(folder, 2, law) +
                        " --quiet --out " + folder.File("run"));
  EXPECT_EQ(run.exit_code, 0) << run.output;
  for (const char* agent : {"agent_1", "agent_2"})
    EXPECT_THAT(run.output, HasSubstr("warning: cannot write " + folder.File("run/logs/") + agent +
                                      ".log: File too large: this log ends here, and what would follow is lost\n"));
  EXPECT_EQ(nlohmann::json::parse(ReadFile(folder.File("run/summary.json")))["ticks"], 100);
}

TEST(Faults, AnAgentWhoseLawHangsSaysSoWhenItIsInterrupted) {
  ScratchFolder folder;
  const std::string law =
      "import time\ndef control(t, me, neighbours):\n  if t > 0.1 and me.id == 1:\n    print('I hang', flush=True)\n"
      "    time.sleep(1000)\n  return [0, 0]\n";
  Up up(folder, "run", Python(folder, 2, law, "fidelity = false\n"),
        {"--set", "agents.override=[{id = 1, host = \"external\"}]", "--set", "run.agent_timeout_s=1000"});
  ASSERT_TRUE(Until([&] { return up.Said("waiting for: agent --id 1"); }));
  Running agent(BuildFolder() + "/agent", {"--id", "1", "--domain", std::to_string(DomainOf(up))},
                folder.File("agent"));
  ASSERT_TRUE(Until([&] { return agent.Said("I hang"); })) << agent.err();
  agent.Signal(SIGINT);
  EXPECT_EQ(agent.Wait(), 130);
  EXPECT_THAT(agent.err(), HasSubstr("agent_1: the DDS library does not end: leaving by force\n"));
}

TEST(Faults, ASecondServerEndsTheRun) {
  ScratchFolder folder;
  Up up = Endless(folder);
  ASSERT_TRUE(Flies(up));
  Running twin(BuildFolder() + "/physics_server", {"--loopback", "--domain", std::to_string(DomainOf(up))},
               folder.File("twin"));
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), HasSubstr("two processes say that they are physics_server"));
}

TEST(Faults, AnAgentThatFallsSilentEndsARealtimeRunToo) {
  ScratchFolder folder;
  Up up = Endless(folder, {"--set", "run.mode=realtime", "--set", "run.agent_timeout_s=0.5"});
  ASSERT_TRUE(Flies(up));
  SignalTo(up.Child("agent_2"), SIGSTOP);
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), NamesAgentTwo());
  EXPECT_GT(up.Summary()["realtime"]["misses"], 10);
  EXPECT_GT(up.Summary()["wall_s"].get<double>(), 0.0);
  std::istringstream events(up.File("events.csv"));
  std::uint64_t late = 0;
  for (std::string line; std::getline(events, line);) {
    const auto at = line.find(",late_command,");
    if (at != std::string::npos) late += std::stoull(line.substr(at + std::string(",late_command,").size()));
  }
  EXPECT_EQ(late, up.Summary()["realtime"]["misses"]);
  EXPECT_THAT(up.File("events.csv"), testing::ContainsRegex(",late_command,[0-9]+,2,,\n"));
  EXPECT_THAT(up.out(), testing::ContainsRegex(": commands of agent [1-4] come too late, for [0-9]+ ticks?"));
}

TEST(Faults, WhatTheServerMeasuredIsReportedWhenAnAgentDies) {
  ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"), {"--set", "run.mode=realtime", "--duration-s", "20"});
  ASSERT_TRUE(Until([&] {  // until a tenth of the run is done: the second progress line
    const std::string said = up.err(), line = "x real time";
    return said.find(line, said.find(line) + 1) < said.size();
  }));
  const pid_t agent = up.Child("agent_2");
  ASSERT_GT(agent, 0);
  SignalTo(agent, SIGKILL);
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_GT(up.Summary()["realtime"]["tick_lateness_s"]["max"], 0);
  EXPECT_EQ(up.Summary()["safety"]["collisions"], 0);
}

TEST(Faults, WhatTheServerMeasuredIsReportedWhenAnAgentDiesInTheFirstTick) {
  ScratchFolder folder;  // when a process exits, samples in its shared memory that are not read yet are lost
  for (int i = 0; i < 10; ++i) {
    Up up = Endless(folder, {"--set", "run.mode=realtime", "--force"});
    ASSERT_TRUE(Flies(up));
    SignalTo(up.Child("agent_2"), SIGKILL);
    EXPECT_EQ(up.Wait(), 1);
    EXPECT_EQ(up.Summary()["safety"]["collisions"], 0);
  }
}

TEST(Faults, HowAProgramWasStartedDoesNotMatter) {
  ScratchFolder folder;
  const std::string up = "'" + BuildFolder() + "/orchestrator' up " + Config("leaderless") +
                         " --duration-s 0.5 --set output.save_plot=false --out ";
  // SIGCHLD ignored, as some supervisors leave it; and without standard streams, as daemons are started.
  EXPECT_EQ(Shell("trap '' CHLD; " + up + folder.File("ignored")).exit_code, 0);
  EXPECT_EQ(Shell("(" + up + folder.File("closed") + " 0<&- 1>&- 2>&-)").exit_code, 0);
  EXPECT_TRUE(ReadMcap(folder.File("closed/run.mcap")).complete);
  EXPECT_EQ(ReadFile(folder.File("closed/run.mcap")), ReadFile(folder.File("ignored/run.mcap")));
}

TEST(Faults, AnAgentProgramThatIsMissingIsNamed) {
  ScratchFolder folder;
  std::filesystem::copy(BuildFolder() + "/orchestrator", folder.File("orchestrator"));
  const Ran run = Shell(folder.File("orchestrator") + " up " + Config("leaderless") + " --out " + folder.File("run"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output,
              HasSubstr("error: cannot start " + folder.File("physics_server") + ": No such file or directory"));
  EXPECT_TRUE(std::filesystem::exists(folder.File("run/summary.json")));
}

TEST(Faults, AnotherProgramMayReadButNotCommand) {
  ScratchFolder folder;
  Up up = Endless(folder, {"--set", "network.delivery=topics"});
  ASSERT_TRUE(Flies(up));
  Domain domain(Intruder(up, "rviz"), [] {});
  std::atomic<int> heard = 0;
  Reader<StateType> listening(domain, Topic::State(4), [&](const auto&) { ++heard; });
  ASSERT_TRUE(Until([&] { return heard > 10; }));
  Writer<CommandType> flying(domain, Topic::Command(4));
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), HasSubstr("'rviz' writes /agent_4/command, which only agent_4 may"));
}

TEST(Faults, TooLittleSharedMemoryIsRefusedInWords) {
  const std::string alone = "unshare --mount sh -c 'mount -t tmpfs -o size=2m tmpfs /dev/shm";
  if (Shell(alone + "'").exit_code != 0) GTEST_SKIP() << "mounting a /dev/shm is not allowed here";
  ScratchFolder folder;
  const std::string up = " && \"" + BuildFolder() + "/orchestrator\" up " + Config("leaderless") +
                         " --duration-s 0.2 --set output.save_plot=false --out " + folder.File("run");
  const Ran refused = Shell(alone + up + "'");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.output,
              testing::ContainsRegex("error: /dev/shm has 2\\.0 MiB free, and this run needs [0-9.]+ MiB"));
  EXPECT_THAT(ReadFile(folder.File("run/summary.json")), HasSubstr("/dev/shm has 2.0 MiB free"));
  EXPECT_EQ(Shell(alone + up + " --force --set network.transport=udp'").exit_code, 0) << "needs none";
}

TEST(Faults, TooLittleAddressSpaceIsRefusedInWords) {
  ScratchFolder folder;
  const Ran run = Shell("ulimit -v 204800; '" + BuildFolder() + "/orchestrator' up " + Config("leaderless") +
                        " --out " + folder.File("run"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output,
              HasSubstr("error: the address space of a process is limited to 200 MiB (ulimit -v), and a run "
                        "over DDS needs 512 MiB\n"));
}

TEST(Faults, TheCommandForAnAgentByHandNamesTheTransport) {
  ScratchFolder folder;
  Up up = Endless(folder,
                  {"--set", "agents.override=[{id = 1, host = \"external\"}]", "--set", "network.transport=\"udp\""});
  ASSERT_TRUE(Until([&] { return up.Said("waiting for: agent --id 1"); }));
  EXPECT_THAT(up.err(), testing::ContainsRegex("waiting for: agent --id 1 --domain [0-9]+ --transport udp\n"));
}

TEST(Faults, ADomainInUseIsRefused) {
  ScratchFolder folder;
  Up up = Endless(folder);
  ASSERT_TRUE(Until([&] { return up.Said("domain "); }));
  const std::string domain = std::to_string(DomainOf(up));
  Up second(folder, "second", Config("leaderless"), {"--set", "network.domain=" + domain});
  EXPECT_EQ(second.Wait(), 1);
  EXPECT_THAT(second.err(),
              HasSubstr("error: network.domain = " + domain + " is in use by another run on this machine"));
}

TEST(Faults, AHostWhoseJanitorCannotStartSaysSoAndKillsNobodyElse) {
  ScratchFolder folder;
  std::filesystem::copy_file(BuildFolder() + "/orchestrator", folder.File("orchestrator"));  // without its neighbours
  WriteFile(folder.File("job"), R"({"kind": "job", "domain": 100, "own_memory": true, "shared_memory": 0, )"
                                R"("silence_s": 10, "processes": []})"
                                "\n");
  const Ran ran = Shell("setsid -w sh -c '\"" + folder.File("orchestrator") + "\" host < \"" + folder.File("job") +
                        "\"; echo code $?' 2>&1");
  EXPECT_THAT(ran.output, HasSubstr("physics_server: No such file or directory"));
  EXPECT_THAT(ran.output, HasSubstr("code 1\n")) << "the shell is of the same process group";
}

}  // namespace
}  // namespace mascot::test
