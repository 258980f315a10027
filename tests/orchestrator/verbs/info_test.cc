#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/mcap/records.h"
#include "orchestrator/formats/mcap/writer.h"
#include "tests/support/call.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ContainsRegex;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

Said Info(const std::vector<std::string>& arguments) { return Call(SetUpInfo, arguments); }

/// An experiment of one agent at 10 Hz.
std::string Config(const std::string& duration_s, const std::string& mode = "lockstep") {
  return "[run]\nname = 'run'\nduration_s = " + duration_s + "\nmode = '" + mode +
         "'\n[agents]\ncount = 1\n[control]\nrate_hz = 10\n[record]\ntopics = ['/agent_*']\n";
}

/// Writes a recording of this experiment: 10 s, 101 states and the first `commands` commands.
void WriteRun(const std::string& path, int commands, const std::string& config = Config("10.0"),
              bool ended_early = false) {
  McapWriter writer(path);
  writer.Attach("config.toml", "application/toml", config);
  writer.Metadata("mascot", {{"seed", "7"}});
  if (ended_early) writer.Metadata("mascot_ended_early", {{"ticks", "101"}});
  const auto command = writer.AddChannel({"/agent_1/command", "mascot_msgs/msg/AgentCommand", "uint64 n\n", {}});
  const auto state = writer.AddChannel({"/agent_1/state", "mascot_msgs/msg/AgentState", "uint64 n\n", {}});
  for (std::uint64_t k = 0; k <= 100; ++k) {
    if (static_cast<int>(k) < commands) writer.Write(command, k * 100'000'000, Bytes(20));
    writer.Write(state, k * 100'000'000, Bytes(200));
    writer.EndTick();
  }
  writer.Close();
}

TEST(Info, DescribesARunAndProvesItComplete) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("run.mcap");
  WriteRun(path, 101);
  const Said said = Info({scratch.path().string()});
  EXPECT_EQ(said.exit_code, 0);
  EXPECT_EQ(said.err, "");
  const std::string size = std::to_string(ReadFile(path).size());
  EXPECT_THAT(said.out, StartsWith("file:         " + path + "\nsize:         " + size +
                                   " bytes\n"
                                   "profile:      ros2 (written by " +
                                   McapWriter::Library() +
                                   ")\nduration:     10.000 s\n"
                                   "messages:     202\nchunks:       10\ncompression:  "));
  EXPECT_THAT(said.out, HasSubstr("  topic             type                               count          Hz\n"
                                  "  /agent_1/command  mascot_msgs/msg/AgentCommand         101       10.00\n"
                                  "  /agent_1/state    mascot_msgs/msg/AgentState           101       10.00\n"));
  EXPECT_THAT(said.out, HasSubstr("attachment:   config.toml, " + std::to_string(Config("10.0").size()) + " bytes\n"));
  EXPECT_THAT(said.out, HasSubstr("metadata:     mascot\n              seed = 7\n"));
  EXPECT_THAT(said.out, EndsWith("ticks:        101, recorded without a gap\ncomplete: yes\n"));
}

TEST(Info, JsonIsOneObjectWithTheSameFacts) {
  const ScratchFolder scratch;
  WriteRun(scratch.File("run.mcap"), 101);
  const Said said = Info({"--json", scratch.File("run.mcap")});
  EXPECT_EQ(said.exit_code, 0);
  const nlohmann::json report = nlohmann::json::parse(said.out);
  EXPECT_EQ(report.at("file"), scratch.File("run.mcap"));
  EXPECT_EQ(report.at("messages"), 202);
  EXPECT_EQ(report.at("duration_s"), 10.0);
  EXPECT_EQ(report.at("ticks"), 101);
  EXPECT_EQ(report.at("complete"), true);
  EXPECT_EQ(report.at("reason"), "");
  EXPECT_GT(report.at("compression_ratio"), 2.0);
  EXPECT_EQ(report.at("topics")[1], nlohmann::json::parse(R"({"topic": "/agent_1/state", "count": 101, "hz": 10.0,
    "type": "mascot_msgs/msg/AgentState", "bytes": 20200, "gaps": 0, "first_ns": 0, "last_ns": 10000000000})"));
  EXPECT_EQ(report.at("attachments"), nlohmann::json({{{"name", "config.toml"}, {"bytes", Config("10.0").size()}}}));
  EXPECT_EQ(report.at("metadata"), nlohmann::json::parse(R"({"mascot": {"seed": "7"}})"));
}

