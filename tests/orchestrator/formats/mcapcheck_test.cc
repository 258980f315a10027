// Our recordings and schemas, checked by tests/mcapcheck: an independent reader that uses the packages of Foxglove.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "base/motion.h"
#include "bus/bus.h"
#include "bus/wire.h"
#include "idl/schemas.h"
#include "idl/topics.h"
#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/mcap/writer.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Ran McapCheck(const std::string& path, const std::string& options) {
  const std::string folder = test::SourceFolder() + "/tests/mcapcheck";
  if (!std::filesystem::exists(folder + "/node_modules"))
    return {-1, "tests/mcapcheck/node_modules is missing: run scripts/test, which installs it with `npm ci`\n"};
  return Shell("node '" + folder + "/mcapcheck.mjs' '" + path + "' --all --strict " + options);
}

/// The serialised bytes of a sample.
template <class PubSub>
Bytes OnTheWire(typename PubSub::type sample) {
  ZeroPadded<PubSub> type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&sample)());
  if (!type.serialize(&sample, &payload)) throw std::runtime_error("does not serialise");
  return {payload.data, payload.data + payload.length};
}

std::uint16_t AddChannel(McapWriter& writer, const std::string& topic, std::string_view type) {
  const TypeSchema& schema = SchemaOf(type);
  return writer.AddChannel({topic,
                            std::string(schema.name),
                            std::string(schema.text),
                            {{"offered_qos_profiles", OfferedQos(TraitsOf(TopicKind::kState))},
                             {"topic_type_hash", std::string(schema.type_hash)}}});
}

/// A sample in which all numbers differ, so that swapped fields are noticed.
mascot_msgs::msg::AgentState SomeState() {
  Motion motion;
  motion.p_WB = {1.5, 2.5, 3.5};
  motion.q_WB = Eigen::Quaterniond(0.5, 0.1, 0.2, 0.3);
  motion.v_WB = {4.5, 5.5, 6.5};
  motion.w_WB_B = {7.5, 8.5, 9.5};
  motion.a_WB = {10.5, 11.5, 12.5};
  mascot_msgs::msg::AgentState sample;
  ToWire(/*tick=*/123, /*rate_hz=*/100, /*agent=*/3, /*events=*/2, motion, sample);
  return sample;
}

mascot_msgs::msg::AgentCommand SomeCommand() {
  mascot_msgs::msg::AgentCommand sample;
  ToWire(/*tick=*/123, /*rate_hz=*/100, /*agent=*/3,
         {.actuator = {1.5, 2.5, 3.5, 4.5},
          .a_law_W = {5.5, 6.5, 7.5},
          .a_limited_W = {8.5, 9.5, 10.5},
          .flags = kTiltLimited | kRotorLimited},
         sample);
  return sample;
}

TEST(McapCheck, AcceptsOurFiles) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  McapWriter writer(path);
  writer.Metadata("mascot", {{"seed", "1"}});
  writer.Attach("config.toml", "application/toml", "[run]\nduration_s = 10.0\n");
  std::vector<std::uint16_t> states, commands;
  for (int id = 1; id <= 10; ++id) {
    commands.push_back(AddChannel(writer, Topic::Command(id).Name(), "mascot_msgs/msg/AgentCommand"));
    states.push_back(AddChannel(writer, Topic::State(id).Name(), "mascot_msgs/msg/AgentState"));
  }
  const auto clock = AddChannel(writer, Topic::Clock().Name(), "rosgraph_msgs/msg/Clock");
  AddChannel(writer, "/never_used", "mascot_msgs/msg/Status");
  Motion motion;
  for (std::int64_t tick = 0; tick <= 1000; ++tick) {
    const std::uint64_t stamp_ns = StampNs(tick, 100);
    for (int id = 1; id <= 10; ++id) {
      motion.p_WB.x() += 0.01 * id;
      mascot_msgs::msg::AgentCommand command;
      mascot_msgs::msg::AgentState state;
      ToWire(tick, 100, id, Command{{motion.p_WB.x(), 1, 2, 3}}, command);
      ToWire(tick, 100, id, 0, motion, state);
      writer.Write(commands[id - 1u], stamp_ns, OnTheWire<CommandType>(command));
      writer.Write(states[id - 1u], stamp_ns, OnTheWire<StateType>(state));
    }
    rosgraph_msgs::msg::Clock sample;
    ToWire(tick, 100, sample);
    writer.Write(clock, stamp_ns, OnTheWire<ClockType>(sample));
    writer.EndTick();
  }
  writer.Close();
  const Ran checked = McapCheck(path, "");
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  EXPECT_THAT(checked.output, HasSubstr("messages    21021 "));
}

