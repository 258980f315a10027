// `orchestrator export`: output, accepted recordings, errors.

#include <gmock/gmock.h>

#include <map>
#include <sstream>

#include "agent/laws/laws.h"
#include "bus/wire.h"
#include "orchestrator/engines/row_feed.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/records.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/recording/run_writer.h"
#include "tests/orchestrator/formats/mat.h"
#include "tests/support/call.h"
#include "tests/support/scratch.h"
#include "tests/support/strict_csv.h"

namespace mascot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::StartsWith;
using testing::ThrowsMessage;

Said Export(const std::vector<std::string>& arguments) { return Call(SetUpExport, arguments); }

/// What the export says when it ends with `exit_code`; "" if it ends with another.
std::string ErrorOf(int exit_code, const std::vector<std::string>& arguments) {
  const Said said = Export(arguments);
  const std::string prefix = "error: ";
  if (said.exit_code != exit_code || !said.err.starts_with(prefix)) return "";
  return said.err.substr(prefix.size(), said.err.size() - prefix.size() - 1);
}

/// Records two quadrotors for 2.5 s at 100 Hz: 251 ticks, in three chunks.
constexpr int kTicks = 251;
void Fly(const ScratchFolder& scratch, const std::string& name, std::vector<std::string> more = {}) {
  const std::string config = scratch.File("two.toml");
  WriteFile(config, "[run]\nduration_s = 2.5\n[agents]\ncount = 2\n[law]\nname = 'consensus'\n");
  std::vector<std::string> arguments = {
      config, "--engine", "inprocess", "--out", scratch.File(name), "--quiet", "--set", "output.save_plot=false"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  ASSERT_EQ(Call(SetUpUp, arguments).exit_code, 0);
}

using Table = std::vector<std::vector<double>>;

/// Reads the numbers of a CSV file, and its first line into `columns`.
Table ReadCsv(const std::string& path, std::string& columns) {
  const std::string text = ReadFile(path);
  columns = text.substr(0, text.find('\n'));
  auto rows = StrictCsv(text);
  rows.erase(rows.begin());
  Table table;
  for (const auto& row : rows) {
    table.emplace_back();
    for (const std::string& cell : row) table.back().push_back(std::stod(cell));
  }
  return table;
}

constexpr const char* kColumns =
    "t,id,position_x,position_y,position_z,velocity_x,velocity_y,velocity_z,"
    "orientation_w,orientation_x,orientation_y,orientation_z,"
    "angular_velocity_x,angular_velocity_y,angular_velocity_z,"
    "acceleration_command_x,acceleration_command_y,acceleration_command_z,actuator_1,actuator_2,actuator_3,actuator_4,"
    "flags";

TEST(Export, NpzIsTheRunsOwnStatesToTheByte) {
  const ScratchFolder scratch;
  Fly(scratch, "run");
  const std::string target = scratch.File("again.npz");
  const Said said = Export({scratch.File("run"), "--format", "npz", "--out", target});
  EXPECT_EQ(said.exit_code, 0);
  EXPECT_EQ(said.err, "");
  EXPECT_EQ(said.out, target + ": 251 ticks, 2 agents\n");
  EXPECT_FALSE(ReadFile(target).empty());
  EXPECT_TRUE(ReadFile(target) == ReadFile(scratch.File("run/states.npz")));
}

TEST(Export, CsvHasALinePerTickAndAgentWithTheNumbersOfTheArrays) {
  const ScratchFolder scratch;
  Fly(scratch, "run");
  EXPECT_EQ(Export({scratch.File("run"), "--format", "csv"}).out,
            scratch.File("run/states.csv") + ": 251 ticks, 2 agents\n");
  std::string columns;
  const Table table = ReadCsv(scratch.File("run/states.csv"), columns);
  EXPECT_EQ(columns, kColumns);
  ASSERT_EQ(table.size(), 2 * kTicks);
  const std::string script = scratch.File("compare.py");
  WriteFile(script, R"(
import csv, sys
import numpy as np
arrays = dict(np.load(sys.argv[1]))
rows = list(csv.DictReader(open(sys.argv[2])))
ticks, agents = arrays["position"].shape[:2]
column = lambda name: np.array([float(row[name]) for row in rows]).reshape(ticks, agents)
print(np.array_equal(column("t"), np.repeat(arrays["t"], agents).reshape(ticks, agents)),
      np.array_equal(column("id"), np.tile(arrays["id"], (ticks, 1))))
for name, components in [("position", "xyz"), ("velocity", "xyz"), ("orientation", "wxyz"), ("angular_velocity", "xyz"),
                         ("acceleration_command", "xyz"), ("actuator", "1234")]:
    print(name, np.array_equal(np.stack([column(f"{name}_{c}") for c in components], axis=2), arrays[name]))
print("flags", np.array_equal(column("flags"), arrays["flags"]))
)");
  EXPECT_EQ(Shell("/usr/bin/python3 '" + script + "' '" + scratch.File("run/states.npz") + "' '" +
                  scratch.File("run/states.csv") + "'")
                .output,
            "True True\nposition True\nvelocity True\norientation True\nangular_velocity True\n"
            "acceleration_command True\nactuator True\nflags True\n");
}

TEST(Export, MatHasTheArraysInMatlabsOrderAndTheExperiment) {
  const ScratchFolder scratch;
  Fly(scratch, "run");
  EXPECT_EQ(Export({scratch.File("run/run.mcap"), "--format", "mat"}).err, "");
  Export({scratch.File("run"), "--format", "csv"});
  std::string columns;
  const Table table = ReadCsv(scratch.File("run/states.csv"), columns);
  const std::string path = scratch.File("run/states.mat");
  EXPECT_THAT(MatNames(path), ElementsAre("experiment", "config", "id", "t", "position", "velocity", "orientation",
                                          "angular_velocity", "acceleration_command", "actuator", "flags"));
  EXPECT_EQ(MatVariable(path, "experiment").text(), u"two");
  const std::string config = ReadFile(scratch.File("run/config.toml"));
  EXPECT_EQ(MatVariable(path, "config").text(), std::u16string(config.begin(), config.end()));
  EXPECT_THAT(MatVariable(path, "id").dimensions(), ElementsAre(1, 2));
  EXPECT_THAT(MatVariable(path, "id").values(), ElementsAre(1, 2));
  const MatVariable t(path, "t");
  EXPECT_THAT(t.dimensions(), ElementsAre(kTicks, 1));
  EXPECT_EQ(t.values().back(), 2.5);

  std::size_t first = 2;  // column of the CSV
  for (const auto& [name, width] : {std::pair{"position", 3},
                                    {"velocity", 3},
                                    {"orientation", 4},
                                    {"angular_velocity", 3},
                                    {"acceleration_command", 3},
                                    {"actuator", 4}}) {
    const MatVariable array(path, name);
    EXPECT_THAT(array.dimensions(), ElementsAre(kTicks, 2, width)) << name;
    const std::vector<double> values = array.values();
    for (std::size_t k = 0; k < kTicks; ++k)
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t c = 0; c < static_cast<std::size_t>(width); ++c)
          ASSERT_EQ(values[k + kTicks * (i + 2 * c)], table[2 * k + i][first + c]) << name << " at tick " << k;
    first += static_cast<std::size_t>(width);
  }
  EXPECT_THAT(MatVariable(path, "flags").dimensions(), ElementsAre(kTicks, 2)) << "one number per agent";
}

