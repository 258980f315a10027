// Runs over DDS, with the real processes, in a domain with strangers: nothing that these send changes the run, and a
// stranger that sends something is named.

#include <gmock/gmock.h>

#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <tuple>

#include "bus/wire.h"
#include "tests/support/folders.h"
#include "tests/support/intruder.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

// A reader that asks for no more than best effort hears all writers.
constexpr Redelivery kAnyWriter = Redelivery::kOnDemand;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();

/// A run that would last longer than any test: four points on a path, whose laws send messages.
class Strangers : public testing::Test {
 protected:
  Up Endless(const std::vector<std::string>& more = {}, const std::string& law = "talker") {
    WriteFile(folder_.File("endless.toml"),
              "[run]\nduration_s = 100000.0\n[agents]\ncount = 4\nmodel = 'double_integrator'\n[graph]\n"
              "topology = 'path'\n[output]\nsave_plot = false\nfidelity = false\n[law]\nname = 'plugin'\nlibrary = '" +
                  BuildFolder() + "/tests/plugins/lib" + law + ".so'\n" +
                  (law == "talker" ? "params = { words = 0 }\n" : ""));
    return Up(folder_, "run", folder_.File("endless.toml"), more);
  }

  /// The run has failed because of `why`, and no process of it because of anything else.
  static void ExpectFailedBy(const Up& up, int exit_code, const std::string& why) {
    EXPECT_EQ(exit_code, 1);
    EXPECT_THAT(up.err(), AllOf(HasSubstr("the wire differs from the graph: " + why), Not(HasSubstr("was killed by")),
                                Not(HasSubstr(" exited with code"))));
    EXPECT_EQ(up.Summary()["wire"]["matches_graph"], false);
  }

  ScratchFolder folder_;
};

// --- what strangers write ----------------------------------------------------------------------------

/// A sample that a stranger writes, and what the run says of it.
struct Lie {
  const char* what;
  std::string name;  ///< of the participant
  std::function<int(Up&, const std::string& name)> tell;
  std::string error;
  std::vector<std::string> more = {};  ///< arguments of `up`
};

const std::vector<std::string> kTopics{"--set", "network.delivery=topics"};
const std::vector<std::string> kTopicsInRealTime{"--set", "network.delivery=topics", "--set", "run.mode=realtime"};

void PrintTo(const Lie& lie, std::ostream* out) { *out << lie.what; }

template <class PubSub>
std::function<int(Up&, const std::string&)> Write(const Topic& topic, const typename PubSub::type& sample) {
  return [=](Up& up, const std::string& name) { return Harass<PubSub>(up, name, topic, sample); };
}

template <class Sample>
Sample OfTick(std::uint64_t tick, std::uint32_t agent) {
  Sample sample;
  sample.tick(tick);
  sample.agent(agent);
  return sample;
}

mascot_msgs::msg::Answers AnswersOf(std::uint64_t tick, std::uint32_t agent) {
  mascot_msgs::msg::Answers answers;
  answers.tick(tick);
  answers.commands().push_back(OfTick<mascot_msgs::msg::AgentCommand>(tick, agent));
  return answers;
}

mascot_msgs::msg::Request RequestTo(Ask ask) {
  mascot_msgs::msg::Request request;
  request.kind(static_cast<std::uint8_t>(ask));
  return request;
}

mascot_msgs::msg::Status StatusOf(const std::string& process, Life life) {
  mascot_msgs::msg::Status status;
  status.process(process);
  status.state(static_cast<std::uint8_t>(life));
  status.tick(3);
  return status;
}

