// Agents that are lost in runs over DDS, by events and for real, and fresh ones that take their place: the runs fly
// again byte for byte.

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Five agents on a ring; `run`: keys of [run]. The law sends messages.
std::string Ring(const std::string& run, const std::string& more = "") {
  return "[run]\n" + run +
         "\n[agents]\ncount = 5\nposition_m = [[0, 0, 2], [4, 0, 3], [6, 4, 4], [2, 6, 5], [-2, 3, 6]]\n"
         "[graph]\ntopology = 'ring'\n[link]\nloss = 0.1\ndelay_s = 0.02\n[law]\nname = 'event_triggered'\n" +
         more;
}

std::string At(const std::string& at_s, const std::string& event) {
  return "[[events]]\nat_s = " + at_s + "\n" + event + "\n";
}

/// What `verify` says of a run.
Ran Verified(const Up& up, const std::string& more = "") {
  return Shell("'" + BuildFolder() + "/orchestrator' verify '" + up.path().string() + "' " + more);
}

/// How the agents are spread over processes, and what they hear by.
struct Layout {
  std::string name;
  std::vector<std::string> options = {};
  bool restarts = true;
};

class LossesByEvents : public testing::TestWithParam<Layout> {};

TEST_P(LossesByEvents, GiveTheBytesOfOneProcess) {
  ScratchFolder folder;
  std::string events = At("0.5", "fault = { agent = 3, kind = 'kill' }") +
                       At("0.8", "fault = { agent = 4, kind = 'hang' }") +
                       At("1.0", "fault = { agent = 1, kind = 'kill', unanswered = true }") +
                       At("1.1", "fault = { agent = 5, kind = 'mute' }") +
                       At("1.2", "fault = { agent = 2, of = 'motor', kind = 'wrong', motor = 2 }") +
                       At("1.3", "fault = { agent = 2, of = 'link', kind = 'delayed', delay_s = 0.1 }") +
                       At("1.4", "fault = { agent = 5, of = 'sensor', kind = 'garbage' }");
  if (GetParam().restarts)
    events += At("1.5", "restart = 4") + At("1.5", "restart = 3") + At("1.8", "restart = 2") + At("1.9", "restart = 1");
  WriteFile(folder.File("events.toml"), Ring("duration_s = 3.0\non_agent_loss = 'hold'", events));
  Up one(folder, "one", folder.File("events.toml"), {"--engine", "inprocess", "--set", "run.name=events"});
  std::vector<std::string> options{"--engine", "dds", "--set", "run.name=events"};
  options.insert(options.end(), GetParam().options.begin(), GetParam().options.end());
  Up dds(folder, "dds", folder.File("events.toml"), options);
  ASSERT_EQ(one.Wait(), 0) << one.err();
  ASSERT_EQ(dds.Wait(), 0) << dds.err();
  EXPECT_TRUE(one.File("states.npz") == dds.File("states.npz"));
  EXPECT_EQ(one.File("events.csv"), dds.File("events.csv"));
  const Ran verified = Verified(dds);
  EXPECT_EQ(verified.exit_code, 0);
  EXPECT_THAT(verified.output, HasSubstr("the same, bit for bit: 301 ticks"));
  EXPECT_THAT(dds.Info(), HasSubstr("complete: yes"));
}

INSTANTIATE_TEST_SUITE_P(Runs, LossesByEvents,
                         testing::Values(Layout{"bundled"},
                                         Layout{"two in a process", {"--set", "network.agents_per_process=2"}},
                                         Layout{"all in a process", {"--set", "network.agents_per_process=5"}},
                                         Layout{"in shared memory", {"--set", "network.transport=shm"}},
                                         Layout{"topics", {"--set", "network.delivery=topics"}, /*restarts=*/false}),
                         [](const auto& row) { return ParamName(row.param.name); });

TEST(Losses, RestartsByRunOnAgentLossGiveTheBytesOfOneProcess) {
  ScratchFolder folder;
  WriteFile(folder.File("back.toml"), Ring("duration_s = 3.0\non_agent_loss = 'restart'\nrestart_after_s = 0.7",
                                           At("0.5", "fault = { agent = 3, kind = 'kill' }") +
                                               At("0.6", "fault = { agent = 1, kind = 'hang' }")));
  Up one(folder, "one", folder.File("back.toml"), {"--engine", "inprocess", "--set", "run.name=back"});
  Up dds(folder, "dds", folder.File("back.toml"), {"--engine", "dds", "--set", "run.name=back"});
  ASSERT_EQ(one.Wait(), 0) << one.err();
  ASSERT_EQ(dds.Wait(), 0) << dds.err();
  EXPECT_TRUE(one.File("run.mcap") == dds.File("run.mcap"));
  EXPECT_THAT(dds.err(), HasSubstr("agent_3 starts afresh at 1.2 s"));
  EXPECT_THAT(dds.err(), HasSubstr("agent_1 starts afresh at 1.3 s"));
  EXPECT_THAT(dds.File("config.toml"), Not(HasSubstr("restart = "))) << "run.on_agent_loss brings them again";
}

