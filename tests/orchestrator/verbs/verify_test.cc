// `orchestrator verify`: the same bits, another bit, another experiment, a cut file, and what cannot repeat.
#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <bit>
#include <filesystem>
#include <map>

#include "bus/wire.h"
#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/recording/compare.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/recording/sample_fields.h"
#include "tests/support/call.h"
#include "tests/support/edited_recording.h"
#include "tests/support/folders.h"
#include "tests/support/recorded_with_actions.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ContainsRegex;
using testing::EndsWith;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

constexpr const char* kTwo =
    "[run]\nduration_s = 2.5\n[agents]\ncount = 2\nmodel = 'double_integrator'\n"
    "[law]\nname = 'consensus'\np_gain = 0.2\n";

class Verify : public testing::Test {
 protected:
  /// Flies an experiment of two agents, of 251 ticks of 5 samples unless told otherwise. Returns the recording's path.
  std::string Fly(const std::string& toml = kTwo, std::vector<std::string> more = {}) {
    WriteFile(File("two.toml"), toml);
    std::vector<std::string> arguments = {File("two.toml"), "--engine", "inprocess", "--out",
                                          File("run"),      "--quiet",  "--set",     "output.save_plot=false"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    flown_ = Call(SetUpUp, arguments);
    return File("run/run.mcap");
  }
  static Said Check(const std::string& run) { return Call(SetUpVerify, {run}); }
  std::string File(const std::string& name) const { return scratch_.File(name); }

  ScratchFolder scratch_;
  Said flown_;
};

/// Changes the first `from` in `text` to `to`.
void Change(std::string& text, const std::string& from, const std::string& to) {
  ASSERT_NE(text.find(from), std::string::npos) << text;
  text.replace(text.find(from), from.size(), to);
}

bool Keep(const std::string& /*topic*/, const McapContents::Message& /*message*/) { return true; }

/// Copies a recording with another experiment.
void CopyWithConfig(const std::string& recording, const std::string& copy, const std::string& from,
                    const std::string& to) {
  McapContents contents = ReadMcap(recording);
  Change(contents.attachments.at("config.toml"), from, to);
  CopyRecording(recording, contents, copy, Keep);
}

TEST_F(Verify, FliesAgainWhatAProgramToldTheAgentsToDo) {
  const std::string toml =
      "[run]\nduration_s = 0.5\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\nname = 'actions'\n";
  const std::string recording = RecordedWithActions(toml, File("told"));
  EXPECT_THAT(Check(recording).out, HasSubstr("the same, bit for bit: 51 ticks, 357 messages\n"));
  WriteFile(File("told.toml"), toml);
  const Said up = Call(SetUpUp, {File("told.toml"), "--out", File("up")});
  EXPECT_EQ(up.exit_code, 2);
  EXPECT_THAT(up.err, HasSubstr("law.name: expected laws that decide by themselves, got one of agent 1"));
  EXPECT_FALSE(std::filesystem::exists(File("up")));
}

TEST_F(Verify, ARunRepeatsBitForBit) {
  const std::string recording = Fly();
  const Said said = Check(File("run"));
  EXPECT_EQ(said.exit_code, kExitDone);
  EXPECT_EQ(said.out, recording + ": the same, bit for bit: 251 ticks, 1255 messages\n");
  EXPECT_EQ(said.err, "");
  EXPECT_EQ(Check(recording).out, said.out) << "the recording alone";
}

TEST_F(Verify, ARunOfALawThatSendsMessagesRepeatsToo) {
  const std::string three =
      "[run]\nduration_s = 0.5\n[agents]\ncount = 3\nmodel = 'double_integrator'\nposition_m = [[0, 0, 1], [-5, 0, 1], "
      "[-10, 0, 1]]\n[graph]\ntopology = 'path'\n[law]\nname = ";
  for (const std::string law : {"'platoon'", "'event_triggered'", "'gradient_tracking'"}) {
    const std::string recording = Fly(three + law + "\n");
    ASSERT_EQ(flown_.exit_code, kExitDone) << flown_.err;
    const Said said = Check(recording);
    EXPECT_EQ(said.out, recording + ": the same, bit for bit: 51 ticks, 510 messages\n") << law << said.err;
    std::filesystem::remove_all(File("run"));
  }
}

TEST_F(Verify, WritesNothing) {
  Fly();
  const auto files = [&] {
    return Shell("cd '" + scratch_.path().string() + "' && find . -type f -exec cksum {} + | sort").output;
  };
  const std::string before = files();
  Check(File("run"));
  EXPECT_EQ(files(), before);
}

TEST_F(Verify, NamesTopicTickFieldAndBothValuesOfTheFirstDifference) {
  const std::string recording = Fly(), changed = File("changed.mcap");
  std::string before, after;
  CopyRecording(recording, changed, [&](const std::string& topic, McapContents::Message& message) {
    if (message.sequence < 57 || topic != "/agent_2/state") return true;
    const Bytes old = message.data;
    message.data[4 + 24] ^= 1;  // the last bit of pose.position.x
    if (message.sequence == 57) {
      const auto difference = FirstDifference(TopicKind::kState, old, message.data);
      before = difference->first;
      after = difference->second;
    }
    return true;
  });
  const Said said = Check(changed);
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_EQ(said.out, changed + ": differs: /agent_2/state at tick 57 (t = 0.57 s): pose.position.x is " + after +
                          " in the recording, " + before + " flown\n");
  EXPECT_NE(before, after);
}

TEST_F(Verify, NamesAMissingSample) {
  const std::string recording = Fly(), changed = File("changed.mcap");
  CopyRecording(recording, changed, [](const std::string& topic, McapContents::Message& message) {
    return topic != "/agent_1/command" || message.sequence != 7;
  });
  EXPECT_EQ(Check(changed).exit_code, kExitFailed);
  EXPECT_EQ(Check(changed).out, changed +
                                    ": differs: /agent_1/command at tick 7 (t = 0.07 s) is missing: the recording has "
                                    "/agent_1/state of t = 0.07 s there\n");
}

TEST_F(Verify, NamesAMissingTopic) {
  const std::string recording = Fly(), changed = File("changed.mcap");
  CopyRecording(recording, changed, [](const std::string& topic, McapContents::Message&) { return topic != "/clock"; });
  EXPECT_THAT(Check(changed).out, EndsWith(": differs: /clock at tick 0 (t = 0 s) is missing: the recording has "
                                           "/agent_1/command of t = 0.01 s there\n"));
}

TEST_F(Verify, ARecordingThatEndsInsideATickDiffers) {
  const std::string recording = Fly(), changed = File("changed.mcap");
  CopyRecording(recording, changed, [](const std::string& topic, McapContents::Message& message) {
    return topic != "/clock" || message.sequence != 250;
  });
  const Said said = Check(changed);
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_THAT(said.out, EndsWith(": differs: /clock at tick 250 (t = 2.5 s) is missing: the recording ends there\n"));
}

TEST_F(Verify, ARecordingThatGoesOnAfterTheLastTickDiffers) {
  CopyWithConfig(Fly(), File("changed.mcap"), "duration_s = 2.5", "duration_s = 2.0");
  const Said said = Check(File("changed.mcap"));
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_THAT(said.out,
              EndsWith(": differs: the recording goes on after tick 200, the last, with /agent_1/command of t "
                       "= 2.01 s\n"));
}

TEST_F(Verify, ACutRecordingIsComparedUpToTheCutWhereverThatIs) {
  const std::string whole = ReadFile(Fly()), cut = File("cut.mcap");
  int compared = 0;
  for (std::size_t size = whole.size() / 8; size < whole.size(); size += whole.size() / 8) {
    WriteFile(cut, whole.substr(0, size));
    const Said said = Check(cut);
    if (said.exit_code == kExitUsage) {
      EXPECT_THAT(said.err, ContainsRegex("expected a (run's recording|recording with messages), .*got none: the file "
                                          "ends .*record at byte [0-9]+\\)\n"));
      continue;
    }
    EXPECT_EQ(said.exit_code, kExitIncomplete) << size;
    EXPECT_THAT(said.out, MatchesRegex(cut + ": the same, bit for bit: [0-9]+( of 251)? ticks, [0-9]+ messages\n" +
                                       cut + ": cut: the file ends .*record at byte [0-9]+\\)\n"));
    ++compared;
  }
  EXPECT_GT(compared, 3);
}

TEST_F(Verify, ARecordingOfALawThatChangesIsComparedWholeOrCutInAnyPhase) {
  const std::string phases =
      "[[law.schedule]]\nat_s = 0.5\np_gain = 0.5\n[[law.schedule]]\nat_s = 1.8\nname = 'waypoint'\naxes = 'xy'\n"
      "waypoints_m = [[1, 2, 3]]\n[[events]]\nat_s = 0.6\nset = { 'law.p_gain' = 0.4 }\n";
  const std::string path = Fly(kTwo + phases), cut = File("cut.mcap");
  EXPECT_EQ(Check(path).exit_code, 0);
  const std::string whole = ReadFile(path);
  for (const std::size_t eighths : {3U, 5U, 7U}) {
    WriteFile(cut, whole.substr(0, whole.size() / 8 * eighths));
    const Said said = Check(cut);
    EXPECT_EQ(said.exit_code, kExitIncomplete) << eighths << ": " << said.err;
    EXPECT_THAT(said.out, HasSubstr(": the same, bit for bit: ")) << eighths;
  }
}

TEST_F(Verify, AChangedBitInTheFileIsDamageAndNoCut) {
  std::string changed = ReadFile(Fly());
  changed[changed.size() / 2] ^= 1;
  WriteFile(File("changed.mcap"), changed);
  const Said said = Check(File("changed.mcap"));
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_THAT(said.out, ContainsRegex(": the same, bit for bit: [0-9]+ of 251 ticks, [0-9]+ messages\n.*: damaged: the "
                                      "CRC of a chunk is wrong \\(record at byte [0-9]+\\)\n"));
}

TEST_F(Verify, ARecoveredRecordingIsStillACutOne) {
  const std::string whole = ReadFile(Fly());
  WriteFile(File("cut.mcap"), whole.substr(0, whole.size() / 2));
  ASSERT_EQ(Call(SetUpRecover, {File("cut.mcap"), "--out", File("out.mcap")}).exit_code, kExitIncomplete);
  const Said said = Check(File("out.mcap"));
  EXPECT_EQ(said.exit_code, kExitIncomplete);
  EXPECT_THAT(said.out, HasSubstr(": cut: recovered from a file that was damaged: the file ends inside a record "));
}

TEST_F(Verify, AChangedConfigBesideTheRecordingIsNamed) {
  const std::string recording = Fly();
  std::string config = ReadFile(File("run/config.toml"));
  Change(config, "p_gain = 0.2", "p_gain = 0.3");
  WriteFile(File("run/config.toml"), config);
  const Said said = Check(File("run"));
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_EQ(said.out, recording +
                          ": config.toml beside it is of another experiment: [law] p_gain = 0.3, the recording's says "
                          "p_gain = 0.2\n`orchestrator verify " +
                          recording + "` checks the recording alone\n");
  EXPECT_EQ(Check(recording).exit_code, kExitDone);
}

TEST_F(Verify, OtherProcessesAndDeliveryAreNoOtherExperiment) {
  Fly(kTwo, {"--set", "network.agents_per_process=2", "--set", "network.delivery='bundled'"});
  std::string config = ReadFile(File("run/config.toml"));
  Change(config, "ros_view = false", "ros_view = true");
  WriteFile(File("run/config.toml"), config);
  EXPECT_EQ(Check(File("run")).exit_code, kExitDone);
}

/// An experiment whose law runs `line` at every tick.
std::string WithLaw(const std::string& line) {
  return "[run]\nduration_s = 2.5\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\nname = 'custom'\n"
         "python = '''\ndef control(t, me, neighbours):\n    " +
         line + "\n    return [0.1, 0, 0]\n'''\n";
}

TEST_F(Verify, ARunThatFailedIsComparedUpToItsEnd) {
  const std::string recording = Fly(WithLaw("1 / (t - 1)"));
  EXPECT_EQ(flown_.exit_code, kExitFailed);
  EXPECT_THAT(flown_.err, HasSubstr("ZeroDivisionError"));
  const Said said = Check(recording);
  EXPECT_EQ(said.exit_code, kExitDone) << said.err;
  EXPECT_EQ(said.out, recording + ": the same, bit for bit: 100 of 251 ticks, 500 messages\n" + recording +
                          ": the run ended early\n");
}

TEST_F(Verify, ARecordingWhoseEndWasTakenAwayIsIncomplete) {
  const std::string recording = Fly(), changed = File("changed.mcap");
  CopyRecording(recording, changed,
                [](const std::string& /*topic*/, McapContents::Message& message) { return message.sequence < 100; });
  const Said said = Check(changed);
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_EQ(said.out, changed + ": the same, bit for bit: 100 of 251 ticks, 500 messages\n" + changed +
                          ": incomplete: it holds 100 ticks, expected 251: the run does not say that it ended early\n");
}

TEST_F(Verify, ARunThatFailsWhereItDidNotIsADifference) {
  const std::string recording = Fly(WithLaw("1 / (t - 9)"));
  ASSERT_EQ(flown_.exit_code, 0) << flown_.err;
  CopyWithConfig(recording, File("changed.mcap"), "1 / (t - 9)", "1 / (t - 1)");
  const Said said = Check(File("changed.mcap"));
  EXPECT_EQ(said.exit_code, kExitFailed);
  EXPECT_THAT(said.out, ContainsRegex(": differs: it goes on after 100 of 251 ticks, 500 messages, where the run now "
                                      "fails: .*ZeroDivisionError"));
}

TEST_F(Verify, ALawWhoseFileChangedIsFlownAsItWas) {
  WriteFile(File("law.py"), "def control(t, me, neighbours):\n    return [0.1, 0, 0]\n");
  const std::string recording =
      Fly("[run]\nduration_s = 0.5\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\nname = 'custom'\nfile = "
          "'law.py'\n");
  WriteFile(File("law.py"), "def control(t, me, neighbours):\n    return [0.2, 0, 0]\n");
  EXPECT_EQ(Check(File("run")).exit_code, kExitDone) << "the recording holds the text of the law";
}

TEST_F(Verify, ALibraryThatChangedIsNamed) {
  const std::string mine = File("libmine.so");
  std::filesystem::copy_file(test::BuildFolder() + "/tests/plugins/libmirror.so", mine);
  Fly("[run]\nduration_s = 0.5\n[agents]\ncount = 2\nmodel = 'double_integrator'\n[law]\nname = 'plugin'\nlibrary = '" +
      mine + "'\n");
  ASSERT_EQ(flown_.exit_code, 0) << flown_.err;
  EXPECT_EQ(Check(File("run")).exit_code, kExitDone);
  EXPECT_THAT(Check(File("run")).out, testing::Not(HasSubstr("note: ")));
  std::ofstream(mine, std::ios::app) << "more";  // the same code
  const Said said = Check(File("run"));
  EXPECT_EQ(said.exit_code, kExitDone) << "it gives the same bits";
  EXPECT_THAT(said.out, StartsWith("note: " + mine + " has changed: recorded with crc32 "));
  std::filesystem::remove(mine);
  const Said gone = Check(File("run"));
  EXPECT_EQ(gone.exit_code, kExitUsage);
  EXPECT_THAT(gone.err, HasSubstr("law.library: expected a shared library, got " + mine));
}

TEST_F(Verify, ARecordingOfAnotherVersionSaysSo) {
  std::string bytes = ReadFile(Fly());
  const std::string ours = McapWriter::Library();
  std::string theirs = ours;
  theirs.back() = static_cast<char>(theirs.back() ^ 1);
  bytes.replace(bytes.find(ours), ours.size(), theirs);
  // DataEnd's CRC covers the header: mark it as absent.
  const std::string data_end = std::string(1, '\x0f') + std::string("\x04\0\0\0\0\0\0\0", 8);
  bytes.replace(bytes.rfind(data_end) + data_end.size(), 4, 4, '\0');
  WriteFile(File("theirs.mcap"), bytes);
  const Said said = Check(File("theirs.mcap"));
  EXPECT_EQ(said.exit_code, kExitDone) << said.out;
  EXPECT_EQ(said.out, "note: recorded by " + theirs + ", flown again by " + ours + "\n" + File("theirs.mcap") +
                          ": the same, bit for bit: 251 ticks, 1255 messages\n");
}

TEST_F(Verify, ARunInRealTimeIsRefusedInWords) {
  CopyWithConfig(Fly(), File("realtime.mcap"), "\"lockstep\"", "\"realtime\"");
  const Said said = Check(File("realtime.mcap"));
  EXPECT_EQ(said.exit_code, kExitUsage);
  EXPECT_EQ(said.err, "error: " + File("realtime.mcap") +
                          ": expected run.mode = \"lockstep\", got \"realtime\": such a run depends on the wall clock, "
                          "and never repeats bit for bit\n");
}

TEST_F(Verify, ARecordingWithoutMessagesIsRefused) {
  const std::string recording = Fly(kTwo, {"--set", "record.topics=[]"});
  const Said said = Check(recording);
  EXPECT_EQ(said.exit_code, kExitUsage);
  EXPECT_EQ(said.err,
            "error: " + recording + ": expected a recording with messages, got none; record.topics left them out\n");
}

TEST_F(Verify, ARecordingOfARunThatEndedBeforeItsFirstTickIsRefused) {
  const std::string recording = Fly();
  McapContents contents = ReadMcap(recording);
  contents.metadata[kEarlyEnd] = {{kTicksKey, "0"}};
  CopyRecording(recording, contents, File("none.mcap"), [](const auto&, const auto&) { return false; });
  const Said said = Check(File("none.mcap"));
  EXPECT_EQ(said.exit_code, kExitUsage);
  EXPECT_EQ(said.err, "error: " + File("none.mcap") +
                          ": expected a recording with messages, got none; the run ended before its first tick\n");
}

TEST_F(Verify, OnlyTheRecordedTopicsAreCompared) {
  const std::string recording = Fly(kTwo, {"--set", "record.topics=['/agent_2/*']"});
  EXPECT_EQ(Check(recording).out, recording + ": the same, bit for bit: 251 ticks, 502 messages\n");
}

TEST_F(Verify, WhatIsNoRecordingIsRefused) {
  EXPECT_EQ(Check(File("none.mcap")).exit_code, kExitUsage);
  WriteFile(File("x.mcap"), "no recording");
  EXPECT_EQ(Check(File("x.mcap")).err,
            "error: " + File("x.mcap") + ": is no MCAP file: it does not begin with MCAP's magic bytes\n");
}

// --- fields -----------------------------------------------------------------------------------------------

template <class Sample>
Bytes OnTheWire(Sample sample) {
  Bytes bytes;
  Serialize(sample, bytes);
  return bytes;
}

mascot_msgs::msg::AgentCommand SomeCommand() {
  mascot_msgs::msg::AgentCommand command;
  ToWire(5, 100, 2, Command{{1, 2, 3, 4}}, command);
  return command;
}

/// "field: first, second"
std::string Differing(TopicKind kind, const Bytes& first, const Bytes& second) {
  const auto difference = FirstDifference(kind, first, second);
  return difference ? difference->field + ": " + difference->first + ", " + difference->second : "none";
}

TEST(SampleFields, EveryByteOfASampleBelongsToAFieldOrToPadding) {
  const Bytes command = OnTheWire(SomeCommand());
  for (std::size_t at = 4; at < command.size(); ++at) {  // behind the encapsulation
    Bytes changed = command;
    changed[at] ^= 1;
    EXPECT_THAT(
        Differing(TopicKind::kCommand, command, changed),
        MatchesRegex("(stamp\\.(sec|nanosec)|tick|agent|flags|actuator\\[[0-3]\\]|acceleration_(wanted|limited)\\."
                     "[xyz]): .*"))
        << at;
  }
}

TEST(SampleFields, EqualSamplesDoNotDiffer) {
  EXPECT_EQ(Differing(TopicKind::kCommand, OnTheWire(SomeCommand()), OnTheWire(SomeCommand())), "none");
}

TEST(SampleFields, NumbersReadBackAsTheSameBits) {
  auto a = SomeCommand(), b = SomeCommand();
  a.actuator()[2] = 0.1;
  b.actuator()[2] = std::bit_cast<double>(std::bit_cast<std::uint64_t>(0.1) + 1);
  EXPECT_EQ(Differing(TopicKind::kCommand, OnTheWire(a), OnTheWire(b)), "actuator[2]: 0.1, 0.10000000000000002");
  a.actuator()[2] = 0.0;
  b.actuator()[2] = -0.0;
  EXPECT_EQ(Differing(TopicKind::kCommand, OnTheWire(a), OnTheWire(b)), "actuator[2]: 0, -0");
}

TEST(SampleFields, MessagesOfOtherLengthsDifferInTheirSize) {
  const auto message = [](std::vector<double> data) {
    mascot_msgs::msg::AgentMessage sample;
    ToWire(5, 100, 2, std::span<const double>(data), sample);
    return OnTheWire(sample);
  };
  EXPECT_EQ(Differing(TopicKind::kMessage, message({1, 2}), message({1})), "data.size(): 2, 1");
  EXPECT_EQ(Differing(TopicKind::kMessage, message({1, 2}), message({1, 3})), "data[1]: 2, 3");
}

TEST(SampleFields, WhatIsNoSampleDiffersBySizeOrByte) {
  EXPECT_EQ(Differing(TopicKind::kClock, Bytes(3), Bytes(4)), "size: 3 bytes, 4 bytes");
  EXPECT_EQ(Differing(TopicKind::kClock, {1, 2, 3}, {1, 2, 0xff}), "byte 2: 0x03, 0xff");
}

}  // namespace
}  // namespace mascot
