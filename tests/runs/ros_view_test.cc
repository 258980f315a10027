// network.ros_view: what RViz2 sees of a run over DDS, read by a program of another vendor, with types of its own.

#include <gmock/gmock.h>

#include <set>
#include <sstream>

#include "bus/wire.h"
#include "idl/schemas.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/recording/row_codec.h"
#include "tests/support/folders.h"
#include "tests/support/intruder.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

const std::string kProgram = BuildFolder() + "/cyclone_rviz";
const std::vector<std::string> kOn = {"--set", "network.ros_view=true"};

/// Reads /tf and /scene as RViz2 does.
class RViz : public Running {
 public:
  RViz(const Up& up, const std::string& output) : Running(kProgram, {std::to_string(DomainOf(up))}, output) {}

  /// What it has seen that has this key: a "writes", "transforms" or "markers".
  std::vector<Json> Seen(const std::string& key) const {
    std::vector<Json> seen;
    std::istringstream lines(out());
    for (std::string line; std::getline(lines, line) && !lines.eof();)  // without a half line
      if (Json json = Json::parse(line); json.contains(key)) seen.push_back(std::move(json));
    return seen;
  }
  bool Sees(const std::string& key) const { return out().find("{\"" + key + "\"") != std::string::npos; }
  bool Discovers(const Topic& topic) const { return !WriterOf(topic).is_null(); }
  Json WriterOf(const Topic& topic) const {
    for (const Json& writer : Seen("writes"))
      if (writer["writes"] == topic.DdsName()) return writer;
    return nullptr;
  }
};

class RosView : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kProgram)) GTEST_SKIP() << "built without cyclonedds-dev: run scripts/setup --test";
  }
  Up Fly(const std::string& name, const std::string& duration_s, const std::vector<std::string>& more = {},
         int agents = 3) {
    WriteFile(folder_.File(name + ".toml"),
              "[run]\nname = 'run'\nagent_timeout_s = 100.0\nduration_s = " + duration_s +
                  "\n[agents]\ncount = " + std::to_string(agents) +
                  "\n[physics]\nobstacles = [{ shape = 'box', position_m = [50, 0, 1], size_m = [1, 2, 3] }]\n"
                  "[graph]\ntopology = 'ring'\n[output]\nsave_plot = false\nfidelity = false\n[law]\nname = "
                  "'consensus'\np_gain = 0.05\n");
    return Up(folder_, name, folder_.File(name + ".toml"), more);
  }

  const ScratchFolder folder_;
};

/// The motions of all agents that are recorded, by stamp (ns).
std::map<std::int64_t, std::vector<Motion>> MotionsOf(const Up& up) {
  std::map<std::int64_t, std::vector<Motion>> motions;
  Recording(up.path().string()).ForEachRow([&](const Row& row) {
    for (const Row::Bytes& bytes : row.states) {
      mascot_msgs::msg::AgentState state;
      Deserialize(bytes, state);
      motions[state.stamp().sec() * 1'000'000'000LL + state.stamp().nanosec()].push_back(FromWire(state));
    }
  });
  return motions;
}

TEST_F(RosView, ShowsAnotherVendorWhereAgentsAreAsRecorded) {
  Up up = Fly("run", "100000.0", kOn);
  const RViz rviz(up, folder_.File("rviz"));
  ASSERT_TRUE(Until([&] { return rviz.Seen("transforms").size() >= 5 && rviz.Sees("markers"); })) << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_EQ(up.Summary()["wire"]["matches_graph"], true);

  const auto motions = MotionsOf(up);
  std::set<std::int64_t> stamps;
  for (const Json& message : rviz.Seen("transforms")) {
    ASSERT_EQ(message["transforms"].size(), 3u);
    int id = 0;
    for (const Json& transform : message["transforms"]) {
      ASSERT_TRUE(motions.contains(transform["stamp_ns"])) << transform;
      const Motion& motion = motions.at(transform["stamp_ns"])[static_cast<std::size_t>(id++)];
      EXPECT_EQ(transform["frame"], "world");
      EXPECT_EQ(transform["child"], AgentName(id));
      const auto& [p, q] = std::pair(motion.p_WB, motion.q_WB);
      EXPECT_EQ(transform["p"], (Json{p.x(), p.y(), p.z()}));
      EXPECT_EQ(transform["q_xyzw"], (Json{q.x(), q.y(), q.z(), q.w()}));
      stamps.insert(transform["stamp_ns"].get<std::int64_t>());
    }
  }
  EXPECT_GE(stamps.size() + 1, rviz.Seen("transforms").size()) << "none twice, but for the one for a new reader";
}

TEST_F(RosView, ShowsAnotherVendorBodiesInTheFramesOfTheirAgents) {
  Up up = Fly("run", "100000.0", kOn);
  const RViz rviz(up, folder_.File("rviz"));
  ASSERT_TRUE(Until([&] { return rviz.Sees("markers"); })) << up.err();
  const Json scene = rviz.Seen("markers").front();
  std::map<std::string, std::vector<Json>> markers;
  for (const Json& marker : scene["markers"]) markers[marker["ns"]].push_back(marker);
  for (const char* of_agents : {"bodies", "arms", "numbers", "trails"}) EXPECT_EQ(markers[of_agents].size(), 3u);
  const Json& body = markers["bodies"][1];
  EXPECT_EQ(body["frame"], "agent_2");
  EXPECT_EQ(body["type"], 1) << "CUBE";
  EXPECT_EQ(body["locked"], true);
  EXPECT_EQ(markers["numbers"][1]["text"], "2");
  EXPECT_EQ(markers["numbers"][1]["type"], 9) << "TEXT_VIEW_FACING";
  EXPECT_EQ(markers["edges"][0]["frame"], "world");
  EXPECT_EQ(markers["edges"][0]["type"], 5) << "LINE_LIST";
  EXPECT_EQ(markers["edges"][0]["points"], 12) << "each hears two, all is heard";
  ASSERT_EQ(markers["obstacles"].size(), 1u);
  EXPECT_EQ(markers["obstacles"][0]["p"], (Json{50.0, 0.0, 1.0}));
  EXPECT_EQ(markers["obstacles"][0]["scale"], (Json{1.0, 2.0, 3.0}));
}

TEST_F(RosView, HasTheTypesAndTheQosThatRos2Expects) {
  Up up = Fly("run", "100000.0", kOn);
  const RViz rviz(up, folder_.File("rviz"));
  ASSERT_TRUE(Until([&] { return rviz.Discovers(Topic::Tf()) && rviz.Discovers(Topic::Scene()); })) << up.err();
  const auto expected = [](const char* topic, const char* type, const char* schema, bool latched) {
    const std::string hash(SchemaOf(schema).type_hash);
    return Json{{"writes", topic},
                {"type", type},
                {"user_data", "typehash=" + hash + ";"},
                {"reliable", true},
                {"latched", latched}};
  };
  EXPECT_EQ(rviz.WriterOf(Topic::Tf()),
            expected("rt/tf", "tf2_msgs::msg::dds_::TFMessage_", "tf2_msgs/msg/TFMessage", false));
  EXPECT_EQ(rviz.WriterOf(Topic::Scene()), expected("rt/scene", "visualization_msgs::msg::dds_::MarkerArray_",
                                                    "visualization_msgs/msg/MarkerArray", true));
}

TEST_F(RosView, IsNotThereUnlessAskedFor) {
  Up up = Fly("run", "100000.0");
  const RViz rviz(up, folder_.File("rviz"));
  ASSERT_TRUE(Until([&] { return rviz.Discovers(Topic::Status()); }));
  ASSERT_TRUE(Flies(up)) << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130);
  EXPECT_FALSE(rviz.Discovers(Topic::Tf()));
  EXPECT_FALSE(rviz.Discovers(Topic::Scene()));
}