/// A law in Python that fails in the agent that `fails` says, and sends a message.
std::string FailingLaw(const std::string& fails) {
  return "def control(t, me, neighbours):\n    if " + fails +
         ":\n        raise ValueError('broken')\n    return [0.1 * sum(j.position[k] - me.position[k] for j in "
         "neighbours) "
         "for k in range(3)]\ndef message(me):\n    return [float(me.id)]\n";
}

class FailingLaws : public testing::TestWithParam<Layout> {};

TEST_P(FailingLaws, AreLossesWithTheBytesOfOneProcess) {
  ScratchFolder folder;
  WriteFile(folder.File("law.py"), FailingLaw("(me.id, round(100 * t)) in ((2, 50), (5, 60), (3, 80))"));
  for (const std::string what : {"hold", "restart"}) {
    WriteFile(folder.File(what + ".toml"),
              "[run]\nduration_s = 1.5\nrestart_after_s = 0.4\non_agent_loss = '" + what +
                  "'\n[agents]\ncount = 5\nmodel = 'double_integrator'\nposition_m = [[0, 0, 2], [4, 0, 3], [6, 4, 4], "
                  "[2, 6, 5], [-2, 3, 6]]\n[graph]\ntopology = 'ring'\n[law]\nname = 'custom'\nfile = '" +
                  folder.File("law.py") + "'\n");
    const auto fly = [&](const std::string& engine, std::vector<std::string> more) {
      more.insert(more.end(), {"--engine", engine, "--set", "run.name=failing"});
      Up up(folder, what + engine, folder.File(what + ".toml"), std::move(more));
      EXPECT_EQ(up.Wait(), 0) << up.err();
      EXPECT_THAT(up.err(), HasSubstr("ValueError: broken"));
      EXPECT_THAT(
          up.err(),
          HasSubstr(what == "hold" ? "run.on_agent_loss = \"hold\": the actuators keep their last values"
                                   : "run.on_agent_loss = \"restart\": a fresh agent takes its place after 0.4 s"));
      return std::tuple(up.File("states.npz"), up.File("events.csv"), Verified(up).exit_code);
    };
    const auto one = fly("inprocess", GetParam().options), dds = fly("dds", GetParam().options);
    EXPECT_TRUE(std::get<0>(one) == std::get<0>(dds)) << "states differ";
    EXPECT_EQ(std::get<1>(one), std::get<1>(dds));
    EXPECT_EQ(std::get<2>(one), 0);
    EXPECT_EQ(std::get<2>(dds), 0);
    EXPECT_EQ(CountOf("unanswered = true", std::get<1>(one)), GetParam().options.empty() ? 3u : 5u);
  }
}

INSTANTIATE_TEST_SUITE_P(Runs, FailingLaws,
                         testing::Values(Layout{"alone"},
                                         Layout{"two in a process", {"--set", "network.agents_per_process=2"}}),
                         [](const auto& row) { return ParamName(row.param.name); });

TEST(Losses, ByALawThatFailsAtTheLastTickFailTheRun) {
  ScratchFolder folder;
  WriteFile(folder.File("law.py"), FailingLaw("me.id == 2 and t == 0.5"));
  WriteFile(folder.File("last.toml"),
            "[run]\nduration_s = 0.5\non_agent_loss = 'hold'\n[agents]\ncount = 2\nmodel = 'double_integrator'\n"
            "[law]\nname = 'custom'\nfile = '" +
                folder.File("law.py") + "'\n");
  Up one(folder, "one", folder.File("last.toml"), {"--engine", "inprocess"});
  EXPECT_EQ(one.Wait(), 1);
  EXPECT_THAT(one.err(), HasSubstr("ValueError: broken"));
  Up dds(folder, "dds", folder.File("last.toml"), {"--engine", "dds"});
  EXPECT_EQ(dds.Wait(), 1);
  EXPECT_THAT(dds.err(), HasSubstr("tick 50, the last: agent 2 is lost, and has not answered"));
  EXPECT_EQ(one.Summary()["ticks"], dds.Summary()["ticks"]);
}