TEST(McapCheck, AcceptsAnEmptyRecording) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("run.mcap"));
  writer.Close();
  const Ran checked = McapCheck(scratch.File("run.mcap"), "");
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
}

TEST(McapCheck, RefusesADamagedFile) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  McapWriter writer(path);
  writer.Attach("config.toml", "application/toml", "[run]\n");
  writer.Close();
  std::string file = ReadFile(path);
  file[file.find("[run]")] = '(';
  WriteFile(path, file);
  const Ran checked = McapCheck(path, "");
  EXPECT_EQ(checked.exit_code, 1);
  EXPECT_THAT(checked.output, HasSubstr("ERROR: attachment 'config.toml'"));
}

/// The first message of each topic, decoded by the independent reader with the schema in the file.
nlohmann::json Decoded(const std::string& path) {
  const Ran checked = McapCheck(path, "--json");
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  const nlohmann::json report = nlohmann::json::parse(checked.output);
  nlohmann::json first;
  for (const auto& channel : report.at("channels"))
    first[channel.at("topic").get<std::string>()] = channel.at("first").at("message");
  return first;
}

TEST(Schemas, MatchTheSerialisedBytes) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  McapWriter writer(path);
  const auto write = [&](const std::string& topic, std::string_view type, const Bytes& bytes) {
    writer.Write(AddChannel(writer, topic, type), 0, bytes);
  };
  rosgraph_msgs::msg::Clock clock;
  ToWire(123, 100, clock);
  mascot_msgs::msg::Status status;
  ToWire(Pacing{.late = {{.agent = 4, .ticks = {.from = 20, .to = 30, .count = 5}}}},
         Contacts{.first = {{.tick = 19, .agent = 3, .other = -2, .speed_m_per_s = 0.5}}}, status);
  status.process("agent_3");
  status.agent(3);
  status.state(5);
  status.experiment(11);
  status.tick(6);
  status.misses(7);
  status.tick_lateness_s({0.5, 1.5, 2.5});
  status.command_age_s({3.5, 4.5, 5.5});
  status.agent_contacts(8);
  status.ground_contacts(9);
  status.obstacle_contacts(10);
  status.request(14);
  status.request_tick(-1);
  status.paused(true);
  status.pace(0.5);
  status.reason("none");
  mascot_msgs::msg::Bundle bundle;
  bundle.states({SomeState()});
  mascot_msgs::msg::Request request;
  request.kind(2);
  request.number(13);
  request.value(1.5);
  request.toml("cut = [[1, 2]]");
  request.reason("over");
  mascot_msgs::msg::Experiment experiment;
  experiment.processes().resize(2);
  experiment.processes()[1].name("agent_3");
  experiment.processes()[1].bits(11);
  experiment.processes()[1].mask(12);
  experiment.name("n");
  experiment.toml("[run]");
  write("/state", "mascot_msgs/msg/AgentState", OnTheWire<StateType>(SomeState()));
  write("/bundle", "mascot_msgs/msg/Bundle", OnTheWire<BundleType>(bundle));
  write("/command", "mascot_msgs/msg/AgentCommand", OnTheWire<CommandType>(SomeCommand()));
  write("/clock", "rosgraph_msgs/msg/Clock", OnTheWire<ClockType>(clock));
  write("/status", "mascot_msgs/msg/Status", OnTheWire<StatusType>(status));
  write("/request", "mascot_msgs/msg/Request", OnTheWire<RequestType>(request));
  write("/experiment", "mascot_msgs/msg/Experiment", OnTheWire<ExperimentType>(experiment));
  writer.Close();

  nlohmann::json decoded = Decoded(path);
  EXPECT_EQ(decoded["/bundle"]["states"], nlohmann::json::array({decoded["/state"]}));
  decoded.erase("/bundle");
  EXPECT_EQ(decoded, nlohmann::json::parse(R"({
    "/state": {"stamp": {"sec": 1, "nanosec": 230000000}, "tick": 123, "agent": 3, "events": 2,
      "pose": {"position": {"x": 1.5, "y": 2.5, "z": 3.5}, "orientation": {"x": 0.1, "y": 0.2, "z": 0.3, "w": 0.5}},
      "twist": {"linear": {"x": 4.5, "y": 5.5, "z": 6.5}, "angular": {"x": 7.5, "y": 8.5, "z": 9.5}},
      "acceleration": {"x": 10.5, "y": 11.5, "z": 12.5}},
    "/command": {"stamp": {"sec": 1, "nanosec": 230000000}, "tick": 123, "agent": 3, "flags": 6,
      "actuator": [1.5, 2.5, 3.5, 4.5], "acceleration_wanted": {"x": 5.5, "y": 6.5, "z": 7.5},
      "acceleration_limited": {"x": 8.5, "y": 9.5, "z": 10.5}},
    "/clock": {"clock": {"sec": 1, "nanosec": 230000000}},
    "/status": {"incidents": [
        {"kind": 0, "agent": 3, "other": -2, "from_tick": 19, "to_tick": 19, "count": 1, "speed": 0.5},
        {"kind": 1, "agent": 4, "other": 0, "from_tick": 20, "to_tick": 30, "count": 5, "speed": 0}],
      "process": "agent_3", "agent": 3, "state": 5, "experiment": 11, "tick": 6, "misses": 7,
      "tick_lateness_s": [0.5, 1.5, 2.5], "command_age_s": [3.5, 4.5, 5.5],
      "agent_contacts": 8, "ground_contacts": 9, "obstacle_contacts": 10,
      "request": 14, "request_tick": -1, "paused": true, "pace": 0.5, "events": 0, "awaited": [],
      "from_tick": 0, "reason": "none"},
    "/request": {"kind": 2, "number": 13, "value": 1.5, "toml": "cut = [[1, 2]]", "agents": [], "reason": "over"},
    "/experiment": {"processes": [{"name": "", "bits": 0, "mask": 0}, {"name": "agent_3", "bits": 11, "mask": 12}],
      "name": "n", "toml": "[run]", "from_tick": 0, "events": []}})"));
}

