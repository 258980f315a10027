// Runs whose agents are on other hosts (`[[hosts]]`): network namespaces, each with an sshd, an address and a /dev/shm
// of its own. Needs root.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <functional>
#include <memory>

#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kHosts = 3;

/// A link between hosts.
struct Cable {
  double delay_ms = 0, loss = 0;
};

/// Our own namespace, 10.79.0.1, and lab1, lab2, ..., 10.79.0.11, ..., connected by a switch of ours. The names of
/// namespaces contain our pid; the destructor removes them, and what runs in them.
class Laboratory {
 public:
  Laboratory(const ScratchFolder& folder, const Cable& cable) : folder_(folder) {
    Do("ip netns add " + Name(0));
    Do("ip -n " + Name(0) + " link add switch type bridge");
    Do("ip -n " + Name(0) + " link set switch up");
    Do("ip -n " + Name(0) + " link set lo up");
    Do("ip -n " + Name(0) + " addr add 10.79.0.1/24 dev switch");
    Do("ssh-keygen -q -t ed25519 -N '' -f " + folder.File("key"));
    Do("ssh-keygen -q -t ed25519 -N '' -f " + folder.File("host_key"));
    WriteFile(folder.File("ssh"),
              "UserKnownHostsFile /dev/null\nStrictHostKeyChecking no\nLogLevel ERROR\nIdentityFile " +
                  folder.File("key") + "\n");
    for (int host = 1; host <= kHosts; ++host) Add(host, cable);
  }
  ~Laboratory() {
    for (int host = 0; host <= kHosts; ++host) {
      Shell("ip netns pids " + Name(host) + " | xargs -r kill -9");
      Shell("ip netns del " + Name(host));
    }
  }
  Laboratory(const Laboratory&) = delete;
  Laboratory& operator=(const Laboratory&) = delete;

  const std::string& trouble() const { return trouble_; }
  /// Words that run what follows them here, where `up` is.
  std::vector<std::string> Here() const { return {"netns", "exec", Name(0)}; }
  /// `[[hosts]]` for agents: the first of each host, then the last of the last one.
  std::string Tables(const std::vector<std::string>& agents) const {
    std::string text;
    for (std::size_t k = 0; k < agents.size(); ++k)
      text += fmt::format("[[hosts]]\nname = 'lab{0}'\nagents = '{1}'\nlaunch = ['ssh', '-F', '{2}', '10.79.0.1{0}']\n",
                          k + 1, agents[k], folder_.File("ssh"));
    return text;
  }
  /// The namespace of a host; 0: ours.
  static std::string Name(int host) { return fmt::format("mascot-lab{}-{}", host, getpid()); }
  void Cut(int host) const { Shell("ip -n " + Name(0) + " link set port" + std::to_string(host) + " down"); }
  /// Process ids of programs of ours on a host whose command line contains `words`.
  std::vector<pid_t> On(int host, const std::string& words) const {
    std::istringstream pids(Shell("ip netns pids " + Name(host)).output);
    std::vector<pid_t> found;
    for (pid_t pid; pids >> pid;)
      if (Replaced(ReadFile("/proc/" + std::to_string(pid) + "/cmdline")).find(words) != std::string::npos)
        found.push_back(pid);
    return found;
  }
  /// Files in the shared memory of a host.
  std::string SharedMemory(int host) const {
    return Shell("nsenter --mount --target " + std::to_string(servers_[static_cast<std::size_t>(host) - 1]->pid()) +
                 " ls /dev/shm")
        .output;
  }