/// Each tick one more agent's law fails, and the run is stopped meanwhile: agents that have not answered the last tick
/// are lost by events of a tick that is not flown.
TEST(Losses, AtTheLastTickOfARunThatIsStoppedFlyAgainByteForByte) {
  for (const auto& [engine, of_run] : {std::pair("inprocess", "os.getpid()"), std::pair("dds", "os.getppid()")}) {
    SCOPED_TRACE(engine);
    ScratchFolder folder;
    WriteFile(
        folder.File("law.py"),
        std::string("import ctypes, os\ndef control(t, me, neighbours):\n    tick = round(100 * t)\n"
                    "    if me.id == 5 and tick == 55:\n        ctypes.CDLL(None).kill(") +
            of_run +
            ", 15)\n    if tick == 50 + me.id:\n        raise ValueError('broken')\n    return [0.0, 0.0, 0.0]\n");
    WriteFile(folder.File("team.toml"),
              "[run]\nduration_s = 1000.0\non_agent_loss = 'hold'\n[agents]\ncount = 20\nmodel = "
              "'double_integrator'\n[graph]\ntopology = 'ring'\n[output]\nfidelity = false\n[law]\nname = "
              "'custom'\nfile = '" +
                  folder.File("law.py") + "'\n");
    Up up(folder, "run", folder.File("team.toml"), {"--engine", engine});
    EXPECT_EQ(up.Wait(), 128 + SIGTERM) << up.err();
    const auto ticks = up.Summary()["ticks"].get<int>();
    EXPECT_THAT(ticks, testing::AllOf(testing::Gt(50), testing::Lt(70))) << "agents fail, the last tick among them";
    EXPECT_THAT(Verified(up).output, HasSubstr("the same, bit for bit"));
  }
}

TEST(Losses, EndTheRunByDefault) {
  ScratchFolder folder;
  WriteFile(folder.File("end.toml"), Ring("duration_s = 3.0", At("0.5", "fault = { agent = 3, kind = 'kill' }")));
  for (const std::string engine : {"inprocess", "dds"}) {
    Up up(folder, engine, folder.File("end.toml"), {"--engine", engine, "--set", "run.name=end"});
    EXPECT_EQ(up.Wait(), 1);
    EXPECT_THAT(up.err(), HasSubstr("tick 50: agent 3 is lost: its process has died (run.on_agent_loss = \"abort\")"));
    EXPECT_EQ(up.Summary()["ticks"], 49) << engine;
    EXPECT_THAT(up.Info(), HasSubstr("the run ended early, recorded without a gap\ncomplete: yes\n"));
  }
}

TEST(Losses, RestartsNeedBundles) {
  ScratchFolder folder;
  WriteFile(folder.File("topics.toml"), Ring("duration_s = 1.0", At("0.5", "restart = 3")));
  Up up(folder, "topics", folder.File("topics.toml"), {"--engine", "dds", "--set", "network.delivery=topics"});
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(),
              HasSubstr("network.delivery: expected \"bundled\" or \"auto\" in a run over DDS in which agents "
                        "start afresh, got \"topics\""));
}

class RealLosses : public testing::TestWithParam<Layout> {
 protected:
  std::vector<std::string> Options(std::vector<std::string> more) const {
    std::vector<std::string> options{"--engine", "dds"};
    options.insert(options.end(), GetParam().options.begin(), GetParam().options.end());
    options.insert(options.end(), more.begin(), more.end());
    return options;
  }
};

TEST_P(RealLosses, AreEventsOfTheRunThatFlyAgain) {
  ScratchFolder folder;
  WriteFile(folder.File("endless.toml"), Ring("duration_s = 100000.0\non_agent_loss = 'hold'"));
  Up up(folder, "run", folder.File("endless.toml"), Options({}));
  ASSERT_TRUE(Flies(up));
  SignalTo(ChildOf(up.pid(), "/agent --"), SIGKILL);
  ASSERT_TRUE(Until([&] { return up.Said("lost: agent"); })) << up.err();
  EXPECT_TRUE(up.Said("run.on_agent_loss = \"hold\": the actuators keep their last values")) << up.err();
  SignalTo(ChildOf(up.pid(), "/agent --"), SIGKILL);
  ASSERT_TRUE(Until([&] { return CountOf("lost: agent", up.err()) == 2; })) << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
  EXPECT_THAT(up.File("config.toml"), HasSubstr("kind = \"kill\""));
  EXPECT_THAT(Verified(up).output, HasSubstr("the same, bit for bit"));
}

INSTANTIATE_TEST_SUITE_P(Runs, RealLosses,
                         testing::Values(Layout{"bundled"},
                                         Layout{"two in a process", {"--set", "network.agents_per_process=2"}},
                                         Layout{"topics", {"--set", "network.delivery=topics"}}),
                         [](const auto& row) { return ParamName(row.param.name); });

