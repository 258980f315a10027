// The bus: topic names, serialised bytes, and exchange of samples between two domains in one process.

#include "bus/bus.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <pwd.h>
#include <sched.h>
#include <sys/mount.h>

#include <atomic>
#include <cstring>
#include <memory>
#include <new>
#include <set>
#include <system_error>
#include <thread>

#include "bus/leave.h"
#include "bus/lifecycle.h"
#include "bus/obituary.h"
#include "bus/ports.h"
#include "bus/wire.h"
#include "idl/schemas.h"
#include "orchestrator/engines/dds/machine/domain_lock.h"
#include "orchestrator/engines/dds/ros_publisher.h"
#include "system/stop_signal.h"
#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Topic, IsMadeAndParsedAlike) {
  for (const Topic& topic :
       {Topic::State(1), Topic::State(123), Topic::Bundle({4, 4}), Topic::Bundle({1, 50}), Topic::Answers({7, 9}),
        Topic::Row(), Topic::Command(7), Topic::Message(12), Topic::Clock(), Topic::Status(), Topic::Request(),
        Topic::Experiment(), Topic::Tf(), Topic::Scene(), Topic::Odom(8)}) {
    EXPECT_EQ(Topic::Parse(topic.Name()), topic);
    EXPECT_EQ(Topic::Parse(topic.DdsName()), topic);
  }
  EXPECT_EQ(Topic::State(3).DdsName(), "rt/agent_3/state");
  EXPECT_EQ(Topic::Clock().DdsName(), "rt/clock");
  EXPECT_EQ(Topic::Bundle({4, 4}).Name(), "/agent_4/bundle");
  EXPECT_EQ(Topic::Answers({1, 50}).Name(), "/agents_1-50/answers");
}

TEST(Topic, HasARowOfItsOwnForEachKindInTheOrderOfTheirNames) {
  for (int i = 0; i <= static_cast<int>(TopicKind::kTf); ++i) {
    const auto kind = static_cast<TopicKind>(i);
    const TopicTraits& traits = TraitsOf(kind);
    EXPECT_EQ(traits.kind, kind);
    EXPECT_EQ(SchemaOf(kind).name, traits.type);
    EXPECT_GE(traits.writer_depth, 1) << traits.name;
    EXPECT_GE(traits.reader_depth, 1) << traits.name;
    if (i == 0) continue;
    const TopicTraits& before = TraitsOf(static_cast<TopicKind>(i - 1));
    const bool has_owner = traits.per_agent || traits.per_process, had_owner = before.per_agent || before.per_process;
    EXPECT_GE(had_owner, has_owner) << traits.name;
    EXPECT_TRUE(had_owner != has_owner || before.name < traits.name) << traits.name;
  }
}

TEST(Topic, AgentsAreNamedAndNumberedAlike) {
  EXPECT_EQ(AgentName(12), "agent_12");
  EXPECT_EQ(ProcessName({12, 12}), "agent_12");
  EXPECT_EQ(ProcessName({1, 50}), "agents_1-50");
  for (const AgentRange agents : {AgentRange{12, 12}, AgentRange{1, 50}, AgentRange{9999, 10000}})
    EXPECT_EQ(AgentsOf(ProcessName(agents)), agents);
  for (const char* name :
       {"agent_", "agent_x", "agent_1x", "agent_-1", "agents_", "agents_3", "agents_-3", "agents_3-", "agents_3-3",
        "agents_5-3", "agents_1-x", "agents_1--2", "agent_0", "agent_03", "agents_0-3", "agents_1-03", "recorder", ""})
    EXPECT_EQ(AgentsOf(name), std::nullopt) << name;
}

TEST(Topic, IsNotParsedFromForeignNames) {
  for (const char* name :
       {"", "rt", "rt/", "/", "/agent_/state", "/agent_0/state", "/agent_03/state", "/agent_-1/state", "/agent_3",
        "/agent_3/", "/agent_3/clock", "/state", "/agent_3/state2", "/tf_static", "/agents_1-3/state", "/bundle",
        "/agents_3-1/bundle", "/agent_1/row", "rt/agent_x/state"})
    EXPECT_EQ(Topic::Parse(name), std::nullopt) << name;
}

TEST(Wire, TypesHaveTheNamesThatRos2GivesThem) {
  EXPECT_EQ(WireTypeName(TopicKind::kState), "mascot_msgs::msg::dds_::AgentState_");
  EXPECT_EQ(WireTypeName(TopicKind::kClock), "rosgraph_msgs::msg::dds_::Clock_");
  EXPECT_EQ(WireTypeName(TopicKind::kTf), "tf2_msgs::msg::dds_::TFMessage_");
  EXPECT_EQ(WireTypeName(TopicKind::kOdom), "nav_msgs::msg::dds_::Odometry_");
  EXPECT_EQ(WireTypeName(TopicKind::kScene), "visualization_msgs::msg::dds_::MarkerArray_");
}

