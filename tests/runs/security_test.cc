// Runs over DDS with network.security = "graph": nobody hears or says what the graph does not allow.

#include <gmock/gmock.h>

#include <atomic>
#include <filesystem>
#include <fstream>

#include "agent/laws/laws.h"
#include "bus/wire.h"
#include "orchestrator/engines/dds/credentials.h"
#include "tests/support/folders.h"
#include "tests/support/intruder.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr Redelivery kAnyWriter = Redelivery::kOnDemand;

/// Four points on a path, whose laws send messages.
std::string Path(const std::string& run, const std::string& more = "") {
  return "[run]\nname = 'path'\n" + run +
         "\n[agents]\ncount = 4\nmodel = 'double_integrator'\n[graph]\ntopology = 'path'\n[output]\nsave_plot = false\n"
         "fidelity = false\n[law]\nname = 'event_triggered'\n" +
         more;
}

class Secured : public testing::Test {
 protected:
  /// Starts `up` with security; its temporary files are in Temporary().
  Up Start(const std::string& name, const std::string& experiment, std::vector<std::string> more = {}) {
    WriteFile(folder_.File(name + ".toml"), experiment);
    std::filesystem::create_directories(Temporary());
    setenv("TMPDIR", Temporary().c_str(), 1);
    more.insert(more.begin(), {"--set", "network.security=graph"});
    return Up(folder_, name, folder_.File(name + ".toml"), more);
  }
  std::string Temporary() const { return folder_.File("tmp"); }
  /// The files with private keys that there are.
  std::vector<std::string> KeyFiles() const {
    std::vector<std::string> files;
    std::error_code vanishes;
    for (auto entry = std::filesystem::recursive_directory_iterator(Temporary(), vanishes);
         entry != std::filesystem::recursive_directory_iterator(); entry.increment(vanishes))
      if (!vanishes && entry->is_regular_file(vanishes) &&
          ReadFile(entry->path().string()).find("PRIVATE KEY") != std::string::npos)
        files.push_back(entry->path().string());
    return files;
  }
  void TearDown() override { unsetenv("TMPDIR"); }

  ScratchFolder folder_;
};

// --- the same run ------------------------------------------------------------------------------------

struct Way {
  std::string name;
  std::vector<std::string> options = {}, also = {};  ///< of the secured run; of the one without security as well
};

void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }

class SecuredRuns : public Secured, public testing::WithParamInterface<Way> {};