 private:
  static std::string Replaced(std::string command) {
    std::ranges::replace(command, '\0', ' ');
    return command;
  }
  void Do(const std::string& command) {
    const Ran ran = Shell(command);
    if (ran.exit_code != 0 && trouble_.empty()) trouble_ = command + ": " + ran.output;
  }
  void Add(int host, const Cable& cable) {
    const std::string port = "port" + std::to_string(host);
    Do("ip netns add " + Name(host));
    if (cable.delay_ms > 0 || cable.loss > 0) {
      cables_.push_back(std::make_unique<Piped>(fmt::format("exec {}/tests/slow_link.py {} {} {} {} {}", SourceFolder(),
                                                            port, cable.delay_ms, cable.loss, Name(0), Name(host))));
      if (cables_.back()->Line() != "ready") trouble_ = "slow_link.py does not work";
      Do("ip -n " + Name(host) + " link set " + port + " name eth0");
    } else {
      Do("ip -n " + Name(0) + " link add " + port + " type veth peer name eth0 netns " + Name(host));
    }
    Do("ip -n " + Name(0) + " link set " + port + " master switch up");
    Do(fmt::format("ip -n {} addr add 10.79.0.1{}/24 dev eth0", Name(host), host));
    Do("ip -n " + Name(host) + " link set eth0 up");
    Do("ip -n " + Name(host) + " link set lo up");
    const std::string config = folder_.File("sshd" + std::to_string(host));
    WriteFile(config, fmt::format("ListenAddress 10.79.0.1{0}\nHostKey {1}/host_key\nAuthorizedKeysFile {1}/key.pub\n"
                                  "PidFile none\nUsePAM no\nStrictModes no\nPermitRootLogin yes\n",
                                  host, folder_.path().string()));
    servers_.push_back(std::make_unique<Running>(
        "ip",
        std::vector<std::string>{"netns", "exec", Name(host), "unshare", "--mount", "sh", "-c",
                                 "mount -t tmpfs none /dev/shm && mount -t tmpfs none /run && mkdir /run/sshd && exec "
                                 "/usr/sbin/sshd -D -e -f " +
                                     config},
        folder_.File("server" + std::to_string(host))));
    if (!Until([&] { return servers_.back()->Said("listening") || servers_.back()->IsOver(); }) ||
        servers_.back()->IsOver())
      trouble_ = servers_.back()->err();
  }

  /// A program whose standard input we keep open, and read what it prints.
  class Piped {
   public:
    explicit Piped(const std::string& command) : command_(command) {
      int in[2], out[2];
      if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0) return;
      std::vector<std::string> words{"sh", "-c", command};
      std::vector<char*> argv;
      for (std::string& word : words) argv.push_back(word.data());
      argv.push_back(nullptr);
      posix_spawn_file_actions_t files;
      posix_spawn_file_actions_init(&files);
      posix_spawn_file_actions_adddup2(&files, in[0], 0);
      posix_spawn_file_actions_adddup2(&files, out[1], 1);
      if (posix_spawnp(&pid_, "sh", &files, nullptr, argv.data(), environ) != 0) pid_ = -1;
      posix_spawn_file_actions_destroy(&files);
      close(in[0]);
      close(out[1]);
      input_ = in[1];
      output_ = out[0];
    }
    ~Piped() {
      close(input_);
      close(output_);
      if (pid_ > 0) AwaitEndOf(pid_, "the end of: " + command_);
    }
    Piped(const Piped&) = delete;
    Piped& operator=(const Piped&) = delete;
    std::string Line() const {
      std::string line;
      char byte = 0;
      while (AwaitInput(output_, "a line of: " + command_) && read(output_, &byte, 1) == 1 && byte != '\n')
        line += byte;
      return line;
    }

   private:
    pid_t pid_ = -1;
    int input_ = -1, output_ = -1;
    std::string command_;
  };

  const ScratchFolder& folder_;
  std::string trouble_;
  std::vector<std::unique_ptr<Piped>> cables_;
  std::vector<std::unique_ptr<Running>> servers_;
};

