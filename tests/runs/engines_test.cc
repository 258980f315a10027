// Both engines, and repeated runs, give the same bytes for the same file.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <sstream>
#include <thread>

#include "orchestrator/engines/dds/machine/domain_lock.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/writer.h"
#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> ShippedConfigs() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(SourceFolder() + "/configs"))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

void ExpectSameBytes(const Up& a, const Up& b) {
  EXPECT_FALSE(a.File("run.mcap").empty());
  EXPECT_TRUE(a.File("run.mcap") == b.File("run.mcap")) << "run.mcap differs";
  EXPECT_TRUE(a.File("states.npz") == b.File("states.npz")) << "states.npz differs";
  EXPECT_EQ(a.File("config.toml"), b.File("config.toml"));
}

/// The summary of a run without the values that depend on the machine or the engine.
nlohmann::json Measurements(const Up& up) {
  nlohmann::json summary = up.Summary();
  for (const char* key : {"engine", "wire", "wall_s", "real_time_factor", "ticks_per_s", "startup_s", "total_s"})
    summary.erase(key);
  return summary;
}

/// Options that make a run of a shipped configuration short, unless it has events, which are all to happen.
std::vector<std::string> Lasting(const std::string& seconds, const std::string& name,
                                 std::vector<std::string> more = {}) {
  if (ReadFile(Config(name)).find("[[events]]") == std::string::npos)
    more.insert(more.end(), {"--duration-s", seconds});
  return more;
}

class Shipped : public testing::TestWithParam<std::string> {};

TEST_P(Shipped, FliesOverDdsAsInOneProcess) {
  ScratchFolder folder;
  Up dds(folder, "dds", Config(GetParam()), Lasting("3", GetParam()));
  EXPECT_EQ(dds.Wait(), 0) << dds.err();
  Up inprocess(folder, "inprocess", Config(GetParam()), Lasting("3", GetParam(), {"--engine", "inprocess"}));
  EXPECT_EQ(inprocess.Wait(), 0) << inprocess.err();
  ExpectSameBytes(dds, inprocess);
  EXPECT_EQ(Measurements(dds), Measurements(inprocess));
  EXPECT_EQ(dds.Summary()["wire"]["matches_graph"], true);
  EXPECT_TRUE(inprocess.Summary()["wire"].at("matches_graph").is_null()) << "there is no wire to look at";
  EXPECT_EQ(dds.Summary()["samples"]["lost"], 0);
  const Ran check = Shell("node '" + SourceFolder() + "/tests/mcapcheck/mcapcheck.mjs' '" +
                          (dds.path() / "run.mcap").string() + "' --all --strict --quiet");
  EXPECT_EQ(check.exit_code, 0) << check.output;
}

/// `orchestrator up` in one process, with a glibc that takes the processor for one without AVX and FMA.
class UpWithoutFma : public Running {
 public:
  UpWithoutFma(const ScratchFolder& folder, const std::string& config)
      : Running("env",
                {"GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable,-FMA4_Usable,-AVX2,-FMA,-FMA4",
                 BuildFolder() + "/orchestrator", "up", config, "--out", folder.File("without_fma"), "--engine",
                 "inprocess", "--set", "output.save_plot=false"},
                folder.File("without_fma")),
        recording_(folder.File("without_fma/run.mcap")) {}

  std::string Recording() const { return ReadFile(recording_); }

 private:
  std::string recording_;
};

void ExpectTheSameBitsWithoutFma(const std::string& config) {
  ScratchFolder folder;
  Up up(folder, "run", config, {"--engine", "inprocess"});
  EXPECT_EQ(up.Wait(), 0) << up.err();
  UpWithoutFma without_fma(folder, config);
  EXPECT_EQ(without_fma.Wait(), 0) << without_fma.err();
  EXPECT_FALSE(up.File("run.mcap").empty());
  EXPECT_TRUE(up.File("run.mcap") == without_fma.Recording()) << "run.mcap differs";
}

TEST_P(Shipped, FliesTheSameBitsWithoutFma) { ExpectTheSameBitsWithoutFma(Config(GetParam())); }

TEST(Engines, AHeapOfQuadrotorsFliesTheSameBitsWithoutFma) {
  const ScratchFolder folder;
  WriteFile(folder.File("heap.toml"), R"(
[run]
duration_s = 20.0
[agents]
count = 8
position_m = [[0, 0, 1], [0.9, 0, 1.1], [0, 0.9, 1.2], [0.9, 0.9, 1.3], [0, 0.1, 2], [0.9, 0.1, 2.1], [0, 1, 2.2],
              [0.9, 1, 2.3]]
[physics]
obstacles = [{ shape = 'box', position_m = [0.45, 0.5, 0.5], size_m = [0.3, 0.3, 0.2] }]
[graph]
topology = 'complete'
[law]
name = 'consensus'
axes = 'xyz'
)");
  ExpectTheSameBitsWithoutFma(folder.File("heap.toml"));
}

/// Few and many agents, a law in Python, models of all kinds: nothing else makes a start another one.
class Starts : public testing::TestWithParam<std::string> {};

TEST_P(Starts, TenTimesOutOfTen) {
  for (int start = 1; start <= 10; ++start) {
    ScratchFolder folder;
    Up up(folder, "run", Config(GetParam()), {"--duration-s", "0.1"});
    ASSERT_EQ(up.Wait(), 0) << "start " << start << ": " << up.err();
  }
}

TEST_P(Shipped, IsReproducedByItsResolvedFile) {
  ScratchFolder folder;
  Up first(folder, "first", Config(GetParam()), Lasting("2", GetParam(), {"--engine", "inprocess"}));
  ASSERT_EQ(first.Wait(), 0) << first.err();
  Up again(folder, "again", first.path() / "config.toml", {"--engine", "inprocess"});
  ASSERT_EQ(again.Wait(), 0) << again.err();
  ExpectSameBytes(first, again);
}

INSTANTIATE_TEST_SUITE_P(Configs, Shipped, testing::ValuesIn(ShippedConfigs()),
                         [](const auto& row) { return row.param; });
INSTANTIATE_TEST_SUITE_P(Configs, Starts, testing::Values("leaderless", "leader_follower", "custom", "mixed"),
                         [](const auto& row) { return row.param; });

