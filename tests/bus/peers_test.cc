// Peers decides which participants a process of a run believes. No DDS here: participants are the names that DDS gives
// them.
#include "bus/peers.h"

#include <gmock/gmock.h>

#include <future>

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// The name that Fast DDS gives participant `number` of a process of a host; the process has drawn a random number for
/// it.
ProcessKey::GuidPrefix ParticipantOf(int host, pid_t pid, int random = 7, int number = 0) {
  ProcessKey::GuidPrefix prefix;
  const int values[] = {1, 15, host, 0, pid & 255, (pid >> 8) & 255, random, 0, number, 0, 0, 0};
  for (std::size_t i = 0; i < std::size(values); ++i) prefix.value[i] = static_cast<std::uint8_t>(values[i]);
  return prefix;
}

TEST(ProcessKey, FitsEveryParticipantOfItsProcessAndNoOther) {
  const ProcessKey key = ProcessKey::Of(ParticipantOf(1, 1000));
  EXPECT_TRUE(key.Fits(ParticipantOf(1, 1000, 7, 5)));
  EXPECT_FALSE(key.Fits(ParticipantOf(2, 1000)));
  EXPECT_FALSE(key.Fits(ParticipantOf(1, 1001)));
  EXPECT_FALSE(key.Fits(ParticipantOf(1, 1000, 8))) << "another process that later got the same id";
}

TEST(ProcessKey, OfAProcessIdFitsThatProcessAlone) {
  EXPECT_TRUE(ProcessKey::WithPid(70000).Fits(ParticipantOf(1, 70000)));
  EXPECT_FALSE(ProcessKey::WithPid(70000).Fits(ParticipantOf(1, 70001)));
  EXPECT_FALSE(ProcessKey().Fits(ParticipantOf(1, 70000)));
  EXPECT_TRUE(ProcessKey::Anybody().Fits(ParticipantOf(1, 70000)));
}

TEST(ProcessKey, IsTheSameForThoseWhoAreToldOfIt) {
  for (const ProcessKey& key : {ProcessKey(), ProcessKey::WithPid(1000), ProcessKey::Of(ParticipantOf(1, 1000))}) {
    const ProcessKey told(key.bits(), key.mask());
    EXPECT_EQ(told.Fits(ParticipantOf(1, 1000)), key.Fits(ParticipantOf(1, 1000)));
    EXPECT_EQ(told.IsNobody(), key.IsNobody());
    EXPECT_EQ(told.IsExact(), key.IsExact());
  }
}

TEST(MayWrite, GivesEachTopicToWhoItIsOf) {
  EXPECT_TRUE(MayWrite("physics_server", Topic::State(3)));
  EXPECT_FALSE(MayWrite("agent_3", Topic::State(3)));
  EXPECT_TRUE(MayWrite("agent_3", Topic::Command(3)));
  EXPECT_FALSE(MayWrite("agent_2", Topic::Command(3)));
  EXPECT_TRUE(MayWrite("agents_1-5", Topic::Message(3)));
  EXPECT_FALSE(MayWrite("physics_server", Topic::Message(3)));
  EXPECT_TRUE(MayWrite("orchestrator", Topic::Experiment()));
  EXPECT_FALSE(MayWrite("physics_server", Topic::Experiment()));
  EXPECT_TRUE(MayWrite("orchestrator", Topic::Action(3)));
  EXPECT_FALSE(MayWrite("agent_3", Topic::Action(3)));
  EXPECT_FALSE(MayWrite("physics_server", Topic::Action(3)));
  EXPECT_TRUE(MayWrite("agent_1", Topic::Status()));
  EXPECT_TRUE(MayWrite("orchestrator", Topic::Request()));
  EXPECT_FALSE(MayWrite("agent_1", Topic::Request()));
}

/// What the orchestrator knows when it has started a server and agent 1, and waits for agent 2.
class PeersTest : public testing::Test {
 protected:
  PeersTest() {
    peers_.Know("physics_server", ProcessKey::WithPid(100));
    peers_.Know("agent_1", ProcessKey::WithPid(101));
    peers_.Await("agent_2", ProcessKey());
  }
  Peers peers_;
};