std::vector<Lie> Lies() {
  using mascot_msgs::msg::AgentCommand;
  using mascot_msgs::msg::AgentMessage;
  using mascot_msgs::msg::AgentState;
  const std::string server_twice = "two processes say that they are physics_server";
  return {
      {"a message of the largest tick", "rviz",
       Write<MessageType>(Topic::Message(2), OfTick<AgentMessage>(kLargest, 2)),
       "'rviz' writes /agent_2/message, which only agent_2 may (process ", kTopics},
      {"a state of tick 2^62", "physics_server",
       Write<StateType>(Topic::State(1), OfTick<AgentState>(std::uint64_t{1} << 62, 1)), server_twice, kTopics},
      {"answers of the largest tick", "rviz", Write<AnswersType>(Topic::Answers({2, 2}), AnswersOf(kLargest, 2)),
       "'rviz' writes /agent_2/answers, which only agent_2 may (process "},
      {"answers of another agent", "rviz", Write<AnswersType>(Topic::Answers({2, 2}), AnswersOf(3, 77)),
       "'rviz' writes /agent_2/answers, which only agent_2 may (process "},
      {"a bundle", "rviz", Write<BundleType>(Topic::Bundle({1, 1}), {}),
       "'rviz' writes /agent_1/bundle, which only physics_server may (process "},
      {"a bundle under the name of the server", "physics_server", Write<BundleType>(Topic::Bundle({1, 1}), {}),
       server_twice},
      {"an action", "rviz", Write<ActionType>(Topic::Action(1), {}),
       "'rviz' writes /agent_1/action, which only orchestrator may (process "},
      {"a row", "rviz", Write<RowType>(Topic::Row(), {}),
       "'rviz' writes /row, which only physics_server may (process "},
      {"a state of the largest tick in real time", "physics_server",
       Write<StateType>(Topic::State(1), OfTick<AgentState>(kLargest, 1)), server_twice, kTopicsInRealTime},
      {"a command of no agent", "rviz", Write<CommandType>(Topic::Command(2), OfTick<AgentCommand>(kLargest, 77)),
       "'rviz' writes /agent_2/command, which only agent_2 may", kTopics},
      {"the end of the server in real time",
       "physics_server",
       Write<StatusType>(Topic::Status(), StatusOf("physics_server", Life::kDone)),
       server_twice,
       {"--set", "run.mode=realtime"}},
      {"a status under the name of another", "rviz",
       Write<StatusType>(Topic::Status(), StatusOf("physics_server", Life::kDone)),
       "'rviz' writes /status, which only processes of the run may"},
      {"a request to stop", "rviz", Write<RequestType>(Topic::Request(), RequestTo(Ask::kStop)),
       "'rviz' writes /request, which only orchestrator may"},
      {"a request to end", "rviz", Write<RequestType>(Topic::Request(), RequestTo(Ask::kEnd)),
       "'rviz' writes /request, which only orchestrator may"},
      {"an experiment", "rviz", Write<ExperimentType>(Topic::Experiment(), {}),
       "'rviz' writes /experiment, which only orchestrator may"},
      {"a place of an agent",
       "rviz",
       Write<ClockType>(Topic::Tf(), {}),
       "'rviz' writes /tf, which only orchestrator may",
       {"--set", "network.ros_view=true"}},
  };
}

class Told : public Strangers, public testing::WithParamInterface<Lie> {};

