// How the orchestrator handles statuses of processes, without DDS.
#include "orchestrator/engines/dds/roster.h"

#include <gmock/gmock.h>

#include "bus/wire.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using testing::ThrowsMessage;

/// Roster of a physics server and two agents, the second started by hand.
class RosterTest : public testing::Test {
 protected:
  Roster::News Say(const std::string& process, Life life, std::uint32_t agent = 0, const std::string& reason = "",
                   std::uint64_t experiment = 0) {
    Roster::Status status;
    status.experiment(experiment);
    status.process(process);
    status.agent(agent);
    status.state(static_cast<std::uint8_t>(life));
    status.reason(reason);
    return roster_.OnStatus(status);
  }

  Roster roster_{
      {.processes = {"physics_server", "agent_1", "agent_2"}, .external = {false, true}, .experiment = 0x5eed}};
  Roster::Time now_ = Roster::Time() + 1h;
};

TEST_F(RosterTest, AStatusIsNewsIfItsStateHasChanged) {
  EXPECT_TRUE(Say("agent_1", Life::kWaiting, 1).changed);
  EXPECT_FALSE(Say("agent_1", Life::kWaiting, 1).changed);
  EXPECT_TRUE(Say("agent_1", Life::kReady, 1).changed);
  EXPECT_EQ(static_cast<Life>(roster_.Of("agent_1")->state()), Life::kReady);
  EXPECT_FALSE(roster_.Of("agent_2").has_value());
}

TEST_F(RosterTest, TheLoopIsWokenForWaitingProcessesAndTheServersEnd) {
  EXPECT_TRUE(Say("agent_1", Life::kWaiting, 1).wake);
  EXPECT_FALSE(Say("agent_1", Life::kReady, 1).wake);
  EXPECT_FALSE(Say("physics_server", Life::kRunning).wake);
  EXPECT_TRUE(Say("physics_server", Life::kDone).wake);
}

TEST_F(RosterTest, TheExperimentIsHandedOutOnRequestAtMostTenTimesASecond) {
  EXPECT_FALSE(roster_.IsTimeToHandOut(now_)) << "nobody has asked";
  Say("agent_1", Life::kWaiting, 1);
  Say("agent_2", Life::kWaiting, 2);
  EXPECT_TRUE(roster_.IsTimeToHandOut(now_));
  EXPECT_FALSE(roster_.IsTimeToHandOut(now_ + 1s)) << "nobody has asked since";
  Say("agent_2", Life::kWaiting, 2);
  EXPECT_TRUE(roster_.IsTimeToHandOut(now_ + 1s));
  Say("agent_2", Life::kWaiting, 2);
  EXPECT_FALSE(roster_.IsTimeToHandOut(now_ + 1s + 99ms));
  EXPECT_TRUE(roster_.IsTimeToHandOut(now_ + 1s + 100ms));
}

TEST_F(RosterTest, EveryProcessMustHaveTheExperimentOfThisRun) {
  for (const char* process : {"physics_server", "agent_1", "agent_2"}) {
    EXPECT_FALSE(roster_.HaveTheExperiment());
    Say(process, Life::kWaiting);
    Say(process, Life::kMatching, 0, "", 0x5eed);
  }
  EXPECT_TRUE(roster_.HaveTheExperiment());
}

TEST_F(RosterTest, AProcessThatHasAnotherExperimentFailsTheRun) {
  EXPECT_THAT([this] { Say("agent_2", Life::kMatching, 2, "", 0xbad); },
              ThrowsMessage<std::runtime_error>("agent_2 has received another experiment than this run's (digest "
                                                "0000000000000bad, expected 0000000000005eed): somebody else publishes "
                                                "experiments in this DDS domain"));
  EXPECT_FALSE(roster_.HaveTheExperiment());
}

TEST_F(RosterTest, TheRecorderSaysHelloFiveTimesASecond) {
  EXPECT_TRUE(roster_.IsTimeForHello(now_));
  EXPECT_FALSE(roster_.IsTimeForHello(now_ + 199ms));
  EXPECT_TRUE(roster_.IsTimeForHello(now_ + 200ms));
}

TEST_F(RosterTest, ProcessesWithoutAStatusAreNamed) {
  EXPECT_EQ(roster_.Missing(), "nothing was heard of physics_server, agent_1, agent_2");
  Say("physics_server", Life::kMatching);
  Say("agent_1", Life::kWaiting, 1);
  EXPECT_EQ(roster_.Missing(), "nothing was heard of agent_2");
  Say("agent_2", Life::kWaiting, 2);
  EXPECT_EQ(roster_.Missing(), "not everybody has found everybody");
}

TEST_F(RosterTest, AnAgentStartedByHandThatFailsIsTheRunsFailure) {
  EXPECT_THAT([&] { Say("agent_2", Life::kFailed, 2, "no such law"); },
              ThrowsMessage<std::runtime_error>("agent_2 failed: no such law"));
  EXPECT_THAT([&] { Say("agent_2", Life::kFailed, 2, "\xFF"); },
              ThrowsMessage<std::runtime_error>("agent_2 failed: \xEF\xBF\xBD"));
}

TEST_F(RosterTest, AFailureOfAnyOtherProcessIsLeftToItsExit) {
  EXPECT_NO_THROW(Say("agent_1", Life::kFailed, 1, "no such law"));
  EXPECT_NO_THROW(Say("stranger", Life::kFailed, 77, "who am I"));
  EXPECT_NO_THROW(Say("physics_server", Life::kFailed, 0, "agent 1 is late"));
}

}  // namespace
}  // namespace mascot