class OnOtherHosts : public testing::Test {
 protected:
  void SetUp() override {
    const Ran may = Shell("unshare --mount --net true");
    if (may.exit_code != 0) GTEST_SKIP() << "making network namespaces is not allowed here: " << may.output;
  }
  /// Connects the hosts.
  void Connect(const Cable& cable = {}) {
    laboratory_.emplace(folder_, cable);
    ASSERT_EQ(laboratory_->trouble(), "");
  }
  /// Writes an experiment of `count` agents for `duration_s`, with these tables behind it.
  std::string Experiment(int count, double duration_s, const std::string& tables) const {
    WriteFile(
        folder_.File("team.toml"),
        fmt::format("[run]\nduration_s = {}\nagent_timeout_s = 5.0\n[agents]\ncount = {}\nrandom = {{}}\n[graph]\n"
                    "topology = 'ring'\n[law]\nname = 'consensus'\np_gain = 0.2\n",
                    duration_s, count) +
            tables);
    return folder_.File("team.toml");
  }
  std::unique_ptr<Running> Fly(const std::string& config, const std::vector<std::string>& more = {}) const {
    const std::string program = BuildFolder() + "/orchestrator";
    std::vector<std::string> words = laboratory_->Here();
    words.insert(words.end(),
                 {program, "up", config, "--out", folder_.File("run"), "--force", "--set", "output.save_plot=false"});
    words.insert(words.end(), more.begin(), more.end());
    return std::make_unique<Running>("ip", words, folder_.File("up"));
  }
  /// A run of agents 1 to 6, of which 1, 2 are on lab1 and 3, 4 on lab2, once it flies.
  std::unique_ptr<Running> FlyForLong(const std::string& on_agent_loss = "abort") {
    Connect();
    auto up = Fly(Experiment(6, 600, laboratory_->Tables({"1-2", "3-4"})),
                  {"--set", "run.pace=1", "--set", "run.on_agent_loss=" + on_agent_loss});
    EXPECT_TRUE(Flies(*up)) << up->err();
    return up;
  }
  /// Expects the recording to be that of one host, and of one process.
  void ExpectTheSameBytes() const {
    Up one(folder_, "one", folder_.File("run/config.toml"), {"--engine", "inprocess", "--force"});
    EXPECT_EQ(one.Wait(), 0) << one.err();
    EXPECT_TRUE(one.File("run.mcap") == ReadFile(folder_.File("run/run.mcap"))) << "run.mcap differs";
  }
  /// Expects that nothing of the run is on any host.
  void ExpectNothingIsLeft() const {
    for (int host = 1; host <= kHosts; ++host) {
      EXPECT_TRUE(Until([&] { return laboratory_->On(host, BuildFolder()).empty(); })) << "on lab" << host;
      EXPECT_TRUE(Until([&] { return laboratory_->SharedMemory(host).empty(); })) << laboratory_->SharedMemory(host);
    }
  }

  ScratchFolder folder_;
  std::optional<Laboratory> laboratory_;
};

TEST(Host, GreetsWhateverItsEnvironmentHolds) {
  const Ran ran = Shell("SSH_CONNECTION=\"$(printf '\\377')\" '" + BuildFolder() + "/orchestrator' host");
  EXPECT_THAT(ran.output, HasSubstr("{\"kind\":\"hello\",")) << "and then the end of its input";
  EXPECT_THAT(ran.output, HasSubstr("\"seen_from\":\"\uFFFD\""));
}

TEST_F(OnOtherHosts, ThirtyAgentsLeaveTheRecordingOfOneHost) {
  Connect();
  const std::string config = Experiment(30, 1, laboratory_->Tables({"1-10", "11-15,21", "16-20,22-26"}));
  const auto up = Fly(config, {"--view", "127.0.0.1:0"});
  ASSERT_EQ(up->Wait(), 0) << up->err();
  EXPECT_THAT(up->err(), AllOf(HasSubstr("[agent_3@lab1] hears 2 4"), HasSubstr("[agent_21@lab2] hears 20 22"),
                               HasSubstr("[agent_27] hears 26 28")));
  EXPECT_EQ(ReadFile(folder_.File("run/logs/agent_21.log")), "hears 20 22\n");
  EXPECT_THAT(ReadFile(folder_.File("run/config.toml")), HasSubstr("agents = \"11-15,21\""));
  ExpectTheSameBytes();
  ExpectNothingIsLeft();
}

TEST_F(OnOtherHosts, GetTheirCredentialsOverTheirConnections) {
  Connect();
  const std::string config = Experiment(30, 1, laboratory_->Tables({"1-10", "11-15,21", "16-20,22-26"}));
  const auto up = Fly(config, {"--set", "network.security=graph", "--set", "network.protection=encrypt"});
  ASSERT_EQ(up->Wait(), 0) << up->err();
  ExpectTheSameBytes();
  ExpectNothingIsLeft();
}

TEST_F(OnOtherHosts, MayAllBeThisOne) {
  const std::string config = Experiment(4, 0.5,
                                        "[[hosts]]\nname = 'lab1'\nagents = '1-2'\nlaunch = ['env']\naddress = "
                                        "'127.0.0.1'\n");
  Up up(folder_, "run", config, {"--force"});
  ASSERT_EQ(up.Wait(), 0) << up.err();
  ExpectTheSameBytes();
}

