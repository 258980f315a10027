// How the orchestrator handles statuses of processes, without DDS.
#include "orchestrator/engines/dds/process_table.h"

#include <gmock/gmock.h>

#include <limits>

#include "bus/wire.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using testing::ThrowsMessage;

/// ProcessTable of a physics server and two agents, the second started by hand.
class ProcessTableTest : public testing::Test {
 protected:
  ProcessTable::News Say(const std::string& process, Life life, const std::string& reason = "",
                         std::uint64_t experiment = 0) {
    ProcessTable::Status status;
    status.experiment(experiment);
    status.state(static_cast<std::uint8_t>(life));
    status.reason(reason);
    return process_table_.OnStatus(process, status);
  }

  ProcessTable process_table_{{.processes = {"physics_server", "agent_1", "agent_2"},
                               .external = {false, true},
                               .experiment = 0x5eed,
                               .last_tick = 100}};
  ProcessTable::Time now_ = ProcessTable::Time() + 1h;
};

TEST_F(ProcessTableTest, AStatusIsNewsIfItsStateHasChanged) {
  EXPECT_TRUE(Say("agent_1", Life::kWaiting).changed);
  EXPECT_FALSE(Say("agent_1", Life::kWaiting).changed);
  EXPECT_TRUE(Say("agent_1", Life::kReady).changed);
  EXPECT_EQ(static_cast<Life>(process_table_.Of("agent_1")->state()), Life::kReady);
  EXPECT_FALSE(process_table_.Of("agent_2").has_value());
}

TEST_F(ProcessTableTest, TheLoopIsWokenForWaitingProcessesAndTheServersEnd) {
  EXPECT_TRUE(Say("agent_1", Life::kWaiting).wake);
  EXPECT_FALSE(Say("agent_1", Life::kReady).wake);
  EXPECT_FALSE(Say("physics_server", Life::kRunning).wake);
  EXPECT_TRUE(Say("physics_server", Life::kDone).wake);
}

TEST_F(ProcessTableTest, TheExperimentIsHandedOutOnRequestAtMostTenTimesASecond) {
  EXPECT_FALSE(process_table_.IsTimeToHandOut(now_)) << "nobody has asked";
  Say("agent_1", Life::kWaiting);
  Say("agent_2", Life::kWaiting);
  EXPECT_TRUE(process_table_.IsTimeToHandOut(now_));
  EXPECT_FALSE(process_table_.IsTimeToHandOut(now_ + 1s)) << "nobody has asked since";
  Say("agent_2", Life::kWaiting);
  EXPECT_TRUE(process_table_.IsTimeToHandOut(now_ + 1s));
  Say("agent_2", Life::kWaiting);
  EXPECT_FALSE(process_table_.IsTimeToHandOut(now_ + 1s + 99ms));
  EXPECT_TRUE(process_table_.IsTimeToHandOut(now_ + 1s + 100ms));
}

TEST_F(ProcessTableTest, EveryProcessMustHaveTheExperimentOfThisRun) {
  for (const char* process : {"physics_server", "agent_1", "agent_2"}) {
    EXPECT_FALSE(process_table_.HaveTheExperiment());
    Say(process, Life::kWaiting);
    Say(process, Life::kMatching, "", 0x5eed);
  }
  EXPECT_TRUE(process_table_.HaveTheExperiment());
}

TEST_F(ProcessTableTest, AProcessThatHasAnotherExperimentFailsTheRun) {
  EXPECT_THAT([this] { Say("agent_2", Life::kMatching, "", 0xbad); },
              ThrowsMessage<std::runtime_error>("agent_2 has received another experiment than this run's (digest "
                                                "0000000000000bad, expected 0000000000005eed): somebody else publishes "
                                                "experiments in this DDS domain"));
  EXPECT_FALSE(process_table_.HaveTheExperiment());
}

TEST_F(ProcessTableTest, TheRecorderSaysHelloFiveTimesASecond) {
  EXPECT_TRUE(process_table_.IsTimeForHello(now_));
  EXPECT_FALSE(process_table_.IsTimeForHello(now_ + 199ms));
  EXPECT_TRUE(process_table_.IsTimeForHello(now_ + 200ms));
}

TEST_F(ProcessTableTest, ProcessesWithoutAStatusAreNamed) {
  EXPECT_EQ(process_table_.Missing(), "nothing was heard of physics_server, agent_1, agent_2");
  Say("physics_server", Life::kMatching);
  Say("agent_1", Life::kWaiting);
  EXPECT_EQ(process_table_.Missing(), "nothing was heard of agent_2");
  Say("agent_2", Life::kWaiting);
  EXPECT_EQ(process_table_.Missing(), "not everybody has found everybody");
}

TEST_F(ProcessTableTest, AnAgentStartedByHandThatFailsIsTheRunsFailure) {
  EXPECT_THAT([&] { Say("agent_2", Life::kFailed, "no such law"); },
              ThrowsMessage<std::runtime_error>("agent_2 failed: no such law"));
  EXPECT_THAT([&] { Say("agent_2", Life::kFailed, "\xFF"); },
              ThrowsMessage<std::runtime_error>("agent_2 failed: \xEF\xBF\xBD"));
}

TEST_F(ProcessTableTest, AFailureOfAnyOtherProcessIsLeftToItsExit) {
  EXPECT_NO_THROW(Say("agent_1", Life::kFailed, "no such law"));
  EXPECT_NO_THROW(Say("agents_1-2", Life::kFailed, "who am I"));
  EXPECT_NO_THROW(Say("physics_server", Life::kFailed, "agent 1 is late"));
}

TEST_F(ProcessTableTest, AStatusThatCannotBeOfThisRunIsRefused) {
  ProcessTable::Status status;
  status.process("agent_1");
  status.state(7);
  EXPECT_THAT([&] { process_table_.OnStatus("agent_1", status); },
              ThrowsMessage<std::runtime_error>(
                  "/status: expected a state of 0 to 6 and a tick of 0 to 101 from agent_1, got state 7 and tick 0"));
  status.state(4);
  status.tick(std::numeric_limits<std::uint64_t>::max());
  EXPECT_THAT([&] { process_table_.OnStatus("agent_1", status); },
              ThrowsMessage<std::runtime_error>(testing::EndsWith("got state 4 and tick 18446744073709551615")));
  EXPECT_FALSE(process_table_.Of("agent_1").has_value());
}

}  // namespace
}  // namespace mascot