TEST(Wire, TypesHaveTheNamesOfTheirGeneratedCode) {
  EXPECT_EQ(WireTypeName(TopicKind::kAction), ActionType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kAnswers), AnswersType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kBundle), BundleType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kRow), RowType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kCommand), CommandType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kMessage), MessageType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kState), StateType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kClock), ClockType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kEvent), EventType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kExperiment), ExperimentType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kRequest), RequestType().getName());
  EXPECT_EQ(WireTypeName(TopicKind::kStatus), StatusType().getName());
}

TEST(Wire, StampsAreDividedAndNeverAccumulated) {
  EXPECT_EQ(StampNs(0, 100), 0u);
  EXPECT_EQ(StampNs(1, 3), 333'333'333u);
  EXPECT_EQ(StampNs(2, 3), 666'666'667u);
  EXPECT_EQ(StampNs(3'000'000'001, 3), 1'000'000'000'333'333'333u);
}

Motion SomeMotion() {
  Motion motion;
  motion.p_WB = {1, 2, 3};
  motion.q_WB = Eigen::Quaterniond(0.5, 0.1, 0.2, 0.3);
  motion.v_WB = {4, 5, 6};
  motion.w_WB_B = {7, 8, 9};
  motion.a_WB = {10, 11, 12};
  return motion;
}

TEST(Wire, AMotionComesBackAsItWent) {
  mascot_msgs::msg::AgentState sample, received;
  ToWire(17, 100, 3, 0, SomeMotion(), sample);
  std::vector<std::uint8_t> bytes;
  Serialize(sample, bytes);
  Deserialize(bytes, received);
  const Motion motion = FromWire(received), sent = SomeMotion();
  EXPECT_EQ(motion.p_WB, sent.p_WB);
  EXPECT_EQ(motion.q_WB.coeffs(), sent.q_WB.coeffs());
  EXPECT_EQ(motion.v_WB, sent.v_WB);
  EXPECT_EQ(motion.w_WB_B, sent.w_WB_B);
  EXPECT_EQ(motion.a_WB, sent.a_WB);
  EXPECT_EQ(received.pose().orientation().w(), 0.5);  // ROS: x, y, z, w, by name
}

TEST(Wire, BytesOfAnotherLengthAreRefused) {
  mascot_msgs::msg::AgentState sample;
  EXPECT_THAT(
      [&] { Deserialize(std::vector<std::uint8_t>(3), sample); },
      ThrowsMessage<std::runtime_error>(HasSubstr("a sample of 3 bytes is no mascot_msgs::msg::dds_::AgentState_")));
}

TEST(Wire, BytesWithAnotherEncapsulationAreRefused) {
  mascot_msgs::msg::AgentState sample;
  std::vector<std::uint8_t> bytes;
  Serialize(sample, bytes);
  for (const std::size_t at : {0, 1}) {
    std::vector<std::uint8_t> changed = bytes;
    changed[at] = 99;
    EXPECT_THAT([&] { Deserialize(changed, sample); },
                ThrowsMessage<std::runtime_error>(HasSubstr("bytes is no mascot_msgs::msg::dds_::AgentState_")));
    changed[at] = bytes[at];
    EXPECT_EQ(changed, bytes) << "the bytes are still the caller's";
  }
}

/// Two participants in a DDS domain that only this test uses.
class Bus : public testing::Test {
 protected:
  DomainOptions Options(const std::string& name) const {
    DomainOptions options;
    options.domain = lock_.domain();
    options.name = name;
    options.loopback = true;
    return options;
  }

  DomainLock lock_{-1};
  Domain here_{Options("here"), [] {}};
  Domain there_{Options("there"), [] {}};
};

TEST_F(Bus, SamplesAreTakenFromTheProcessWhoseTopicItIsAndFromNobodyElse) {
  Peers peers;
  peers.Know("physics_server", ProcessKey::WithPid(getpid() + 1));
  Domain believer(
      Options("agent_1"), [] {}, &peers);
  std::atomic<int> taken = 0, heard = 0;
  Reader<StateType> reader(believer, Topic::State(1), [&](const auto&, const Sender& sender) {
    EXPECT_EQ(sender.process, "physics_server");
    ++taken;
  });
  Reader<StateType> listener(there_, Topic::State(1), [&](const auto&) { ++heard; });
  Writer<StateType> writer(here_, Topic::State(1));
  ASSERT_TRUE(Until([&] { return writer.matched() == 2 && listener.matched() == 1; }));
  mascot_msgs::msg::AgentState sample;
  ASSERT_TRUE(Until([&] {
    writer.Write(sample);
    return !peers.Refusals().empty();
  }));
  EXPECT_EQ(taken, 0);
  EXPECT_EQ(reader.matched(), 0) << "a stranger's writer counts for nothing";
  EXPECT_THAT(peers.Refusals().at(0), HasSubstr("of /agent_1/state from " + Text(here_.guid_prefix())));
  peers.Know("physics_server", ProcessKey::Of(here_.guid_prefix()));
  ASSERT_TRUE(Until([&] {
    writer.Write(sample);
    return taken > 0;
  }));
  EXPECT_EQ(reader.matched(), 1);
  EXPECT_TRUE(Until([&] { return heard > 0; })) << "who knows no peers listens to everybody";
}

TEST_F(Bus, ASecondWriterOfAProcessIsCountedAndNotHeardBesideTheFirst) {
  Peers peers;
  peers.Know("physics_server", ProcessKey::WithPid(getpid()));
  Domain believer(
      Options("agent_1"), [] {}, &peers);
  std::atomic<std::uint64_t> newest = 0;
  std::atomic<int> wrong = 0;
  Reader<StateType> reader(believer, Topic::State(1), [&](const mascot_msgs::msg::AgentState& state) {
    newest = state.tick();
    if (state.tick() > 1000) ++wrong;
  });
  Writer<StateType> first(here_, Topic::State(1)), second(there_, Topic::State(1));
  ASSERT_TRUE(Until([&] { return first.matched() == 1 && second.matched() == 1; }));
  mascot_msgs::msg::AgentState sample;
  sample.tick(1);
  first.Write(sample);
  ASSERT_TRUE(Until([&] { return newest == 1; }));
  sample.tick(1001);
  second.Write(sample);
  second.AwaitReaders(std::chrono::seconds(10));
  sample.tick(2);
  first.Write(sample);
  ASSERT_TRUE(Until([&] { return newest == 2; }));
  EXPECT_EQ(wrong, 0);
  ASSERT_TRUE(Until([&] { return !peers.Refusals().empty(); }));
  EXPECT_THAT(peers.Refusals(), ElementsAre("not taken: 1 sample of /agent_1/state from " + Text(there_.guid_prefix()) +
                                            ", a second writer of physics_server"));
}

TEST_F(Bus, ADomainCountsTheParticipantsThatItHasDiscovered) {
  std::atomic<int> wakes = 0;
  const Domain domain(Options("agent_1"), [&] { ++wakes; });
  ASSERT_TRUE(Until([&] { return domain.discovered() == 2; })) << domain.discovered();
  EXPECT_GE(wakes, 2) << "who waits for them looks again";
  {
    const Domain third(Options("agent_2"), [] {});
    ASSERT_TRUE(Until([&] { return domain.discovered() == 3; })) << domain.discovered();
  }
  EXPECT_TRUE(Until([&] { return domain.discovered() == 2; })) << domain.discovered();
}

TEST_F(Bus, WhoIsSaidToHaveGoneIsNoReaderAnyMore) {
  Domain dead(Options("dead"), [] {});
  const RawWriter writer(here_, Topic::Event());
  const RawReader reader(dead, Topic::Event(), [](const RawReader::Bytes&, const Sender&) {});
  ASSERT_TRUE(Until([&] { return writer.matched() == 1; }));
  // The participant lives, and says so again: it is gone for a moment.
  ASSERT_TRUE(Until([&] {
    SayFarewellFor(dead.guid_prefix(), lock_.domain());
    return writer.matched() == 0;
  }));
}

TEST_F(Bus, AWriterCountsTheProcessesOfTheRunThatHearIt) {
  Peers peers;
  Domain server(
      Options("physics_server"), [] {}, &peers);
  Writer<StateType> writer(server, Topic::State(1));
  Writer<ClockType> clock(server, Topic::Clock());
  Reader<StateType> one(here_, Topic::State(1), [](const auto&) {}), two(there_, Topic::State(1), [](const auto&) {});
  Reader<ClockType> last_one(here_, Topic::Clock(), [](const auto&) {}),
      last_two(there_, Topic::Clock(), [](const auto&) {});
  ASSERT_TRUE(Until([&] { return one.matched() == 1 && two.matched() == 1; }));
  EXPECT_EQ(writer.matched(), 0) << "they are strangers";
  peers.Know("agent_1", ProcessKey::Of(here_.guid_prefix()));
  EXPECT_TRUE(Until([&] { return writer.matched() == 1; })) << "both are participants of one process";
}

TEST_F(Bus, OnlyTheOrchestratorIsObeyed) {
  Peers peers;
  peers.Know("orchestrator", ProcessKey::WithPid(getpid() + 1));
  peers.Know("physics_server", ProcessKey::Of(here_.guid_prefix()));
  StopSignal stop;
  Domain domain(
      Options("agent_1"), [&] { stop.Wake(); }, &peers);
  Lifecycle lifecycle(domain, peers, stop, "agent_1", 1);
  std::atomic<int> reports = 0;
  Reader<StatusType> statuses(there_, Topic::Status(), [&](const auto&) { ++reports; });
  Writer<RequestType> server(here_, Topic::Request());
  const auto ask = [&](Ask what) {
    mascot_msgs::msg::Request request;
    request.kind(static_cast<std::uint8_t>(what));
    server.Write(request);
  };
  ASSERT_TRUE(Until([&] { return server.matched() == 1 && statuses.matched() == 1; }));
  ask(Ask::kStop);
  ask(Ask::kEnd);
  ASSERT_TRUE(Until([&] {  // requests come in order: after a report, the others have been heard, too
    ask(Ask::kReport);
    lifecycle.Wait(std::chrono::milliseconds(5));
    return reports > 0;
  }));
  EXPECT_FALSE(lifecycle.stop_requested());
  peers.Know("orchestrator", ProcessKey::Of(there_.guid_prefix()));
  Writer<RequestType> orchestrator(there_, Topic::Request());
  mascot_msgs::msg::Request end;
  end.kind(static_cast<std::uint8_t>(Ask::kEnd));
  EXPECT_TRUE(Until([&] {
    orchestrator.Write(end);
    try {
      lifecycle.Wait(std::chrono::milliseconds(5));
      return false;
    } catch (const Ended&) {
      return true;
    }
  }));
}

/// Whether a sample is decoded after it was encoded.
template <class PubSub>
bool ComesBack(typename PubSub::type& sample) {
  ZeroPadded<PubSub> type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&sample)());
  typename PubSub::type back;
  return type.serialize(&sample, &payload) && Decode<PubSub>({payload.data, payload.length}, back);
}