TEST(Losses, AnAgentThatIsStoppedBeyondTheTimeOutHangs) {
  ScratchFolder folder;
  WriteFile(folder.File("endless.toml"), Ring("duration_s = 100000.0\non_agent_loss = 'drop'\nagent_timeout_s = 1.0"));
  Up up(folder, "run", folder.File("endless.toml"), {"--engine", "dds"});
  ASSERT_TRUE(Flies(up));
  const pid_t agent = up.Child("agent_2");
  SignalTo(agent, SIGSTOP);
  ASSERT_TRUE(Until([&] { return up.Said("lost: agent 2 hangs"); })) << up.err();
  SignalTo(agent, SIGCONT);  // too late: what it answers now does not count
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
  EXPECT_THAT(up.File("config.toml"),
              HasSubstr("fault = { agent = 2, of = \"agent\", kind = \"hang\", unanswered = true }"));
  EXPECT_THAT(Verified(up).output, HasSubstr("the same, bit for bit"));
}

/// Its queue in shared memory looks alive for as long as it counts as a reader.
TEST(Losses, AProcessThatDiesWhileItHandlesASampleIsInNobodysWay) {
  ScratchFolder folder;
  WriteFile(folder.File("law.py"),
            "import ctypes\ndef control(t, me, neighbours):\n    if me.id == 3 and round(100 * t) == 50:\n"
            "        ctypes.string_at(0)\n    return [0.0, 0.0, 0.0]\n");
  WriteFile(folder.File("back.toml"),
            "[run]\nduration_s = 40.0\non_agent_loss = 'restart'\nrestart_after_s = 0.2\n[agents]\ncount = 6\n[graph]\n"
            "topology = 'complete'\n[output]\nfidelity = false\n[law]\nname = 'custom'\nfile = '" +
                folder.File("law.py") + "'\n");
  Up up(folder, "run", folder.File("back.toml"), {"--engine", "dds"});
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.err(), HasSubstr("lost: agent_3: the law of agent 3 crashed: SIGSEGV"));
  EXPECT_EQ(up.Summary()["ticks"], 4000);
}

TEST(Losses, ComeByHandToo) {
  ScratchFolder folder;
  WriteFile(folder.File("endless.toml"), Ring("duration_s = 100000.0\non_agent_loss = 'hold'\npace = 1.0"));
  Up up(folder, "run", folder.File("endless.toml"), {"--engine", "dds"});
  ASSERT_TRUE(Flies(up));
  const auto send = [&up](const std::string& words) {
    return Shell("'" + BuildFolder() + "/orchestrator' send --run '" + up.path().string() + "' " + words + " 2>&1")
        .output;
  };
  EXPECT_THAT(send("fault 3 kill"), testing::StartsWith("takes effect at tick "));
  ASSERT_TRUE(Until([&] { return up.Child("agent_3") == 0; }));
  EXPECT_THAT(send("fault 2 wrong of=sensor offset_m='[1, 0, 0]'"), testing::StartsWith("takes effect at tick "));
  EXPECT_THAT(send("fault 2 stuck"), HasSubstr("event by hand: fault.kind: expected for of = \"agent\" one of"));
  EXPECT_THAT(send("fault 2"), HasSubstr("send: expected fault AGENT KIND [KEY=VALUE...], got 1 word behind it"));
  EXPECT_THAT(send("fault 2 mute delay_s=1 delay_s=2"), HasSubstr("expected each key once, got 'delay_s=2'"));
  EXPECT_THAT(send("restart 3"), testing::StartsWith("takes effect at tick "));
  ASSERT_TRUE(Until([&] { return up.Child("agent_3") > 0 && up.Said("agent_3 starts afresh at "); }));
  EXPECT_THAT(send("restart 7"), HasSubstr("event by hand: restart: expected an integer in [1, 5], got 7"));
  EXPECT_THAT(send("pace 0"), HasSubstr("as fast as it goes"));
  const auto tick = [&up] {
    for (const auto& run : nlohmann::json::parse(Shell("'" + BuildFolder() + "/orchestrator' ps --json").output))
      if (run.value("process", 0) == up.pid() && run["tick"].is_number()) return run["tick"].get<std::int64_t>();
    return std::int64_t{-1};
  };
  const std::int64_t held = tick();
  ASSERT_TRUE(Until([&] { return tick() > held + 1; })) << "it goes on";
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
  EXPECT_FALSE(up.Said("lost: ")) << "it was asked for";
  EXPECT_THAT(up.File("config.toml"), HasSubstr("restart = 3"));
  EXPECT_THAT(Verified(up).output, HasSubstr("the same, bit for bit"));
}