TEST(Info, ATickThatWasNotAnsweredMakesARunIncomplete) {
  const ScratchFolder scratch;
  WriteRun(scratch.File("run.mcap"), 100);
  const Said said = Info({scratch.File("run.mcap")});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_THAT(said.out, EndsWith("complete: no (/agent_1/state has 101 messages, /agent_1/command has 100)\n"));
}

TEST(Info, InRealTimeAMissingCommandIsNoGap) {
  const ScratchFolder scratch;
  WriteRun(scratch.File("run.mcap"), 100, Config("10.0", "realtime"));
  const Said said = Info({scratch.File("run.mcap")});
  EXPECT_EQ(said.exit_code, 0);
  EXPECT_THAT(said.out, EndsWith("ticks:        101, recorded without a gap\ncomplete: yes\n"));
}

TEST(Info, ANewerFormatIsDescribedButNotProved) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("run.mcap"));
  writer.Metadata("mascot", {{"format", "2"}});
  writer.Close();
  const Said said = Info({scratch.File("run.mcap")});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_THAT(said.out, HasSubstr("metadata:     mascot\n              format = 2\n"));
  EXPECT_THAT(said.out,
              EndsWith("complete: no (it is of format 2, newer than the 1 that this version of MASCOT reads)\n"));
}

TEST(Info, SaysThatARunEndedEarly) {
  const ScratchFolder scratch;
  WriteRun(scratch.File("run.mcap"), 101, Config("30.0"), /*ended_early=*/true);
  EXPECT_THAT(Info({scratch.File("run.mcap")}).out,
              EndsWith("ticks:        101 of 301: the run ended early, recorded without a gap\ncomplete: yes\n"));
  EXPECT_EQ(nlohmann::json::parse(Info({"--json", scratch.File("run.mcap")}).out).at("planned_ticks"), 301);
}

TEST(Info, ARecordingThatStopsWithoutSayingSoIsNotComplete) {
  const ScratchFolder scratch;
  WriteRun(scratch.File("run.mcap"), 101, Config("30.0"));
  const Said said = Info({scratch.File("run.mcap")});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_THAT(said.out, EndsWith("complete: no (it holds 101 ticks, expected 301: the run does not say that it ended "
                                 "early)\n"));
}

TEST(Info, AFileWithoutAnExperimentIsNotProved) {
  const ScratchFolder scratch;
  WriteRun(scratch.File("run.mcap"), 101, "[run]\n");
  const Said said = Info({scratch.File("run.mcap")});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_THAT(said.out, EndsWith("complete: no (no experiment is attached, which would say what there must be)\n"));
  EXPECT_EQ(nlohmann::json::parse(Info({"--json", scratch.File("run.mcap")}).out).at("planned_ticks"), nullptr);
}

/// Writes a closed file without CRCs, with a channel whose sequence numbers are 0, 2.
void WriteGap(const std::string& path) {
  using mcap::Op;
  using mcap::Record;
  Bytes file;
  Append(file, ByteSpan(mcap::kMagic));
  Record(file, Op::kHeader).String("ros2").String("hand").End();
  Record(file, Op::kChannel).U16(1).U16(0).String("/n").String("cdr").Map({}).End();
  for (const std::uint32_t sequence : {0u, 2u}) Record(file, Op::kMessage).U16(1).U32(sequence).U64(0).U64(0).End();
  Record(file, Op::kDataEnd).U32(0).End();
  const std::uint64_t summary = file.size();
  Record statistics(file, Op::kStatistics);
  statistics.U64(2).U16(0).U32(1).U32(0).U32(0).U32(0).U64(0).U64(0).U32(10).U16(1).U64(2).End();
  Record(file, Op::kFooter).U64(summary).U64(0).U32(0).End();
  Append(file, ByteSpan(mcap::kMagic));
  WriteFile(path, {file.begin(), file.end()});
}