TEST(Wire, ASequenceThatIsLongerThanItsSampleIsRefusedBeforeMemoryIsReserved) {
  mascot_msgs::msg::AgentMessage message;
  message.data({1, 2, 3});
  std::vector<std::uint8_t> bytes;
  Serialize(message, bytes);
  EXPECT_TRUE(Decode<MessageType>(bytes, message));
  std::fill_n(bytes.begin() + 24, 4, std::uint8_t{0xff});  // the number of elements: 4 294 967 295 of 8 bytes
  EXPECT_FALSE(Decode<MessageType>(bytes, message));
  mascot_msgs::msg::Experiment experiment;
  experiment.processes().resize(3);
  EXPECT_TRUE(ComesBack<ExperimentType>(experiment)) << "names may be empty";
  bytes.assign({0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff});
  EXPECT_FALSE(Decode<ExperimentType>(bytes, experiment));
  bytes.resize(3);
  EXPECT_FALSE(Decode<ExperimentType>(bytes, experiment));
}

TEST(Wire, TicksAndAgentsThatCannotBeAreRefused) {
  EXPECT_EQ(CheckedTick(Topic::State(2), 2, 100, 100), 100);
  for (const std::uint64_t tick : {std::uint64_t{101}, std::uint64_t{1} << 62, ~std::uint64_t{0}})
    EXPECT_THAT(
        [&] { CheckedTick(Topic::Message(2), 2, tick, 100); },
        ThrowsMessage<std::runtime_error>("/agent_2/message: expected a tick of 0 to 100 of agent 2, got tick " +
                                          std::to_string(tick) + " of agent 2"));
  for (const std::uint32_t agent : {0U, 3U, ~0U})
    EXPECT_THAT([&] { CheckedTick(Topic::Command(2), agent, 0, 100); },
                ThrowsMessage<std::runtime_error>(HasSubstr("got tick 0 of agent " + std::to_string(agent))));
}