TEST_F(OnOtherHosts, ShareProcessesAndSayWhatTheyHear) {
  Connect();
  const std::string config = Experiment(9, 0.5, laboratory_->Tables({"2-4", "5-8"}));
  const auto up = Fly(config, {"--set", "network.agents_per_process=3"});
  ASSERT_EQ(up->Wait(), 0) << up->err();
  for (const char* process : {"agent_1", "agents_2-4", "agents_5-7", "agent_8", "agent_9"})
    EXPECT_TRUE(std::filesystem::exists(folder_.File("run/logs/" + std::string(process) + ".log"))) << process;
  ExpectTheSameBytes();
}

TEST_F(OnOtherHosts, ALinkThatDelaysAndLosesChangesNoByte) {
  Connect({.delay_ms = 20, .loss = 0.01});
  const std::string config = Experiment(30, 0.3, laboratory_->Tables({"1-10", "11-20", "21-30"}));
  const auto up = Fly(config, {"--set", "run.agent_timeout_s=20"});
  ASSERT_EQ(up->Wait(), 0) << up->err();
  ExpectTheSameBytes();
}

TEST_F(OnOtherHosts, EventsByHandReachThem) {
  Connect();
  const std::string config = Experiment(6, 3, laboratory_->Tables({"1-2", "3-4"}));
  const auto up = Fly(config, {"--set", "run.pace=2"});
  ASSERT_TRUE(Flies(*up)) << up->err();
  const auto send = [&](const std::string& words) {
    return Shell("ip netns exec " + laboratory_->Here().back() + " " + BuildFolder() + "/orchestrator send --run " +
                 folder_.File("run") + " " + words);
  };
  EXPECT_EQ(send("--agents 3 set law.p_gain=0.4").exit_code, 0);
  EXPECT_EQ(send("pace 0").exit_code, 0);
  ASSERT_EQ(up->Wait(), 0) << up->err();
  ExpectTheSameBytes();
}

TEST_F(OnOtherHosts, AVehicleIsFlownFromTheHostOfItsAgent) {
  Connect();
  std::vector<std::string> on_lab1{"netns", "exec", Laboratory::Name(1), BuildFolder() + "/fake_px4"};
  on_lab1.insert(on_lab1.end(), {"--namespace", "px4_1", "--system-id", "2", "--domain", "100"});
  Running px4("ip", on_lab1, folder_.File("px4"));
  WriteFile(folder_.File("team.toml"),
            "[run]\nmode = 'realtime'\nduration_s = 3.0\nagent_timeout_s = 5.0\n[agents]\ncount = 2\n"
            "model = 'double_integrator'\nposition_m = [[0.0, 0.0, 0.8], [4.0, 0.0, 0.8]]\n[law]\nname = 'consensus'\n"
            "p_gain = 0.05\n[[vehicles]]\nagents = [1]\nkind = 'px4'\ndomain = 100\naddress = '127.0.0.1'\n" +
                laboratory_->Tables({"1"}));
  const auto up = Fly(folder_.File("team.toml"), {"--go"});
  ASSERT_EQ(up->Wait(), 0) << up->err();
  EXPECT_THAT(up->err(), AllOf(HasSubstr("vehicle 1: flying"), HasSubstr("vehicle 1: landed")));
  px4.Signal(SIGTERM);
  EXPECT_EQ(px4.Wait(), 0) << px4.err();
  ExpectNothingIsLeft();
}

TEST_F(OnOtherHosts, AHostThatDiesEndsTheRunAndIsNamed) {
  const auto up = FlyForLong();
  for (const pid_t pid : laboratory_->On(2, "orchestrator host")) SignalTo(pid, SIGKILL);
  EXPECT_EQ(up->Wait(), 1);
  EXPECT_THAT(up->err(), HasSubstr("host_lab2"));
  ExpectNothingIsLeft();
}

TEST_F(OnOtherHosts, AnAgentThatDiesThereIsNamedWithItsHost) {
  const auto up = FlyForLong();
  const auto agents = laboratory_->On(2, "agent --id");
  ASSERT_FALSE(agents.empty());
  SignalTo(agents.front(), SIGKILL);
  EXPECT_EQ(up->Wait(), 1);
  EXPECT_THAT(up->err(), HasSubstr("was killed by signal 9 (Killed) on lab2"));
  ExpectNothingIsLeft();
}

