// What the audit finds in what discovery reports, without DDS.
#include "orchestrator/engines/dds/wire_audit.h"

#include <gmock/gmock.h>

#include <tuple>

#include "agent/laws/laws.h"

namespace mascot {
namespace {

/// Participants are numbered; those of a process are the same but for their last byte.
WireAudit::GuidPrefix Participant(int process, int number = 0) {
  WireAudit::GuidPrefix prefix;
  prefix.value[0] = 1;
  prefix.value[1] = 15;
  prefix.value[4] = static_cast<std::uint8_t>(process);
  prefix.value[8] = static_cast<std::uint8_t>(number);
  return prefix;
}

Experiment Load(const std::string& toml, const std::string& delivery = "topics") {
  const Override how{.key = "network.delivery", .value = "'" + delivery + "'"};
  return LoadExperiment(Section::FromText(toml, "a.toml", {&how, 1}), "a");
}

/// A run of three agents on a path: 1 - 2 - 3. The server is process 100, the agents are 101 to 103.
class WireAuditTest : public testing::Test {
 protected:
  WireAuditTest() {
    peers_.Know("orchestrator", ProcessKey::Of(Participant(99)));
    Start("physics_server", 100);
    for (int id = 1; id <= 3; ++id) Start(AgentName(id), 100 + id);
  }
  void Start(const std::string& process, int pid) {
    peers_.Know(process, ProcessKey::WithPid(pid));
    audit_.OnParticipant(Participant(pid), process, "");
  }
  /// A new endpoint of a participant. Returns its GUID.
  WireAudit::Guid Endpoint(const WireAudit::GuidPrefix& participant, const Topic& topic, bool reads) {
    WireAudit::Guid guid;
    guid.guidPrefix = participant;
    guid.entityId.value[0] = ++endpoints_;
    audit_.OnEndpoint(guid, topic.DdsName(), reads);
    return guid;
  }
  WireAudit::Guid Reads(const WireAudit::GuidPrefix& participant, const Topic& topic) {
    return Endpoint(participant, topic, true);
  }
  WireAudit::Guid Writes(const WireAudit::GuidPrefix& participant, const Topic& topic) {
    return Endpoint(participant, topic, false);
  }