TEST_F(RosView, WhoComesLateToARunThatStandsStillSeesTheLastTick) {
  Up up = Fly("run", "100000.0", kOn);
  ASSERT_TRUE(Flies(up)) << up.err();
  SignalTo(up.Child("agent_2"), SIGSTOP);
  const RViz first(up, folder_.File("first"));
  ASSERT_TRUE(Until([&] { return first.Sees("markers") && first.Sees("transforms"); }));
  const RViz second(up, folder_.File("second"));
  ASSERT_TRUE(Until([&] { return second.Sees("markers") && second.Sees("transforms"); }));
  EXPECT_EQ(second.Seen("transforms").front(), first.Seen("transforms").back());
  EXPECT_EQ(second.Seen("markers").front(), first.Seen("markers").back());
  SignalTo(up.Child("agent_2"), SIGCONT);
}

TEST_F(RosView, ChangesNoBitOfTheRecordingAlsoIfItsReaderHangs) {
  const std::string duration_s = "500.0";
  Up without = Fly("without", duration_s);
  EXPECT_EQ(without.Wait(), 0) << without.err();
  Up with = Fly("with", duration_s, kOn);
  ASSERT_TRUE(Flies(with)) << with.err();
  SignalTo(with.Child("agent_2"), SIGSTOP);  // the run stands until its reader has joined
  const RViz rviz(with, folder_.File("rviz"));
  ASSERT_TRUE(Until([&] { return rviz.Discovers(Topic::Tf()) && rviz.Discovers(Topic::Scene()); })) << with.err();
  SignalTo(with.Child("agent_2"), SIGCONT);
  ASSERT_TRUE(Until([&] { return rviz.Sees("transforms"); })) << with.err();
  rviz.Signal(SIGSTOP);
  EXPECT_FALSE(with.IsOver());
  EXPECT_EQ(with.Wait(), 0) << with.err();
  EXPECT_TRUE(with.File("run.mcap") == without.File("run.mcap")) << "run.mcap differs";
  EXPECT_TRUE(with.File("states.npz") == without.File("states.npz")) << "states.npz differs";
}

TEST_F(RosView, IsFoundWithoutTheDiscoveryServerOfALargeRun) {
  std::vector<std::string> on_topics = kOn;  // with bundles, the run would need none
  on_topics.insert(on_topics.end(), {"--set", "network.delivery=topics"});
  Up up = Fly("run", "100000.0", on_topics, 20);
  const RViz rviz(up, folder_.File("rviz"));
  EXPECT_TRUE(up.Said("discovery server"));
  ASSERT_TRUE(Until([&] { return rviz.Sees("transforms"); })) << up.err();
  EXPECT_EQ(rviz.Seen("transforms").front()["transforms"].size(), 20u);
  const int exit_code = Harass<ClockType>(up, "rviz", Topic::Scene(), {});
  EXPECT_EQ(exit_code, 1);
  EXPECT_THAT(up.err(), HasSubstr("'rviz' writes /scene, which only orchestrator may"));
}

TEST(RosViewInOneProcess, IsRefused) {
  const ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"), {"--engine", "inprocess", "--set", "network.ros_view=true"});
  EXPECT_EQ(up.Wait(), 2);
  EXPECT_EQ(up.err(), "error: --engine inprocess: expected network.ros_view = false, got true\n");
  EXPECT_FALSE(std::filesystem::exists(up.path())) << "nothing was started";
}

}  // namespace
}  // namespace mascot::test
