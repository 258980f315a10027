// `orchestrator recover`: what it keeps of a recording that was cut or damaged, and what it says of the rest.
#include <gmock/gmock.h>

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/records.h"
#include "tests/orchestrator/formats/mcap_files.h"
#include "tests/support/call.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::EndsWith;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

Said Recover(const std::vector<std::string>& arguments) { return Call(SetUpRecover, arguments); }

/// Flies two agents for 2.5 s at 100 Hz: 251 ticks of 5 samples, in three chunks. Returns the recording.
constexpr std::size_t kSamples = 1255;
std::string Fly(const ScratchFolder& scratch) {
  const std::string config = scratch.File("two.toml");
  WriteFile(config,
            "[run]\nduration_s = 2.5\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\nname = 'consensus'\n");
  const Said said = Call(SetUpUp, {config, "--engine", "inprocess", "--out", scratch.File("run"), "--quiet", "--set",
                                   "output.save_plot=false"});
  EXPECT_EQ(said.exit_code, 0) << said.err;
  return ReadFile(scratch.File("run/run.mcap"));
}

using Samples = std::vector<std::tuple<std::string, std::uint32_t, std::uint64_t, std::vector<std::uint8_t>>>;

/// Topic, sequence number, time and bytes of every message.
Samples SamplesOf(const std::string& path) {
  Samples samples;
  for (McapReader reader(path); const McapContents::Message* message = reader.Next();)
    samples.emplace_back(reader.contents().channels.at(message->channel).topic, message->sequence, message->log_time,
                         message->data);
  return samples;
}

Ran McapCheck(const std::string& path) {
  return Shell("node '" + test::SourceFolder() + "/tests/mcapcheck/mcapcheck.mjs' '" + path +
               "' --all --strict --quiet");
}

TEST(Recover, KeepsEveryWholeMessageWhereverTheFileWasCut) {
  const ScratchFolder scratch;
  const std::string whole = Fly(scratch);
  const std::string cut = scratch.File("cut.mcap"), out = scratch.File("out.mcap");
  int recovered = 0;
  for (std::size_t size = 0; size < whole.size(); size += whole.size() / 60) {
    WriteFile(cut, whole.substr(0, size));
    std::filesystem::remove(out);
    const Said said = Recover({cut, "--out", out});
    if (SamplesOf(cut).empty()) {
      EXPECT_THAT(said.exit_code, testing::AnyOf(kExitFailed, kExitUsage));
      EXPECT_FALSE(std::filesystem::exists(out));
      continue;
    }
    const Samples kept = SamplesOf(out);
    EXPECT_EQ(said.exit_code, kept.size() == kSamples ? kExitDone : kExitIncomplete) << said.err;
    EXPECT_TRUE(ReadMcap(out).complete);
    EXPECT_EQ(kept, SamplesOf(cut)) << "cut at " << size;
    ++recovered;
  }
  EXPECT_GT(recovered, 30);
}

TEST(Recover, TheIndependentReaderAcceptsWhatItMade) {
  const ScratchFolder scratch;
  const std::string whole = Fly(scratch);
  const std::string cut = scratch.File("cut.mcap"), out = scratch.File("cut.recovered.mcap");
  WriteFile(cut, whole.substr(0, whole.size() / 2));
  const Said said = Recover({cut});
  EXPECT_EQ(said.exit_code, kExitIncomplete) << said.err;
  const Ran checked = McapCheck(out);
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
}

TEST(Recover, SaysWhatWasKeptAndWhatIsLost) {
  const ScratchFolder scratch;
  const std::string whole = Fly(scratch);
  const std::string cut = scratch.File("run/cut.mcap"), out = scratch.File("run/cut.recovered.mcap");
  WriteFile(cut, whole.substr(0, whole.size() / 2));
  EXPECT_THAT(Recover({cut}).out,
              MatchesRegex(out + ": kept [0-9]+ messages, whole up to tick [0-9]+ of 250\n"
                                 "damage: the file ends inside a record \\(record at byte [0-9]+\\)\n"
                                 "lost: all messages behind the damage\n"));
}

TEST(Recover, InfoSaysThatARecoveredRunIsNotComplete) {
  const ScratchFolder scratch;
  const std::string whole = Fly(scratch);
  WriteFile(scratch.File("run.mcap"), whole.substr(0, whole.size() / 2));
  EXPECT_EQ(Recover({scratch.File("run.mcap"), "--out", scratch.File("out.mcap")}).exit_code, kExitIncomplete);
  const Said info = Call(SetUpInfo, {scratch.File("out.mcap")});
  EXPECT_EQ(info.exit_code, 1);
  EXPECT_THAT(info.out,
              ContainsRegex("\ncomplete: no \\(recovered from a file that was damaged: the file ends inside a "
                            "record \\(record at byte [0-9]+\\); whole up to tick [0-9]+ of 250\\)\n$"));
}