TEST(Info, AGapMakesARecordingIncomplete) {
  const ScratchFolder scratch;
  WriteGap(scratch.File("run.mcap"));
  const Said said = Info({scratch.File("run.mcap")});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_THAT(said.out, EndsWith("\ncomplete: no (/n: gaps in its sequence numbers: 1)\n"));
}

TEST(Info, AFileThatWasCutIsDescribedUpToTheCut) {
  const ScratchFolder scratch;
  WriteRun(scratch.File("run.mcap"), 101);
  std::filesystem::resize_file(scratch.File("run.mcap"), std::filesystem::file_size(scratch.File("run.mcap")) / 2);
  const Said said = Info({scratch.File("run.mcap")});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_THAT(said.out,
              ContainsRegex(
                  "\ncomplete: no \\(the file ends .*record at byte [0-9]+\\); whole up to tick [0-9]+ of 100\\)\n$"));
  const nlohmann::json report = nlohmann::json::parse(Info({scratch.File("run.mcap"), "--json"}).out);
  EXPECT_EQ(report.at("complete"), false);
  EXPECT_EQ(report.at("ticks"), nullptr);
  EXPECT_GT(report.at("messages"), 0);
}

TEST(Info, AnEmptyFileIsACutOne) {
  const ScratchFolder scratch;
  WriteFile(scratch.File("run.mcap"), "");
  const Said said = Info({scratch.File("run.mcap")});
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_THAT(said.out, EndsWith("complete: no (the file ends inside its first magic bytes (record at byte 0))\n"));
}

TEST(Info, ARecordingByAnotherNameIsFoundInItsRunFolder) {
  const ScratchFolder scratch;
  WriteRun(scratch.File("flight.mcap"), 101);
  EXPECT_EQ(Info({scratch.path().string()}).exit_code, 0);
  WriteRun(scratch.File("second.mcap"), 101);
  const Said said = Info({scratch.path().string()});
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_EQ(said.err, "error: " + scratch.path().string() + ": expected a run folder with one .mcap file, got 2\n");
}

TEST(Info, TakesTheNewestRunOfAFolder) {
  namespace fs = std::filesystem;
  const ScratchFolder scratch;
  const auto now = fs::file_time_type::clock::now();
  for (const auto& [name, age_s] : {std::pair("b/2026-01-02", 30), {"a/2026-01-01", 10}, {"a/2026-01-03", 20}}) {
    const fs::path run = scratch.path() / "runs" / name;
    fs::create_directories(run / "logs");
    WriteRun((run / "run.mcap").string(), 101);
    WriteFile((run / "config.toml").string(), Config("10.0"));
    fs::last_write_time(run / "config.toml", now - std::chrono::seconds(age_s));
  }
  const std::string runs = scratch.File("runs");
  EXPECT_THAT(Info({runs}).out, HasSubstr(runs + "/a/2026-01-01/run.mcap\n"));
  EXPECT_THAT(Info({runs + "/b"}).out, HasSubstr(runs + "/b/2026-01-02/run.mcap\n"));
  EXPECT_THAT(Info({runs + "/a/2026-01-03"}).out, HasSubstr(runs + "/a/2026-01-03/run.mcap\n"));
  const fs::path before = fs::current_path();
  fs::current_path(scratch.path());
  EXPECT_THAT(Info({"latest"}).out, HasSubstr("runs/a/2026-01-01/run.mcap\n"));
  fs::current_path(runs);
  EXPECT_EQ(Info({"latest"}).err, "error: latest: expected the newest run in the folder runs, which is not here\n");
  fs::current_path(before);
}

TEST(Info, AFileThatCannotBeOpenedIsAnErrorAndPrintsNothingElse) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("none.mcap");
  const Said said = Info({path, "--json"});
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_EQ(said.out, "");
  EXPECT_EQ(said.err, "error: cannot open " + path + ": No such file or directory\n");
  WriteFile(path, "no recording");
  EXPECT_EQ(Info({path}).err, "error: " + path + ": is no MCAP file: it does not begin with MCAP's magic bytes\n");
}

}  // namespace
}  // namespace mascot