TEST_F(PeersTest, AProcessThatWasStartedIsKnownByItsIdUnderWhateverName) {
  EXPECT_EQ(peers_.Claim(ParticipantOf(1, 101), "agent_1"), "agent_1");
  EXPECT_EQ(peers_.Claim(ParticipantOf(1, 101, 7, 1), "rviz"), "agent_1") << "its second participant";
  EXPECT_EQ(peers_.ProcessOf(ParticipantOf(1, 101, 7, 2)), "agent_1");
}

TEST_F(PeersTest, ANameAloneDoesNotMakeAProcessThatWasStarted) {
  EXPECT_EQ(peers_.Claim(ParticipantOf(1, 999), "agent_1"), "");
  EXPECT_EQ(peers_.Believe(Topic::Command(1), ParticipantOf(1, 999)), "");
}

TEST_F(PeersTest, AProcessThatIsBeingStartedIsKnownWhenItIsHeardOf) {
  std::promise<void> started;
  std::future<std::string> claimed;
  peers_.Know("agent_1", [&] {
    claimed = std::async(std::launch::async, [&] {
      started.set_value();
      return peers_.Claim(ParticipantOf(1, 111), "agent_1");
    });
    started.get_future().wait();
    return ProcessKey::WithPid(111);
  });
  EXPECT_EQ(claimed.get(), "agent_1");
}

TEST_F(PeersTest, OnlyTheOrchestratorTellsAgentsWhatToDo) {
  peers_.Know("orchestrator", ProcessKey::Of(ParticipantOf(1, 99)));
  EXPECT_EQ(peers_.Believe(Topic::Action(1), ParticipantOf(1, 99)), "orchestrator");
  for (const int other : {100, 101, 999}) EXPECT_EQ(peers_.Believe(Topic::Action(1), ParticipantOf(1, other)), "");
}

TEST_F(PeersTest, OnceAProcessHasShownUpItIsKnownByItsHostToo) {
  EXPECT_EQ(peers_.Claim(ParticipantOf(1, 101), "agent_1"), "agent_1");
  EXPECT_EQ(peers_.Claim(ParticipantOf(2, 101), "agent_1"), "") << "the same process id on another host";
}

TEST_F(PeersTest, TheFirstThatHasTheNameTakesThePlaceOfAnAgentStartedByHand) {
  EXPECT_EQ(peers_.Claim(ParticipantOf(2, 500), "agent_2"), "agent_2");
  EXPECT_EQ(peers_.Claim(ParticipantOf(3, 600), "agent_2"), "") << "the second";
  EXPECT_EQ(peers_.Believe(Topic::Command(2), ParticipantOf(2, 500)), "agent_2");
  EXPECT_EQ(peers_.Believe(Topic::Command(2), ParticipantOf(3, 600)), "");
  peers_.Leave(ParticipantOf(3, 600));
  EXPECT_EQ(peers_.Claim(ParticipantOf(3, 600), "agent_2"), "");
  peers_.Leave(ParticipantOf(2, 500));
  EXPECT_EQ(peers_.Claim(ParticipantOf(3, 600), "agent_2"), "agent_2") << "the place was free again";
}

TEST_F(PeersTest, OneParticipantMayHaveThePlacesOfSeveralProcesses) {
  const ProcessKey::GuidPrefix player = ParticipantOf(1, 300);
  for (const char* process : {"orchestrator", "physics_server", "agent_1"})
    peers_.Know(process, ProcessKey::Of(player));
  EXPECT_THAT(peers_.ProcessesOf(player), testing::UnorderedElementsAre("orchestrator", "physics_server", "agent_1"));
  EXPECT_EQ(peers_.Believe(Topic::State(2), player), "physics_server");
  EXPECT_EQ(peers_.Believe(Topic::Message(1), player), "agent_1");
  EXPECT_EQ(peers_.Believe(Topic::Message(2), player), "");
  EXPECT_THAT(peers_.ProcessesOf(ParticipantOf(1, 999)), ElementsAre());
}

