// record.ros_types: the channels in standard types of ROS 2, decoded by readers that are not ours and held against the
// states of the same recording.
#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/recording/recording.h"
#include "tests/support/call.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Three quadrotors that hear each other in a ring; at 1.5 s agent 1 no longer hears agent 2, and at 2 s nobody hears
/// anybody but agent 3 agent 2. An obstacle, a range.
constexpr const char* kRosTeam =
    "[run]\nduration_s = 3.0\n[agents]\ncount = 3\nposition_m = [[0, 0, 1], [4, 0, 1.5], [0, 4, 2]]\n"
    "[physics]\nobstacles = [{ shape = 'sphere', position_m = [9, 9, 1], size_m = [1, 1, 1] }]\n"
    "[graph]\ntopology = 'ring'\n[[graph.schedule]]\nat_s = 2\nedges = [[3, 2]]\n"
    "[law]\nname = 'consensus'\np_gain = 0.2\n[[events]]\nat_s = 1.5\ncut = [[1, 2]]\n";

class RosTypes : public testing::Test {
 protected:
  std::string Fly(const std::string& name, const std::vector<std::string>& sets, const std::string& toml = kRosTeam) {
    WriteFile(File("three.toml"), toml);
    std::vector<std::string> words = {File("three.toml"), "--engine", "inprocess", "--out",
                                      File(name),         "--quiet",  "--set",     "output.save_plot=false"};
    for (const std::string& set : sets) words.insert(words.end(), {"--set", set});
    const Said said = Call(SetUpUp, words);
    EXPECT_EQ(said.exit_code, 0) << said.err;
    return File(name + "/run.mcap");
  }
  /// What tests/mcapcheck/ros_types.mjs says of a recording.
  static nlohmann::json Held(const std::string& path) {
    const Ran ran = Shell("node '" + test::SourceFolder() + "/tests/mcapcheck/ros_types.mjs' '" + path + "'");
    EXPECT_EQ(ran.exit_code, 0) << ran.output;
    return nlohmann::json::parse(ran.output, nullptr, /*allow_exceptions=*/false);
  }
  std::string File(const std::string& name) const { return scratch_.File(name); }

  ScratchFolder scratch_;
};

TEST_F(RosTypes, SayWhatTheStatesSay) {
  const std::string path = Fly("run", {"record.ros_types=true"});
  const nlohmann::json held = Held(path);
  EXPECT_EQ(held["problems"], nlohmann::json::array());
  for (const char* topic : {"/tf", "/agent_1/odom", "/agent_2/odom", "/agent_3/odom", "/clock"})
    EXPECT_EQ(held["counts"][topic], 301) << topic;
  const auto schema = [&](const char* topic) { return held["schemas"][topic]; };
  EXPECT_EQ(schema("/tf"), nlohmann::json({"tf2_msgs/msg/TFMessage", "ros2msg", "cdr"}));
  EXPECT_EQ(schema("/scene"), nlohmann::json({"visualization_msgs/msg/MarkerArray", "ros2msg", "cdr"}));
  EXPECT_EQ(schema("/agent_2/odom"), nlohmann::json({"nav_msgs/msg/Odometry", "ros2msg", "cdr"}));
  EXPECT_THAT(held["qos"]["/scene"].get<std::string>(), HasSubstr("  depth: 1\n  reliability: 1\n  durability: 1\n"));
  EXPECT_THAT(held["qos"]["/tf"].get<std::string>(), HasSubstr("  depth: 10\n  reliability: 1\n  durability: 2\n"));
  const Ran strict =
      Shell("node '" + test::SourceFolder() + "/tests/mcapcheck/mcapcheck.mjs' '" + path + "' --all --strict");
  EXPECT_EQ(strict.exit_code, 0) << strict.output;
}

TEST_F(RosTypes, ShowTheEdgesThatAreInForce) {
  const nlohmann::json scenes = Held(Fly("run", {"record.ros_types=true"}))["scenes"];
  std::map<double, nlohmann::json> heard;
  std::vector<double> whole_s;
  for (const nlohmann::json& scene : scenes) {
    heard[scene["t"]] = scene["edges"]["heard"];
    if (scene["markers"].contains("bodies")) whole_s.push_back(scene["t"]);
  }
  EXPECT_THAT(whole_s, ElementsAre(0, 1, 2, 3));
  const auto edges_at = [&](double t_s) { return std::prev(heard.upper_bound(t_s + 1e-9))->second; };
  const nlohmann::json ring = {"1-2", "1-3", "2-1", "2-3", "3-1", "3-2"};
  EXPECT_EQ(edges_at(0), ring);
  EXPECT_EQ(edges_at(1.49), ring);
  EXPECT_EQ(edges_at(1.54), nlohmann::json({"1-3", "2-1", "2-3", "3-1", "3-2"}));
  EXPECT_EQ(edges_at(2), nlohmann::json({"3-2"}));
  EXPECT_EQ(edges_at(3), nlohmann::json({"3-2"}));
  EXPECT_EQ(heard.size(), 91u) << "30 a second";
  EXPECT_EQ(
      scenes[0]["markers"],
      (nlohmann::json{{"edges", 4}, {"bodies", 3}, {"arms", 3}, {"numbers", 3}, {"trails", 3}, {"obstacles", 1}}));
  EXPECT_EQ(scenes[1]["markers"], (nlohmann::json{{"edges", 4}}));
  EXPECT_EQ(scenes.back()["trail"], 16) << "5 points a second";
}