/// Leaves, is asked to end by SIGTERM, and ends by itself with code 7.
[[noreturn]] void LeaveInSpiteOf(bool on_signals) {
  LeaveWithin(std::chrono::seconds(60), {.code = 3, .process = "agent_1", .on_signals = on_signals, .says_so = false});
  raise(SIGTERM);
  std::exit(7);
}

TEST(Leaving, HeedsNoSignalUnlessItIsToEndByForce) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(LeaveInSpiteOf(false), testing::ExitedWithCode(7), "");
  EXPECT_EXIT(LeaveInSpiteOf(true), testing::ExitedWithCode(3), "");
}

/// The files of Fast DDS in /dev/shm that this process maps.
std::set<std::string> FilesInSharedMemory() {
  std::set<std::string> files;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (const auto at = line.find("/dev/shm/fastrtps_"); at != line.npos) files.insert(line.substr(at));
  return files;
}

/// Their bytes.
std::uint64_t MappedSharedMemory() {
  std::uint64_t bytes = 0;
  for (const std::string& file : FilesInSharedMemory())
    if (std::filesystem::exists(file)) bytes += std::filesystem::file_size(file);  // else it says "(deleted)"
  return bytes;
}

TEST(Redelivery, ComesSoonOverANetworkThatMayLoseSamples) {
  const auto ms = [](const eprosima::fastrtps::Duration_t& time) { return static_cast<double>(time.to_ns()) / 1e6; };
  const auto times = [](TopicKind kind, Redelivery redelivery) {
    return WriterQos(kind, redelivery).reliable_writer_qos().times;
  };
  for (const TopicKind kind : {TopicKind::kBundle, TopicKind::kAnswers, TopicKind::kState, TopicKind::kCommand}) {
    EXPECT_EQ(ms(times(kind, Redelivery::kSeldom).nackSupressionDuration), 1000);
    EXPECT_LE(ms(times(kind, Redelivery::kOften).nackSupressionDuration), 5);
    EXPECT_EQ(ms(times(kind, Redelivery::kOften).nackResponseDelay), 0);
    EXPECT_EQ(ms(ReaderQos({kind, 1, 1}, Redelivery::kOften).reliable_reader_qos().times.heartbeatResponseDelay), 0);
  }
  for (const TopicKind kind : {TopicKind::kBundle, TopicKind::kAnswers})
    EXPECT_LE(ms(times(kind, Redelivery::kOften).heartbeatPeriod), 20) << "one for each process";
  EXPECT_GE(ms(times(TopicKind::kState, Redelivery::kOften).heartbeatPeriod), 200) << "many for each process";
}

