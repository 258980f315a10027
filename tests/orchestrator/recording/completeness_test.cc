// Check that a recording is complete: compares its contents with those that the attached experiment asks for.
#include "orchestrator/recording/completeness.h"

#include <gmock/gmock.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "agent/laws/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/recording/run_writer.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Two agents for a tenth of a second; agent 2 has a law that sends messages.
const char* const kExperiment = R"(
[run]
name = "talk"
duration_s = 0.1
[agents]
count = 2
model = "double_integrator"
[[agents.override]]
id = 2
law = { name = "custom", python = """
def control(t, me, neighbours):
    return [0, 0, 0]
def message(me):
    return [1.0]
""" }
)";

/// Runs `toml` in this process, for at most so many rows, and records it. Returns the path of the recording.
std::string Record(const ScratchFolder& scratch, const std::string& toml, int rows = 1000) {
  const Experiment experiment = LoadExperiment(Section::FromText(toml, "talk.toml"), "talk");
  const RunFolder folder(scratch.File("run"), experiment, false);
  RunWriter writer(experiment, folder, experiment.resolved);
  EXPECT_EQ(RunInProcess(experiment, {&writer}, [&rows] { return rows-- > 0; }).failure, "");
  writer.Close(experiment.resolved);
  return folder.File("run.mcap").string();
}

TEST(RunInProcess, ReportsWhatFailsBeforeTheFirstTick) {
  const ScratchFolder scratch;
  const std::string breaks = scratch.File("breaks");
  const Experiment experiment = LoadExperiment(
      Section::FromText("[run]\nduration_s = 1.0\n[agents]\ncount = 1\n[law]\nname = 'custom'\npython = \"\"\"\n"
                        "import os\ndef start(me, params):\n  if os.path.exists('" +
                            breaks +
                            "'):\n    raise ValueError('broken')\n"
                            "def control(t, me, neighbours):\n  return [0, 0]\n\"\"\"\n",
                        "late.toml"),
      "late");
  WriteFile(breaks, "");
  EXPECT_THAT(RunInProcess(experiment, {}, [] { return true; }).failure, HasSubstr("ValueError: broken"));
}

/// A copy of the recording, closed properly, of what `edit` keeps: it may change the time of the n-th message of a
/// topic.
std::string Edited(const std::string& path,
                   const std::function<bool(const std::string& topic, std::uint64_t n, std::uint64_t& time_ns)>& edit,
                   std::map<std::string, std::string> early_end = {}) {
  const McapContents contents = ReadMcap(path);
  const std::string copy = path + ".edited.mcap";
  McapWriter writer(copy);
  for (const auto& [name, data] : contents.attachments) writer.Attach(name, "application/toml", data);
  if (!early_end.empty()) writer.Metadata("mascot_ended_early", early_end);
  std::map<std::uint16_t, std::uint16_t> channels;
  std::map<std::uint16_t, std::uint64_t> next;
  ReadMcap(path, [&](const McapContents::Message& message) {
    const McapContents::ChannelInfo& channel = contents.channels.at(message.channel);
    std::uint64_t time_ns = message.log_time;
    if (!edit(channel.topic, next[message.channel]++, time_ns)) return;
    if (!channels.contains(message.channel))
      channels[message.channel] = writer.AddChannel({channel.topic, channel.schema_name, "uint64 n\n", {}});
    writer.Write(channels[message.channel], time_ns, message.data);
  });
  writer.Close();
  return copy;
}

/// Copies the recording without one topic and closes it properly; `fewer`: without the last sample of that topic only.
std::string Without(const std::string& path, const std::string& topic, bool fewer = false) {
  const McapContents contents = ReadMcap(path);
  const std::string copy = path + ".without.mcap";
  McapWriter writer(copy);
  for (const auto& [name, data] : contents.attachments) writer.Attach(name, "application/toml", data);
  std::map<std::uint16_t, std::uint16_t> channels;
  std::map<std::uint16_t, std::uint64_t> left;
  for (const auto& [id, channel] : contents.channels) {
    if (channel.topic == topic && !fewer) continue;
    channels[id] = writer.AddChannel({channel.topic, channel.schema_name, "uint64 n\n", {}});
    left[id] = channel.messages - (channel.topic == topic ? 1 : 0);
  }
  ReadMcap(path, [&](const McapContents::Message& message) {
    if (!channels.contains(message.channel) || left[message.channel] == 0) return;
    --left[message.channel];
    writer.Write(channels[message.channel], message.log_time, message.data);
  });
  writer.Close();
  return copy;
}

Proof ProofOf(const std::string& path) {
  const McapContents contents = ReadMcap(path);
  EXPECT_EQ(contents.damage, "");
  return Prove(contents, PlanOf(contents, path));
}

TEST(Completeness, AWholeRecordingHasNoGapAndEveryTick) {
  const ScratchFolder scratch;
  const Proof proof = ProofOf(Record(scratch, kExperiment));
  EXPECT_EQ(proof.gap, "");
  EXPECT_EQ(proof.ticks, 11u);
}

