// Programs outside that have nothing of MASCOT but the installed IDL and profiles read a run over DDS: what they hear
// is what is recorded, bit for bit.

#include <gmock/gmock.h>

#include <map>
#include <sstream>

#include "bus/wire.h"
#include "orchestrator/recording/recording.h"
#include "tests/support/folders.h"
#include "tests/support/intruder.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

/// A program with types made by another generator, and the words of its command line before the topics.
struct PlainReader {
  const char* what;
  std::string program;
  std::vector<std::string> profiles;
};

void PrintTo(const PlainReader& reader, std::ostream* out) { *out << reader.what; }

class PlainIdl : public testing::TestWithParam<PlainReader> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(GetParam().program))
      GTEST_SKIP() << "built without cyclonedds-dev: run scripts/setup --test";
  }
  /// A run of three agents, until it is told to stop; it keeps to the pace of real time.
  Up Fly(const std::string& delivery) {
    WriteFile(folder_.File("run.toml"),
              "[run]\nname = 'run'\nduration_s = 100000.0\n[agents]\ncount = 3\n[graph]\ntopology = 'ring'\n[output]\n"
              "save_plot = false\nfidelity = false\n[network]\ndelivery = '" +
                  delivery + "'\n[law]\nname = 'consensus'\n");
    return Up(folder_, "run", folder_.File("run.toml"), {"--set", "run.pace=1"});
  }
  std::vector<std::string> Words(const Up& up, const std::vector<std::string>& topics) const {
    std::vector<std::string> words = GetParam().profiles;
    words.push_back(std::to_string(DomainOf(up)));
    words.insert(words.end(), topics.begin(), topics.end());
    return words;
  }

  const ScratchFolder folder_;
};

/// The samples that a reader has printed of a topic, in order.
std::vector<Json> HeardOn(const Running& reader, const std::string& topic) {
  std::vector<Json> heard;
  std::istringstream lines(reader.out());
  for (std::string line; std::getline(lines, line) && !lines.eof();)  // without a half line
    if (Json json = Json::parse(line); json["topic"] == topic) heard.push_back(std::move(json));
  return heard;
}

template <class Sample>
Json PrintedSample(const Sample& sample, Json numbers) {
  return {{"sec", sample.stamp().sec()},
          {"nanosec", sample.stamp().nanosec()},
          {"tick", sample.tick()},
          {"agent", sample.agent()},
          {"numbers", std::move(numbers)}};
}

Json AsPrinted(const mascot_msgs::msg::AgentState& s) {
  const auto& [p, q, v, w, a] =
      std::tie(s.pose().position(), s.pose().orientation(), s.twist().linear(), s.twist().angular(), s.acceleration());
  return PrintedSample(s, {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z(),
                           a.x(), a.y(), a.z()});
}

Json AsPrinted(const mascot_msgs::msg::AgentCommand& c) {
  const auto& [u, wanted, limited] = std::tie(c.actuator(), c.acceleration_wanted(), c.acceleration_limited());
  return PrintedSample(
      c, {u[0], u[1], u[2], u[3], wanted.x(), wanted.y(), wanted.z(), limited.x(), limited.y(), limited.z()});
}

/// What a run has recorded, by tick and agent.
struct RecordedSamples {
  std::map<std::pair<std::uint64_t, std::uint32_t>, Json> states, commands;
};

RecordedSamples SamplesOf(const Up& up) {
  RecordedSamples recorded;
  Recording(up.path().string()).ForEachRow([&](const Row& row) {
    for (const Row::Bytes& bytes : row.states) {
      mascot_msgs::msg::AgentState state;
      Deserialize(bytes, state);
      recorded.states[{state.tick(), state.agent()}] = AsPrinted(state);
    }
    for (const Row::Bytes& bytes : row.commands) {
      mascot_msgs::msg::AgentCommand command;
      Deserialize(bytes, command);
      recorded.commands[{command.tick(), command.agent()}] = AsPrinted(command);
    }
  });
  return recorded;
}