TEST(Redelivery, OnDemandIsBestEffort) {
  const Topic topic = Topic::Bundle({1, 1});
  for (const auto& [redelivery, kind] :
       {std::pair(Redelivery::kOnDemand, eprosima::fastdds::dds::BEST_EFFORT_RELIABILITY_QOS),
        std::pair(Redelivery::kSeldom, eprosima::fastdds::dds::RELIABLE_RELIABILITY_QOS),
        std::pair(Redelivery::kOften, eprosima::fastdds::dds::RELIABLE_RELIABILITY_QOS)}) {
    EXPECT_EQ(WriterQos(topic.kind, redelivery).reliability().kind, kind);
    EXPECT_EQ(ReaderQos(topic, redelivery).reliability().kind, kind);
    EXPECT_EQ(RecorderQos(topic, redelivery).reliability().kind, kind);
  }
}

TEST(SharedMemoryNeed, IsKnownBeforeAParticipantIsMade) {
  const DomainLock lock(-1);
  for (const int peers : {2, 100}) {
    DomainOptions options;
    options.domain = lock.domain();
    options.transport = "shm";
    options.name = "needy";
    options.participants = peers;
    const auto before = MappedSharedMemory();
    const Domain domain(options, [] {});
    const auto taken = static_cast<double>(MappedSharedMemory() - before);
    const auto needed = static_cast<double>(SharedMemoryNeeded(options));
    EXPECT_GE(needed, taken) << peers;
    EXPECT_LT(needed, 1.1 * taken) << peers;
    options.transport = "udp";
    EXPECT_EQ(SharedMemoryNeeded(options), 0u);
  }
}

/// A participant that leaves before others have read its first message in shared memory makes them deaf there. Messages
/// of discovery therefore go by UDP.
TEST(Discovery, ComesByUdpAlone) {
  constexpr int kNumber = 50;
  const DomainLock lock(-1);
  for (const bool has_udp : {true, false}) {
    DomainOptions options;
    options.domain = lock.domain();
    options.transport = has_udp ? "auto" : "shm";
    options.name = "reader";
    options.number = kNumber;
    options.loopback = true;
    Domain domain(options, [] {});
    const Reader<StateType> reader(domain, Topic::State(1), [](const auto&) {});
    const int discovery = DiscoveryPort(options.domain, kNumber), samples = discovery + 1;
    std::set<std::string> ports;
    for (const std::string& file : FilesInSharedMemory())
      if (const auto at = file.find("port"); at != file.npos) ports.insert(file.substr(at));
    EXPECT_TRUE(ports.contains(fmt::format("port{}", samples)));
    EXPECT_EQ(ports.contains(fmt::format("port{}", discovery)), !has_udp);
    EXPECT_EQ(ports.contains(fmt::format("port{}", FirstPort(options.domain))), !has_udp) << "by multicast";
  }
}