TEST(Completeness, ThePlanIsThatOfTheAttachedExperiment) {
  const ScratchFolder scratch;
  const std::string path = Record(scratch, kExperiment);
  const RecordingPlan plan = PlanOf(ReadMcap(path), path);
  EXPECT_EQ(plan.name, "talk");
  EXPECT_EQ(plan.agents, 2);
  EXPECT_EQ(plan.rate_hz, 100);
  EXPECT_EQ(plan.ticks, 11u);
  EXPECT_FALSE(plan.realtime);
  EXPECT_THAT(plan.topics, ElementsAre(Topic::Command(1), Topic::State(1), Topic::Command(2), Topic::Message(2),
                                       Topic::State(2), Topic::Clock(), Topic::Event()));
}

TEST(Completeness, ARecordingFromWhichAWholeTopicWasTakenIsNotComplete) {
  const ScratchFolder scratch;
  const std::string whole = Record(scratch, kExperiment);
  for (const Topic& topic : PlanOf(ReadMcap(whole), whole).topics) {
    if (topic.kind == TopicKind::kEvent) continue;  // there were none
    const std::string path = Without(whole, topic.Name());
    EXPECT_EQ(ProofOf(path).gap, topic.Name() + " is missing, which the experiment records");
    if (topic.kind != TopicKind::kState && topic.kind != TopicKind::kCommand) continue;  // not needed for exports
    const std::string error = path + ": " + topic.Name() + " is missing, which the experiment records";
    EXPECT_THAT([&] { Recording{path}; }, ThrowsMessage<std::runtime_error>(error));
  }
}

TEST(Completeness, ARecordingThatLacksASampleOfATopicIsNotComplete) {
  const ScratchFolder scratch;
  const std::string whole = Record(scratch, kExperiment);
  for (const Topic& topic : PlanOf(ReadMcap(whole), whole).topics)
    if (topic.kind != TopicKind::kEvent) {  // there were none
      EXPECT_THAT(ProofOf(Without(whole, topic.Name(), /*fewer=*/true)).gap, HasSubstr(topic.Name() + " has 10"));
    }
}

TEST(Completeness, TopicsThatTheExperimentDoesNotRecordAreNotMissed) {
  const ScratchFolder scratch;
  const std::string toml = std::string(kExperiment) + "[record]\ntopics = ['/agent_1/*', '/agent_2/state']\n";
  const Proof proof = ProofOf(Record(scratch, toml));
  EXPECT_EQ(proof.gap, "");
  EXPECT_EQ(proof.ticks, 11u);
}

TEST(Completeness, InRealTimeOnlyCommandsAndMessagesMayBeFewer) {
  RecordingPlan plan;
  plan.realtime = true;
  EXPECT_TRUE(plan.IsInEveryRow(Topic::State(1)));
  EXPECT_TRUE(plan.IsInEveryRow(Topic::Clock()));
  EXPECT_FALSE(plan.IsInEveryRow(Topic::Command(1)));
  EXPECT_FALSE(plan.IsInEveryRow(Topic::Message(1)));
}

Verdict JudgementOf(const std::string& path) { return Judge(path, ReadMcap(path)); }

constexpr auto kAll = [](const std::string&, std::uint64_t, std::uint64_t&) { return true; };

TEST(Completeness, OfAWholeRecordingIsProved) {
  const ScratchFolder scratch;
  const Verdict verdict = JudgementOf(Record(scratch, kExperiment));
  EXPECT_EQ(verdict.reason, "");
  EXPECT_EQ(verdict.ticks, 11u);
}

TEST(Completeness, OfARecordingWithoutMessagesIsNotProved) {
  const ScratchFolder scratch;
  const auto none = [](const std::string&, std::uint64_t, std::uint64_t&) { return false; };
  EXPECT_EQ(JudgementOf(Edited(Record(scratch, kExperiment), none)).reason,
            "it holds 0 ticks, expected 11: the run does not say that it ended early");
}

TEST(Completeness, OfARecordingThatLacksAnAgentIsNotProved) {
  const ScratchFolder scratch;
  const auto one = [](const std::string& topic, std::uint64_t, std::uint64_t&) {
    return !topic.starts_with("/agent_2/");
  };
  EXPECT_EQ(JudgementOf(Edited(Record(scratch, kExperiment), one)).reason,
            "/agent_2/command is missing, which the experiment records");
}

TEST(Completeness, OfTopicsThatTellNoTicksIsNotProved) {
  const ScratchFolder scratch;
  const std::string toml = std::string(kExperiment) + "[record]\ntopics = ['/agent_7/*']\n";
  EXPECT_EQ(JudgementOf(Record(scratch, toml)).reason,
            "record.topics selects no topic that has a sample of every tick: nothing proves how many there were");
}

TEST(Completeness, NeedsTheTimeOfEachTick) {
  const ScratchFolder scratch;
  const std::string whole = Record(scratch, kExperiment);
  const auto zero = [](const std::string&, std::uint64_t, std::uint64_t& time_ns) { return time_ns = 0, true; };
  EXPECT_THAT(JudgementOf(Edited(whole, zero)).reason, HasSubstr(" has a message of t = 0 s, expected 0.01 s"));
  const auto late = [](const std::string& topic, std::uint64_t n, std::uint64_t& time_ns) {
    if (topic == "/agent_2/message" && n == 10) ++time_ns;
    return true;
  };
  EXPECT_EQ(JudgementOf(Edited(whole, late)).reason,
            "/agent_2/message has a message of t = 0.100000001 s, expected 0.1 s");
}