TEST(Export, ACutRecordingIsExportedUpToTheCutWhereverThatIs) {
  const ScratchFolder scratch;
  Fly(scratch, "run");
  Export({scratch.File("run"), "--format", "csv"});
  const std::string whole = ReadFile(scratch.File("run/states.csv"));
  const std::string recording = ReadFile(scratch.File("run/run.mcap"));
  const std::string cut = scratch.File("cut.mcap"), csv = scratch.File("states.csv");
  std::size_t exported = 0;
  for (std::size_t size = 0; size < recording.size(); size += recording.size() / 60) {
    WriteFile(cut, recording.substr(0, size));
    std::filesystem::remove(csv);
    const Said said = Export({cut, "--format", "csv"});
    if (said.exit_code != kExitIncomplete) {  // nothing is whole
      EXPECT_FALSE(std::filesystem::exists(csv));
      EXPECT_THAT(said.err,
                  testing::AnyOf(StartsWith("error: " + cut + ": holds no whole tick: the file ends "),
                                 StartsWith("error: " + cut +
                                            ": expected a run's recording, with its config.toml attached, got none: "
                                            "the file ends ")));
      continue;
    }
    EXPECT_THAT(said.err,
                AllOf(StartsWith("warning: " + cut + ": the file "), EndsWith("); exported what comes before\n")));
    ++exported;
    const std::string part = ReadFile(csv);
    EXPECT_TRUE(whole.starts_with(part)) << "cut at " << size;
    EXPECT_EQ(std::count(part.begin(), part.end(), '\n') % 2, 1) << "a line of names, two agents a tick";
  }
  EXPECT_GT(exported, 40);
}

