// `up` checks before the start what the transport needs, and takes no notice of what users have set for other DDS
// programs.
#include <gmock/gmock.h>

#include "tests/support/folders.h"
#include "tests/support/intruder.h"

namespace mascot::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kOrchestratorProgram = "'" + BuildFolder() + "/orchestrator'";
const std::string kAgentProgram = "'" + BuildFolder() + "/agent'";

/// `up` for a fifth of a second; `before`: words in front of it.
Ran ShortRun(const ScratchFolder& folder, const std::string& before, const std::string& more = "") {
  return Shell(before + " " + kOrchestratorProgram + " up " + Config("leaderless") +
               " --duration-s 0.2 --force --set output.save_plot=false --out '" + folder.File("run") + "' " + more);
}

bool MayMakeNetworks() { return Shell("unshare -n ip link show lo").exit_code == 0; }

/// `up` does not ask this question, which it used to ask after a minute when the network was wrong.
auto AsksNoWrongQuestion() { return Not(HasSubstr("is an orchestrator running in this domain?")); }

TEST(StartNeeds, TheLoopbackInterfaceThatIsDownIsNamedBeforeTheStart) {
  if (!MayMakeNetworks()) GTEST_SKIP() << "needs root, to make a network namespace";
  const ScratchFolder folder;
  const std::string words =
      "error: the network interface lo is down, by which the processes of a run on one host find each other: as root, "
      "`ip link set lo up`\n";
  const Ran run = ShortRun(folder, "unshare -n");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, AllOf(HasSubstr(words), AsksNoWrongQuestion(), Not(HasSubstr("DDS domain"))));
  EXPECT_THAT(ReadFile(folder.File("run/summary.json")), HasSubstr("lo is down"));
  for (const std::string& by_hand : {kAgentProgram + " --id 1 ", "'" + BuildFolder() + "/physics_server' "}) {
    const Ran process = Shell("unshare -n " + by_hand + "--domain 90 --loopback --wait-s 20");
    EXPECT_EQ(process.exit_code, 1);
    EXPECT_THAT(process.output, HasSubstr(words));
  }
  EXPECT_THAT(Shell("unshare -n " + kAgentProgram + " --id 1 --domain 90 --wait-s 20").output,
              HasSubstr("error: no network interface of this machine that is up has an IPv4 address, not even lo\n"));
}

TEST(StartNeeds, ALoopbackInterfaceWithoutItsAddressIsNamedToo) {
  if (!MayMakeNetworks()) GTEST_SKIP() << "needs root, to make a network namespace";
  const ScratchFolder folder;
  const Ran run =
      Shell("unshare -n sh -c 'ip link set lo up && ip address del 127.0.0.1/8 dev lo && exec \"$0\" up " +
            Config("leaderless") + " --out \"$1\"' " + kOrchestratorProgram + " '" + folder.File("run") + "'");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("error: the network interface lo does not have the address 127.0.0.1, by which the "
                                    "processes of a run on one host find each other: as root, "
                                    "`ip address add 127.0.0.1/8 dev lo`\n"));
}

TEST(StartNeeds, SharedMemoryAloneNeedsNoInterface) {
  if (!MayMakeNetworks()) GTEST_SKIP() << "needs root, to make a network namespace";
  const ScratchFolder folder;
  EXPECT_THAT(ShortRun(folder, "unshare -n", "--set network.transport=shm").output, Not(HasSubstr("interface")));
}

TEST(StartNeeds, AnAddressThatThisMachineDoesNotHaveIsRefusedWithThoseThatItHas) {
  const Ran agent = Shell(std::string(kAgentProgram) + " --id 1 --domain 90 --address 192.0.2.7 --wait-s 20");
  EXPECT_EQ(agent.exit_code, 1);
  EXPECT_THAT(agent.output, HasSubstr("error: no network interface of this machine that is up has the address "
                                      "192.0.2.7; there are 127.0.0.1 (lo)"));
}

TEST(StartNeeds, TooFewFileDescriptorsAreRefusedInWords) {
  const ScratchFolder folder;
  const Ran run = ShortRun(folder, "prlimit --nofile=40:40");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output,
              HasSubstr("error: a process may have 40 open files (ulimit -n), and this run needs 132: raise "
                        "the limit\n"));
  const Ran agent = Shell(std::string("prlimit --nofile=40:40 ") + kAgentProgram + " --id 1 --domain 90 --wait-s 20");
  EXPECT_EQ(agent.exit_code, 1);
  EXPECT_THAT(agent.output, HasSubstr("error: a process may have 40 open files (ulimit -n), and this run needs 64: "
                                      "raise the limit\n"));
  EXPECT_EQ(ShortRun(folder, "prlimit --nofile=40:1024").exit_code, 0) << "it may raise the limit itself";
}

TEST(StartNeeds, TooLittleMemoryForDataIsRefusedInWords) {
  const ScratchFolder folder;
  const Ran run = ShortRun(folder, "prlimit --data=62914560");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("error: the data of a process is limited to 60 MiB (ulimit -d), and a run over DDS "
                                    "needs 192 MiB\n"));
}