TEST(Recover, ExportTakesARecoveredRunAsItTakesTheCutOne) {
  const ScratchFolder scratch;
  const std::string whole = Fly(scratch);
  WriteFile(scratch.File("cut.mcap"), whole.substr(0, whole.size() / 2));
  Recover({scratch.File("cut.mcap"), "--out", scratch.File("out.mcap")});
  const auto exported = [&](const std::string& recording) {
    const Said said =
        Call(SetUpExport, {scratch.File(recording), "--format", "csv", "--out", scratch.File("x.csv"), "--force"});
    EXPECT_EQ(said.exit_code, kExitIncomplete);
    EXPECT_THAT(said.err, EndsWith("; exported what comes before\n"));
    return ReadFile(scratch.File("x.csv"));
  };
  EXPECT_EQ(exported("out.mcap"), exported("cut.mcap"));
}

TEST(Recover, ACutRecoveredRunStillTellsItsFirstDamage) {
  const ScratchFolder scratch;
  const std::string whole = Fly(scratch);
  WriteFile(scratch.File("a.mcap"), whole.substr(0, whole.size() / 2));
  Recover({scratch.File("a.mcap"), "--out", scratch.File("b.mcap")});
  const std::string once = ReadFile(scratch.File("b.mcap"));
  WriteFile(scratch.File("c.mcap"), once.substr(0, once.size() - 20));  // the summary only: the last tick is still lost
  EXPECT_EQ(Recover({scratch.File("c.mcap"), "--out", scratch.File("d.mcap")}).exit_code, kExitDone);
  EXPECT_TRUE(ReadFile(scratch.File("d.mcap")) == once);
}

TEST(Recover, ARunWhoseSummaryAloneIsDamagedIsMadeAgainByteForByte) {
  const ScratchFolder scratch;
  const std::string whole = Fly(scratch);
  WriteFile(scratch.File("cut.mcap"), whole.substr(0, whole.size() - 1));
  std::string changed = whole;
  changed[whole.size() - 20] ^= 1;
  WriteFile(scratch.File("changed.mcap"), changed);
  for (const char* const damaged : {"cut.mcap", "changed.mcap"}) {
    const Said said = Recover({scratch.File(damaged), "--out", scratch.File("out.mcap"), "--force"});
    EXPECT_EQ(said.exit_code, kExitDone);
    EXPECT_THAT(said.out,
                AllOf(HasSubstr(": kept 1255 messages, whole up to tick 250 of 250\n"), EndsWith("\nlost: nothing\n")));
    EXPECT_TRUE(ReadFile(scratch.File("out.mcap")) == whole) << damaged;
  }
  EXPECT_EQ(Call(SetUpInfo, {scratch.File("out.mcap")}).exit_code, 0);
}

TEST(Recover, ARunThatEndedEarlyIsAsWholeAsItWas) {
  const ScratchFolder scratch;
  WriteFile(scratch.File("fails.toml"),
            "[run]\nduration_s = 1.0\n[agents]\ncount = 1\nmodel = 'double_integrator'\n[law]\nname = 'custom'\n"
            "python = '''\ndef control(t, me, neighbours):\n    return [1 / (t - 0.5), 0, 0]\n'''\n");
  EXPECT_EQ(Call(SetUpUp, {scratch.File("fails.toml"), "--engine", "inprocess", "--out", scratch.File("run"), "--quiet",
                           "--set", "output.save_plot=false"})
                .exit_code,
            kExitFailed);
  const std::string whole = ReadFile(scratch.File("run/run.mcap"));
  const std::string data_end = std::string(1, '\x0f') + std::string("\x04\0\0\0\0\0\0\0", 8);
  for (const std::size_t size : {whole.size() - 1, whole.rfind(data_end)}) {  // all in front of the summary is there
    WriteFile(scratch.File("cut.mcap"), whole.substr(0, size));
    const Said said = Recover({scratch.File("cut.mcap"), "--out", scratch.File("out.mcap"), "--force"});
    EXPECT_EQ(said.exit_code, kExitDone);
    EXPECT_THAT(said.out, HasSubstr(", whole up to tick 49 of 100\n"));
    EXPECT_TRUE(ReadFile(scratch.File("out.mcap")) == whole);
  }
}

TEST(Recover, AChangedByteEndsWhatIsKept) {
  const ScratchFolder scratch;
  std::string changed = Fly(scratch);
  changed[changed.size() / 2] ^= 1;
  WriteFile(scratch.File("changed.mcap"), changed);
  const Said said = Recover({scratch.File("changed.mcap")});
  EXPECT_EQ(said.exit_code, kExitIncomplete);
  EXPECT_THAT(
      said.out,
      ContainsRegex("whole up to tick [0-9]+ of 250\ndamage: (the CRC of a chunk is wrong|zstd: [^(]*) \\(record at "
                    "byte [0-9]+\\)\nlost: all messages behind the damage\n"));
}