std::pair<std::uint64_t, std::uint32_t> KeyOf(const Json& sample) { return {sample["tick"], sample["agent"]}; }

constexpr std::size_t kEnough = 50;  // samples

TEST_P(PlainIdl, ReadsTopicsOfAgentsAsRecorded) {
  Up up = Fly("topics");
  const std::vector<std::string> topics{"rt/agent_2/state", "rt/agent_3/command", "rt/clock", "rt/experiment"};
  const Running reader(GetParam().program, Words(up, topics), folder_.File("reader"));
  ASSERT_TRUE(Until([&] {
    return HeardOn(reader, topics[0]).size() >= kEnough && HeardOn(reader, topics[1]).size() >= kEnough &&
           HeardOn(reader, topics[2]).size() >= kEnough && !HeardOn(reader, topics[3]).empty();
  })) << reader.err()
      << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_EQ(up.Summary()["wire"]["matches_graph"], true);

  const RecordedSamples recorded = SamplesOf(up);
  std::size_t compared = 0;
  for (Json& state : HeardOn(reader, topics[0])) {
    state.erase("topic");
    EXPECT_EQ(state["agent"], 2);
    if (!recorded.states.contains(KeyOf(state))) continue;  // of a tick that the end has cut
    EXPECT_EQ(state, recorded.states.at(KeyOf(state)));
    ++compared;
  }
  for (Json& command : HeardOn(reader, topics[1])) {
    command.erase("topic");
    EXPECT_EQ(command["agent"], 3);
    if (!recorded.commands.contains(KeyOf(command))) continue;
    EXPECT_EQ(command, recorded.commands.at(KeyOf(command)));
    ++compared;
  }
  EXPECT_GE(compared, kEnough);
  for (const Json& clock : HeardOn(reader, topics[2]))  // 100 ticks a second
    EXPECT_EQ(clock["nanosec"].get<std::int64_t>() % 10'000'000, 0);
  const Json experiment = HeardOn(reader, topics[3]).front();
  EXPECT_EQ(experiment["name"], "run");
  EXPECT_THAT(experiment["toml"].get<std::string>(), HasSubstr("delivery = \"topics\""));
}

TEST_P(PlainIdl, ReadsWholeTicksAsRecorded) {
  Up up = Fly("bundled");
  const Running reader(GetParam().program, Words(up, {"rt/row"}), folder_.File("reader"));
  ASSERT_TRUE(Until([&] { return HeardOn(reader, "rt/row").size() >= kEnough; })) << reader.err() << up.err();
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
  EXPECT_EQ(up.Summary()["wire"]["matches_graph"], true);

  const RecordedSamples recorded = SamplesOf(up);
  std::size_t compared = 0;
  for (const Json& row : HeardOn(reader, "rt/row")) {
    for (const Json& state : row["states"]) {
      if (!recorded.states.contains(KeyOf(state))) continue;  // of a tick that the end has cut
      EXPECT_EQ(state, recorded.states.at(KeyOf(state)));
      ++compared;
    }
    for (const Json& command : row["commands"]) {
      if (!recorded.commands.contains(KeyOf(command))) continue;
      EXPECT_EQ(command, recorded.commands.at(KeyOf(command)));
      ++compared;
    }
  }
  EXPECT_GE(compared, kEnough);
}

INSTANTIATE_TEST_SUITE_P(Generators, PlainIdl,
                         testing::Values(PlainReader{"fastddsgen",
                                                     BuildFolder() + "/fastdds_plain",
                                                     {SourceFolder() + "/idl/profiles/fastdds.xml"}},
                                         PlainReader{"idlc", BuildFolder() + "/cyclone_plain", {}}),
                         NamedAsPrinted<PlainReader>);

}  // namespace
}  // namespace mascot::test