/// A control group of this test whose memory is limited; its name is empty if it cannot be made.
class SmallGroup {
 public:
  explicit SmallGroup(const std::string& limit) {
    const std::string name = "/mascot-test-" + std::to_string(getpid());
    const bool is_v1 = std::filesystem::exists("/sys/fs/cgroup/memory/memory.limit_in_bytes");
    path_ = (is_v1 ? "/sys/fs/cgroup/memory" : "/sys/fs/cgroup") + name;
    const std::string file = path_ + (is_v1 ? "/memory.limit_in_bytes" : "/memory.max");
    if (Shell("mkdir " + path_ + " && echo " + limit + " > " + file).exit_code != 0) path_.clear();
  }
  ~SmallGroup() {
    if (!path_.empty()) Until([this] { return Shell("rmdir " + path_).exit_code == 0; });
  }
  SmallGroup(const SmallGroup&) = delete;
  SmallGroup& operator=(const SmallGroup&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

TEST(StartNeeds, TooLittleMemoryOfTheControlGroupIsRefusedInWords) {
  const SmallGroup group("41943040");
  if (group.path().empty()) GTEST_SKIP() << "needs root, to make a control group";
  const ScratchFolder folder;
  const Ran run = ShortRun(folder, "echo $$ > " + group.path() + "/cgroup.procs && exec");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output,
              testing::ContainsRegex("error: this control group may have 40 MiB of memory \\(" + group.path() +
                                     "/memory[a-z._]+\\) and has [0-9]+ MiB, and this run needs about "
                                     "[0-9]+ MiB more: raise the limit, or let agents share processes"));
}

TEST(StartNeeds, TooFewThreadsAreRefusedInWordsAndLeaveNothing) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to be a user without other processes";
  const std::string as_user = "setpriv --reuid 12345 --regid 12345 --clear-groups prlimit --nproc=30";
  const auto files = [] { return Shell("find /dev/shm -user 12345 | wc -l").output; };
  ScratchFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  const Ran run = ShortRun(folder, as_user);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, testing::ContainsRegex(
                              "error: this user may have 30 processes and threads \\(ulimit -u\\) and has [0-9]+, "
                              "and this run needs about 72 more: raise the limit"));
  const Ran agent = Shell(std::string("setpriv --reuid 12345 --regid 12345 --clear-groups prlimit --nproc=5 ") +
                          kAgentProgram + " --id 1 --domain 90 --wait-s 20");
  EXPECT_EQ(agent.exit_code, 1);
  EXPECT_THAT(agent.output, HasSubstr("and this run needs about 22 more"));
  EXPECT_EQ(files(), "0\n");
}

/// What users of ROS 2 and of Fast DDS set, with values that keep programs that heed them from finding ours.
std::string SettingsOfOthers(const ScratchFolder& folder) {
  WriteFile(folder.File("profiles.xml"), R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"><profiles>
<participant profile_name="all" is_default_profile="true"><rtps><builtin><discovery_config>
<discoveryProtocol>CLIENT</discoveryProtocol></discovery_config></builtin></rtps></participant>
<nonsense/></profiles></dds>)");
  WriteFile(folder.File("DEFAULT_FASTRTPS_PROFILES.xml"), ReadFile(folder.File("profiles.xml")));
  WriteFile(folder.File("environment.json"),
            R"({"environment_variables": {"ROS_DISCOVERY_SERVER": "127.0.0.1:11811"}})");
  const std::string profiles = "='" + folder.File("profiles.xml") + "' ";
  return "cd '" + folder.path().string() +
         "' && ROS_DISCOVERY_SERVER=127.0.0.1:11811 ROS_SUPER_CLIENT=TRUE ROS_LOCALHOST_ONLY=1 "
         "ROS_AUTOMATIC_DISCOVERY_RANGE=OFF ROS_STATIC_PEERS=192.0.2.1 RMW_IMPLEMENTATION=rmw_fastrtps_cpp "
         "RMW_FASTRTPS_USE_QOS_FROM_XML=1 RMW_FASTRTPS_PUBLICATION_MODE=ASYNCHRONOUS SKIP_DEFAULT_XML_FILE= "
         "FASTDDS_STATISTICS='HISTORY_LATENCY_TOPIC;NETWORK_LATENCY_TOPIC;PHYSICAL_DATA_TOPIC' "
         "FASTDDS_ENVIRONMENT_FILE='" +
         folder.File("environment.json") + "' FASTRTPS_DEFAULT_PROFILES_FILE" + profiles +
         "FASTDDS_DEFAULT_PROFILES_FILE" + profiles;
}

TEST(StartNeeds, WhatUsersHaveSetForOtherDdsProgramsDoesNotReachARun) {
  const ScratchFolder folder;
  const Ran run = ShortRun(folder, SettingsOfOthers(folder));
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, Not(HasSubstr("XML")));
}

TEST(StartNeeds, NorAnAgentThatIsStartedByHand) {
  const ScratchFolder folder;
  Up up(folder, "by_hand", Config("leaderless"),
        {"--duration-s", "0.2", "--set", "agents.override=[{id = 2, host = \"external\"}]"});
  ASSERT_TRUE(Until([&] { return up.IsOver() || up.Said("waiting for: agent --id 2"); })) << up.err();
  const Ran agent =
      Shell(SettingsOfOthers(folder) + kAgentProgram + " --id 2 --domain " + std::to_string(DomainOf(up)));
  EXPECT_EQ(agent.exit_code, 0) << agent.output;
  EXPECT_EQ(up.Wait(), 0) << up.err();
}

}  // namespace
}  // namespace mascot::test