TEST_P(SecuredRuns, HaveTheSameRecording) {
  WriteFile(folder_.File("plain.toml"), Path("duration_s = 2.0"));
  Up plain(folder_, "plain", folder_.File("plain.toml"), [] {
    std::vector<std::string> options{"--engine", "inprocess"};
    options.insert(options.end(), GetParam().also.begin(), GetParam().also.end());
    return options;
  }());
  Up up = Start("secured", Path("duration_s = 2.0"), GetParam().options);
  ASSERT_EQ(plain.Wait(), 0) << plain.err();
  ASSERT_EQ(up.Wait(), 0) << up.err();
  EXPECT_TRUE(plain.File("run.mcap") == up.File("run.mcap")) << "run.mcap differs";
  EXPECT_EQ(up.Summary()["wire"]["matches_graph"], true);
  EXPECT_THAT(KeyFiles(), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    By, SecuredRuns,
    testing::Values(Way{"bundles"}, Way{"topics", {"--set", "network.delivery=topics"}},
                    Way{"two in a process", {"--set", "network.agents_per_process=2"}},
                    Way{"UDP", {"--set", "network.transport=udp"}, {"--set", "network.transport=udp"}},
                    Way{"signed bundles", {"--set", "network.protection=sign"}},
                    Way{"encrypted bundles", {"--set", "network.protection=encrypt"}},
                    Way{"encrypted topics",
                        {"--set", "network.protection=encrypt", "--set", "network.delivery=topics"}}),
    [](const auto& row) { return ParamName(row.param.name); });

TEST_F(Secured, AgentsStartAfresh) {
  const std::string experiment = Path("duration_s = 3.0\non_agent_loss = 'restart'\nrestart_after_s = 0.5",
                                      "[[events]]\nat_s = 1.0\nfault = { agent = 2, kind = 'kill' }\n"
                                      "[[events]]\nat_s = 2.0\nfault = { agent = 2, kind = 'kill' }\n");
  WriteFile(folder_.File("plain.toml"), experiment);
  Up plain(folder_, "plain", folder_.File("plain.toml"), {"--engine", "inprocess"});
  Up up = Start("secured", experiment);
  ASSERT_EQ(plain.Wait(), 0) << plain.err();
  ASSERT_EQ(up.Wait(), 0) << up.err();
  EXPECT_TRUE(plain.File("run.mcap") == up.File("run.mcap")) << "run.mcap differs";
  EXPECT_THAT(up.err(), HasSubstr("agent_2 starts afresh at 2.5 s"));
}

// --- strangers ---------------------------------------------------------------------------------------

TEST_F(Secured, AStrangerHearsNothingAndIsNotHeard) {
  for (const std::string delivery : {"bundled", "topics"}) {
    Up up = Start(delivery, Path("duration_s = 3.0\npace = 1.0"), {"--set", "network.delivery=" + delivery});
    ASSERT_TRUE(Until([&] { return up.Said("domain "); }));
    std::atomic<int> heard = 0;
    Domain domain(Intruder(up, "physics_server"), [] {});
    const auto count = [&](const auto&, const auto&) { ++heard; };
    const RawReader states(domain, Topic::State(4), count, kAnyWriter);
    const RawReader bundles(domain, Topic::Bundle({4, 4}), count, kAnyWriter);
    const RawReader rows(domain, Topic::Row(), count, kAnyWriter);
    const RawReader statuses(domain, Topic::Status(), count, kAnyWriter);
    const RawReader experiments(domain, Topic::Experiment(), count);
    Writer<RequestType> requests(domain, Topic::Request());
    mascot_msgs::msg::Request stop;
    stop.kind(static_cast<std::uint8_t>(Ask::kStop));
    ASSERT_TRUE(Until([&] {
      requests.Write(stop);
      return up.IsOver();
    }));
    EXPECT_EQ(up.Wait(), 0) << up.err();
    EXPECT_EQ(heard, 0) << delivery;
    EXPECT_EQ(requests.matched(), 0) << delivery;
    EXPECT_EQ(up.Summary()["ticks"], 300);
  }
}

TEST_F(Secured, AStrangerOfAnotherVendorHearsNothingAndIsNotHeard) {
  const std::string writer = BuildFolder() + "/cyclone_note", reader = BuildFolder() + "/cyclone_rviz";
  if (!std::filesystem::exists(writer)) GTEST_SKIP() << "built without cyclonedds-dev: run scripts/setup --test";
  Up up = Start("run", Path("duration_s = 3.0\npace = 1.0"), {"--set", "network.delivery=topics"});
  ASSERT_TRUE(Until([&] { return up.Said("domain "); }));
  const std::string domain = std::to_string(DomainOf(up));
  const Running speaks(writer, {domain, Topic::Command(2).DdsName()}, folder_.File("speaks"));
  const Running listens(reader, {domain}, folder_.File("listens"));
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(listens.out(), Not(HasSubstr("mascot_msgs"))) << "it has found no writer of the run";
  EXPECT_THAT(listens.out(), HasSubstr("\"type\":\"Note\"")) << "it has found the other stranger";
}

TEST_F(Secured, ALawThatOpensASecondParticipantHearsNothing) {
  Up up = Start("run",
                "[run]\nduration_s = 3.0\npace = 1.0\n[agents]\ncount = 4\nmodel = 'double_integrator'\n[graph]\n"
                "topology = 'path'\n[law]\nname = 'plugin'\nlibrary = '" +
                    BuildFolder() +
                    "/tests/plugins/libeavesdropper.so'\nparams = { topic = 'agent_4/state', type = 'AgentState' }\n",
                {"--set", "network.delivery=topics"});
  EXPECT_EQ(up.Wait(), 0) << up.err();
  const std::string log = up.File("logs/agent_1.log");
  EXPECT_THAT(log, HasSubstr("eavesdropper: reads /agent_4/state"));
  EXPECT_THAT(log, Not(HasSubstr("eavesdropper: hears")));
}

TEST_F(Secured, ForgedDatagramsChangeNoSignedSample) {
  if (geteuid() != 0) GTEST_SKIP() << "packet sockets are not allowed here";
  Up up = Start("run", Path("duration_s = 100000.0\nagent_timeout_s = 2.0"),
                {"--set", "network.protection=sign", "--set", "network.transport=udp"});
  ASSERT_TRUE(Flies(up)) << up.err();
  const Running attacker(SourceFolder() + "/tests/flip_bits.py", {std::to_string(DomainOf(up)), "--seed", "1"},
                         folder_.File("attacker"));
  ASSERT_TRUE(Until([&] { return up.IsOver() || attacker.Said("1000 datagrams forged"); })) << attacker.err();
  up.Signal(SIGINT);  // in case it still flies
  EXPECT_THAT(up.Wait(), testing::AnyOf(1, 130)) << up.err();
  const Ran verified = Shell("'" + BuildFolder() + "/orchestrator' verify '" + up.path().string() + "' 2>&1");
  EXPECT_THAT(verified.output, HasSubstr("the same, bit for bit")) << up.err();
  EXPECT_THAT(KeyFiles(), IsEmpty());
}

// --- certificates ------------------------------------------------------------------------------------

/// A run whose agent 4 is started by hand.
class ByHand : public Secured {
 protected:
  Up StartWaiting(const std::string& run) {
    return Start("run", Path(run),
                 {"--set", "agents.override=[{id = 4, host = \"external\"}]", "--set", "network.delivery=topics",
                  "--set", "law.name=velocity_consensus"});
  }
  /// The file that `up` tells of.
  static std::string CredentialsOf(const Up& up) {
    EXPECT_TRUE(Until([&] { return up.Said("--credentials ") || up.IsOver(); })) << up.err();
    const std::string text = up.err(), words = "--credentials ";
    const auto at = text.find(words) + words.size();
    return text.substr(at, text.find_first_of(" \n", at) - at);
  }
  Running Agent(const Up& up, const std::string& credentials, const std::string& name = "agent",
                const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"--id",          "4",        "--loopback", "--domain", std::to_string(DomainOf(up)),
                                   "--credentials", credentials};
    words.insert(words.end(), more.begin(), more.end());
    return Running(BuildFolder() + "/agent", words, folder_.File(name));
  }
};