TEST_F(PeersTest, KnowTheParticipantThatHasTakenAPlaceLast) {
  EXPECT_EQ(peers_.ParticipantOf("agent_1"), std::nullopt);
  peers_.Claim(ParticipantOf(1, 101), "agent_1");
  EXPECT_EQ(peers_.ParticipantOf("agent_1"), ParticipantOf(1, 101));
  EXPECT_EQ(peers_.ParticipantOf("agent_9"), std::nullopt);
}

TEST_F(PeersTest, InARunAParticipantHasOnePlaceAlsoIfProcessIdsLookTheSame) {
  peers_.Know("agent_3", ProcessKey::WithPid(101 + 65536));  // of the id, DDS says the lower half
  EXPECT_THAT(peers_.ProcessesOf(ParticipantOf(1, 101)), testing::SizeIs(1));
}

TEST_F(PeersTest, APlaceThatIsVacatedIsForTheNextOfItsName) {
  EXPECT_EQ(peers_.Claim(ParticipantOf(1, 500), "agent_2"), "agent_2");
  EXPECT_EQ(peers_.Claim(ParticipantOf(1, 501), "agent_2"), "");
  const auto version = peers_.version();
  peers_.Vacate("agent_2");
  EXPECT_GT(peers_.version(), version);
  EXPECT_EQ(peers_.ProcessOf(ParticipantOf(1, 500)), "");
  EXPECT_EQ(peers_.Claim(ParticipantOf(1, 501), "agent_2"), "agent_2");
  peers_.Leave(ParticipantOf(1, 500));
  EXPECT_EQ(peers_.ProcessOf(ParticipantOf(1, 501)), "agent_2") << "its predecessor is discovered to be gone";
}

TEST_F(PeersTest, AnAgentInAContainerIsNotTakenForAnotherProcessOfTheSameId) {
  // Containers may share the host's network, and so the host's number, and count their processes on their own.
  EXPECT_EQ(peers_.Claim(ParticipantOf(1, 101), "agent_1"), "agent_1");
  EXPECT_EQ(peers_.Claim(ParticipantOf(1, 101, 8), "agent_2"), "agent_2");
  EXPECT_EQ(peers_.Believe(Topic::Command(1), ParticipantOf(1, 101)), "agent_1");
  EXPECT_EQ(peers_.Believe(Topic::Command(2), ParticipantOf(1, 101, 8)), "agent_2");
}

TEST_F(PeersTest, AProcessIsBelievedOnItsOwnTopicsOnly) {
  EXPECT_EQ(peers_.Believe(Topic::State(1), ParticipantOf(1, 100)), "physics_server");
  EXPECT_EQ(peers_.Believe(Topic::State(1), ParticipantOf(1, 101)), "");
  EXPECT_EQ(peers_.Believe(Topic::Status(), ParticipantOf(1, 101)), "agent_1");
  EXPECT_EQ(peers_.Believe(Topic::Request(), ParticipantOf(1, 101)), "");
}

TEST_F(PeersTest, WhatIsNotTakenIsCountedByWriterAndTopic) {
  for (int i = 0; i < 3; ++i) peers_.Believe(Topic::Request(), ParticipantOf(1, 999));
  peers_.Believe(Topic::State(2), ParticipantOf(1, 999));
  EXPECT_THAT(peers_.Refusals(),
              ElementsAre("not taken: 1 sample of /agent_2/state from 01.0f.01.00.e7.03.07.00.00.00.00.00, who may not "
                          "write it",
                          HasSubstr("3 samples of /request from 01.0f.01.00.e7.03")));
}