TEST_F(OnOtherHosts, ACutLinkEndsTheRunOnBothOfItsEnds) {
  const auto up = FlyForLong();
  laboratory_->Cut(2);
  EXPECT_EQ(up->Wait(), 1);
  EXPECT_THAT(up->err(), HasSubstr("host lab2 has not been heard of for 3 s"));
  ExpectNothingIsLeft();
}

/// A host is gone: the run goes on without its agents.
class HostsThatAreGone : public OnOtherHosts, public testing::WithParamInterface<bool> {};

TEST_P(HostsThatAreGone, AreLossesOfTheirAgentsThatFlyAgain) {
  const bool is_cut = GetParam();
  const auto up = FlyForLong("hold");
  if (is_cut)
    laboratory_->Cut(2);
  else
    for (const pid_t pid : laboratory_->On(2, "orchestrator host")) SignalTo(pid, SIGKILL);
  ASSERT_TRUE(Until([&] { return up->IsOver() || CountOf("lost: agent", up->err()) == 2; })) << up->err();
  for (const std::string agent : {"agent_3", "agent_4"})
    EXPECT_THAT(up->err(), HasSubstr("lost: " + agent + " was on host lab2, " +
                                     (is_cut ? "which has not been heard of for 3 s" : "the connection to which ")));
  for (const pid_t pid : laboratory_->On(0, "orchestrator up")) SignalTo(pid, SIGINT);
  EXPECT_EQ(up->Wait(), 130) << up->err();
  EXPECT_EQ(CountOf("kind = \"kill\"", ReadFile(folder_.File("run/config.toml"))), 2);
  const Ran verified = Shell("'" + BuildFolder() + "/orchestrator' verify '" + folder_.File("run") + "' 2>&1");
  EXPECT_THAT(verified.output, HasSubstr("the same, bit for bit"));
  ExpectNothingIsLeft();
}

INSTANTIATE_TEST_SUITE_P(By, HostsThatAreGone, testing::Bool(),
                         [](const auto& row) { return row.param ? "ACutLink" : "ADeadProgram"; });

TEST_F(OnOtherHosts, NothingIsLeftOfAnOrchestratorThatIsKilled) {
  const auto up = FlyForLong();
  for (const pid_t pid : laboratory_->On(0, "orchestrator up")) SignalTo(pid, SIGKILL);
  up->Wait();
  ExpectNothingIsLeft();
}

TEST_F(OnOtherHosts, CtrlCEndsThemInOrder) {
  const auto up = FlyForLong();
  for (const pid_t pid : laboratory_->On(0, "orchestrator up")) SignalTo(pid, SIGINT);
  EXPECT_EQ(up->Wait(), 130);
  ExpectNothingIsLeft();
}

TEST_F(OnOtherHosts, NeedTheirAddressWhereNeitherSshNorTheirNameTellsIt) {
  Connect();
  const std::string tables = fmt::format(
      "[[hosts]]\nname = 'lab1'\nagents = '2'\nlaunch = ['ip', 'netns', 'exec', '{}']\n", laboratory_->Name(1));
  const auto without = Fly(Experiment(3, 0.5, tables));
  EXPECT_EQ(without->Wait(), 1);
  EXPECT_THAT(without->err(), HasSubstr("host lab1: expected hosts.address, because neither its launch command nor its "
                                        "name tells by which address it reaches this host"));
  const std::string config = Experiment(3, 0.5, tables + "address = '10.79.0.11'\n");
  const auto up = Fly(config);
  ASSERT_EQ(up->Wait(), 0) << up->err();
  ExpectTheSameBytes();
}

TEST_F(OnOtherHosts, NeedTheirAddressBehindAJumpHost) {
  Connect();
  const std::string tables = fmt::format(
      "[[hosts]]\nname = 'lab1'\nagents = '2'\nlaunch = ['ssh', '-F', '{}', '-J', '10.79.0.12', '10.79.0.11']\n",
      folder_.File("ssh"));
  const auto without = Fly(Experiment(3, 0.5, tables));
  EXPECT_EQ(without->Wait(), 1);
  EXPECT_THAT(without->err(), HasSubstr("host lab1: expected hosts.address"));
  const auto up = Fly(Experiment(3, 0.5, tables + "address = '10.79.0.11'\n"));
  ASSERT_EQ(up->Wait(), 0) << up->err();
  ExpectTheSameBytes();
}