TEST_F(Bus, AProcessSaysWhichExperimentItHasReceived) {
  StopSignal stop;
  Peers peers;
  Lifecycle agent(there_, peers, stop, "agent_1", 1);
  Writer<ExperimentType> orchestrator(here_, Topic::Experiment());
  std::atomic<std::uint64_t> reported = 0;
  Reader<StatusType> statuses(here_, Topic::Status(), [&](const auto& status) { reported = status.experiment(); });
  mascot_msgs::msg::Experiment experiment, other;
  experiment.toml("p_gain = 0.1");
  other.toml("p_gain = 0.2");
  orchestrator.Write(experiment);
  EXPECT_EQ(agent.AwaitExperiment(std::chrono::seconds(60)).toml(), experiment.toml());
  EXPECT_TRUE(Until([&] {
    agent.Set(Life::kMatching);
    return reported == DigestOf(experiment);
  }));
  EXPECT_NE(DigestOf(experiment), DigestOf(other));
}

TEST_F(Bus, RawBytesAreThoseOfTheSerialiserWithZeroedPadding) {
  Writer<StateType> writer(here_, Topic::State(1));
  std::mutex mutex;
  std::vector<std::pair<RawReader::Bytes, std::int64_t>> heard;
  RawReader reader(there_, Topic::State(1), [&](const RawReader::Bytes& bytes, const Sender& sender) {
    const std::lock_guard lock(mutex);
    heard.emplace_back(bytes, sender.sequence);
  });
  ASSERT_TRUE(Until([&] { return writer.matched() == 1 && reader.matched() == 1; }));
  mascot_msgs::msg::AgentState sample;
  for (int tick = 0; tick < 3; ++tick) {
    ToWire(tick, 100, 1, 0, SomeMotion(), sample);
    writer.Write(sample);
  }
  ASSERT_TRUE(Until([&] {
    const std::lock_guard lock(mutex);
    return heard.size() == 3;
  }));
  for (int tick = 0; tick < 3; ++tick) {
    ToWire(tick, 100, 1, 0, SomeMotion(), sample);
    std::vector<std::uint8_t> bytes;
    Serialize(sample, bytes);
    EXPECT_EQ(heard[static_cast<std::size_t>(tick)].first, bytes);
    EXPECT_EQ(heard[static_cast<std::size_t>(tick)].second, tick + 1);
    for (int padding = 24; padding < 28; ++padding) EXPECT_EQ(bytes[static_cast<std::size_t>(padding)], 0);
  }
}

TEST_F(Bus, AnExceptionInACallbackBecomesTheDomainsFailure) {
  Writer<ClockType> writer(here_, Topic::Clock());
  Reader<ClockType> reader(there_, Topic::Clock(), [](const auto&) { throw std::runtime_error("no such luck"); });
  ASSERT_TRUE(Until([&] { return writer.matched() == 1 && reader.matched() == 1; }));
  rosgraph_msgs::msg::Clock sample;
  writer.Write(sample);
  ASSERT_TRUE(Until([&] {
    try {
      there_.RethrowFailure();
      return false;
    } catch (const std::runtime_error& failure) {
      return failure.what() == std::string("no such luck");
    }
  }));
  EXPECT_NO_THROW(here_.RethrowFailure());
}

TEST_F(Bus, AProcessMayReadAndWriteOneTopic) {
  std::atomic<int> own = 0, others = 0;
  Writer<ClockType> writer(here_, Topic::Clock());
  Reader<ClockType> here(here_, Topic::Clock(), [&](const auto&) { ++own; });
  Reader<ClockType> there(there_, Topic::Clock(), [&](const auto&) { ++others; });
  ASSERT_TRUE(Until([&] { return writer.matched() == 2 && here.matched() == 1 && there.matched() == 1; }));
  rosgraph_msgs::msg::Clock sample;
  writer.Write(sample);
  EXPECT_TRUE(Until([&] { return own == 1 && others == 1; }));
}

TEST_F(Bus, ASampleReachesItsReadersBeforeItsWriterLeaves) {
  for (int i = 0; i < 10; ++i) {
    std::atomic<int> heard = 0;
    Reader<ClockType> reader(here_, Topic::Clock(), [&](const auto&) { ++heard; });
    {
      Domain leaving(Options("leaving"), [] {});
      Writer<ClockType> writer(leaving, Topic::Clock());
      ASSERT_TRUE(Until([&] { return writer.matched() == 1 && reader.matched() == 1; }));
      rosgraph_msgs::msg::Clock sample;
      writer.Write(sample);
      writer.AwaitReaders(std::chrono::seconds(10));
    }
    EXPECT_TRUE(Until([&] { return heard == 1; }));
  }
}