TEST(Schemas, ListEachDependencyOnceBehindALineOfEightyEqualSigns) {
  const std::string_view text = SchemaOf("rosgraph_msgs/msg/Clock").text;
  EXPECT_THAT(std::string(text), testing::EndsWith("builtin_interfaces/Time clock\n" + std::string(80, '=') +
                                                   "\nMSG: builtin_interfaces/Time\n# A point in time, in seconds and "
                                                   "nanoseconds.\nint32 sec\nuint32 nanosec\n"));
}

TEST(Schemas, NameEachBitOfTheFlagsOfACommand) {
  const std::pair<CommandFlag, std::string> names[] = {{kAccelerationLimited, "ACCELERATION_LIMITED"},
                                                       {kTiltLimited, "TILT_LIMITED"},
                                                       {kRotorLimited, "ROTOR_LIMITED"},
                                                       {kSpeedLimited, "SPEED_LIMITED"},
                                                       {kSafetyFiltered, "SAFETY_FILTERED"},
                                                       {kSafetyInfeasible, "SAFETY_INFEASIBLE"}};
  const std::string text(SchemaOf("mascot_msgs/msg/AgentCommand").text);
  for (const auto& [flag, name] : names)
    EXPECT_THAT(text, testing::HasSubstr("\nuint32 " + name + "=" + std::to_string(flag) + "\n"));
}

TEST(Schemas, TypeHashesAreThoseThatRosPublishes) {
  EXPECT_EQ(SchemaOf("rosgraph_msgs/msg/Clock").type_hash,
            "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564");
  EXPECT_EQ(SchemaOf("nav_msgs/msg/Odometry").type_hash,
            "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0");
  // A type with nested types, which is not the type of any of our topics.
  const Ran ran = Shell("/usr/bin/python3 " + test::SourceFolder() + "/scripts/type_hash.py " + test::SourceFolder() +
                        "/idl/ros_interfaces -- geometry_msgs/msg/Twist");
  EXPECT_EQ(ran.output,
            "geometry_msgs/msg/Twist RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a\n");
}

TEST(Schemas, AnUnknownTypeIsAnError) {
  EXPECT_THAT([] { SchemaOf("x/msg/Y"); }, ThrowsMessage<std::out_of_range>("no schema for the type x/msg/Y"));
}

}  // namespace
}  // namespace mascot
