// An agent started by hand on another host: two network namespaces connected by a veth pair. Needs root.

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>

#include "experiment/events.h"
#include "orchestrator/recording/indexed_rows.h"
#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Two network namespaces as hosts, 10.77.0.1 (ours) and 10.77.0.2. Their names contain our pid; the destructor removes
/// them.
class TwoHosts {
 public:
  TwoHosts() : here_("mascot-a" + std::to_string(getpid())), there_("mascot-b" + std::to_string(getpid())) {
    for (const std::string& command :
         {"ip netns add " + here_, "ip netns add " + there_,
          "ip -n " + here_ + " link add veth0 type veth peer name veth0 netns " + there_,
          "ip -n " + here_ + " addr add 10.77.0.1/24 dev veth0", "ip -n " + there_ + " addr add 10.77.0.2/24 dev veth0",
          "ip -n " + here_ + " link set veth0 up", "ip -n " + there_ + " link set veth0 up",
          "ip -n " + here_ + " link set lo up", "ip -n " + there_ + " link set lo up",
          "ip -n " + here_ + " route add 239.0.0.0/8 dev veth0",
          "ip -n " + there_ + " route add 239.0.0.0/8 dev veth0"}) {
      const Ran ran = Shell(command);
      if (ran.exit_code != 0 && trouble_.empty()) trouble_ = command + ": " + ran.output;
    }
  }
  ~TwoHosts() {
    Shell("ip netns del " + here_);
    Shell("ip netns del " + there_);
  }
  TwoHosts(const TwoHosts&) = delete;
  TwoHosts& operator=(const TwoHosts&) = delete;

  const std::string& trouble() const { return trouble_; }
  std::vector<std::string> Here(std::vector<std::string> words) const { return In(here_, std::move(words)); }
  std::vector<std::string> There(std::vector<std::string> words) const { return In(there_, std::move(words)); }

 private:
  static std::vector<std::string> In(const std::string& host, std::vector<std::string> words) {
    std::vector<std::string> all{"netns", "exec", host};
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }
  std::string here_, there_, trouble_;
};

class Hosts : public testing::Test {
 protected:
  void SetUp() override {
    const Ran may = Shell("unshare --mount --net true");
    if (may.exit_code != 0) GTEST_SKIP() << "making network namespaces is not allowed here: " << may.output;
    ASSERT_EQ(hosts_.trouble(), "");
  }

  /// Runs `config` with agent `external_id` on the other host, where the file does not exist, and flies the file that
  /// this leaves again in one process. `more`: further arguments. `meanwhile`: called once the agent has been started.
  void FlyTogether(const std::string& config, const std::vector<std::string>& more, int external_id,
                   const std::function<void()>& meanwhile = {}) {
    const std::string& bin = BuildFolder();
    std::vector<std::string> up_words{
        bin + "/orchestrator",
        "up",
        config,
        "--out",
        folder_.File("run"),
        "--set",
        "output.save_plot=false",
        "--set",
        "agents.override=[{ id = " + std::to_string(external_id) + ", host = \"external\" }]"};
    up_words.insert(up_words.end(), more.begin(), more.end());
    Running up("ip", hosts_.Here(up_words), folder_.File("up"));
    ASSERT_TRUE(Until([&] { return up.Said("waiting for: agent --id"); })) << up.err();
    Running agent("ip", hosts_.There(AgentWords(up.err(), external_id)), folder_.File("agent"));
    if (meanwhile) meanwhile();
    EXPECT_EQ(up.Wait(), 0) << up.err() << agent.err() << ReadFile(folder_.File("run/logs/orchestrator.log"));
    EXPECT_EQ(agent.Wait(), 0) << agent.err();

    Up inprocess(folder_, "inprocess", folder_.File("run/config.toml"), {"--engine", "inprocess", "--force"});
    EXPECT_EQ(inprocess.Wait(), 0) << inprocess.err();
    EXPECT_TRUE(inprocess.File("run.mcap") == ReadFile(folder_.File("run/run.mcap"))) << "run.mcap differs";
  }

  /// What starts agent `id` on the other host for a run that has said this.
  static std::vector<std::string> AgentWords(const std::string& said, int id) {
    std::vector<std::string> words{BuildFolder() + "/agent", "--id", std::to_string(id), "--domain",
                                   std::to_string(std::stoi(said.substr(said.find("domain ") + 7)))};
    if (const auto at = said.find("THIS-HOST:"); at != std::string::npos)
      words.insert(words.end(), {"--discovery", "10.77.0.1:" + std::to_string(std::stoi(said.substr(at + 10)))});
    if (const auto at = said.find("--credentials "); at != std::string::npos)
      words.insert(words.end(), {"--peers-at", "10.77.0.1", "--credentials",
                                 said.substr(at + 14, said.find_first_of(" \n", at + 14) - at - 14)});
    return words;
  }

