#include "orchestrator/recording/completeness.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "experiment/read_experiment.h"
#include "orchestrator/recording/topic_filter.h"

namespace mascot {
namespace {

/// Whether a topic of this kind has a sample of every tick.
bool IsPerTick(const Topic& topic, bool realtime) {
  switch (topic.kind) {
    case TopicKind::kState:
    case TopicKind::kClock:
      return true;
    case TopicKind::kCommand:
    case TopicKind::kMessage:
      return !realtime;
    default:
      return false;
  }
}

/// Which agents have a law that sends messages (law.messages of the resolved experiment), by id - 1.
std::vector<bool> SendersOf(Section& config, std::size_t agents) {
  const auto sends = [](Section law) { return law.Boolean("messages", false); };
  std::vector<bool> senders(agents, sends(config.Child("law")));
  for (Section& override : config.Child("agents").Children("override")) {
    const auto id = override.Integer("id");
    if (override.Has("law") && id >= 1 && static_cast<std::size_t>(id) <= agents)
      senders[static_cast<std::size_t>(id - 1)] = sends(override.Child("law"));
  }
  return senders;
}

/// The recorded topics (record.topics): each agent's command, message and state, then the clock.
std::vector<Topic> TopicsOf(const std::vector<std::string>& patterns, const std::vector<bool>& sends_messages) {
  std::vector<Topic> topics;
  for (std::size_t i = 0; i < sends_messages.size(); ++i) {
    const int id = static_cast<int>(i) + 1;
    topics.push_back(Topic::Command(id));
    if (sends_messages[i]) topics.push_back(Topic::Message(id));
    topics.push_back(Topic::State(id));
  }
  topics.push_back(Topic::Clock());
  std::erase_if(topics, [&](const Topic& topic) { return !IsRecorded(patterns, topic); });
  return topics;
}

using Counts = std::map<std::string, std::uint64_t>;  // messages by topic

/// Counts the messages of the topics that should have a sample of every tick.
Counts Count(const McapContents& contents, const std::optional<RecordingPlan>& plan) {
  Counts counts;
  if (plan)
    for (const Topic& topic : plan->topics)
      if (plan->HasEveryTick(topic)) counts[topic.Name()] = 0;
  for (const auto& [id, channel] : contents.channels) {
    const auto topic = Topic::Parse(channel.topic);
    if (topic && (plan ? counts.contains(channel.topic) : IsPerTick(*topic, /*realtime=*/false)))
      counts[channel.topic] = channel.messages;
  }
  return counts;
}

/// The entry of the metadata that says which format a recording has; null: there is none.
const std::string* MetadataEntry(const McapContents& contents, const char* key) {
  const auto metadata = contents.metadata.find(kMetadata);
  if (metadata == contents.metadata.end()) return nullptr;
  const auto entry = metadata->second.find(key);
  return entry == metadata->second.end() ? nullptr : &entry->second;
}

/// Describes the first gap: a gap in the sequence numbers of a channel; in a recording that lost nothing at its end,
/// also a topic that is missing or has fewer samples than another. Empty: none.
std::string FindGap(const McapContents& contents, const std::optional<RecordingPlan>& plan, const Counts& counts) {
  for (const auto& [id, channel] : contents.channels)
    if (channel.gaps > 0) return fmt::format("{}: gaps in its sequence numbers: {}", channel.topic, channel.gaps);
  if (!LossOf(contents).empty()) return "";
  const auto is_there = [&](const Topic& topic) {
    return std::ranges::any_of(contents.channels,
                               [&](const auto& channel) { return channel.second.topic == topic.Name(); });
  };
  if (plan)
    for (const Topic& topic : plan->topics)
      if (!is_there(topic)) return topic.Name() + " is missing, which the experiment records";
  const auto fewest = std::ranges::min_element(counts, {}, &Counts::value_type::second);
  const auto most = std::ranges::max_element(counts, {}, &Counts::value_type::second);
  if (counts.empty() || fewest->second == most->second) return "";
  return fmt::format("{} has {} messages, {} has {}", most->first, most->second, fewest->first, fewest->second);
}

}  // namespace

bool RecordingPlan::HasEveryTick(const Topic& topic) const { return IsPerTick(topic, realtime); }

std::string TooNew(const McapContents& contents) {
  const std::string* format = MetadataEntry(contents, kFormatKey);
  if (format == nullptr) return "";
  int version = 0;
  const char* end = format->data() + format->size();
  const auto [rest, error] = std::from_chars(format->data(), end, version);
  if (error == std::errc() && rest == end && version <= kFormat) return "";
  return fmt::format("it is of format {}, newer than the {} that this version of MASCOT reads", *format, kFormat);
}

std::string LossOf(const McapContents& contents) {
  if (!contents.damage.empty()) return contents.damage;
  const std::string* recovered = MetadataEntry(contents, kRecoveredKey);
  return recovered == nullptr ? "" : "recovered from a file that was damaged: " + *recovered;
}

RecordingPlan PlanOf(const McapContents& contents, const std::string& path) {
  if (const std::string why = TooNew(contents); !why.empty()) throw ConfigError({path + ": " + why});
  const auto attached = contents.attachments.find("config.toml");
  if (attached == contents.attachments.end())
    throw ConfigError({path + ": expected a run's recording, with its config.toml attached, got none" +
                       (contents.damage.empty() ? "" : ": " + contents.damage)});
  Section config = Section::FromText(attached->second, path + " (config.toml)");
  config.Use(ExperimentKeys());
  CheckFormat(config);
  config.ThrowIfWrong();
  Section run = config.Child("run");
  RecordingPlan plan;
  plan.name = run.Text("name");
  plan.realtime = kModes.Value(run.OneOf("mode")) == Mode::kRealtime;
  plan.agents = static_cast<int>(config.Child("agents").Integer("count"));
  plan.rate_hz = static_cast<int>(config.Child("control").Integer("rate_hz"));
  plan.ticks = static_cast<std::uint64_t>(std::llround(run.Number("duration_s") * plan.rate_hz)) + 1;
  const std::vector<std::string> patterns = config.Child("record").Texts("topics");
  config.ThrowIfWrong();  // before `agents` is used as a size
  plan.topics = TopicsOf(patterns, SendersOf(config, static_cast<std::size_t>(plan.agents)));
  config.ThrowIfWrong();
  return plan;
}

std::string Proof::End(std::optional<std::uint64_t> planned_ticks) const {
  if (!ticks) return "";
  if (*ticks == 0) return "no tick is whole";
  return fmt::format("whole up to tick {}{}", *ticks - 1,
                     planned_ticks ? fmt::format(" of {}", *planned_ticks - 1) : "");
}

Proof Prove(const McapContents& contents, const std::optional<RecordingPlan>& plan) {
  const Counts counts = Count(contents, plan);
  Proof proof{.gap = FindGap(contents, plan, counts), .ticks = {}};
  if (!counts.empty()) proof.ticks = std::ranges::min_element(counts, {}, &Counts::value_type::second)->second;
  return proof;
}

}  // namespace mascot