/// Writes a run in real time in which agent 2 answers only every third tick, beginning with tick 1.
void WriteLateRun(const ScratchFolder& scratch, const std::string& name) {
  const std::string text =
      "[run]\nname = 'late'\nduration_s = 0.1\nmode = 'realtime'\n[agents]\ncount = 2\n[law]\nname = 'consensus'\n";
  Experiment experiment = LoadExperiment(Section::FromText(text, "late.toml"), "late");
  const RunFolder folder(scratch.File(name), experiment, false);
  RunWriter writer(experiment, folder, experiment.resolved);
  RowFeed feed(experiment, {&writer});
  Row row(2);
  for (row.tick = 0; row.tick <= 10; ++row.tick) {
    for (int id = 1; id <= 2; ++id) {
      mascot_msgs::msg::AgentState state;
      mascot_msgs::msg::AgentCommand command;
      Motion motion;
      motion.p_WB.x() = id;
      ToWire(row.tick, 100, id, 0, motion, state);
      Serialize(state, row.states[static_cast<std::size_t>(id - 1)]);
      Command wanted;
      wanted.actuator[0] = 100.0 * id + static_cast<double>(row.tick);
      wanted.flags = id == 2 ? kSafetyFiltered | kSafetyInfeasible : 0;
      ToWire(row.tick, 100, id, wanted, command);
      Row::Bytes& bytes = row.commands[static_cast<std::size_t>(id - 1)];
      if (id == 1 || row.tick % 3 == 1)
        Serialize(command, bytes);
      else
        bytes.clear();
    }
    feed.Add(row);
  }
  writer.Close(experiment.resolved);
}

TEST(Export, InRealTimeALateCommandIsHeldAsInTheRunsOwnStates) {
  const ScratchFolder scratch;
  WriteLateRun(scratch, "run");
  EXPECT_EQ(Export({scratch.File("run"), "--format", "npz", "--out", scratch.path().string()}).err, "");
  EXPECT_TRUE(ReadFile(scratch.File("states.npz")) == ReadFile(scratch.File("run/states.npz")));
  Export({scratch.File("run"), "--format", "csv"});
  std::string columns;
  const Table table = ReadCsv(scratch.File("run/states.csv"), columns);
  const std::size_t actuator = table[0].size() - 5, flags = table[0].size() - 1;
  EXPECT_EQ(table[1][actuator], 0) << "no command so far";
  EXPECT_EQ(table[2 * 1 + 1][actuator], 201);
  EXPECT_EQ(table[2 * 3 + 1][actuator], 201) << "held";
  EXPECT_EQ(table[2 * 4 + 1][actuator], 204);
  EXPECT_EQ(table[1][flags], 0) << "no command so far";
  EXPECT_EQ(table[2 * 4][flags], 0);
  EXPECT_EQ(table[2 * 4 + 1][flags], 48) << "16 + 32";
}

TEST(Export, WithoutStatesThereIsNothingToExport) {
  const ScratchFolder scratch;
  Fly(scratch, "run", {"--set", "record.topics=['/clock', '/agent_1/*']"});
  EXPECT_EQ(ErrorOf(kExitFailed, {scratch.File("run"), "--format", "csv"}),
            scratch.File("run/run.mcap") + ": holds no /agent_2/state: record.topics left it out");
  EXPECT_FALSE(std::filesystem::exists(scratch.File("run/states.csv")));
}

TEST(Export, WithoutCommandsTheirArraysAreLeftOutWithAWarning) {
  const ScratchFolder scratch;
  Fly(scratch, "run", {"--set", "record.topics=['*/state', '/agent_1/*']"});
  const Said said = Export({scratch.File("run"), "--format", "csv"});
  EXPECT_EQ(said.exit_code, 0);
  EXPECT_EQ(said.err,
            "warning: " + scratch.File("run/run.mcap") +
                ": record.topics left out commands; exported without acceleration_command, actuator, flags\n");
  std::string columns;
  EXPECT_EQ(ReadCsv(scratch.File("run/states.csv"), columns).size(), 2 * kTicks);
  EXPECT_THAT(columns, EndsWith(",angular_velocity_x,angular_velocity_y,angular_velocity_z"));
  Export({scratch.File("run"), "--format", "mat"});
  EXPECT_THAT(MatNames(scratch.File("run/states.mat")), testing::Not(testing::Contains("actuator")));
  Export({scratch.File("run"), "--format", "npz", "--force"});
  EXPECT_EQ(Shell("/usr/bin/python3 -c 'import numpy, sys; print(*numpy.load(sys.argv[1]).files)' '" +
                  scratch.File("run/states.npz") + "'")
                .output,
            "t id position velocity orientation angular_velocity\n");
}