TEST_F(Bus, AllSamplesReachTheirReadersBeforeAProcessLeaves) {
  constexpr int kSamples = 50;
  std::atomic<int> clocks = 0, states = 0;
  std::atomic<bool> begun = false, goes_on = false;
  Reader<ClockType> clock(here_, Topic::Clock(), [&](const auto&) {
    begun = true;
    goes_on.wait(false);
    ++clocks;
  });
  Reader<StateType> state(there_, Topic::State(1), [&](const auto&) { ++states; });
  {
    Domain leaving(Options("leaving"), [] {});
    Writer<ClockType> writes_clocks(leaving, Topic::Clock());
    Writer<StateType> writes_states(leaving, Topic::State(1));
    ASSERT_TRUE(Until([&] { return writes_clocks.matched() == 1 && writes_states.matched() == 1; }));
    rosgraph_msgs::msg::Clock tick;
    mascot_msgs::msg::AgentState motion;
    for (int k = 0; k < kSamples; ++k) {
      writes_clocks.Write(tick);
      writes_states.Write(motion);
    }
    ASSERT_TRUE(Until([&] { return begun.load(); }));
    goes_on = true;
    goes_on.notify_all();
    leaving.AwaitReaders(std::chrono::seconds(10));
  }
  EXPECT_TRUE(Until([&] { return clocks == kSamples && states == kSamples; })) << clocks << " and " << states;
}

std::string UserName() {
  const passwd* entry = getpwuid(geteuid());
  return entry != nullptr ? entry->pw_name : std::to_string(geteuid());
}

/// Has a tick, and throws when a sample of it is asked for.
class BrokenSource final : public RosSource {
 public:
  std::int64_t TakeNewest() override { return 1; }
  Bytes Transforms() const override { throw std::runtime_error("made up"); }
  Bytes Scene() const override { throw std::runtime_error("made up"); }
};

TEST_F(Bus, AnErrorOfTheViewForRosEndsThatViewAndNothingElse) {
  std::mutex mutex;
  std::string log;
  BrokenSource source;
  const RosPublisher publisher(
      Options("ros_view"), source,
      [&](const std::string& line) {
        const std::lock_guard lock(mutex);
        log += line + "\n";
      },
      nullptr);
  const RawReader reader(there_, Topic::Tf(), [](const RawReader::Bytes&, const Sender&) {});
  EXPECT_TRUE(Until([&] {
    const std::lock_guard lock(mutex);
    return !log.empty();
  }));
  EXPECT_EQ(log, "ros_view: it has ended because of an error of ours, and nothing else has: made up\n");
  EXPECT_NO_THROW(there_.RethrowFailure());
}

TEST(DomainLock, GivesEachRunADomainOfItsOwn) {
  const DomainLock one(-1), two(-1);
  EXPECT_NE(one.domain(), two.domain());
  EXPECT_NE(one.discovery_port(), two.discovery_port());
  EXPECT_THAT([&] { DomainLock third(one.domain()); },
              ThrowsMessage<std::runtime_error>("network.domain = " + std::to_string(one.domain()) +
                                                " is in use by another run on this machine: process " +
                                                std::to_string(getpid()) + " of user " + UserName()));
}

TEST(DomainLock, OfAnyDomainIsNoneOfOthers) {
  int domain = 0;
  {
    const DomainLock lock(-1);
    domain = lock.domain();
  }
  EXPECT_NE(DomainLock(-1, {domain}).domain(), domain);
}

TEST(DomainLock, IsFreeAgainWhenItsRunIsOver) {
  int domain = 0;
  {
    const DomainLock lock(-1);
    domain = lock.domain();
  }
  EXPECT_EQ(DomainLock(domain).domain(), domain);
}

/// Runs `test` in a thread with namespaces of its own (CLONE_NEWNET, ...). Returns why that is not allowed; empty: it
/// is.
std::string Apart(int namespaces, const std::function<void()>& test) {
  std::string trouble;
  std::thread([&] {
    if (unshare(namespaces) != 0)
      trouble = std::string("making namespaces is not allowed here: ") + std::strerror(errno);
    else
      test();
  }).join();
  return trouble;
}

TEST(DomainLock, IsSharedByNetworkNamespacesThatShareSharedMemory) {
  const DomainLock here(-1);
  const std::string trouble = Apart(CLONE_NEWNET, [&] {
    EXPECT_NE(DomainLock(-1).domain(), here.domain());
    EXPECT_THAT(
        [&] { DomainLock there(here.domain()); },
        ThrowsMessage<std::runtime_error>("network.domain = " + std::to_string(here.domain()) +
                                          " is in use by a run in another network namespace that shares /dev/shm"));
  });
  if (!trouble.empty()) GTEST_SKIP() << trouble;
}