TEST(Verify, FliesOverDdsWhatOneProcessRecordedAndEndsAtTheFirstDifference) {
  ScratchFolder folder;
  Up up(folder, "run", Config("minmax"), {"--duration-s", "1", "--engine", "inprocess"});
  ASSERT_EQ(up.Wait(), 0) << up.err();
  const auto verify = [&](const std::string& recording) {
    return Shell(BuildFolder() + "/orchestrator verify '" + recording + "' --engine dds");
  };
  const std::string recording = folder.File("run/run.mcap"), changed = folder.File("changed.mcap");
  const Ran same = verify(recording);
  EXPECT_EQ(same.exit_code, 0) << same.output;
  EXPECT_THAT(same.output, StartsWith(recording + ": the same, bit for bit: 101 ticks, "));

  const McapContents contents = ReadMcap(recording);
  McapWriter writer(changed);
  writer.Attach("config.toml", "application/toml", contents.attachments.at("config.toml"));
  for (const auto& [id, channel] : contents.channels)
    writer.AddChannel({channel.topic, channel.schema_name, channel.schema_text, channel.metadata});
  ReadMcap(recording, [&](McapContents::Message message) {
    if (message.channel == 2 && message.sequence == 30) message.data.back() ^= 1;
    writer.Write(message.channel, message.log_time, message.data);
  });
  writer.Close();
  const Ran other = verify(changed);
  EXPECT_EQ(other.exit_code, 1) << other.output;
  EXPECT_THAT(other.output, StartsWith(changed + ": differs: " + contents.channels.at(2).topic +
                                       " at tick 30 (t = 0.3 s): acceleration.z is "));
}

// A law in Python that sends messages, over lossy and delayed links, on a graph that changes: agent i counts what it
// has heard from each neighbour, and passes it on.
const std::string kTalkers = R"([run]
duration_s = 2.0
[agents]
count = 5
model = "double_integrator"
[[agents.override]]
id = 4
start_s = 0.5
stop_s = 1.5
[sensors.own]
position_std_m = 0.01
[sensors.heard]
velocity_std_m_per_s = 0.01
[graph]
topology = "directed_ring"
repeat_s = 1.0
range_m = 25.0
[[graph.schedule]]
at_s = 0.4
topology = "complete"
[link]
gilbert_elliott = { good_to_bad = 0.1, bad_to_good = 0.3 }
delay_s = 0.03
jitter_s = 0.02
[[link.override]]
edges = [[2, 1]]
delay_s = 0.0
jitter_s = 0.0
[law]
name = "custom"
python = '''
def start(me, params):
    me.heard = 0.0
def control(t, me, neighbours):
    for j in neighbours:
        if j.message is not None:
            me.heard += 0.001 * j.message[0] + j.age_s
    return 0.1 * me.heard, me.random.normal()
def message(me):
    return None if me.heard % 2 > 1.5 else [me.id + me.heard] * me.id
'''
)";

/// The same kind of experiment with a law in C++: agents move at random and pass on what they have heard.
const std::string kPluginTalkers = R"([run]
duration_s = 2.0
[agents]
count = 4
model = "double_integrator"
[[agents.override]]
id = 3
law = { name = "consensus" }
[graph]
topology = "ring"
[link]
loss = 0.2
[law]
name = "plugin"
library = ")" + BuildFolder() + "/tests/plugins/libtalker.so\"\n";

TEST(PluginLaw, GivesTheSameBytesInBothEnginesMessagesIncluded) {
  ScratchFolder folder;
  WriteFile(folder.File("talkers.toml"), kPluginTalkers);
  Up dds(folder, "dds", folder.File("talkers.toml"), {});
  ASSERT_EQ(dds.Wait(), 0) << dds.err();
  Up inprocess(folder, "inprocess", folder.File("talkers.toml"), {"--engine", "inprocess"});
  ASSERT_EQ(inprocess.Wait(), 0) << inprocess.err();
  ExpectSameBytes(dds, inprocess);
  EXPECT_EQ(Measurements(dds), Measurements(inprocess));
  EXPECT_EQ(dds.Summary()["wire"]["matches_graph"], true);
  EXPECT_EQ(dds.Summary()["samples"]["topics"], 3 * 4 + 2 - 1) << "agent 3 sends no messages";
  Up muffled(folder, "muffled", folder.File("talkers.toml"), {"--engine", "inprocess", "--set", "law.messages=false"});
  ASSERT_EQ(muffled.Wait(), 0) << muffled.err();
  EXPECT_FALSE(muffled.File("states.npz") == inprocess.File("states.npz")) << "what they say matters";
}

/// Three agents with one of the FMUs of tests/fmus.
std::string Fmus(const std::string& name) {
  return "[run]\nduration_s = 1.0\n[agents]\ncount = 3\nmodel = \"double_integrator\"\n[graph]\ntopology = \"ring\"\n"
         "[link]\nloss = 0.2\n[law]\nname = \"fmu\"\nfile = \"" +
         BuildFolder() + "/tests/fmus/" + name + "\"\n";
}

TEST(FmuLaw, GivesTheSameBytesInBothEngines) {
  for (const std::string fmi : {"law_fmi2", "law_fmi3"}) {
    ScratchFolder folder;
    WriteFile(folder.File("fmus.toml"), Fmus(fmi + ".fmu"));
    Up dds(folder, "dds", folder.File("fmus.toml"), {});
    ASSERT_EQ(dds.Wait(), 0) << dds.err();
    Up inprocess(folder, "inprocess", folder.File("fmus.toml"), {"--engine", "inprocess"});
    ASSERT_EQ(inprocess.Wait(), 0) << inprocess.err();
    ExpectSameBytes(dds, inprocess);
  }
}

TEST(FmuLaw, ThatAProcessCanHaveOnceIsFlownInAProcessForEachAgent) {
  ScratchFolder folder;
  WriteFile(folder.File("once.toml"), Fmus("law_once.fmu"));
  Up dds(folder, "dds", folder.File("once.toml"), {});
  EXPECT_EQ(dds.Wait(), 0) << dds.err();
  Up inprocess(folder, "inprocess", folder.File("once.toml"), {"--engine", "inprocess"});
  EXPECT_EQ(inprocess.Wait(), 1);
  EXPECT_THAT(inprocess.err(), HasSubstr("fly the experiment over DDS, with a process for each agent"));
}