/// Writes a recording of two agents at 100 Hz for 3 s, without the sample of `leave_out` at `tick`, or without the
/// whole tick. Without `close` the file has no summary.
void WriteRunWithout(const std::string& path, const Topic& leave_out, int tick, bool whole_tick, bool close) {
  McapWriter writer(path);
  writer.Attach("config.toml", "application/toml",
                "[run]\nname = \"gap\"\nduration_s = 3.0\n[agents]\ncount = 2\n[control]\nrate_hz = 100\n");
  std::map<Topic, std::uint16_t> channels;
  for (int id = 1; id <= 2; ++id)
    for (const Topic& topic : {Topic::Command(id), Topic::State(id)})
      channels[topic] = writer.AddChannel({topic.Name(), "mascot_msgs/msg/Any", "uint64 n\n", {}});
  mascot_msgs::msg::AgentState state;
  mascot_msgs::msg::AgentCommand command;
  Row::Bytes bytes;
  for (int k = 0; k <= 300; ++k) {
    for (const auto& [topic, channel] : channels) {
      if (k == tick && (whole_tick || topic == leave_out)) continue;
      ToWire(k, 100, topic.agent, 0, Motion(), state);
      ToWire(k, 100, topic.agent, Command(), command);
      if (topic.kind == TopicKind::kState)
        Serialize(state, bytes);
      else
        Serialize(command, bytes);
      writer.Write(channel, StampNs(k, 100), bytes);
    }
    writer.EndTick();
  }
  if (close) writer.Close();
}

TEST(Export, AMissingSampleIsAnErrorThatNamesIt) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  WriteRunWithout(path, Topic::State(2), 5, false, /*close=*/true);
  EXPECT_EQ(ErrorOf(kExitFailed, {path, "--format", "csv"}),
            path + ": /agent_1/command has 301 messages, /agent_2/state has 300");
  WriteRunWithout(path, Topic::State(2), 5, false, /*close=*/false);
  EXPECT_EQ(ErrorOf(kExitFailed, {path, "--format", "csv"}), path + ": tick 5 has no /agent_2/state");
  WriteRunWithout(path, Topic::Command(1), 7, false, /*close=*/false);
  EXPECT_EQ(ErrorOf(kExitFailed, {path, "--format", "npz"}), path + ": tick 7 has no /agent_1/command");
  WriteRunWithout(path, Topic::Clock(), 9, /*whole_tick=*/true, /*close=*/true);
  EXPECT_EQ(ErrorOf(kExitFailed, {path, "--format", "mat"}), path + ": tick 9 is missing");
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(scratch.path())) left.push_back(entry.path());
  EXPECT_THAT(left, ElementsAre(path)) << "nothing half-written";
}

TEST(Export, AGapInTheSequenceNumbersIsAnError) {
  using mcap::Op;
  using mcap::Record;
  const std::string config = "[run]\nname = \"gap\"\nduration_s = 3.0\n[agents]\ncount = 1\n[control]\nrate_hz = 100\n";
  Bytes file;
  Append(file, ByteSpan(mcap::kMagic));
  Record(file, Op::kHeader).String("ros2").String("hand").End();
  Record attachment(file, Op::kAttachment);
  attachment.U64(0).U64(0).String("config.toml").String("").U64(config.size()).Raw(AsBytes(config)).U32(0).End();
  Record(file, Op::kChannel).U16(1).U16(0).String("/agent_1/state").String("cdr").Map({}).End();
  for (const std::uint32_t sequence : {0u, 2u}) Record(file, Op::kMessage).U16(1).U32(sequence).U64(0).U64(0).End();
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  WriteFile(path, {file.begin(), file.end()});
  EXPECT_EQ(ErrorOf(kExitFailed, {path, "--format", "csv"}),
            path + ": /agent_1/state: gaps in its sequence numbers: 1");
}

TEST(Export, NamesTickAndTopicOfASampleThatIsNone) {
  const ScratchFolder scratch;
  Fly(scratch, "run");
  const McapContents contents = ReadMcap(scratch.File("run/run.mcap"));
  const std::string path = scratch.File("bad.mcap");
  McapWriter writer(path);
  writer.Attach("config.toml", "application/toml", contents.attachments.at("config.toml"));
  for (const auto& [id, channel] : contents.channels)
    writer.AddChannel({channel.topic, channel.schema_name, channel.schema_text, {}});
  ReadMcap(scratch.File("run/run.mcap"), [&](McapContents::Message message) {
    if (message.channel == 2 && message.sequence == 7) message.data[1] = 99;  // no encapsulation that CDR knows
    writer.Write(message.channel, message.log_time, message.data);
  });
  writer.Close();
  EXPECT_THAT(ErrorOf(kExitFailed, {path, "--format", "csv"}),
              testing::MatchesRegex(path + ": tick 7: /agent_1/state: a sample of [0-9]+ bytes is no "
                                           "mascot_msgs::msg::dds_::AgentState_"));
}