/// Random kills of a run: how many, of how many agents, and what the run says of each when it goes on.
struct Storm {
  std::string on_agent_loss;
  int agents = 0;
  std::size_t kills = 0, said_before = 0;
  std::string says;
};

TEST(Losses, RunsThatOutliveAgentsShareNoMemoryUnlessAsked) {
  struct Row {
    std::string on_agent_loss, transport;
    bool shares;
  };
  for (const Row& row : {Row{"abort", "auto", true}, Row{"abort", "udp", false}, Row{"hold", "auto", false},
                         Row{"drop", "auto", false}, Row{"restart", "auto", false}, Row{"hold", "shm", true}}) {
    SCOPED_TRACE(row.on_agent_loss + " " + row.transport);
    ScratchFolder folder;
    WriteFile(folder.File("team.toml"), Ring("duration_s = 100000.0\non_agent_loss = '" + row.on_agent_loss + "'", ""));
    Up up(folder, "run", folder.File("team.toml"),
          {"--engine", "dds", "--set", "network.transport=" + row.transport, "--set", "output.fidelity=false"});
    ASSERT_TRUE(Flies(up));
    for (const std::string process : {"physics_server", "agent_1"}) {
      const std::string maps = ReadFile("/proc/" + std::to_string(up.Child(process)) + "/maps");
      EXPECT_EQ(maps.find("/dev/shm/fastrtps_port") != maps.npos, row.shares) << process;
    }
    up.Signal(SIGINT);
    EXPECT_EQ(up.Wait(), 130) << up.err();
  }
}

class RandomKills : public testing::TestWithParam<Storm> {};

TEST_P(RandomKills, FlyAgainByteForByte) {
  const Storm& storm = GetParam();
  ScratchFolder folder;
  WriteFile(folder.File("storm.toml"),
            "[run]\nduration_s = 100000.0\npace = 5.0\nrestart_after_s = 0.1\non_agent_loss = '" + storm.on_agent_loss +
                "'\n[agents]\ncount = " + std::to_string(storm.agents) +
                "\n[graph]\ntopology = 'ring'\n[law]\nname = 'event_triggered'\n");
  Up up(folder, "run", folder.File("storm.toml"), {"--engine", "dds"});
  ASSERT_TRUE(Flies(up));
  std::mt19937 random(1);  // NOLINT(bugprone-random-generator-seed): the same kills each time
  std::vector<int> ids(static_cast<std::size_t>(storm.agents));
  std::iota(ids.begin(), ids.end(), 1);
  std::size_t kills = 0;
  while (kills < storm.kills) {
    std::ranges::shuffle(ids, random);
    for (std::size_t at_once = 1 + random() % 3; at_once > 0; --at_once) {
      const pid_t agent = up.Child("agent_" + std::to_string(ids[at_once]));
      if (agent > 0 && kill(agent, SIGKILL) == 0) ++kills;
    }
    ASSERT_TRUE(Until([&] { return CountOf(storm.says, up.err()) >= storm.said_before + kills || up.IsOver(); },
                      kPatienceForRuns))
        << up.err();
    ASSERT_FALSE(up.IsOver()) << up.err();
  }
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_THAT(Verified(up).output, HasSubstr("the same, bit for bit"));
}

INSTANTIATE_TEST_SUITE_P(Losses, RandomKills,
                         testing::Values(Storm{"hold", 80, 75, 0, "lost: agent_"},
                                         Storm{"restart", 5, 25, 5, "] hears"}),
                         [](const auto& row) { return row.param.on_agent_loss; });

TEST(Losses, AFreshProcessThatDiesBeforeItIsReadyIsStartedAgain) {
  ScratchFolder folder;
  WriteFile(folder.File("back.toml"),
            Ring("duration_s = 2.0\non_agent_loss = 'restart'\nrestart_after_s = 0.5\npace = 2.0",
                 At("0.5", "fault = { agent = 3, kind = 'kill' }")));
  Up up(folder, "run", folder.File("back.toml"), {"--engine", "dds"});
  ASSERT_TRUE(Until([&] { return up.Said("agent_3 starts afresh at 1.0 s"); })) << up.err();
  for (pid_t fresh = 0; fresh == 0; fresh = ChildOf(up.pid(), "--from-tick 100 ")) ASSERT_FALSE(up.IsOver());
  SignalTo(ChildOf(up.pid(), "--from-tick 100 "), SIGKILL);
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(Verified(up).output, HasSubstr("the same, bit for bit: 201 ticks"));
}

}  // namespace
}  // namespace mascot::test