TEST(PluginLaw, ThatFailsInFlightEndsTheRunInBothEngines) {
  ScratchFolder folder;
  const auto fly = [&](const std::string& engine, const std::string& does) {
    const std::string law = "law={ name = 'plugin', library = '" + BuildFolder() +
                            "/tests/plugins/libmirror.so', params = { from_s = 0.5, does = '" + does + "' } }";
    Up up(folder, engine + does, Config("leaderless"), {"--engine", engine, "--duration-s", "1", "--set", law});
    EXPECT_EQ(up.Wait(), 1);
    EXPECT_EQ(up.Summary()["exit"], 1);
    return up.err();
  };
  for (const std::string engine : {"dds", "inprocess"}) {
    EXPECT_THAT(fly(engine, "throw"),
                testing::ContainsRegex("error: .*the law of agent [1-4] failed at t = 0.5 s: the map ends here\n"));
    EXPECT_THAT(fly(engine, "nan"),
                testing::ContainsRegex("error: .*tick 50: agent [1-4]: the law's acceleration is not finite"));
  }
}

TEST(Messages, ReachThoseWhoHearTheSenderTheSameInBothEngines) {
  ScratchFolder folder;
  WriteFile(folder.File("talkers.toml"), kTalkers);
  Up dds(folder, "dds", folder.File("talkers.toml"), {});
  ASSERT_EQ(dds.Wait(), 0) << dds.err();
  Up inprocess(folder, "inprocess", folder.File("talkers.toml"), {"--engine", "inprocess"});
  ASSERT_EQ(inprocess.Wait(), 0) << inprocess.err();
  ExpectSameBytes(dds, inprocess);
  EXPECT_EQ(Measurements(dds), Measurements(inprocess));
  EXPECT_EQ(dds.Summary()["wire"]["matches_graph"], true);
  EXPECT_EQ(dds.Summary()["samples"]["topics"], 3 * 5 + 2);
  EXPECT_GT(dds.Summary()["links"]["lost"], 0);
  EXPECT_GT(dds.Summary()["links"]["late"], 0);
  EXPECT_THAT(dds.out(), ContainsRegex("links          [0-9]+ samples sent, [0-9.]+ % lost, [0-9.]+ % overtaken\n"));
  Up muffled(folder, "muffled", folder.File("talkers.toml"), {"--engine", "inprocess", "--set", "law.messages=false"});
  ASSERT_EQ(muffled.Wait(), 0) << muffled.err();
  EXPECT_FALSE(muffled.File("states.npz") == inprocess.File("states.npz")) << "what they say matters";
  const Ran check = Shell("node '" + SourceFolder() + "/tests/mcapcheck/mcapcheck.mjs' '" +
                          (dds.path() / "run.mcap").string() + "' --all --strict --quiet");
  EXPECT_EQ(check.exit_code, 0) << check.output;
}

TEST(CustomLaw, ThatFailsEndsTheRunWithItsTracebackAgentTickAndTime) {
  ScratchFolder folder;
  WriteFile(folder.File("bad.toml"),
            "[run]\nduration_s = 2.0\n[agents]\ncount = 3\n[law]\nname = 'custom'\npython = '''\n"
            "def control(t, me, neighbours):\n  if t > 0.5 and me.id == 2:\n    return neighbours[7].position\n"
            "  return 0, 0\n'''\n");
  for (const std::string engine : {"dds", "inprocess"}) {
    Up up(folder, engine, folder.File("bad.toml"), {"--engine", engine});
    EXPECT_EQ(up.Wait(), 1);
    EXPECT_THAT(up.err(), HasSubstr("tick 51: the law of agent 2 failed at t = 0.51 s"));
    EXPECT_THAT(up.err(), HasSubstr("File \"bad.toml\", line 10, in control"));
    EXPECT_THAT(up.err(), HasSubstr("IndexError: list index out of range"));
    EXPECT_EQ(up.Summary()["exit"], 1);
  }
}

TEST(CustomLaw, ThatFailsOnIdealBodiesOnlyFliesAndSaysThatFidelityIsNotMeasured) {
  ScratchFolder folder;
  WriteFile(folder.File("exact.toml"),
            "[run]\nduration_s = 1.0\n[agents]\ncount = 2\n[law]\nname = 'custom'\npython = '''\n"
            "def control(t, me, neighbours):\n  if t > 0.5 and me.orientation[0] == 1:\n"
            "    raise ValueError('too good to be true')\n  return 1, 0.5\n'''\n");
  const std::string failure =
      "tick 51: the law of agent 1 failed at t = 0.51 s\nTraceback (most recent call last):\n"
      "  File \"exact.toml\", line 10, in control\n    raise ValueError('too good to be true')\n"
      "ValueError: too good to be true";
  for (const std::string engine : {"dds", "inprocess"}) {
    Up up(folder, engine, folder.File("exact.toml"), {"--engine", engine});
    EXPECT_EQ(up.Wait(), 0) << up.err();
    EXPECT_THAT(up.out(),
                HasSubstr("fidelity       not measured, the law failed on ideal double integrators: " + failure));
    EXPECT_EQ(up.Summary()["ticks"], 100);
    EXPECT_TRUE(up.Summary()["fidelity"]["rms_m"].is_null());
    EXPECT_EQ(up.Summary()["fidelity"]["failure"], failure);
  }
}

TEST(CustomLaw, WithASyntaxErrorStartsNothing) {
  ScratchFolder folder;
  WriteFile(folder.File("bad.toml"),
            "[run]\nduration_s = 2.0\n[agents]\ncount = 3\n[law]\nname = 'custom'\npython = 'def control(:'\n");
  Up up(folder, "run", folder.File("bad.toml"), {});
  EXPECT_EQ(up.Wait(), 2);
  EXPECT_THAT(up.err(), HasSubstr("bad.toml:7:13: law.python: expected Python, got SyntaxError: "));
  EXPECT_FALSE(std::filesystem::exists(up.path()));
}