TEST(Export, AnExistingFileIsReplacedOnlyWithForce) {
  const ScratchFolder scratch;
  Fly(scratch, "run");
  const std::string states = scratch.File("run/states.npz"), before = ReadFile(states);
  EXPECT_EQ(ErrorOf(kExitUsage, {scratch.File("run"), "--format", "npz"}),
            states + ": expected a new file, got one that exists (--force replaces it)");
  WriteFile(states, "mine");
  EXPECT_EQ(ErrorOf(kExitUsage, {scratch.File("run"), "--format", "npz", "--out", states}),
            "--out " + states + ": expected a new file, got one that exists (--force replaces it)");
  EXPECT_EQ(ReadFile(states), "mine");
  EXPECT_EQ(Export({scratch.File("run"), "--format", "npz", "--force"}).exit_code, 0);
  EXPECT_TRUE(ReadFile(states) == before);
}

TEST(Export, TheRecordingItselfIsNeverReplaced) {
  const ScratchFolder scratch;
  Fly(scratch, "run");
  const std::string recording = scratch.File("run/run.mcap");
  EXPECT_EQ(ErrorOf(kExitUsage, {recording, "--format", "csv", "--force", "--out", recording}),
            "--out " + recording + ": expected another file than the recording");
}

TEST(Export, OutNamesAFileOrAFolderThatExists) {
  const ScratchFolder scratch;
  Fly(scratch, "run");
  std::filesystem::create_directory(scratch.File("results"));
  EXPECT_THAT(Export({scratch.File("run"), "--format", "csv", "--out", scratch.File("results")}).out,
              StartsWith(scratch.File("results/states.csv")));
  EXPECT_THAT(Export({scratch.File("run"), "--format", "csv", "--out", scratch.File("results/mine.txt")}).out,
              StartsWith(scratch.File("results/mine.txt")));
  for (const std::string wrong : {"none/states.csv", "none/"})
    EXPECT_EQ(ErrorOf(kExitUsage, {scratch.File("run"), "--format", "csv", "--out", scratch.File(wrong)}),
              "--out " + scratch.File(wrong) + ": expected a file in a folder that exists");
  std::filesystem::create_directory(scratch.File("run/states.csv"));
  EXPECT_EQ(ErrorOf(kExitUsage, {scratch.File("run"), "--format", "csv", "--force"}),
            scratch.File("run/states.csv") + ": expected a file, got a folder");
}

TEST(Export, AnythingButARecordingIsAUsageError) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  EXPECT_EQ(ErrorOf(kExitUsage, {path, "--format", "csv"}), "cannot open " + path + ": No such file or directory");
  EXPECT_EQ(ErrorOf(kExitUsage, {scratch.path().string(), "--format", "csv"}),
            scratch.path().string() + ": expected a run folder with one .mcap file, got 0");
  WriteFile(path, "no recording");
  EXPECT_EQ(ErrorOf(kExitUsage, {path, "--format", "csv"}),
            path + ": is no MCAP file: it does not begin with MCAP's magic bytes");
  { McapWriter(path).Close(); }
  EXPECT_EQ(ErrorOf(kExitUsage, {path, "--format", "csv"}),
            path + ": expected a run's recording, with its config.toml attached, got none");
  McapWriter somebodys(path);
  somebodys.Attach("config.toml", "application/toml",
                   "[run]\nname = \"x\"\nduration_s = 3.0\n[agents]\n[control]\nrate_hz = 100\n");
  somebodys.Close();
  EXPECT_THAT(ErrorOf(kExitUsage, {path, "--format", "csv"}),
              StartsWith(path + " (config.toml):4:1: agents.count: expected "));
}

TEST(Export, AnUnknownFormatIsAUsageError) {
  EXPECT_THAT(
      [] {
        Export({"run", "--format", "xls"});
      },
      ThrowsMessage<CLI::ParseError>("--format: expected one of npz, csv, mat, got xls"));
  EXPECT_THAT([] { Export({"run"}); }, ThrowsMessage<CLI::ParseError>("--format is required"));
}

}  // namespace
}  // namespace mascot