TEST(DomainLock, SaysWhoHasTheDomainsIfNoneIsFree) {
  const std::string trouble = Apart(CLONE_NEWNS | CLONE_NEWNET, [] {  // others go on taking domains
    ASSERT_EQ(mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr), 0) << std::strerror(errno);
    ASSERT_EQ(mount("none", "/dev/shm", "tmpfs", 0, nullptr), 0) << std::strerror(errno);
    std::vector<std::unique_ptr<DomainLock>> taken;
    for (int domain = 2; domain <= 98; domain += 2) taken.push_back(std::make_unique<DomainLock>(domain));
    EXPECT_THAT([&] { DomainLock{-1}; },
                ThrowsMessage<std::runtime_error>("no free DDS domain among 2, 4, ..., 98: user " + UserName() +
                                                  " has 49; network.domain may name another"));
    EXPECT_EQ(DomainLock(3).domain(), 3);
  });
  if (!trouble.empty()) GTEST_SKIP() << trouble;
}

TEST(DomainLock, NeedsNoFile) {  // which another user may have made, or may not read
  const std::string trouble = Apart(CLONE_NEWNS | CLONE_NEWNET, [] {
    ASSERT_EQ(mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr), 0) << std::strerror(errno);
    ASSERT_EQ(mount("none", "/tmp", "tmpfs", MS_RDONLY, nullptr), 0) << std::strerror(errno);
    EXPECT_NO_THROW(DomainLock{-1});
    EXPECT_NO_THROW(DomainLock{3});
  });
  if (!trouble.empty()) GTEST_SKIP() << trouble;
}

// --- programs started by hand ---------------------------------------------------------------------------

Ran Agent(const std::string& arguments) { return Shell("'" + BuildFolder() + "/agent' " + arguments); }

TEST(AgentProcess, SaysThatNobodyGaveItAnExperiment) {
  const DomainLock lock(-1);
  const Ran ran = Agent("--id 1 --loopback --wait-s 1 --domain " + std::to_string(lock.domain()));
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_EQ(ran.output, "error: no experiment came within 1 s: is an orchestrator running in this domain?\n");
}

TEST(AgentProcess, RefusesWrongArguments) {
  EXPECT_EQ(Agent("").exit_code, 2);
  EXPECT_THAT(Agent("--domain 1").output, HasSubstr("error: --id is required"));
  EXPECT_EQ(Agent("--id 1 --domain 1 --transports udp").output,
            "error: unknown option '--transports' (did you mean \"--transport\"?)\n");
  EXPECT_EQ(Agent("--id 0 --domain 1").exit_code, 2);
  for (const char* ids : {"0", "x", "3-1", "1-10001", "1-"}) {
    const Ran ran = Agent("--id " + std::string(ids) + " --domain 1");
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_THAT(ran.output,
                HasSubstr("expected a number, or two such as 1-50, in 1 to 10000, got '" + std::string(ids) + "'"));
  }
  const Ran transport = Agent("--id 1 --domain 1 --transport pigeon");
  EXPECT_EQ(transport.exit_code, 2);
  EXPECT_EQ(transport.output, "error: --transport: expected one of auto, udp, shm, got 'pigeon'\n");
  const Ran discovery = Agent("--id 1 --domain 1 --discovery somewhere");
  EXPECT_EQ(discovery.exit_code, 2);
  EXPECT_EQ(discovery.output, "error: --discovery: expected IP-ADDRESS:PORT, got 'somewhere'\n");
}

TEST(StopSignal, OfThreadsAloneLeavesSignalsToOthersAndTellsWhatIsRaised) {
  StopSignal signals;  // who hears them in this process
  StopSignal threads(StopSignal::Hears::kThreads);
  raise(SIGTERM);
  EXPECT_EQ(threads.Within(std::chrono::nanoseconds(1)), 0);
  EXPECT_EQ(signals.Within(std::chrono::hours(1)), SIGTERM);
  threads.Raise(SIGINT);
  EXPECT_EQ(threads.Within(std::chrono::hours(1)), SIGINT);
  EXPECT_EQ(threads.Within(std::chrono::nanoseconds(1)), 0) << "once";
}

TEST(StopSignal, ReturnsAfterAWakeUpOrASignal) {
  StopSignal stop;
  stop.Wake();
  EXPECT_EQ(stop.Within(std::chrono::hours(1)), 0);
  raise(SIGTERM);  // to this thread: earlier threads of Fast DDS do not block the signal
  EXPECT_EQ(stop.Within(std::chrono::hours(1)), SIGTERM);
  EXPECT_EQ(stop.Within(std::chrono::nanoseconds(1)), 0);
}

}  // namespace
}  // namespace mascot::test