/// Keeps every core busy until it is destroyed.
class Load {
 public:
  Load() {
    for (unsigned i = 0; i < 2 * std::thread::hardware_concurrency(); ++i)
      threads_.emplace_back([this] {
        while (!over_) {
        }
      });
  }
  ~Load() {
    over_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::atomic<bool> over_ = false;
  std::vector<std::thread> threads_;
};

/// Arguments that set keys of [network].
std::vector<std::string> Network(int agents_per_process, const std::string& delivery) {
  return {"--set", "network.agents_per_process=" + std::to_string(agents_per_process), "--set",
          "network.delivery=" + delivery};
}

struct Way {
  int agents_per_process;
  const char* delivery;
  std::vector<std::string> processes;  ///< names of the agent processes, for five agents
};

void PrintTo(const Way& way, std::ostream* out) {
  *out << way.delivery << " in processes of " << way.agents_per_process;
}

class Delivery : public testing::TestWithParam<Way> {};

TEST_P(Delivery, DoesNotChangeABitOfTheRecording) {
  ScratchFolder folder;
  const std::string config = folder.File("talkers.toml");
  WriteFile(config, kTalkers);
  Up inprocess(folder, "inprocess", config, {"--engine", "inprocess"});
  ASSERT_EQ(inprocess.Wait(), 0) << inprocess.err();
  Up dds(folder, "dds", config, Network(GetParam().agents_per_process, GetParam().delivery));
  ASSERT_EQ(dds.Wait(), 0) << dds.err();
  EXPECT_TRUE(dds.File("run.mcap") == inprocess.File("run.mcap"));
  EXPECT_TRUE(dds.File("states.npz") == inprocess.File("states.npz"));
  EXPECT_EQ(Measurements(dds), Measurements(inprocess));
  EXPECT_EQ(dds.Summary()["wire"]["matches_graph"], true);
  std::vector<std::string> logs;
  for (const auto& log : std::filesystem::directory_iterator(dds.path() / "logs")) logs.push_back(log.path().stem());
  for (const std::string& process : GetParam().processes) EXPECT_THAT(logs, testing::Contains(process));
  EXPECT_THAT(logs, testing::SizeIs(GetParam().processes.size() + 2)) << "and the server's and the orchestrator's";
}

INSTANTIATE_TEST_SUITE_P(Ways, Delivery,
                         testing::Values(Way{2, "topics", {"agents_1-2", "agents_3-4", "agent_5"}},
                                         Way{5, "topics", {"agents_1-5"}},
                                         Way{1, "bundled", {"agent_1", "agent_2", "agent_3", "agent_4", "agent_5"}},
                                         Way{3, "bundled", {"agents_1-3", "agents_4-5"}}),
                         NamedAsPrinted<Way>);

TEST(Engines, ThreeHundredAgentsShareTenProcesses) {
  ScratchFolder folder;
  const std::string config = folder.File("many.toml");
  WriteFile(
      config,
      "[run]\nduration_s = 0.1\n[agents]\ncount = 300\nrandom = { min_m = [-99, -99, 1], max_m = [99, 99, 400] }\n"
      "[graph]\ntopology = 'ring'\n[law]\np_gain = 0.01\n");
  Up dds(folder, "dds", config, Network(30, "topics"));
  ASSERT_EQ(dds.Wait(), 0) << dds.err();
  Up inprocess(folder, "inprocess", config, {"--engine", "inprocess"});
  ASSERT_EQ(inprocess.Wait(), 0) << inprocess.err();
  EXPECT_TRUE(dds.File("run.mcap") == inprocess.File("run.mcap"));
  EXPECT_EQ(dds.Summary()["wire"]["matches_graph"], true);
  Up too_many(folder, "too_many", config);
  EXPECT_EQ(too_many.Wait(), 2);
  EXPECT_THAT(too_many.err(),
              HasSubstr("error: network.agents_per_process: expected at most 110 processes of agents on "
                        "this host, such as by 3, got 300 processes"));
  EXPECT_FALSE(std::filesystem::exists(too_many.path())) << "nothing was started";
}

TEST(Engines, LoadDoesNotChangeABit) {
  ScratchFolder folder;
  Up quiet(folder, "quiet", Config("leaderless"), {"--duration-s", "5"});
  ASSERT_EQ(quiet.Wait(), 0) << quiet.err();
  const Load load;
  Up loaded(folder, "loaded", Config("leaderless"), {"--duration-s", "5"});
  ASSERT_EQ(loaded.Wait(), 0) << loaded.err();
  ExpectSameBytes(quiet, loaded);
}

TEST(Engines, EventsTakeEffectAtTheSameTickInBothAndAnotherFlightOfTheResolvedFileIsTheSame) {
  ScratchFolder folder;
  const std::string config = SourceFolder() + "/tests/good_configs/events.toml";
  Up inprocess(folder, "inprocess", config, {"--engine", "inprocess", "--set", "run.name=events"});
  ASSERT_EQ(inprocess.Wait(), 0) << inprocess.err();
  const std::vector<std::vector<std::string>> deliveries = {
      {}, {"--set", "network.agents_per_process=2", "--set", "network.delivery=bundled"}};
  for (std::size_t k = 0; k < deliveries.size(); ++k) {
    std::vector<std::string> words{"--set", "run.name=events"};
    words.insert(words.end(), deliveries[k].begin(), deliveries[k].end());
    Up dds(folder, "dds" + std::to_string(k), config, words);
    ASSERT_EQ(dds.Wait(), 0) << dds.err();
    EXPECT_TRUE(dds.File("run.mcap") == inprocess.File("run.mcap")) << "run.mcap differs";
    EXPECT_TRUE(dds.File("states.npz") == inprocess.File("states.npz")) << "states.npz differs";
    EXPECT_EQ(dds.Summary()["fidelity"], inprocess.Summary()["fidelity"]);
  }
  Up again(folder, "again", folder.File("inprocess/config.toml"), {"--engine", "inprocess"});
  ASSERT_EQ(again.Wait(), 0) << again.err();
  ExpectSameBytes(again, inprocess);
}

/// What RViz sees of a recorded run, and rows at a lower rate than ticks: both engines, a schedule, lost samples,
/// events.
TEST(Engines, RecordTypesOfRosAndFewerRowsAlike) {
  ScratchFolder folder;
  WriteFile(folder.File("team.toml"), R"(
[run]
duration_s = 2.05
[agents]
count = 3
position_m = [[0, 0, 1], [4, 0, 1.5], [0, 4, 2]]
[graph]
topology = "ring"
[[graph.schedule]]
at_s = 1
topology = "complete"
[link]
loss = 0.3
[law]
name = "consensus"
[record]
ros_types = true
rate_hz = 20
[[events]]
at_s = 0.52
cut = [[1, 2]]
)");
  Up dds(folder, "dds", folder.File("team.toml"));
  EXPECT_EQ(dds.Wait(), 0) << dds.err();
  Up inprocess(folder, "inprocess", folder.File("team.toml"), {"--engine", "inprocess"});
  EXPECT_EQ(inprocess.Wait(), 0) << inprocess.err();
  ExpectSameBytes(dds, inprocess);
  EXPECT_EQ(Measurements(dds), Measurements(inprocess));
  EXPECT_THAT(dds.Info(), HasSubstr("of which 42 have a row"));
  const Ran check =
      Shell("node '" + SourceFolder() + "/tests/mcapcheck/ros_types.mjs' '" + (dds.path() / "run.mcap").string() + "'");
  EXPECT_EQ(check.exit_code, 0) << check.output;
  const Ran verify =
      Shell("'" + BuildFolder() + "/orchestrator' verify --engine dds '" + inprocess.path().string() + "'");
  EXPECT_EQ(verify.exit_code, 0) << verify.output;
}

// Fast DDS sends more than 64 KB in fragments, and then does not pad the end.
TEST(Engines, AnEventThatTravelsInFragmentsIsRecordedTheSame) {
  ScratchFolder folder;
  std::string edges;
  for (int i = 1; i <= 110; ++i)
    for (int j = 1; j <= 110; ++j)
      if (i != j) edges += fmt::format("{}[{}, {}]", edges.empty() ? "" : ", ", i, j);
  for (const char* end : {"", ", [1, 111]", ", [11, 111]", ", [111, 11]"}) {  // each leaves other bytes to pad
    const std::string config = folder.File("edges.toml");
    WriteFile(config,
              "[run]\nduration_s = 0.05\n[agents]\ncount = 111\nmodel = 'double_integrator'\nrandom = { min_m = [0, 0, "
              "1], max_m = [99, 99, 99] }\n[law]\np_gain = 0.01\n[[events]]\nat_s = 0.02\ngraph = { edges = [" +
                  edges + end + "] }\n");
    Up inprocess(folder, "inprocess", config, {"--force", "--engine", "inprocess"});
    ASSERT_EQ(inprocess.Wait(), 0) << inprocess.err();
    Up dds(folder, "dds", config, {"--force", "--set", "network.agents_per_process=37"});
    ASSERT_EQ(dds.Wait(), 0) << dds.err();
    EXPECT_TRUE(dds.File("run.mcap") == inprocess.File("run.mcap")) << end;
  }
}

TEST(Engines, TwoRunsAtOnceDoNotDisturbEachOther) {
  ScratchFolder folder;
  Up one(folder, "one", Config("leaderless"), {"--duration-s", "5"});
  Up two(folder, "two", Config("leaderless"), {"--duration-s", "5"});
  ASSERT_EQ(one.Wait(), 0) << one.err();
  ASSERT_EQ(two.Wait(), 0) << two.err();
  ExpectSameBytes(one, two);
  Up alone(folder, "alone", Config("leaderless"), {"--duration-s", "5"});
  ASSERT_EQ(alone.Wait(), 0) << alone.err();
  ExpectSameBytes(one, alone);
}

void FlyFifty(const std::string& delivery, bool with_server) {
  ScratchFolder folder;
  const std::vector<std::string> fifty = {"--duration-s", "0.5",
                                          "--set",        "agents.count=50",
                                          "--set",        "graph.topology=ring",
                                          "--set",        "agents.random={}",
                                          "--set",        "network.delivery=" + delivery};
  Up dds(folder, "dds", Config("leaderless"), fifty);
  EXPECT_EQ(dds.Wait(), 0) << dds.err();
  EXPECT_EQ(dds.Said("discovery server 127.0.0.1:"), with_server) << dds.err();
  auto inprocess_words = fifty;
  inprocess_words.insert(inprocess_words.end(), {"--engine", "inprocess"});
  Up inprocess(folder, "inprocess", Config("leaderless"), inprocess_words);
  EXPECT_EQ(inprocess.Wait(), 0) << inprocess.err();
  ExpectSameBytes(dds, inprocess);
}

TEST(Engines, FiftyAgentsOfTopicsFlyThroughADiscoveryServer) { FlyFifty("topics", true); }
TEST(Engines, FiftyAgentsOfBundlesAnnounceThemselvesToTheServerAndTheOrchestrator) { FlyFifty("bundled", false); }

TEST(Engines, ReportContactsByKindAlike) {
  ScratchFolder folder;
  const std::string agents =
      "agents={ count = 4, model = 'double_integrator', position_m = [[0, 0, 1], [1, 0, 1], [0, 9, 0.2], [9, 9, 5]], "
      "velocity_m_per_s = [[2, 0, 0], [-2, 0, 0], [0, 0, -5], [3, 0, 0]] }";
  const std::vector<std::string> crowd = {
      "--duration-s", "1",     "--set",
      agents,         "--set", "physics.obstacles=[{ shape = 'box', position_m = [10.2, 9, 5], size_m = [1, 1, 1] }]"};
  Up dds(folder, "dds", Config("leaderless"), crowd);
  EXPECT_EQ(dds.Wait(), 0) << dds.err();
  auto inprocess_words = crowd;
  inprocess_words.insert(inprocess_words.end(), {"--engine", "inprocess"});
  Up inprocess(folder, "inprocess", Config("leaderless"), inprocess_words);
  EXPECT_EQ(inprocess.Wait(), 0) << inprocess.err();
  ExpectSameBytes(dds, inprocess);
  const nlohmann::json safety = dds.Summary()["safety"];
  const nlohmann::json& contacts = safety["contacts"];
  EXPECT_EQ(contacts["agents"], 1);
  EXPECT_EQ(contacts["ground"], 1);
  EXPECT_EQ(contacts["obstacles"], 1);
  ASSERT_EQ(contacts["first"].size(), 3u);
  EXPECT_EQ(contacts["first"][0]["agent"], 3);
  EXPECT_EQ(contacts["first"][0]["with"], "ground");
  EXPECT_EQ(contacts["first"][0]["t_s"], 0.02) << "0.1 m at 5 m/s";
  EXPECT_NEAR(contacts["first"][0]["speed_m_per_s"], 4.04, 0.01) << "it brakes for 2 ticks";
  EXPECT_EQ(inprocess.File("events.csv"), dds.File("events.csv"));
  EXPECT_THAT(dds.File("events.csv"), HasSubstr(",contact,1,1,agent 2,"));
  EXPECT_THAT(dds.File("events.csv"), HasSubstr(",contact,1,4,obstacle 1,"));
  EXPECT_THAT(dds.out(), HasSubstr("happened       0.02 s: agent 3 touches the ground at "));
  EXPECT_EQ(safety["collisions"], 3);
  EXPECT_EQ(inprocess.Summary()["safety"], safety);
}

/// A free domain that `up` does not pick by itself (an odd one); another test suite may be running.
int FreeOddDomain() {
  for (int k = 0;; ++k) {
    const int domain = 1 + 2 * ((getpid() + k) % 49);
    try {
      return DomainLock(domain).domain();
    } catch (const std::runtime_error&) {
      if (k == 49) throw;
    }
  }
}

TEST(Engines, AnExplicitDomainAndTransportDoNotChangeTheRecording) {
  ScratchFolder folder;
  const std::string domain = std::to_string(FreeOddDomain());
  Up automatic(folder, "automatic", Config("leaderless"), {"--duration-s", "1"});
  EXPECT_EQ(automatic.Wait(), 0) << automatic.err();
  Up by_udp(folder, "by_udp", Config("leaderless"),
            {"--duration-s", "1", "--set", "network.domain=" + domain, "--set", "network.transport=udp"});
  EXPECT_EQ(by_udp.Wait(), 0) << by_udp.err();
  EXPECT_THAT(by_udp.err(), HasSubstr("domain " + domain));
  // The transport is part of the attached experiment, so that run.mcap differs; the samples are the same.
  EXPECT_TRUE(automatic.File("states.npz") == by_udp.File("states.npz"));
  Up elsewhere(folder, "elsewhere", Config("leaderless"), {"--duration-s", "1", "--set", "network.domain=" + domain});
  EXPECT_EQ(elsewhere.Wait(), 0) << elsewhere.err();
  EXPECT_TRUE(automatic.File("run.mcap") == elsewhere.File("run.mcap"));
}

TEST(Realtime, IsPacedByTheWallClock) {
  ScratchFolder folder;
  const std::vector<std::string> realtime = {"--duration-s", "1", "--set", "run.mode=realtime"};
  Up up(folder, "once", Config("leaderless"), realtime);
  ASSERT_EQ(up.Wait(), 0) << up.err();
  EXPECT_EQ(up.Summary()["mode"], "realtime");
  EXPECT_EQ(up.Summary()["ticks"], 100);
  EXPECT_GE(up.Summary()["wall_s"].get<double>(), 0.9);  // from the first tick recorded, which may be late
  EXPECT_TRUE(up.Summary()["realtime"]["misses"].is_number_unsigned());
  auto slowly = realtime;
  slowly.insert(slowly.end(), {"--set", "run.speed=0.5"});
  Up half(folder, "half", Config("leaderless"), slowly);
  ASSERT_EQ(half.Wait(), 0) << half.err();
  EXPECT_GE(half.Summary()["wall_s"].get<double>(), 1.8);
}

TEST(Realtime, SaysHowItKeptToItsTimes) {
  ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"), {"--duration-s", "1", "--set", "run.mode=realtime"});
  ASSERT_EQ(up.Wait(), 0) << up.err();
  const auto realtime = up.Summary()["realtime"];
  for (const char* spread : {"tick_lateness_s", "command_age_s"}) {
    const double p50 = realtime[spread]["p50"], p99 = realtime[spread]["p99"], max = realtime[spread]["max"];
    EXPECT_GE(p50, 0) << spread;
    EXPECT_LE(p50, p99) << spread;
    EXPECT_LE(p99, max) << spread;
  }
  EXPECT_GT(realtime["tick_lateness_s"]["max"], 0) << "nobody wakes before it is time";
  EXPECT_EQ(realtime["misses"] == 0, realtime["command_age_s"]["max"] == 0.0);
  EXPECT_THAT(up.out(), HasSubstr("ms after they were due in the median"));
  EXPECT_THAT(up.Info(), HasSubstr("ticks:        101, recorded without a gap\ncomplete: yes\n"));
}

/// Whether a process has locked memory, according to the kernel.
bool HasLockedMemory(pid_t pid) {
  std::istringstream status(ReadFile("/proc/" + std::to_string(pid) + "/status"));
  for (std::string word; status >> word;)
    if (word == "VmLck:") return status >> word && word != "0";
  return false;
}

TEST(Realtime, TakesPrivilegesOrSaysThatItMayNot) {
  ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"),
        {"--duration-s", "600", "--set", "run.mode=realtime", "--set", "run.scheduler=fifo", "--set",
         "run.pin_cores=true", "--set", "run.lock_memory=true"});
  ASSERT_TRUE(Until([&] { return up.Said("agent_2] hears"); }));
  const pid_t agent = up.Child("agent_2");
  ASSERT_GT(agent, 0);
  EXPECT_TRUE(Until([&] {
    return ::sched_getscheduler(agent) == SCHED_FIFO || up.Said("run.scheduler: SCHED_FIFO is not permitted");
  }));
  cpu_set_t cores;
  ASSERT_EQ(::sched_getaffinity(agent, sizeof cores, &cores), 0);
  EXPECT_EQ(CPU_COUNT(&cores), 1);
  EXPECT_TRUE(HasLockedMemory(agent) || up.Said("run.lock_memory: memory cannot be locked"));
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
}