TEST(Completeness, InRealTimeCommandsMayMissTicksButNotTheirTimes) {
  const ScratchFolder scratch;  // written as in real time; flown in lockstep, as tests do
  std::string toml = kExperiment;
  toml.replace(toml.find("duration_s"), 0, "mode = 'realtime'\n");
  const std::string whole = Record(scratch, toml);
  const auto some = [](const std::string& topic, std::uint64_t n, std::uint64_t&) {
    return !topic.ends_with("/command") || n % 5 == 0;
  };
  EXPECT_EQ(JudgementOf(Edited(whole, some)).reason, "");
  const auto twice = [](const std::string& topic, std::uint64_t n, std::uint64_t& time_ns) {
    if (topic == "/agent_1/command" && n == 3) time_ns = 20'000'000;
    return true;
  };
  EXPECT_EQ(JudgementOf(Edited(whole, twice)).reason, "/agent_1/command has a message of t = 0.02 s, expected 0.03 s");
}

TEST(Completeness, ARunThatEndedEarlySaysSo) {
  const ScratchFolder scratch;
  const Verdict verdict = JudgementOf(Record(scratch, kExperiment, /*rows=*/4));
  EXPECT_EQ(verdict.reason, "");
  EXPECT_EQ(verdict.ticks, 4u);
  EXPECT_EQ(verdict.plan->ticks, 11u);
}

TEST(Completeness, ARecordingWhoseEndWasTakenAwayIsNotComplete) {
  const ScratchFolder scratch;
  const std::string whole = Record(scratch, kExperiment);
  const auto four = [](const std::string&, std::uint64_t n, std::uint64_t&) { return n < 4; };
  EXPECT_EQ(JudgementOf(Edited(whole, four)).reason,
            "it holds 4 ticks, expected 11: the run does not say that it ended early");
  EXPECT_EQ(JudgementOf(Edited(whole, four, {{"ticks", "7"}})).reason,
            "it holds 4 ticks, expected 7, at which the run says it ended early");
  EXPECT_EQ(JudgementOf(Edited(whole, kAll, {{"ticks", "7"}})).reason,
            "it holds 11 ticks, expected 7, at which the run says it ended early");
  EXPECT_NE(JudgementOf(Edited(whole, four, {{"ticks", "some"}})).reason, "");
}

TEST(Completeness, WithoutAnExperimentNothingIsProved) {
  const ScratchFolder scratch;
  McapWriter(scratch.File("other.mcap")).Close();
  EXPECT_EQ(JudgementOf(scratch.File("other.mcap")).reason,
            "no experiment is attached, which would say what there must be");
}

TEST(Completeness, ARecordingSaysItsFormat) {
  const ScratchFolder scratch;
  const McapContents contents = ReadMcap(Record(scratch, kExperiment));
  EXPECT_EQ(contents.metadata.at("mascot").at("format"), "1");
  EXPECT_THAT(contents.attachments.at("config.toml"), testing::StartsWith("format = 1\n\n[run]\n"));
  EXPECT_EQ(TooNew(contents), "");
}

TEST(Completeness, ARecordingWithoutAFormatIsOfTheFirst) { EXPECT_EQ(TooNew(McapContents{}), ""); }

TEST(Completeness, ARecordingOfANewerFormatIsRefused) {
  McapContents contents;
  for (const std::string format : {"2", "1.5", "next"}) {
    contents.metadata["mascot"] = {{"format", format}};
    EXPECT_THAT([&] { PlanOf(contents, "run.mcap"); },
                ThrowsMessage<ConfigError>("run.mcap: it is of format " + format +
                                           ", newer than the 1 that this version of MASCOT reads"));
  }
}

TEST(Completeness, AnAttachedExperimentOfANewerFormatIsRefused) {
  McapContents contents;
  contents.attachments["config.toml"] = "format = 2\n[run]\n";
  EXPECT_THAT(
      [&] { PlanOf(contents, "run.mcap"); },
      ThrowsMessage<ConfigError>("run.mcap (config.toml):1:10: format: expected at most 1, got 2: the file is of a "
                                 "newer version of MASCOT"));
}

TEST(Completeness, AFileOfAnotherProgramHasNoPlan) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("other.mcap"));
  writer.Attach("config.toml", "application/toml", "colour = 'red'\n");
  writer.Close();
  const McapContents contents = ReadMcap(scratch.File("other.mcap"));
  EXPECT_THROW(PlanOf(contents, "other.mcap"), ConfigError);
  EXPECT_THAT(
      [&] { PlanOf(McapContents{}, "none.mcap"); },
      ThrowsMessage<ConfigError>("none.mcap: expected a run's recording, with its config.toml attached, got none"));
}

}  // namespace
}  // namespace mascot