TEST_F(OnOtherHosts, HaveAllThatTheirAgentsPrintedInTheLogs) {
  Connect();
  WriteFile(folder_.File("talkative.py"),
            "def control(t, me, neighbours):\n  print((str(t) + 80 * 'x' + chr(10)) * 300)\n  return (0, 0, 0)\n");
  WriteFile(folder_.File("team.toml"),
            "[run]\nduration_s = 0.5\n[agents]\ncount = 3\nrandom = {}\n[graph]\ntopology = 'ring'\n[law]\nname = "
            "'custom'\nfile = 'talkative.py'\n" +
                laboratory_->Tables({"2", "3"}));
  const auto up = Fly(folder_.File("team.toml"), {"--quiet"});
  ASSERT_EQ(up->Wait(), 0) << up->err();
  const auto lines = [&](int agent) {
    const std::string log = ReadFile(folder_.File(fmt::format("run/logs/agent_{}.log", agent)));
    return std::ranges::count(log, '\n');
  };
  EXPECT_GT(lines(1), 50 * 300);
  EXPECT_EQ(lines(2), lines(1));
  EXPECT_EQ(lines(3), lines(1));
}

/// Passes on what a host tells until it has begun to print much, and then waits until the law, which has printed all of
/// that, opens the other end of a named pipe.
constexpr const char* kSlowReader = R"(
import shutil, subprocess, sys
host = subprocess.Popen(sys.argv[2:], stdout=subprocess.PIPE)
for line in host.stdout:
  sys.stdout.buffer.write(line)
  sys.stdout.buffer.flush()
  if b'much begins' in line: break
open(sys.argv[1]).close()
shutil.copyfileobj(host.stdout, sys.stdout.buffer)
)";

TEST_F(OnOtherHosts, SayWhereLinesAreMissingBecauseTheConnectionIsTooSlow) {
  WriteFile(folder_.File("slow_reader.py"), kSlowReader);
  ASSERT_EQ(mkfifo(folder_.File("printed").c_str(), 0600), 0);
  WriteFile(folder_.File("talkative.py"), fmt::format(R"(
ticks = 0
def control(t, me, neighbours):
  global ticks
  ticks += me.id == 1
  if me.id == 1 and ticks <= 20: print('much begins' if ticks == 1 else 400 * (3000 * 'x' + chr(10)))
  if me.id == 1 and ticks == 21: open('{}', 'w').close()
  return (0, 0, 0)
)",
                                                      folder_.File("printed")));
  WriteFile(folder_.File("team.toml"),
            fmt::format("[run]\nduration_s = 0.3\nagent_timeout_s = 60.0\n[agents]\ncount = 2\nrandom = {{}}\n"
                        "[graph]\ntopology = 'ring'\n[law]\nname = 'custom'\nfile = 'talkative.py'\n[[hosts]]\n"
                        "name = 'lab1'\nagents = '1'\naddress = '127.0.0.1'\nlaunch = ['python3', '{}', '{}']\n"
                        "[output]\nfidelity = false\n",
                        folder_.File("slow_reader.py"), folder_.File("printed")));
  Up up(folder_, "run", folder_.File("team.toml"), {"--force", "--quiet"});
  ASSERT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.File("logs/agent_1.log"),
              HasSubstr("\norchestrator: lines are missing here, because `up` did not read them in time\n"));
}

TEST_F(OnOtherHosts, AreWarnedOfIfTheyDoNotEnd) {
  const std::string config = Experiment(2, 0.5,
                                        "[[hosts]]\nname = 'lab1'\nagents = '1'\naddress = '127.0.0.1'\nlaunch = "
                                        "['sh', '-c', '\"$@\"; sleep 1000', 'sh', 'env']\n");
  Up up(folder_, "run", config, {"--force"});
  EXPECT_EQ(up.Wait(), 0);
  EXPECT_THAT(up.err(), HasSubstr("warning: a host has not ended by itself; what its agents printed last may be "
                                  "missing in the logs"));
}

TEST(HostsPage, HasAnExperimentThatIsOne) {
  const ScratchFolder folder;
  const std::string page = ReadFile(SourceFolder() + "/docs/hosts.md"), begin = "```toml\n";
  const auto at = page.find(begin) + begin.size();
  WriteFile(folder.File("thirty.toml"), page.substr(at, page.find("```", at) - at));
  const Ran ran = Shell("'" + BuildFolder() + "/orchestrator' check " + folder.File("thirty.toml"));
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
}