  /// Runs a verb of the orchestrator on our host.
  Ran Orchestrator(const std::vector<std::string>& words) {
    std::string command = "ip";
    for (const std::string& word : hosts_.Here({BuildFolder() + "/orchestrator"})) command += " " + word;
    for (const std::string& word : words) command += " '" + word + "'";
    return Shell(command + " 2>&1");
  }

  /// Asks the run of FlyTogether() for something.
  Ran Send(std::vector<std::string> words) {
    words.insert(words.begin(), {"send", "--run", folder_.File("run")});
    return Orchestrator(words);
  }

  /// The newest tick of that run; -1: none yet.
  std::int64_t TickNow() {
    for (const auto& run : nlohmann::json::parse(Orchestrator({"ps", "--json"}).output))
      if (run["tick"].is_number()) return run["tick"].get<std::int64_t>();
    return -1;
  }

  ScratchFolder folder_;
  TwoHosts hosts_;
};

/// Where the commands of two runs begin to differ: the tick, and the agents whose commands differ at it.
struct Difference {
  std::int64_t tick = -1;  ///< -1: nowhere
  std::vector<int> agents = {};
};

Difference FirstDifference(const std::string& a, const std::string& b) {
  IndexedRows rows_a(a), rows_b(b);
  DecodedRow row_a(rows_a.agents()), row_b(rows_b.agents());
  for (std::int64_t tick = 0; tick < std::min(rows_a.ticks().rows(), rows_b.ticks().rows()); ++tick) {
    rows_a.Read(tick, row_a);
    rows_b.Read(tick, row_b);
    Difference difference{.tick = tick};
    for (std::size_t i = 0; i < row_a.commands.size(); ++i)
      if (row_a.commands[i].a_limited_W != row_b.commands[i].a_limited_W)
        difference.agents.push_back(static_cast<int>(i) + 1);
    if (!difference.agents.empty()) return difference;
  }
  return {};
}

TEST_F(Hosts, AnAgentOnAnotherHostJoinsAndTheRecordingIsTheSame) {
  FlyTogether(Config("leaderless"), {"--duration-s", "1"}, 2);
}

TEST_F(Hosts, AnAgentOnAnotherHostJoinsWithItsCredentials) {
  FlyTogether(Config("event_triggered"), {"--duration-s", "1", "--set", "network.security=graph"}, 2);
}

TEST_F(Hosts, ALawInPythonTravelsToAnotherHostAsTextOrFromAFile) {
  FlyTogether(Config("custom"), {"--duration-s", "1"}, 3);
  WriteFile(folder_.File("law.py"),
            "def control(t, me, neighbours):\n  return sum((0.1 * (j.position - me.position) for j in neighbours))\n"
            "def message(me):\n  return me.position\n");
  WriteFile(folder_.File("from_file.toml"),
            "[run]\nduration_s = 1.0\n[agents]\ncount = 3\n[law]\nname = \"custom\"\nfile = \"law.py\"\n");
  FlyTogether(folder_.File("from_file.toml"), {"--force"}, 2);
}

TEST_F(Hosts, AnAgentOnAnotherHostTakesEventsOfTheFileAndByHand) {
  WriteFile(folder_.File("events.toml"), R"(
[run]
duration_s = 2.0
pace = 1.0
[agents]
count = 3
model = "double_integrator"
random = {}
[graph]
topology = "ring"
[law]
name = "consensus"
leader = 2
[[events]]
at_s = 0.1
agents = [2]
set = { "law.p_gain" = 0.4 }
)");
  FlyTogether(folder_.File("events.toml"), {}, 2, [&] {
    ASSERT_TRUE(Until([&] { return Send({"pause"}).exit_code == 0; })) << Send({"pause"}).output;
    for (const std::vector<std::string>& words : std::initializer_list<std::vector<std::string>>{
             {"goto", "2", "-3", "1", "2"}, {"--agents", "2", "set", "law.beta=2"}, {"cut", "2,1"}, {"step", "20"}}) {
      const Ran ran = Send(words);
      EXPECT_EQ(ran.exit_code, 0) << ran.output;
    }
    EXPECT_EQ(Send({"resume"}).exit_code, 0);
    EXPECT_EQ(Send({"pace", "0"}).exit_code, 0);
  });
  EXPECT_THAT(ReadFile(folder_.File("run/config.toml")),
              AllOf(HasSubstr("goto = { agent = 2, position_m = [-3.0, 1.0, 2.0] }"),
                    HasSubstr("set = { \"law.beta\" = 2"), HasSubstr("cut = [[2, 1]]")));
}