TEST_F(ByHand, AnAgentGetsItsCredentialsAsAFile) {
  Up up = StartWaiting("duration_s = 1.0");
  Running agent = Agent(up, CredentialsOf(up));
  EXPECT_EQ(up.Wait(), 0) << up.err() << agent.err();
  EXPECT_EQ(agent.Wait(), 0) << agent.err();
  EXPECT_FALSE(std::filesystem::exists(CredentialsOf(up))) << "they are gone after the run";
}

TEST_F(ByHand, MessagesNeedBundles) {
  Up up = Start("run", Path("duration_s = 1.0"),
                {"--set", "agents.override=[{id = 4, host = \"external\"}]", "--set", "network.delivery=topics"});
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), HasSubstr("network.delivery: expected \"bundled\" or \"auto\" with security = \"graph\", where "
                                  "agents that send messages are on other hosts or started by hand, got \"topics\""));
}

TEST_F(ByHand, AnAgentIsThereOnce) {
  Up up = StartWaiting("duration_s = 100000.0");
  Running first = Agent(up, CredentialsOf(up), "first");
  ASSERT_TRUE(Flies(up)) << up.err() << first.err();
  Running second = Agent(up, CredentialsOf(up), "second");
  EXPECT_EQ(second.Wait(), 2);
  EXPECT_EQ(second.err(),
            "error: --id 4: expected no agent, because the run waits for none, got one that is there already\n");
  EXPECT_FALSE(up.IsOver()) << up.err();
  up.Signal(SIGTERM);
  EXPECT_EQ(up.Wait(), 128 + SIGTERM) << up.err();
}