TEST(Slurm, IsExpectedAroundARunOnItsNodes) {
  const ScratchFolder folder;
  WriteFile(folder.File("two.toml"), "[run]\nduration_s = 1.0\n[agents]\ncount = 2\n[law]\nname = 'consensus'\n");
  const auto refusal = [&](const std::string& words) {
    const Ran ran = Shell("env -u SLURM_JOB_ID '" + BuildFolder() + "/orchestrator' up " + folder.File("two.toml") +
                          " --slurm --out " + folder.File("run") + " " + words);
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(folder.File("run")));
    return ran.output;
  };
  EXPECT_EQ(refusal(""),
            "error: --slurm: expected a Slurm allocation (sbatch, salloc) around this command, got none\n");
  EXPECT_EQ(refusal("--engine inprocess"), "error: --slurm: expected --engine dds, got inprocess\n");
  EXPECT_EQ(refusal("--set 'hosts=[{name=\"lab1\", agents=\"1\"}]'"),
            "error: --slurm: expected a file without hosts, because the job's nodes are the hosts\n");
}

TEST(Slurm, WhatScontrolTellsIsReadAsNamesOfNodes) {
  const ScratchFolder folder;
  WriteFile(folder.File("two.toml"), "[run]\nduration_s = 1.0\n[agents]\ncount = 2\n[law]\nname = 'consensus'\n");
  const auto told = [&](const std::string& script) {
    WriteFile(folder.File("scontrol"), "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(folder.File("scontrol"), std::filesystem::perms::owner_all);
    const Ran ran =
        Shell("env SLURM_JOB_ID=1 SLURM_JOB_NODELIST=n PATH=" + folder.path().string() + ":$PATH '" + BuildFolder() +
              "/orchestrator' up " + folder.File("two.toml") + " --slurm --out " + folder.File("run"));
    EXPECT_EQ(ran.exit_code, 1) << script;
    EXPECT_FALSE(std::filesystem::exists(folder.File("run")));
    return ran.output;
  };
  const std::string expected = "error: scontrol: expected the name of each node of this job once, got ";
  EXPECT_EQ(told("echo n1; echo n1"), expected + "'n1' again\n");
  EXPECT_EQ(told("printf \"n1', launch = ['sh\""), expected + "'n1','\n");
  EXPECT_EQ(told("printf 'n\\033[31m1'"), expected + "'n\\u001b[31m1'\n");
  EXPECT_EQ(told("head -c 300 /dev/zero | tr '\\0' n"), expected + "'" + std::string(255, 'n') + "...'\n");
  for (const char* silent : {"true", "exit 1", "yes n | head -c 20000000 | tr -d '\\n'"})
    EXPECT_THAT(told(silent), HasSubstr("error: scontrol")) << silent;
}

TEST_F(OnOtherHosts, RefuseWhatIsNotTheSameProgram) {
  Connect();
  const auto launch = [&](const std::string& words) {
    const auto up = Fly(Experiment(2, 1, "[[hosts]]\nname = 'lab1'\nagents = '2'\n" + words));
    EXPECT_EQ(up->Wait(), 1) << words;
    return up->err();
  };
  EXPECT_THAT(launch("launch = ['sh', '-c', 'echo welcome; sleep 100']\n"),
              HasSubstr("host lab1: expected the words of `orchestrator host`, got 'welcome' (does its login print "
                        "something?)"));
  WriteFile(folder_.File("older"),
            "#!/bin/sh\necho '{\"kind\": \"hello\", \"build\": \"0.0.1, build 7\", \"machine\": "
            "\"\", \"seen_from\": \"\"}'\nsleep 100\n");
  std::filesystem::permissions(folder_.File("older"), std::filesystem::perms::owner_all);
  EXPECT_THAT(launch("launch = ['env']\nprogram = '" + folder_.File("older") + "'\n"),
              HasSubstr("host lab1 has another build of MASCOT: 0.0.1, build 7, expected "));
  WriteFile(folder_.File("on_arm"),
            "#!/bin/sh\necho '{\"kind\": \"hello\", \"build\": \"0.0.1, build 7\", \"sources\": \"7\", \"processor\": "
            "\"aarch64\", \"machine\": \"\", \"seen_from\": \"\"}'\nsleep 100\n");
  std::filesystem::permissions(folder_.File("on_arm"), std::filesystem::perms::owner_all);
  EXPECT_THAT(launch("launch = ['env']\nprogram = '" + folder_.File("on_arm") + "'\n"),
              HasSubstr("host lab1 (aarch64) was built from other sources: MASCOT 0.0.1, sources 7; expected MASCOT "));
  EXPECT_THAT(launch("launch = ['false']\n"), HasSubstr("host_lab1 exited with code 1"));
  EXPECT_THAT(launch("launch = ['" + folder_.File("nowhere") + "']\n"),
              HasSubstr("cannot start " + folder_.File("nowhere")));
}

TEST_F(OnOtherHosts, AreNamedWhenTheySayWhatNoHostSays) {
  Connect();
  const auto says = [&](const std::string& script) {
    WriteFile(folder_.File("script"), "#!/bin/sh\n" + script);
    std::filesystem::permissions(folder_.File("script"), std::filesystem::perms::owner_all);
    const auto up = Fly(Experiment(2, 600,
                                   "[[hosts]]\nname = 'lab1'\nagents = '2'\nlaunch = ['" + folder_.File("script") +
                                       "']\naddress = '10.79.0.1'\n"),
                        {"--set", "run.start_timeout_s=10"});
    EXPECT_EQ(up->Wait(), 1) << script;
    return up->err();
  };
  EXPECT_THAT(says("printf 'caf\\351\\n'; sleep 100\n"),
              HasSubstr("got 'caf\uFFFD' (does its login print something?)"));
  EXPECT_THAT(says("tr -d '\\n' < /dev/zero\n"), HasSubstr("error: host_lab1: a line of a pipe is too long"));
  EXPECT_THAT(says("exec yes '{\"kind\": \"alive\"}'\n"),
              HasSubstr("error: host lab1: expected its greeting first, and once, got 'alive'"));
  EXPECT_THAT(says("exec \"$@\" | sed --unbuffered 's/agent_2/agent_77/'\n"),
              HasSubstr("error: host lab1: expected words of its own processes, got agent_77"));
  const auto alters = [&](const std::string& sed) { return says("exec \"$@\" | sed --unbuffered '" + sed + "'\n"); };
  EXPECT_THAT(alters("s/\"pid\":[0-9]*/\"pid\":\"many\"/"),
              HasSubstr("error: host lab1: expected an integer in [1, 4194304] as \"pid\", got \"many\""));
  EXPECT_THAT(alters("s/\"pid\":[0-9]*/\"pid\":1e300/"), HasSubstr("as \"pid\", got 1e+300"));
  EXPECT_THAT(alters("/\"started\"/p"),
              HasSubstr("error: host lab1: expected \"started\" of agent_2 once, got it again"));
  EXPECT_THAT(alters("s/\"started\"/\"exit\",\"status\":4991/"),
              HasSubstr("error: host lab1: expected how agent_2 has ended as \"status\", got 4991"));
  EXPECT_THAT(alters("s/\"started\"/\"begun\"/"),
              HasSubstr("error: host lab1: expected the words of `orchestrator host`, got 'begun'"));
  EXPECT_THAT(alters("s/\"machine\":\"[^\"]*\"/\"machine\":null/"),
              HasSubstr("error: host lab1: expected a text of at most 10000 bytes as \"machine\", got null"));
  EXPECT_THAT(says("exec >&-; sleep 100\n"), HasSubstr("error: host lab1 has not answered for 9 s"));
}

TEST_F(OnOtherHosts, AreEachAMachineOfItsOwn) {
  Connect();
  const auto table = [&](const std::string& name, int agent) {
    return fmt::format("[[hosts]]\nname = '{}'\nagents = '{}'\nlaunch = ['ssh', '-F', '{}', '10.79.0.11']\n", name,
                       agent, folder_.File("ssh"));
  };
  const auto up = Fly(Experiment(3, 0.5, table("lab1", 1) + table("me@lab1", 2)));
  EXPECT_EQ(up->Wait(), 1);
  EXPECT_THAT(up->err(), HasSubstr(" are one machine: expected each machine once"));
  ExpectNothingIsLeft();
}

}  // namespace
}  // namespace mascot::test