TEST_F(PeersTest, WhatASecondWriterOfAProcessSaysIsCountedToo) {
  for (int i = 0; i < 2; ++i) peers_.RefuseSecond(Topic::State(1), ParticipantOf(1, 100));
  EXPECT_THAT(peers_.Refusals(), ElementsAre("not taken: 2 samples of /agent_1/state from "
                                             "01.0f.01.00.64.00.07.00.00.00.00.00, a second writer of physics_server"));
}

TEST_F(PeersTest, WhatCameBeforeItsProcessWasKnownIsNoOffence) {
  peers_.Believe(Topic::Status(), ParticipantOf(2, 500));
  peers_.Know("agent_2", ProcessKey::Of(ParticipantOf(2, 500)));
  EXPECT_THAT(peers_.Refusals(), ElementsAre());
}

TEST_F(PeersTest, AnotherLearnsWhoIsWho) {
  peers_.Claim(ParticipantOf(1, 100), "physics_server");
  Peers told;
  for (const auto& [process, key] : peers_.Places()) told.Know(process, key);
  EXPECT_EQ(told.Believe(Topic::State(1), ParticipantOf(2, 100)), "");
  EXPECT_EQ(told.Believe(Topic::State(1), ParticipantOf(1, 100)), "physics_server");
  EXPECT_EQ(told.Believe(Topic::Command(2), ParticipantOf(2, 500)), "") << "nobody has that place yet";
  peers_.Claim(ParticipantOf(2, 500), "agent_2");
  for (const auto& [process, key] : peers_.Places()) told.Know(process, key);
  EXPECT_EQ(told.Believe(Topic::Command(2), ParticipantOf(2, 500)), "agent_2");
}

TEST_F(PeersTest, OthersMustBeToldWhenAPlaceIsTakenByNameOrLeft) {
  peers_.Claim(ParticipantOf(1, 101), "agent_1");
  EXPECT_EQ(peers_.version(), 0U) << "they know its process id";
  peers_.Claim(ParticipantOf(2, 500), "agent_2");
  EXPECT_EQ(peers_.version(), 1U);
  peers_.Claim(ParticipantOf(2, 500), "agent_2");
  EXPECT_EQ(peers_.version(), 1U);
  peers_.Leave(ParticipantOf(2, 500));
  EXPECT_EQ(peers_.version(), 2U);
}

TEST(Peers, AnAgentStartedByHandBelievesTheFirstThatGivesItAnExperiment) {
  Peers peers;
  peers.Know("orchestrator", ProcessKey::Anybody());
  EXPECT_EQ(peers.Believe(Topic::Request(), ParticipantOf(1, 50)), "") << "it has given none";
  EXPECT_EQ(peers.ProcessOf(ParticipantOf(1, 50)), "");
  EXPECT_EQ(peers.Believe(Topic::Experiment(), ParticipantOf(1, 50)), "orchestrator");
  EXPECT_EQ(peers.Believe(Topic::Experiment(), ParticipantOf(1, 60)), "");
  EXPECT_EQ(peers.Believe(Topic::Request(), ParticipantOf(1, 50)), "orchestrator");
}

TEST_F(PeersTest, AFreshProcessTakesThePlaceOfTheOneBeforeIt) {
  const auto old = ParticipantOf(1, 101), fresh = ParticipantOf(1, 201);
  ASSERT_EQ(peers_.Claim(old, "agent_1"), "agent_1");
  const auto before = peers_.version();
  peers_.Know("agent_1", ProcessKey::WithPid(101));
  EXPECT_EQ(peers_.version(), before) << "it is the same process";
  peers_.Know("agent_1", ProcessKey::WithPid(201));
  EXPECT_GT(peers_.version(), before) << "others must be told";
  EXPECT_EQ(peers_.ProcessOf(old), "");
  EXPECT_EQ(peers_.WriterOf(Topic::Command(1), old), "");
  EXPECT_EQ(peers_.Claim(fresh, "agent_1"), "agent_1");
  EXPECT_EQ(peers_.WriterOf(Topic::Command(1), fresh), "agent_1");
}

}  // namespace
}  // namespace mascot