TEST(Realtime, TakesNoPrivilegesUnlessAsked) {
  ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"), {"--duration-s", "600", "--set", "run.mode=realtime"});
  ASSERT_TRUE(Flies(up));
  const pid_t agent = up.Child("agent_2");
  EXPECT_EQ(::sched_getscheduler(agent), SCHED_OTHER);
  EXPECT_FALSE(HasLockedMemory(agent));
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
}

TEST(Lockstep, RunsAsABatchJobUnlessAskedForMore) {
  ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"), {"--duration-s", "600"});
  ASSERT_TRUE(Flies(up));
  EXPECT_EQ(::sched_getscheduler(up.Child("agent_2")), SCHED_BATCH);
  EXPECT_EQ(::sched_getscheduler(up.Child("physics_server")), SCHED_BATCH);
  up.Signal(SIGINT);
  EXPECT_EQ(up.Wait(), 130) << up.err();
}

TEST(Realtime, CountsWhatIsLostWhereTheMachineCannotKeepUp) {
  ScratchFolder folder;  // writers may overwrite commands that are not read yet, which must not end the run
  for (int i = 0; i < 3; ++i) {
    Up up(folder, "run", Config("leaderless"),
          {"--duration-s", "30", "--set", "run.mode=realtime", "--set", "run.speed=1000", "--force"});
    EXPECT_EQ(up.Wait(), 0) << up.err();
    const auto samples = up.Summary()["samples"];
    EXPECT_LE(samples["recorded"].get<int>() + samples["lost"].get<int>(), 9 * 3001);
  }
}