TEST_P(Told, ALieIsNotBelievedAndItsTellerIsNamed) {
  Up up = Endless(GetParam().more);
  ASSERT_TRUE(Flies(up));
  const int exit_code = GetParam().tell(up, GetParam().name);
  ExpectFailedBy(up, exit_code, GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(By, Told, testing::ValuesIn(Lies()), NamedAsPrinted<Lie>);

TEST_F(Strangers, ALieBeforeTheStartIsNotBelievedEither) {
  Up up = Endless({"--set", "agents.override=[{id = 1, host = \"external\"}]"});
  ASSERT_TRUE(Until([&] { return up.Said("waiting for: agent --id 1"); }));
  const int exit_code = Harass<RequestType>(up, "rviz", Topic::Request(), RequestTo(Ask::kEnd));
  ExpectFailedBy(up, exit_code, "'rviz' writes /request, which only orchestrator may");
}

TEST_F(Strangers, OneOfAnotherVendorIsNamedByItsProcess) {
  const std::string program = BuildFolder() + "/cyclone_note";
  if (!std::filesystem::exists(program)) GTEST_SKIP() << "built without cyclonedds-dev: run scripts/setup --test";
  Up up = Endless();
  ASSERT_TRUE(Flies(up));
  Running stranger(program, {std::to_string(DomainOf(up)), Topic::Command(2).DdsName()}, folder_.File("stranger"));
  const std::string process = std::to_string(stranger.pid());
  const int exit_code = up.Wait();
  ExpectFailedBy(up, exit_code, "a participant without a name (process " + process + " (cyclone_note) on ");
  EXPECT_THAT(up.err(), HasSubstr(") writes /agent_2/command, which only agent_2 may"));
}

// --- which strangers listen --------------------------------------------------------------------------

TEST_F(Strangers, ARunIsTheSameWhoeverListensAndInEveryDelivery) {
  const auto fly = [&](const std::string& name, const std::string& delivery,
                       const std::function<void(Up&)>& meanwhile) {
    Up up(folder_, name, folder_.File("endless.toml"), {"--duration-s", "2", "--set", "network.delivery=" + delivery});
    meanwhile(up);
    EXPECT_EQ(up.Wait(), 0) << up.err();
    return up.File("run.mcap");
  };
  Endless().Signal(SIGKILL);  // writes the file
  const std::string alone = fly("alone", "auto", [](Up&) {});
  for (const std::string delivery : {"topics", "bundled"}) {
    std::atomic<int> heard = 0;
    const std::string watched = fly(delivery, delivery, [&](Up& up) {
      ASSERT_TRUE(Until([&] { return up.Said("domain "); }));
      Domain domain(Intruder(up, "rviz"), [] {});  // it is there before the run starts, and to its end
      Reader<StateType> states(domain, Topic::State(4), [&](const auto&) { ++heard; });
      Reader<MessageType> messages(domain, Topic::Message(2), [](const auto&) {});
      const RawReader bundles(
          domain, Topic::Bundle({4, 4}), [&](const auto&, const auto&) { ++heard; }, kAnyWriter);
      Reader<RowType> rows(domain, Topic::Row(), [](const auto&) {});
      Reader<StatusType> statuses(domain, Topic::Status(), [](const auto&) {});
      EXPECT_TRUE(Until([&] { return up.IsOver(); }));
    });
    EXPECT_TRUE(alone == watched) << "run.mcap differs";
    EXPECT_GT(heard, 0);
  }
}

TEST_F(Strangers, WhatAProcessIsSentHasNoStateThatNoneOfItsAgentsMayHear) {
  Up up = Endless({"--set", "network.agents_per_process=2"});
  ASSERT_TRUE(Flies(up));
  std::mutex mutex;
  std::map<std::string, std::set<std::vector<std::uint32_t>>> sent;  // states and senders of messages, by process
  Domain domain(Intruder(up, "rviz"), [] {});
  std::vector<std::unique_ptr<RawReader>> readers;
  for (const AgentRange agents : {AgentRange{1, 2}, AgentRange{3, 4}})
    readers.push_back(std::make_unique<RawReader>(
        domain, Topic::Bundle(agents),
        [&, name = ProcessName(agents)](const RawReader::Bytes& bytes, const Sender& /*sender*/) {
          mascot_msgs::msg::Bundle bundle;
          ASSERT_TRUE(Decode<BundleType>(bytes, bundle));
          std::vector<std::uint32_t> states, senders;
          for (const auto& state : bundle.states()) states.push_back(state.agent());
          for (const auto& message : bundle.messages()) senders.push_back(message.agent());
          const std::lock_guard lock(mutex);
          sent[name + " states"].insert(states);
          sent[name + " messages"].insert(senders);
        },
        kAnyWriter));
  ASSERT_TRUE(Until([&] {
    const std::lock_guard lock(mutex);
    return sent.size() == 4;
  }));
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  using Ids = std::set<std::vector<std::uint32_t>>;
  EXPECT_EQ(sent["agents_1-2 states"], (Ids{{1, 2, 3}}));
  EXPECT_EQ(sent["agents_1-2 messages"], (Ids{{1, 2, 3}}));
  EXPECT_EQ(sent["agents_3-4 states"], (Ids{{3, 4, 2}}));
  EXPECT_EQ(sent["agents_3-4 messages"], (Ids{{3, 4, 2}}));
}

TEST_F(Strangers, OneThatListenedAsAnAgentFailsTheRunThoughItHasLeft) {
  for (const std::string delivery : {"topics", "bundled"}) {
    Up up = Endless({"--force", "--set", "network.delivery=" + delivery});
    ASSERT_TRUE(Flies(up));
    {
      std::atomic<bool> heard = false;
      Domain domain(Intruder(up, "agent_1"), [] {});
      Reader<StateType> peeking(domain, Topic::State(4), [&](const auto&) { heard = true; });
      const RawReader bundles(
          domain, Topic::Bundle({4, 4}), [&](const auto&, const auto&) { heard = true; }, kAnyWriter);
      ASSERT_TRUE(Until([&] { return heard || up.IsOver(); }));  // it may be found first
    }
    ExpectFailedBy(up, up.Wait(), "two processes say that they are agent_1 (process " + std::to_string(getpid()));
  }
}

TEST_F(Strangers, AnAgentThatHearsMoreThanTheGraphAllowsFailsTheRunThoughByASecondParticipant) {
  for (const auto& [topic, type, delivery] :
       {std::tuple("agent_4/state", "AgentState", "topics"), std::tuple("agent_4/bundle", "Bundle", "bundled"),
        std::tuple("agent_4/answers", "Answers", "bundled"), std::tuple("row", "TickRow", "bundled")}) {
    SCOPED_TRACE(topic);
    const std::string params = std::string("law.params={ topic = '") + topic + "', type = '" + type + "' }";
    Up up = Endless({"--force", "--set", std::string("network.delivery=") + delivery, "--set", params}, "eavesdropper");
    ExpectFailedBy(up, up.Wait(),
                   std::string("agent_1 (as 'rviz') reads /") + topic + ", which the graph does not let it");
  }
}

// --- places of the run --------------------------------------------------------------------------------

TEST_F(Strangers, ThePlaceOfAnAgentStartedByHandIsTheFirstOnes) {
  Up up = Endless({"--set", "agents.override=[{id = 2, host = \"external\"}]"});
  ASSERT_TRUE(Until([&] { return up.Said("waiting for: agent --id 2"); }));
  const std::vector<std::string> words{"--id", "2", "--loopback", "--domain", std::to_string(DomainOf(up))};
  Running first(BuildFolder() + "/agent", words, folder_.File("first"));
  ASSERT_TRUE(Flies(up)) << up.err() << first.err();
  Running second(BuildFolder() + "/agent", words, folder_.File("second"));
  EXPECT_EQ(second.Wait(), 2);
  EXPECT_EQ(second.err(),
            "error: --id 2: expected no agent, because the run waits for none, got one that is there already\n");
  EXPECT_FALSE(up.IsOver()) << "nobody has heard the second";
}

TEST_F(Strangers, AnAgentByHandThatTheRunDoesNotWaitForIsNotHeard) {
  Up up = Endless({"--set", "agents.override=[{id = 2, host = \"external\"},{id = 3, host = \"external\"}]"});
  ASSERT_TRUE(Until([&] { return up.Said("waiting for: agent --id 3"); }));
  const auto refusal = [&](const std::string& id) {
    Running agent(BuildFolder() + "/agent", {"--id", id, "--loopback", "--domain", std::to_string(DomainOf(up))},
                  folder_.File("agent" + id));
    EXPECT_EQ(agent.Wait(), 2);
    return agent.err();
  };
  EXPECT_EQ(refusal("9"),
            "error: --id 9: expected an agent for which the run waits (2, 3), got one that the run does "
            "not have\n");
  EXPECT_EQ(refusal("1"),
            "error: --id 1: expected an agent for which the run waits (2, 3), got one that is there "
            "already\n");
  EXPECT_FALSE(up.IsOver()) << up.err();
}

TEST_F(Strangers, ThePlaceOfAnAgentThatLeftBeforeTheStartIsFree) {
  Up up = Endless({"--duration-s", "0.5", "--set",
                   "agents.override=[{id = 2, host = \"external\"},{id = 3, host = \"external\"}]"});
  ASSERT_TRUE(Until([&] { return up.Said("waiting for: agent --id 3"); }));
  const auto words = [&](const char* id) {
    return std::vector<std::string>{"--id", id, "--loopback", "--domain", std::to_string(DomainOf(up))};
  };
  Running first(BuildFolder() + "/agent", words("2"), folder_.File("first"));
  ASSERT_TRUE(Until([&] { return first.Said("hears 1 3"); })) << first.err();
  first.Signal(SIGINT);
  EXPECT_EQ(first.Wait(), 130);
  Running second(BuildFolder() + "/agent", words("2"), folder_.File("second"));
  Running third(BuildFolder() + "/agent", words("3"), folder_.File("third"));
  EXPECT_EQ(up.Wait(), 0) << up.err() << second.err() << third.err();
}

}  // namespace
}  // namespace mascot::test