TEST(Recover, AWholeRunIsLeftAlone) {
  const ScratchFolder scratch;
  Fly(scratch);
  const Said said = Recover({scratch.File("run")});
  EXPECT_EQ(said.exit_code, kExitDone);
  EXPECT_EQ(said.out, scratch.File("run/run.mcap") + ": is whole; nothing is to be recovered\n");
  EXPECT_FALSE(std::filesystem::exists(scratch.File("run/run.recovered.mcap")));
}

TEST(Recover, RefusesToReplaceAFile) {
  const ScratchFolder scratch;
  const std::string whole = Fly(scratch);
  WriteFile(scratch.File("cut.mcap"), whole.substr(0, whole.size() / 2));
  WriteFile(scratch.File("cut.recovered.mcap"), "mine");
  const Said said = Recover({scratch.File("cut.mcap")});
  EXPECT_EQ(said.exit_code, kExitUsage);
  EXPECT_EQ(said.err, "error: " + scratch.File("cut.recovered.mcap") +
                          ": expected a new file, got one that exists (--force replaces it)\n");
  EXPECT_EQ(ReadFile(scratch.File("cut.recovered.mcap")), "mine");
  EXPECT_EQ(Recover({scratch.File("cut.mcap"), "--out", scratch.File("cut.mcap"), "--force"}).exit_code, kExitUsage);
}

TEST(Recover, NamesWhatIsNoRecording) {
  const ScratchFolder scratch;
  const std::string path = scratch.File("x.mcap");
  EXPECT_EQ(Recover({path}).err, "error: cannot open " + path + ": No such file or directory\n");
  WriteFile(path, "");
  Said said = Recover({path});
  EXPECT_EQ(said.exit_code, kExitUsage);
  EXPECT_EQ(said.err, "error: " + path +
                          ": expected a run's recording, with its config.toml attached, got none: the file ends inside "
                          "its first magic bytes (record at byte 0)\n");
}

/// A recording without an end: the experiment of a run, then `records`.
std::string Unclosed(const std::string& config, const Bytes& records) {
  Bytes attachment;
  mcap::Record record(attachment, mcap::Op::kAttachment);
  record.U64(0).U64(0).String("config.toml").String("application/toml").U64(config.size()).Raw(AsBytes(config));
  record.U32(0).End();
  Append(attachment, ByteSpan(records));
  return Handmade(attachment);
}

TEST(Recover, SaysThatNoMessageIsWhole) {
  const ScratchFolder scratch;
  Fly(scratch);
  WriteFile(scratch.File("x.mcap"), Unclosed(ReadFile(scratch.File("run/config.toml")), {}));
  const Said said = Recover({scratch.File("x.mcap")});
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_THAT(said.err, StartsWith("error: " + scratch.File("x.mcap") +
                                   ": holds no whole message: the file ends without a summary: it was not closed "));
}

TEST(Recover, RefusesARecordingWithGaps) {
  const ScratchFolder scratch;
  Fly(scratch);
  Bytes records;
  mcap::Record(records, mcap::Op::kChannel).U16(1).U16(0).String("/clock").String("cdr").Map({}).End();
  for (const std::uint32_t sequence : {0u, 2u})
    mcap::Record(records, mcap::Op::kMessage).U16(1).U32(sequence).U64(0).U64(0).End();
  WriteFile(scratch.File("x.mcap"), Unclosed(ReadFile(scratch.File("run/config.toml")), records));
  const Said said = Recover({scratch.File("x.mcap")});
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_EQ(said.err, "error: " + scratch.File("x.mcap") + ": /clock: gaps in its sequence numbers: 1\n");
}

TEST(Recover, RefusesAChannelThatNoRunWrites) {
  const ScratchFolder scratch;
  Fly(scratch);
  Bytes records;
  mcap::Record(records, mcap::Op::kChannel).U16(1).U16(0).String("/n").String("json").Map({}).End();
  mcap::Record(records, mcap::Op::kMessage).U16(1).U32(0).U64(0).U64(0).End();
  WriteFile(scratch.File("x.mcap"), Unclosed(ReadFile(scratch.File("run/config.toml")), records));
  const Said said = Recover({scratch.File("x.mcap")});
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_EQ(said.err,
            "error: " + scratch.File("x.mcap") + ": /n: expected cdr with a schema in ros2msg, got 'json' with ''\n");
  EXPECT_FALSE(std::filesystem::exists(scratch.File("x.recovered.mcap")));
}

}  // namespace
}  // namespace mascot