TEST_F(Hosts, AnEventByHandReachesTheAgentOnAnotherHostAloneAndAtItsTick) {
  const std::string file = R"(
[run]
duration_s = 1.0
pace = 1.0
[agents]
count = 3
model = "double_integrator"
position_m = [[0, 0, 1], [1, 0, 2], [0, 2, 3]]
[graph]
topology = "ring"
[law]
name = "consensus"
leader = 2
)";
  WriteFile(folder_.File("file.toml"), file);
  const auto tick_of = [](const Ran& ran) {
    const std::string before = "takes effect at tick ";
    EXPECT_THAT(ran.output, StartsWith(before));
    return ran.output.starts_with(before) ? std::stoll(ran.output.substr(before.size())) : -1;
  };
  std::int64_t sent_there = 0, gain_set = 0;
  FlyTogether(folder_.File("file.toml"), {}, 2, [&] {
    ASSERT_TRUE(Until([&] { return Send({"pause"}).exit_code == 0; })) << Send({"pause"}).output;
    sent_there = tick_of(Send({"goto", "2", "-3", "1", "2"}));
    EXPECT_EQ(Send({"step", "5"}).exit_code, 0);
    EXPECT_TRUE(Until([&] { return TickNow() >= sent_there; }));
    gain_set = tick_of(Send({"--agents", "2", "set", "law.leader_p_gain=3"}));
    EXPECT_EQ(Send({"resume"}).exit_code, 0);
    EXPECT_EQ(Send({"pace", "0"}).exit_code, 0);
  });
  EXPECT_GT(gain_set, sent_there);

  const auto fly = [this](const std::string& name, const std::string& text) {
    WriteFile(folder_.File(name + ".toml"), text);
    Up up(folder_, name, folder_.File(name + ".toml"), {"--engine", "inprocess", "--set", "run.pace=0"});
    EXPECT_EQ(up.Wait(), 0) << up.err();
    return up.path().string();
  };
  const Difference first = FirstDifference(folder_.File("run"), fly("without", file));
  EXPECT_EQ(first.tick, sent_there);
  EXPECT_THAT(first.agents, ElementsAre(2));
  const std::string goto_alone =
      WithEvent(file, sent_there, 100, "goto = { agent = 2, position_m = [-3.0, 1.0, 2.0] }\n");
  const Difference second = FirstDifference(folder_.File("run"), fly("goto_alone", goto_alone));
  EXPECT_EQ(second.tick, gain_set);
  EXPECT_THAT(second.agents, ElementsAre(2));
}

TEST_F(Hosts, ATeamWithAnAgentOnAnotherHostIsSteppedByActions) {
  const std::string file = folder_.File("told.toml"), client = folder_.File("client.py");
  WriteFile(file, R"(
[run]
duration_s = 0.3
[agents]
count = 3
model = "double_integrator"
random = {}
override = [{ id = 2, host = "external" }]
[graph]
topology = "ring"
[law]
name = "actions"
message = 1
)");
  WriteFile(client, R"(
import json, socket, sys
lines = socket.create_connection(("127.0.0.1", int(sys.argv[1])), timeout=60).makefile("rw")
def ask(request, **fields):
    print(json.dumps({"request": request, **fields}), file=lines, flush=True)
    print(lines.readline(), end="")
ask("hello", protocol=1)
for k in range(6):
    ask("step", ticks=5, actions=[[0.1 * k, 0, 0, 1], [0, 0.2 * k, 0, 2], None])
)");
  const auto serve = [&](const std::string& engine) {
    return hosts_.Here(
        {BuildFolder() + "/orchestrator", "serve", file, "--at", "127.0.0.1:0", "--once", "--engine", engine});
  };
  const auto told = [&](const std::string& engine, const std::function<void(const Running&)>& meanwhile) {
    Running server("ip", serve(engine), folder_.File(engine));
    const std::string port = std::to_string(std::stoi(RestOfLine(server, "stepped at 127.0.0.1:")));
    Running asks("ip", hosts_.Here({"/usr/bin/python3", client, port}), folder_.File("asks"));
    meanwhile(server);
    EXPECT_EQ(asks.Wait(), 0) << asks.err() << server.err();
    const std::string answers = asks.out();
    EXPECT_EQ(server.Wait(), 0) << server.err();
    return answers.substr(answers.find('\n'));  // without hello, which names the engine
  };
  std::optional<Running> agent;
  const std::string over_dds = told("dds", [&](const Running& server) {
    ASSERT_TRUE(Until([&] { return server.Said("waiting for: agent --id"); })) << server.err();
    agent.emplace("ip", hosts_.There(AgentWords(server.err(), 2)), folder_.File("agent"));
  });
  ASSERT_TRUE(agent);
  EXPECT_EQ(agent->Wait(), 0) << agent->err();
  EXPECT_THAT(over_dds, HasSubstr("\"tick\":30"));
  EXPECT_EQ(over_dds, told("inprocess", [](const Running&) {}));
}

TEST_F(Hosts, AnAgentOnAnotherHostJoinsThroughTheDiscoveryServer) {
  FlyTogether(
      Config("leaderless"),
      {"--duration-s", "0.2", "--set", "agents.count=20", "--set", "agents.random={}", "--set", "graph.topology=ring"},
      7);
}

}  // namespace
}  // namespace mascot::test