TEST_F(ByHand, WrongCredentialsAreRefusedInWords) {
  Up up = StartWaiting("duration_s = 100000.0");
  const std::string good = ReadFile(CredentialsOf(up)), copy = folder_.File("copy.toml");
  const auto refusal = [&](const std::string& id, const std::string& text, ::mode_t mode) {
    WriteFile(copy, text);
    ::chmod(copy.c_str(), mode);
    Running agent(BuildFolder() + "/agent",
                  {"--id", id, "--loopback", "--domain", std::to_string(DomainOf(up)), "--credentials", copy},
                  folder_.File("refused"));
    EXPECT_EQ(agent.Wait(), 2);
    return agent.err();
  };
  EXPECT_THAT(refusal("3", good, 0600), HasSubstr("--credentials: expected those of agent_3, got those of agent_4"));
  EXPECT_THAT(refusal("4", good, 0644), HasSubstr("expected a file that only its owner may read (chmod 600)"));
  EXPECT_THAT(refusal("4", "process = 'agent_4'\n", 0600),
              HasSubstr("copy.toml:1:1: certificate: expected a string, got nothing"));
}

TEST_F(ByHand, AnotherAuthorityIsNobody) {
  Up up = StartWaiting("duration_s = 3.0\npace = 1.0");
  const Running agent = Agent(up, CredentialsOf(up));
  const Experiment experiment = LoadExperiment(Section::FromText(up.File("config.toml"), "config.toml"), "path");
  const CertificateAuthority foreign(experiment, DomainOf(up));
  const std::string file = folder_.File("foreign.toml");
  WriteFile(file, ToText(foreign.Issue("agent_3", 1).credentials));
  ::chmod(file.c_str(), 0600);
  const Running thief(BuildFolder() + "/thief",
                      {file, std::to_string(DomainOf(up)), "/agent_2/state", "/agent_4/state", "/clock"},
                      folder_.File("thief"));
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_TRUE(thief.Said("reads /agent_2/state")) << thief.err();
  EXPECT_FALSE(thief.Said("found")) << thief.err();
  EXPECT_FALSE(thief.Said("hears")) << thief.err();
}

TEST_F(ByHand, AStolenCertificateReadsNoMoreThanItsAgentMay) {
  Up up = StartWaiting("duration_s = 100000.0");
  const std::string credentials = CredentialsOf(up);
  const Running agent = Agent(up, credentials);
  ASSERT_TRUE(Flies(up)) << up.err() << agent.err();
  const std::vector<std::string> words{credentials, std::to_string(DomainOf(up)), "/agent_1/state", "/agent_3/state"};
  const Running honest(BuildFolder() + "/thief", words, folder_.File("honest"));
  EXPECT_TRUE(Until([&] { return honest.Said("hears /agent_3/state"); })) << honest.err();
  EXPECT_TRUE(honest.Said("refused: Fast DDS refused to make the reader for /agent_1/state")) << honest.err();
  EXPECT_FALSE(up.IsOver()) << "it reads what agent 4 may: " << up.err();
  up.Signal(SIGTERM);
  EXPECT_EQ(up.Wait(), 128 + SIGTERM) << up.err();
}