TEST(Engines, FlyALargeTeamInAnyNumberOfThreadsToTheSameBytes) {
  ScratchFolder folder;
  const auto large = [](const char* threads) -> std::vector<std::string> {
    return {"--engine", "inprocess", "--threads",        threads, "--duration-s",
            "1",        "--set",     "agents.count=100", "--set", "agents.random.max_m=[10, 10, 60]"};
  };
  Up one(folder, "one", Config("leaderless"), large("1"));
  ASSERT_EQ(one.Wait(), 0) << one.err();
  Up three(folder, "three", Config("leaderless"), large("3"));
  ASSERT_EQ(three.Wait(), 0) << three.err();
  ExpectSameBytes(one, three);
}

TEST(Engines, RefuseThreadsThatTheyCannotHave) {
  ScratchFolder folder;
  const auto refusal = [&](const std::vector<std::string>& args) {
    Up up(folder, "run", Config("leaderless"), args);
    EXPECT_EQ(up.Wait(), 2);
    return up.err();
  };
  EXPECT_EQ(refusal({"--threads", "2"}), "error: --threads: expected --engine inprocess with it\n");
  EXPECT_EQ(refusal({"--engine", "inprocess", "--threads", "0"}), "error: --threads: expected 1 to 1024, got 0\n");
  EXPECT_EQ(refusal({"--engine", "inprocess", "--threads", "1025"}),
            "error: --threads: expected 1 to 1024, got 1025\n");
}