  const Experiment experiment_ =
      Load("[run]\nduration_s = 1.0\n[agents]\ncount = 3\n[graph]\ntopology = \"path\"\n[law]\nname = \"consensus\"\n");
  Peers peers_;
  WireAudit audit_{experiment_, peers_};
  std::uint8_t endpoints_ = 0;
};

TEST_F(WireAuditTest, WhatAStrangerCallsItselfIsFitForATerminal) {
  audit_.OnParticipant(Participant(7), "\x1b[2J\u202erviz\n\xff", "process 7 (\x1b]0;x\x07) on \u2066vm");
  Writes(Participant(7), Topic::Command(1));
  EXPECT_EQ(audit_.Violation(),
            "'\\u001b[2J\\u202erviz\\n\uFFFD' writes /agent_1/command, which only agent_1 may "
            "(process 7 (\\u001b]0;x\\u0007) on \\u2066vm)");
}

TEST_F(WireAuditTest, FindsNothingInARunAsItShouldBe) {
  Reads(Participant(101), Topic::State(1));
  Reads(Participant(101), Topic::State(2));
  Writes(Participant(101), Topic::Command(1));
  Writes(Participant(101), Topic::Status());
  Reads(Participant(101), Topic::Request());
  Writes(Participant(100), Topic::State(1));
  Writes(Participant(100), Topic::Status());
  Writes(Participant(100), Topic::Request());
  Reads(Participant(99), Topic::State(3));
  Writes(Participant(99), Topic::Experiment());
  Writes(Participant(99), Topic::Request());
  Writes(Participant(99), Topic::Status());
  EXPECT_EQ(audit_.Violation(), "");
}

TEST_F(WireAuditTest, AnyoneMayListenWhoDoesNotCallItselfAnAgent) {
  audit_.OnParticipant(Participant(200), "rviz", "");
  for (const Topic& topic : {Topic::State(1), Topic::Command(2), Topic::Clock(), Topic::Status(), Topic::Request()})
    Reads(Participant(200), topic);
  EXPECT_EQ(audit_.Violation(), "");
}

TEST_F(WireAuditTest, WithAViewForRosStrangersMayReadItAndAgentsMayNot) {
  audit_.OnParticipant(Participant(200), "rviz", "");
  Reads(Participant(101), Topic::Tf());
  Writes(Participant(200), Topic::Tf());  // of no concern to a run without
  EXPECT_EQ(audit_.Violation(), "");
  Experiment experiment = experiment_;
  experiment.network.ros_view = true;
  const auto violation_of = [&](int process, const Topic& topic, bool reads) {
    WireAudit audit(experiment, peers_);
    for (const int participant : {99, 100, 101, 200})
      audit.OnParticipant(Participant(participant), participant == 200 ? "rviz" : "", "");
    WireAudit::Guid guid;
    guid.guidPrefix = Participant(process, 1);
    if (process == 200) guid.guidPrefix = Participant(200);
    audit.OnEndpoint(guid, topic.DdsName(), reads);
    return audit.Violation();
  };
  EXPECT_EQ(violation_of(200, Topic::Odom(1), /*reads=*/false), "") << "only recordings have it";
  for (const Topic& topic : {Topic::Tf(), Topic::Scene()}) {
    EXPECT_EQ(violation_of(99, topic, /*reads=*/false), "") << "by a second participant";
    EXPECT_EQ(violation_of(200, topic, /*reads=*/true), "");
    EXPECT_EQ(violation_of(101, topic, /*reads=*/true),
              "agent_1 reads " + topic.Name() + ", which the graph does not let it");
    EXPECT_EQ(violation_of(200, topic, /*reads=*/false),
              "'rviz' writes " + topic.Name() + ", which only orchestrator may");
    EXPECT_EQ(violation_of(100, topic, /*reads=*/false),
              "'physics_server' writes " + topic.Name() + ", which only orchestrator may");
  }
}

TEST_F(WireAuditTest, RemembersWhoHasLeft) {
  audit_.OnEndpointGone(Reads(Participant(101), Topic::State(3)));
  audit_.OnParticipantGone(Participant(101));
  EXPECT_EQ(audit_.Violation(), "agent_1 reads /agent_3/state, which the graph does not let it");
}

TEST_F(WireAuditTest, NobodyElseMayCallItselfAProcessOfTheRun) {
  audit_.OnParticipant(Participant(200), "agent_1", "process 200 on vm");
  audit_.OnParticipantGone(Participant(200));
  EXPECT_EQ(audit_.Violation(), "two processes say that they are agent_1 (process 200 on vm)");
}

TEST_F(WireAuditTest, ASecondParticipantOfAProcessIsThatProcess) {
  audit_.OnParticipant(Participant(101, 1), "rviz", "");
  Reads(Participant(101, 1), Topic::State(2));
  EXPECT_EQ(audit_.Violation(), "");
  Reads(Participant(101, 1), Topic::State(3));
  EXPECT_EQ(audit_.Violation(), "agent_1 (as 'rviz') reads /agent_3/state, which the graph does not let it");
}

TEST_F(WireAuditTest, AProcessHasOneVoiceOnATopic) {
  const WireAudit::Guid first = Writes(Participant(101), Topic::Command(1));
  audit_.OnEndpoint(first, Topic::Command(1).DdsName(), /*reads=*/false);  // is reported again when its QoS changes
  EXPECT_EQ(audit_.Violation(), "");
  audit_.OnParticipant(Participant(101, 1), "spare", "");
  Writes(Participant(101, 1), Topic::Command(1));
  EXPECT_EQ(audit_.Violation(), "agent_1 (as 'spare') writes /agent_1/command twice");
}

TEST_F(WireAuditTest, AnAgentThatDoesNotExistMayListenAndNotSpeak) {
  audit_.OnParticipant(Participant(200), "agent_9", "");
  Reads(Participant(200), Topic::Experiment());
  EXPECT_EQ(audit_.Violation(), "");
  Writes(Participant(200), Topic::Status());
  EXPECT_EQ(audit_.Violation(), "agent_9 writes /status, but there are only agents 1 to 3");
}

struct Voice {
  Topic topic;
  const char* rightful;
};

TEST_F(WireAuditTest, StrangersAreNamedOnEveryTopicOfTheRun) {
  for (const Voice& voice : {Voice{Topic::State(1), "physics_server"}, Voice{Topic::Bundle({1, 1}), "physics_server"},
                             Voice{Topic::Row(), "physics_server"}, Voice{Topic::Answers({1, 1}), "agent_1"},
                             Voice{Topic::Clock(), "physics_server"}, Voice{Topic::Command(1), "agent_1"},
                             Voice{Topic::Message(1), "agent_1"}, Voice{Topic::Action(1), "orchestrator"},
                             Voice{Topic::Experiment(), "orchestrator"}, Voice{Topic::Request(), "orchestrator"},
                             Voice{Topic::Status(), "processes of the run"}}) {
    WireAudit audit(experiment_, peers_);
    WireAudit::Guid guid;
    guid.guidPrefix = Participant(200);
    audit.OnParticipant(guid.guidPrefix, "rviz", "process 200 on vm");
    audit.OnEndpoint(guid, voice.topic.DdsName(), /*reads=*/false);
    EXPECT_EQ(audit.Violation(),
              "'rviz' writes " + voice.topic.Name() + ", which only " + voice.rightful + " may (process 200 on vm)");
  }
}

TEST_F(WireAuditTest, AStrangerWithoutANameIsNamedByItsProcessOrItsGuid) {
  audit_.OnParticipant(Participant(200), "", "process 200 (ddsperf) on vm");
  Writes(Participant(200), Topic::Command(1));
  EXPECT_EQ(
      audit_.Violation(),
      "a participant without a name (process 200 (ddsperf) on vm) writes /agent_1/command, which only agent_1 may");
  WireAudit another(experiment_, peers_);
  WireAudit::Guid guid;
  guid.guidPrefix = Participant(200);
  another.OnParticipant(guid.guidPrefix, "", "");
  another.OnEndpoint(guid, Topic::Clock().DdsName(), /*reads=*/false);
  EXPECT_EQ(another.Violation(),
            "a participant without a name (01.0f.00.00.c8.00.00.00.00.00.00.00) writes /clock, which only "
            "physics_server may");
}

TEST_F(WireAuditTest, AProcessOfTheRunMayNotWriteForAnother) {
  Writes(Participant(102), Topic::Command(1));
  EXPECT_EQ(audit_.Violation(), "agent_2 writes /agent_1/command, which the graph does not let it");
  WireAudit another(experiment_, peers_);
  WireAudit::Guid guid;
  guid.guidPrefix = Participant(100);
  another.OnParticipant(guid.guidPrefix, "physics_server", "");
  another.OnEndpoint(guid, Topic::Experiment().DdsName(), /*reads=*/false);
  EXPECT_EQ(another.Violation(), "'physics_server' writes /experiment, which only orchestrator may");
}

/// What is found if the process of agents 1 and 2, on a path of four agents, is on this topic.
std::string IfAgentsOneAndTwo(bool reads, const Topic& topic, const std::string& delivery) {
  const Experiment experiment = Load(
      "[run]\nduration_s = 1.0\n[agents]\ncount = 4\n[graph]\ntopology = \"path\"\n[law]\nname = \"consensus\"\n"
      "[network]\nagents_per_process = 2\n",
      delivery);
  Peers peers;
  peers.Know("agents_1-2", ProcessKey::WithPid(100));
  WireAudit audit(experiment, peers);
  audit.OnParticipant(Participant(100), "agents_1-2", "");
  WireAudit::Guid guid;
  guid.guidPrefix = Participant(100);
  audit.OnEndpoint(guid, topic.DdsName(), reads);
  return audit.Violation();
}
std::string IfAgentsOneAndTwoRead(const Topic& topic, const std::string& delivery) {
  return IfAgentsOneAndTwo(/*reads=*/true, topic, delivery);
}

TEST(WireAudit, AProcessOfSeveralAgentsMayHearWhatOneOfThemMayAndNoMore) {
  EXPECT_EQ(IfAgentsOneAndTwoRead(Topic::State(3), "topics"), "") << "agent 2 may hear it";
  EXPECT_EQ(IfAgentsOneAndTwoRead(Topic::State(4), "topics"),
            "agents_1-2 reads /agent_4/state, which the graph does not let it");
  EXPECT_EQ(IfAgentsOneAndTwoRead(Topic::Bundle({1, 2}), "topics"),
            "agents_1-2 reads /agents_1-2/bundle, which the graph does not let it");
}

TEST(WireAudit, AProcessThatIsSentBundlesMayHearItsOwnAndNothingElse) {
  for (const char* delivery : {"bundled", "auto"}) {
    EXPECT_EQ(IfAgentsOneAndTwoRead(Topic::Bundle({1, 2}), delivery), "");
    EXPECT_EQ(IfAgentsOneAndTwoRead(Topic::Event(), delivery), "");
    for (const Topic& topic : {Topic::Bundle({3, 4}), Topic::Bundle({1, 1}), Topic::Answers({1, 2}), Topic::Row(),
                               Topic::State(1), Topic::State(2), Topic::Command(1), Topic::Clock()})
      EXPECT_EQ(IfAgentsOneAndTwoRead(topic, delivery),
                "agents_1-2 reads " + topic.Name() + ", which the graph does not let it");
  }
}

TEST(WireAudit, AProcessThatIsSentBundlesMayWriteItsOwnAnswersAndNothingElse) {
  EXPECT_EQ(IfAgentsOneAndTwo(/*reads=*/false, Topic::Answers({1, 2}), "bundled"), "");
  for (const Topic& topic :
       {Topic::Answers({3, 4}), Topic::Answers({1, 1}), Topic::Bundle({1, 2}), Topic::Row(), Topic::Command(1)})
    EXPECT_EQ(IfAgentsOneAndTwo(/*reads=*/false, topic, "bundled"),
              "agents_1-2 writes " + topic.Name() + ", which the graph does not let it");
}

TEST(WireAudit, OfBundlesIsCompleteWithBothStreamsOfEachProcess) {
  const Experiment experiment =
      Load("[run]\nduration_s = 1.0\n[agents]\ncount = 3\n[network]\nagents_per_process = 2\n", "bundled");
  Peers peers;
  peers.Know("agents_1-2", ProcessKey::WithPid(100));
  peers.Know("agent_3", ProcessKey::WithPid(101));
  WireAudit audit(experiment, peers);
  std::uint8_t number = 0;
  for (const auto& [pid, topic, reads] :
       {std::tuple(100, Topic::Bundle({1, 2}), true), std::tuple(100, Topic::Answers({1, 2}), false),
        std::tuple(101, Topic::Bundle({3, 3}), true), std::tuple(101, Topic::Answers({3, 3}), false)}) {
    EXPECT_FALSE(audit.IsComplete());
    audit.OnParticipant(Participant(pid), pid == 100 ? "agents_1-2" : "agent_3", "");
    WireAudit::Guid guid;
    guid.guidPrefix = Participant(pid);
    guid.entityId.value[0] = ++number;
    audit.OnEndpoint(guid, topic.DdsName(), reads);
  }
  EXPECT_TRUE(audit.IsComplete());
  EXPECT_EQ(audit.Violation(), "");
}

TEST(WireAudit, IsNotCompleteWithoutEveryReaderOfMessages) {
  const Experiment two = Load(
      "[run]\nduration_s = 1.0\n[agents]\ncount = 2\n[network]\nagents_per_process = 2\n[law]\nname = 'custom'\n"
      "python = '''\ndef control(t, me, heard):\n  return [0, 0]\ndef message(me):\n  return [1]\n'''\n");
  Peers peers;
  peers.Know("agents_1-2", ProcessKey::WithPid(100));
  WireAudit audit(two, peers);
  audit.OnParticipant(Participant(100), "agents_1-2", "");
  WireAudit::Guid guid;
  guid.guidPrefix = Participant(100);
  const auto add = [&](const Topic& topic, bool reads) {
    ++guid.entityId.value[0];
    audit.OnEndpoint(guid, topic.DdsName(), reads);
  };
  for (const int id : {1, 2}) {
    add(Topic::State(id), true);
    add(Topic::Command(id), false);
    add(Topic::Message(id), false);
  }
  add(Topic::Message(1), true);
  EXPECT_FALSE(audit.IsComplete()) << "nobody reads the messages of agent 2";
  add(Topic::Message(2), true);
  EXPECT_TRUE(audit.IsComplete());
  EXPECT_EQ(audit.Violation(), "");
}

TEST(WireAudit, IsNotCompleteWithoutEveryReaderOfActions) {
  for (const std::string delivery : {"bundled", "topics"}) {
    const Experiment one = Load("[run]\nduration_s = 1.0\n[agents]\ncount = 1\n[law]\nname = 'actions'\n", delivery);
    Peers peers;
    peers.Know("agent_1", ProcessKey::WithPid(100));
    WireAudit audit(one, peers);
    audit.OnParticipant(Participant(100), "agent_1", "");
    WireAudit::Guid guid;
    guid.guidPrefix = Participant(100);
    const auto add = [&](const Topic& topic, bool reads) {
      ++guid.entityId.value[0];
      audit.OnEndpoint(guid, topic.DdsName(), reads);
    };
    add(delivery == "topics" ? Topic::State(1) : Topic::Bundle({1, 1}), true);
    add(delivery == "topics" ? Topic::Command(1) : Topic::Answers({1, 1}), false);
    EXPECT_FALSE(audit.IsComplete());
    add(Topic::Action(1), true);
    EXPECT_TRUE(audit.IsComplete());
    EXPECT_EQ(audit.Violation(), "");
  }
}

TEST(WireAudit, AnAgentMayReadItsOwnActionsAlone) {
  const Experiment two = Load(
      "[run]\nduration_s = 1.0\n[agents]\ncount = 2\n[[agents.override]]\nid = 2\nlaw = { name = 'consensus' }\n"
      "[law]\nname = 'actions'\n");
  const auto violation_of = [&](int agent, const Topic& topic, bool reads) {
    Peers peers;
    for (const int id : {1, 2}) peers.Know(AgentName(id), ProcessKey::WithPid(100 + id));
    WireAudit audit(two, peers);
    audit.OnParticipant(Participant(100 + agent), AgentName(agent), "");
    WireAudit::Guid guid;
    guid.guidPrefix = Participant(100 + agent);
    audit.OnEndpoint(guid, topic.DdsName(), reads);
    return audit.Violation();
  };
  EXPECT_EQ(violation_of(1, Topic::Action(1), true), "");
  EXPECT_EQ(violation_of(2, Topic::Action(1), true), "agent_2 reads /agent_1/action, which the graph does not let it");
  EXPECT_EQ(violation_of(2, Topic::Action(2), true), "agent_2 reads /agent_2/action, which the graph does not let it")
      << "its law takes none";
  EXPECT_EQ(violation_of(1, Topic::Action(1), false),
            "agent_1 writes /agent_1/action, which the graph does not let it");
}

// --- fresh processes ------------------------------------------------------------------------------------

TEST_F(WireAuditTest, AProcessThatHasEndedWritesNothingAnyMore) {
  Writes(Participant(102), Topic::Command(2));
  audit_.OnEnd("agent_2");  // discovery has not noticed
  Start("agent_2", 112);
  Writes(Participant(112), Topic::Command(2));
  EXPECT_EQ(audit_.Violation(), "");
}

// --- the replay of an agent -----------------------------------------------------------------------------

TEST_F(WireAuditTest, AParticipantThatStandsForSeveralProcessesWritesWhatTheseMay) {
  for (const char* process : {"physics_server", "agent_2", "agent_3"})
    peers_.Know(process, ProcessKey::Of(Participant(99)));
  for (const Topic& topic : {Topic::State(1), Topic::Event(), Topic::Message(2), Topic::Experiment()})
    Writes(Participant(99), topic);
  EXPECT_EQ(audit_.Violation(), "");
  Writes(Participant(99), Topic::Command(1));
  EXPECT_EQ(audit_.Violation(), "'orchestrator' writes /agent_1/command, which only agent_1 may");
}

}  // namespace
}  // namespace mascot