TEST_F(ByHand, WhoBypassesTheChecksOfTheLibraryGetsNoSampleAndIsNamed) {
  Up up = StartWaiting("duration_s = 100000.0");
  const std::string credentials = CredentialsOf(up);
  const Running agent = Agent(up, credentials);
  ASSERT_TRUE(Flies(up)) << up.err() << agent.err();
  setenv("LD_PRELOAD", (BuildFolder() + "/tests/preload/libunchecked.so").c_str(), 1);
  const Running thief(BuildFolder() + "/thief",
                      {credentials, std::to_string(DomainOf(up)), "/agent_3/state", "/agent_1/state", "/agent_2/state"},
                      folder_.File("thief"));
  unsetenv("LD_PRELOAD");
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_TRUE(thief.Said("reads /agent_1/state")) << thief.err();
  EXPECT_FALSE(thief.Said("hears /agent_1/state")) << thief.err();
  EXPECT_FALSE(thief.Said("hears /agent_2/state")) << thief.err();
  EXPECT_THAT(up.err(), HasSubstr("the wire differs from the graph: agent_4 (as 'thief') reads /agent_"));
}

// --- laws of users --------------------------------------------------------------------------------------

TEST_F(ByHand, AnAgentMayRefuseToRunCode) {
  Up up = Start("run",
                "[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[graph]\ntopology = "
                "'path'\n[law]\nname = 'custom'\npython = 'def control(t, me, neighbours): return -me.velocity'\n",
                {"--set", "agents.override=[{id = 2, host = \"external\"}]"});
  const std::string credentials = CredentialsOf(up);
  Running agent(
      BuildFolder() + "/agent",
      {"--id", "2", "--loopback", "--domain", std::to_string(DomainOf(up)), "--credentials", credentials, "--no-code"},
      folder_.File("agent"));
  EXPECT_EQ(agent.Wait(), 1);
  EXPECT_THAT(agent.err(), HasSubstr("error: --no-code: agent 2 flies law 'custom', which runs code of the "
                                     "experiment's author"));
  EXPECT_EQ(up.Wait(), 1);
  EXPECT_THAT(up.err(), HasSubstr("--no-code: agent 2 flies law 'custom'"));
}

// --- keys --------------------------------------------------------------------------------------------

TEST_F(Secured, NoKeyIsLeftInAFileWhileTheRunFlies) {
  Up up = Start("run", Path("duration_s = 100000.0"));
  ASSERT_TRUE(Flies(up)) << up.err();
  EXPECT_THAT(KeyFiles(), IsEmpty());
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
}

TEST_F(ByHand, KeysAreGoneAfterAKill) {
  Up up = StartWaiting("duration_s = 100000.0");
  const std::string credentials = CredentialsOf(up);
  EXPECT_THAT(KeyFiles(), testing::Contains(credentials));
  struct stat info {};
  ASSERT_EQ(::stat(std::filesystem::path(credentials).parent_path().c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0700U) << "nobody else may look into the folder";
  up.Signal(SIGKILL);
  EXPECT_TRUE(Until([&] { return KeyFiles().empty(); })) << "the janitor removes them";
}

TEST_F(ByHand, TheNextRunRemovesKeysIfTheJanitorWasKilledToo) {
  Up up = StartWaiting("duration_s = 100000.0");
  const std::string credentials = CredentialsOf(up);
  up.Signal(SIGSTOP);  // or it might see that the janitor has gone
  const pid_t janitor = ChildOf(up.pid(), "janitor");
  ASSERT_GT(janitor, 0);
  SignalTo(janitor, SIGKILL);
  up.Signal(SIGKILL);
  EXPECT_EQ(up.Wait(), -SIGKILL);
  EXPECT_THAT(KeyFiles(), testing::Contains(credentials));
  Up next = Start("next", Path("duration_s = 0.1"));
  EXPECT_EQ(next.Wait(), 0) << next.err();
  EXPECT_THAT(KeyFiles(), IsEmpty());
}

}  // namespace
}  // namespace mascot::test