TEST(Realtime, IsRefusedInOneProcess) {
  ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"), {"--engine", "inprocess", "--set", "run.mode=realtime"});
  EXPECT_EQ(up.Wait(), 2);
  EXPECT_EQ(up.err(), "error: --engine inprocess: expected run.mode = \"lockstep\", got \"realtime\"\n");
  EXPECT_FALSE(std::filesystem::exists(up.path()));
}

TEST(Up, SaysWhatItRunsAndWhereTheResultsAre) {
  ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"), {"--duration-s", "1"});
  ASSERT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.err(), testing::ContainsRegex("domain [0-9]+\n"));
  EXPECT_THAT(up.err(), HasSubstr("[agent_3] "));
  EXPECT_THAT(up.err(), HasSubstr("t = 1.00 of 1 s | "));
  EXPECT_THAT(up.out(), HasSubstr("results        " + up.path().string()));
  EXPECT_THAT(ReadFile((up.path() / "logs/agent_3.log").string()), HasSubstr("hears 1 2 4"));
}

TEST(Up, SaysWhatWasMeasuredAndBesideItWhatTheoryPredicted) {
  ScratchFolder folder;
  Up whole(folder, "whole", Config("leaderless"), {"--engine", "inprocess"});
  ASSERT_EQ(whole.Wait(), 0) << whole.err();
  EXPECT_THAT(whole.out(), ContainsRegex("decayed        at 0\\.29.. 1/s\n  predicted    0\\.2988 1/s .from this "
                                         "start; slowest mode 0\\.2996.: [+-]"));
  EXPECT_THAT(whole.out(),
              ContainsRegex("settled        after 15\\... s .2 %.\n  predicted    15\\.34 s .from this start.: [+-]"));
  Up cut(folder, "cut", Config("leaderless"), {"--engine", "inprocess", "--duration-s", "3"});
  ASSERT_EQ(cut.Wait(), 0) << cut.err();
  EXPECT_THAT(
      cut.out(),
      HasSubstr("decayed        at no rate that can be measured: the disagreement fell too little, or rose again\n"
                "  predicted    0.2988 1/s (from this start; slowest mode 0.2996)\n"
                "settled        not by the end (2 %)\n"
                "  predicted    15.34 s (from this start)\n"));
}

TEST(Up, SaysWithWhichIdealBodiesARunWasCompared) {
  ScratchFolder folder;
  const auto compared_with = [&](const std::string& config) {
    Up up(folder, config, Config(config), {"--engine", "inprocess", "--duration-s", "1"});
    EXPECT_EQ(up.Wait(), 0) << up.err();
    const std::string text = up.out(), from = "m rms from ";
    const std::size_t begin = text.find(from) + from.size();
    return text.substr(begin, text.find(':', begin) - begin);
  };
  EXPECT_EQ(compared_with("leaderless"), "ideal double integrators");
  EXPECT_EQ(compared_with("switching"), "ideal single integrators");
  EXPECT_EQ(compared_with("mixed"), "ideal single and double integrators");
}

/// The summary of a run of 1 s in one process: two double integrators with a Python law that returns `returned`.
nlohmann::json OneSecond(const ScratchFolder& folder, const std::string& returned, std::vector<std::string> more = {}) {
  WriteFile(folder.File("law.toml"),
            "[run]\nduration_s = 1.0\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\nname = 'custom'\n"
            "python = '''\ndef control(t, me, neighbours):\n    return " +
                returned + "\n'''\n");
  more.insert(more.end(), {"--engine", "inprocess"});
  Up up(folder, "run", folder.File("law.toml"), more);
  EXPECT_EQ(up.Wait(), 0) << up.err();
  return up.Summary();
}

TEST(Up, IntegratesTheEffortOverThePeriodsFlown) {
  const ScratchFolder folder;
  EXPECT_NEAR(OneSecond(folder, "[0.5, 0]")["control"]["effort"].get<double>(), 0.25 * 1, 1e-12);
}

TEST(Up, MeasuresFidelityOfLawsThatLookAtTheirHeading) {
  const ScratchFolder folder;  // q = w x y z: 1 - 2 z^2 is the cosine of the heading
  const auto summary =
      OneSecond(folder, "[1 - 2 * me.orientation[3]**2, 0]", {"--set", "agents.heading_rad=[1.5,0.3]"});
  EXPECT_LT(summary["fidelity"]["rms_m"].get<double>(), 1e-9);
  EXPECT_GT(summary["fidelity"]["travelled_m"].get<double>(), 0.1);
}

TEST(Up, EndsAtASignalWhileALawHangsBeforeTheRun) {
  const ScratchFolder folder;
  const std::string hangs = folder.File("hangs");
  WriteFile(
      folder.File("law.toml"),
      "[run]\nduration_s = 1.0\nagent_timeout_s = 3600.0\nstart_timeout_s = 3600.0\n[agents]\ncount = 1\n[law]\nname "
      "= 'custom'\npython = '''\nopen('" +
          hangs + "', 'w').close()\nwhile True: pass\n'''\n");
  for (const auto& [signal, code] : {std::pair(SIGINT, 130), std::pair(SIGTERM, 143)}) {
    std::filesystem::remove(hangs);
    Up up(folder, "run", folder.File("law.toml"));
    ASSERT_TRUE(Await("the law", [&] { return std::filesystem::exists(hangs); }));
    up.Signal(signal);
    EXPECT_EQ(up.Wait(), code) << up.err();
    EXPECT_FALSE(std::filesystem::exists(up.path()));
  }
}