TEST_F(RosTypes, AreAtTheRateOfTheRecording) {
  const nlohmann::json held = Held(Fly("run", {"record.ros_types=true", "record.rate_hz=5", "run.duration_s=2.5"}));
  EXPECT_EQ(held["problems"], nlohmann::json::array());
  EXPECT_EQ(held["counts"]["/tf"], 14);  // with the last tick
  EXPECT_EQ(held["counts"]["/agent_3/odom"], 14);
  EXPECT_EQ(held["counts"]["/scene"], 13);
}

/// The bytes of all messages but those of record.ros_types, in their order.
std::vector<std::vector<std::uint8_t>> OthersIn(const std::string& path) {
  std::vector<std::vector<std::uint8_t>> others;
  const McapContents contents = ReadMcap(path);
  ReadMcap(path, [&](const McapContents::Message& message) {
    const std::string& topic = contents.channels.at(message.channel).topic;
    if (topic != "/tf" && topic != "/scene" && !topic.ends_with("/odom")) others.push_back(message.data);
  });
  return others;
}

TEST_F(RosTypes, LeaveTheOtherChannelsAsTheyAre) {
  const std::string with = Fly("with", {"record.ros_types=true"}), without = Fly("without", {});
  const auto channels = ReadMcap(without).channels;
  for (const auto& [id, channel] : channels) EXPECT_EQ(ReadMcap(with).channels.at(id).topic, channel.topic);
  for (const auto& [id, channel] : channels) EXPECT_EQ(channel.topic.find("odom"), std::string::npos);
  EXPECT_TRUE(OthersIn(with) == OthersIn(without));
  EXPECT_TRUE(ReadFile(File("with/states.npz")) == ReadFile(File("without/states.npz")));
}

TEST_F(RosTypes, AreChosenByTheirTopics) {
  const std::string path = Fly("run", {"record.ros_types=true", "record.topics=['/tf', '/agent_2/*', '/clock']"});
  std::vector<std::string> topics;
  for (const auto& [id, channel] : ReadMcap(path).channels) topics.push_back(channel.topic);
  EXPECT_THAT(topics,
              testing::UnorderedElementsAre("/agent_2/command", "/agent_2/state", "/agent_2/odom", "/clock", "/tf"));
  EXPECT_EQ(Call(SetUpInfo, {path}).exit_code, 0);
  EXPECT_EQ(Call(SetUpVerify, {path}).exit_code, 0);
}

TEST_F(RosTypes, AreVerified) {
  const std::string path = Fly("run", {"record.ros_types=true"});
  EXPECT_EQ(Call(SetUpInfo, {path}).exit_code, 0);
  const Said said = Call(SetUpVerify, {path});
  EXPECT_EQ(said.exit_code, 0) << said.out;
  // 301 rows of 3 states, 3 commands, 3 odometries, /clock and /tf; 91 scenes; 2 events, one of them the schedule's.
  EXPECT_THAT(said.out, HasSubstr("the same, bit for bit: 301 ticks, " + std::to_string(301 * 11 + 91 + 1)));
}

TEST_F(RosTypes, GoOnInARecoveredRecording) {
  const std::string path = Fly("run", {"record.ros_types=true"}), cut = File("cut.mcap");
  const std::string whole = ReadFile(path);
  WriteFile(cut, whole.substr(0, whole.size() * 2 / 3));
  EXPECT_EQ(Call(SetUpRecover, {cut, "--out", File("again.mcap")}).exit_code, 3);
  EXPECT_GT(Held(File("again.mcap"))["counts"]["/tf"], 100);
  EXPECT_EQ(Call(SetUpVerify, {cut}).exit_code, 3);
  EXPECT_EQ(Call(SetUpExport, {path, "--format", "npz", "--out", File("states.npz")}).exit_code, 0);
  EXPECT_TRUE(ReadFile(File("states.npz")) == ReadFile(File("run/states.npz")));
}

TEST_F(RosTypes, OfALossyLinkSayWhatIsHeard) {
  const nlohmann::json scenes = Held(Fly("run", {"record.ros_types=true", "link.loss=0.5"}))["scenes"];
  std::size_t lost = 0, heard = 0;
  for (const nlohmann::json& scene : scenes)
    if (const double t_s = scene["t"]; t_s < 1.5) {
      lost += scene["edges"]["lost"].size() + scene["edges"]["nothing yet"].size();
      heard += scene["edges"]["heard"].size();
    }
  EXPECT_EQ(lost + heard, 45u * 6);
  EXPECT_GT(heard, 0u);
}

TEST_F(RosTypes, NameTheFieldThatDiffers) {
  const std::string path = Fly("run", {"record.ros_types=true"}), copy = File("changed.mcap");
  const McapContents contents = ReadMcap(path);
  McapWriter writer(copy);
  for (const auto& [name, data] : contents.attachments) writer.Attach(name, contents.media_types.at(name), data);
  for (const auto& [name, entries] : contents.metadata) writer.Metadata(name, entries);
  for (const auto& [id, channel] : contents.channels)
    ASSERT_EQ(writer.AddChannel({channel.topic, channel.schema_name, channel.schema_text, channel.metadata}), id);
  ReadMcap(path, [&](McapContents::Message message) {
    if (contents.channels.at(message.channel).topic == "/agent_2/odom" && message.log_time == 570'000'000) {
      const double x = 1.25;  // behind the encapsulation, the stamp, "world" and "agent_2"
      std::memcpy(message.data.data() + 36, &x, sizeof x);
    }
    writer.Write(message.channel, message.log_time, message.data);
  });
  writer.Close();
  const Said said = Call(SetUpVerify, {copy});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_THAT(
      said.out,
      HasSubstr("differs: /agent_2/odom at tick 57 (t = 0.57 s): pose.pose.position.x is 1.25 in the recording"));
}

}  // namespace
}  // namespace mascot