TEST(Up, OutlivesAHangUpThatItWasToldToIgnore) {
  const ScratchFolder folder;
  Running up(
      "sh",
      {"-c", "trap '' HUP; exec '" + BuildFolder() + "/orchestrator' up " + Config("leaderless") +
                 " --engine inprocess --duration-s 500 --set output.save_plot=false --out " + folder.File("run")},
      folder.File("up"));
  ASSERT_TRUE(Flies(up));
  up.Signal(SIGHUP);
  EXPECT_EQ(up.Wait(), 0);
}

TEST(Up, PrintsTheSummaryAndNothingElseAsJson) {
  ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"), {"--duration-s", "1", "--json", "--engine", "inprocess"});
  ASSERT_EQ(up.Wait(), 0) << up.err();
  EXPECT_EQ(up.err(), "");
  const auto printed = nlohmann::json::parse(up.out());
  EXPECT_EQ(printed["experiment"], "leaderless");
  EXPECT_EQ(printed, up.Summary());
}

TEST(Up, FailsIfTheSummaryCannotBePrintedUnlessNobodyWantsIt) {
  ScratchFolder folder;
  const auto up = [&](const std::string& name, const std::string& where) {
    const Ran ran = Shell("{ { '" + BuildFolder() + "/orchestrator' up " + Config("leaderless") +
                          " --engine inprocess --duration-s 0.1 --set output.save_plot=false --out " +
                          folder.File(name) + "; echo exit $? >&2; } " + where + "; }");
    EXPECT_THAT(
        ran.output,
        HasSubstr("exit " + nlohmann::json::parse(ReadFile(folder.File(name + "/summary.json")))["exit"].dump()));
    return ran.output;
  };
  EXPECT_THAT(up("full", ">/dev/full"),
              HasSubstr("error: cannot write to standard output: No space left on device\nexit 1\n"));
  EXPECT_THAT(up("closed", ">&-"), AllOf(HasSubstr("\nexit 0\n"), Not(HasSubstr("error"))));
  EXPECT_THAT(up("gone", "| true"), AllOf(HasSubstr("\nexit 0\n"), Not(HasSubstr("error"))));
}

TEST(Up, RefusesAFolderThatHoldsSomethingUnlessForced) {
  ScratchFolder folder;
  Up earlier(folder, "run", Config("leaderless"), {"--duration-s", "0.2", "--engine", "inprocess"});
  ASSERT_EQ(earlier.Wait(), 0) << earlier.err();
  WriteFile(folder.File("run/notes.txt"), "a person's own");
  const std::vector<std::string> words = {"--duration-s", "0.1", "--engine", "inprocess"};
  Up refused(folder, "run", Config("leaderless"), words);
  EXPECT_EQ(refused.Wait(), 2);
  EXPECT_THAT(refused.err(), HasSubstr("error: --out " + folder.File("run") + ": expected a new or empty folder"));
  auto forced_words = words;
  forced_words.push_back("--force");
  Up forced(folder, "run", Config("leaderless"), forced_words);
  EXPECT_EQ(forced.Wait(), 0) << forced.err();
  EXPECT_EQ(forced.Summary()["ticks"], 10);
  EXPECT_EQ(ReadFile(folder.File("run/notes.txt")), "a person's own");
}

TEST(Up, SaysFirstWhatItIsGoingToDo) {
  ScratchFolder folder;
  Up up(folder, "run", Config("leaderless"), {"--duration-s", "0.5", "--engine", "inprocess"});
  EXPECT_EQ(up.Wait(), 0) << up.err();
  EXPECT_THAT(up.err(), testing::StartsWith("leaderless: 4 agents for 0.5 s at 100 Hz, law consensus, in one process; "
                                            "results go to " +
                                            folder.File("run") + "\n"));
}

TEST(Help, OfAVerbIsThatOfItsOption) {
  ScratchFolder folder;
  const auto said = [&](std::vector<std::string> words) {
    Running run(BuildFolder() + "/orchestrator", std::move(words), folder.File("help"));
    EXPECT_EQ(run.Wait(), 0);
    EXPECT_EQ(run.err(), "");
    return run.out();
  };
  EXPECT_EQ(said({"help", "sweep"}), said({"sweep", "--help"}));
  EXPECT_EQ(said({"help"}), said({"--help"}));
  EXPECT_THAT(said({"help"}), HasSubstr("orchestrator help VERB"));
  Running unknown(BuildFolder() + "/orchestrator", {"help", "swep"}, folder.File("unknown"));
  EXPECT_EQ(unknown.Wait(), 2);
  EXPECT_THAT(unknown.err(), HasSubstr("error: unknown verb 'swep' (did you mean \"sweep\"?)"));
}

TEST(Up, SaysWhatIsWrongWithItsArguments) {
  ScratchFolder folder;
  auto refusal = [&](std::vector<std::string> words) {
    Running up(BuildFolder() + "/orchestrator", std::move(words), folder.File("refusal"));
    EXPECT_EQ(up.Wait(), 2);
    return up.err();
  };
  EXPECT_THAT(refusal({"upp"}),
              HasSubstr("error: unknown verb 'upp' (did you mean \"up\"?); expected one of up, ps, send, check"));
  EXPECT_THAT(refusal({}), HasSubstr("Usage: "));
  EXPECT_THAT(refusal({"up"}), HasSubstr("error: config is required"));
  EXPECT_THAT(refusal({"up", "--duratio-s", "5"}),
              HasSubstr("error: unknown option '--duratio-s' (did you mean \"--duration-s\"?)"));
  EXPECT_THAT(refusal({"up", Config("leaderless"), "--duration", "5"}),
              HasSubstr("error: unknown option '--duration' (did you mean \"--duration-s\"?)"));
  EXPECT_THAT(refusal({"check", Config("leaderless"), "5", "6"}), HasSubstr("error: unexpected argument '5'"));
  EXPECT_THAT(refusal({"up", Config("leaderless"), "--engine", "ros"}),
              HasSubstr("error: --engine: expected one of dds, inprocess, got ros"));
  EXPECT_THAT(refusal({"up", Config("leaderless"), "--duration-s", "soon"}), HasSubstr("run.duration_s: expected"));
  EXPECT_THAT(refusal({"up", Config("leaderless"), "--out", "/proc/nowhere/run"}),
              HasSubstr("error: --out: cannot make the run folder"));
}

}  // namespace
}  // namespace mascot::test
