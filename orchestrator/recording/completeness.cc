#include "orchestrator/recording/completeness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "base/number.h"
#include "bus/wire.h"
#include "experiment/read_experiment.h"
#include "orchestrator/recording/topic_filter.h"

namespace mascot {
namespace {

/// The agents that events make answer nothing for some time.
std::set<int> LostIn(Section& config) {
  std::set<int> lost;
  for (Section& event : config.Children("events")) {
    if (!event.Has("fault")) continue;
    Section fault = event.Child("fault");
    const FaultKind kind = kFaultKinds.Value(fault.OneOf("kind"));
    if (kind == FaultKind::kKill || kind == FaultKind::kHang) lost.insert(static_cast<int>(fault.Integer("agent")));
  }
  return lost;
}

/// Which agents have a law that sends messages, by id - 1: one that says so in the resolved experiment (law.messages of
/// users' laws), or whose messages have a channel. Laws of the table have no such key, and no reader of recordings
/// knows them.
std::vector<bool> SendersOf(Section& config, const McapContents& contents, std::size_t agents) {
  const auto sends = [](Section law) { return law.Boolean("messages", false); };
  std::vector<bool> senders(agents, sends(config.Child("law")));
  for (Section& override : config.Child("agents").Children("override")) {
    const auto id = override.Integer("id");
    if (override.Has("law") && id >= 1 && static_cast<std::size_t>(id) <= agents)
      senders[static_cast<std::size_t>(id - 1)] = sends(override.Child("law"));
  }
  for (const auto& [id, channel] : contents.channels) {
    const auto topic = Topic::Parse(channel.topic);
    if (topic && topic->kind == TopicKind::kMessage && static_cast<std::size_t>(topic->agent) <= agents)
      senders[static_cast<std::size_t>(topic->agent - 1)] = true;
  }
  return senders;
}

/// Which agents have a law that takes actions, by id - 1: those whose actions have a channel.
std::vector<bool> TakersIn(const McapContents& contents, std::size_t agents) {
  std::vector<bool> takers(agents);
  for (const auto& [id, channel] : contents.channels) {
    const auto topic = Topic::Parse(channel.topic);
    if (topic && topic->kind == TopicKind::kAction && static_cast<std::size_t>(topic->agent) <= agents)
      takers[static_cast<std::size_t>(topic->agent - 1)] = true;
  }
  return takers;
}

/// The recorded topics (record.topics, record.ros_types): each agent's action, command, message, odometry and state,
/// then the clock, the events, the scene and the transforms.
std::vector<Topic> TopicsOf(const std::vector<std::string>& patterns, bool ros_types,
                            const std::vector<bool>& takes_actions, const std::vector<bool>& sends_messages) {
  std::vector<Topic> topics;
  for (std::size_t i = 0; i < sends_messages.size(); ++i) {
    const int id = static_cast<int>(i) + 1;
    if (takes_actions[i]) topics.push_back(Topic::Action(id));
    topics.push_back(Topic::Command(id));
    if (sends_messages[i]) topics.push_back(Topic::Message(id));
    if (ros_types) topics.push_back(Topic::Odom(id));
    topics.push_back(Topic::State(id));
  }
  topics.push_back(Topic::Clock());
  topics.push_back(Topic::Event());
  if (ros_types) topics.insert(topics.end(), {Topic::Scene(), Topic::Tf()});
  std::erase_if(topics, [&](const Topic& topic) { return !IsRecorded(patterns, topic); });
  return topics;
}

using Counts = std::map<std::string, std::uint64_t>;  // messages by topic

/// Messages of all topics that the plan has, also of those that are not there.
Counts CountMessages(const McapContents& contents, const RecordingPlan& plan) {
  Counts counts;
  for (const Topic& topic : plan.topics) counts[topic.Name()] = 0;
  for (const auto& [id, channel] : contents.channels)
    if (const auto count = counts.find(channel.topic); count != counts.end()) count->second += channel.messages;
  return counts;
}

/// An entry of a metadata record; null: there is none.
const std::string* MetadataEntry(const McapContents& contents, const char* name, const char* key) {
  const auto metadata = contents.metadata.find(name);
  if (metadata == contents.metadata.end()) return nullptr;
  const auto entry = metadata->second.find(key);
  return entry == metadata->second.end() ? nullptr : &entry->second;
}

/// The topics of the plan, by name.
std::map<std::string, Topic> TopicsByName(const RecordingPlan& plan) {
  std::map<std::string, Topic> topics;
  for (const Topic& topic : plan.topics) topics[topic.Name()] = topic;
  return topics;
}

std::string SequenceGap(const McapContents& contents) {
  for (const auto& [id, channel] : contents.channels)
    if (channel.gaps > 0) return fmt::format("{}: gaps in its sequence numbers: {}", channel.topic, channel.gaps);
  return "";
}

/// In a recording that was closed: the first topic that is missing, or has fewer samples than another. Empty: none.
std::string TopicGap(const RecordingPlan& plan, const Counts& counts, bool ended_early) {
  const std::pair<const std::string, std::uint64_t>* most = nullptr;
  for (const auto& count : counts)
    if (most == nullptr || count.second > most->second) most = &count;
  for (const Topic& topic : plan.topics) {
    const std::string name = topic.Name();
    const std::uint64_t count = counts.at(name);
    const bool may_miss_ticks = !plan.IsInEveryRow(topic);
    const bool may_be_empty = topic.kind == TopicKind::kEvent || (may_miss_ticks && ended_early);
    if (count == 0 && most->second > 0 && !may_be_empty) return name + " is missing, which the experiment records";
    if (count < most->second && !may_miss_ticks)
      return fmt::format("{} has {} messages, {} has {}", most->first, most->second, name, count);
  }
  return "";
}

/// Why a recording without a gap does not prove that it holds its run up to the end. Empty: it does.
std::string EndGap(const McapContents& contents, const RecordingPlan& plan, std::optional<std::uint64_t> ticks) {
  if (!ticks)
    return "record.topics selects no topic that has a sample of every tick: nothing proves how many there were";
  const auto early = TicksOfEarlyEnd(contents);
  if (*ticks == early.value_or(plan.ticks)) return "";
  return fmt::format("it holds {} ticks, expected {}{}", *ticks, early.value_or(plan.ticks),
                     early ? ", at which the run says it ended early" : ": the run does not say that it ended early");
}

/// The tick that is next to this time; the last one of the plan for times beyond.
std::int64_t TickAt(std::uint64_t time_ns, const RecordingPlan& plan) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  const auto rate = static_cast<std::uint64_t>(plan.rate_hz);
  const std::uint64_t rest = time_ns % kSecond;
  return static_cast<std::int64_t>(
      std::min(time_ns / kSecond * rate + (rest * rate + kSecond / 2) / kSecond, plan.ticks - 1));
}

/// The number of ticks up to the end of so many rows. Rows beyond the last tick count as a tick each.
std::uint64_t TicksUpTo(std::uint64_t rows, const RecordedTicks& ticks) {
  const std::uint64_t within = std::min(rows, static_cast<std::uint64_t>(ticks.rows()));
  if (within == 0) return rows;
  return static_cast<std::uint64_t>(ticks.TickOf(static_cast<std::int64_t>(within) - 1)) + 1 + (rows - within);
}

/// Checks the times of one topic, message by message: tick k is at k / rate.
class Times {
 public:
  Times(const Topic& topic, const RecordingPlan& plan, const RecordedTicks& ticks)
      : name_(topic.Name()), plan_(plan), ticks_(ticks), dense_(plan.IsInEveryRow(topic)) {}

  /// What is wrong with the time of the topic's next message. Empty: nothing.
  std::string Take(std::uint64_t time_ns) {
    const std::int64_t row = dense_ ? next_ : std::max(next_, ticks_.RowAt(TickAt(time_ns, plan_)));
    const std::uint64_t expected_ns = StampNs(ticks_.TickOf(row), plan_.rate_hz);
    next_ = row + 1;
    if (time_ns == expected_ns && row < ticks_.rows()) return "";
    return fmt::format("{} has a message of t = {:.9g} s, expected {:.9g} s", name_,
                       1e-9 * static_cast<double>(time_ns), 1e-9 * static_cast<double>(expected_ns));
  }

 private:
  std::string name_;
  const RecordingPlan& plan_;
  const RecordedTicks& ticks_;
  bool dense_;             // a message in each row; else (real time) in some, in order
  std::int64_t next_ = 0;  // the first row that may come next
};

/// Checks the events: each has its number and the time of its tick, and there are as many as the states say.
class EventsCheck {
 public:
  explicit EventsCheck(const RecordingPlan& plan) : plan_(plan) {}

  /// What is wrong with the next event. Empty: nothing.
  std::string TakeEvent(const McapContents::Message& message) {
    mascot_msgs::msg::Event event;
    Deserialize(message.data, event);
    const std::uint64_t time_ns = StampNs(static_cast<std::int64_t>(event.tick()), plan_.rate_hz);
    if (event.number() == ++events_ && time_ns == message.log_time && event.tick() < plan_.ticks) return "";
    return fmt::format("{} has event {} of t = {:.9g} s, expected event {}", Topic::Event().Name(), event.number(),
                       1e-9 * static_cast<double>(message.log_time), events_);
  }
  void TakeState(const McapContents::Message& message) {
    constexpr std::size_t kEvents = 24;  // behind encapsulation, stamp, tick and agent (idl/mascot.idl)
    std::uint32_t events = 0;
    if (message.data.size() >= kEvents + sizeof events)
      std::memcpy(&events, message.data.data() + kEvents, sizeof events);
    said_ = std::max(said_, events);
  }
  /// What is wrong with their number, after the last message. Empty: nothing.
  std::string Finish() const {
    if (events_ == said_) return "";
    return fmt::format("{} has {} events, the states say {}", Topic::Event().Name(), events_, said_);
  }

 private:
  const RecordingPlan& plan_;
  std::uint32_t events_ = 0, said_ = 0;
};

/// The first message of the recording that has not the time of its tick, or what is wrong with its events. Empty:
/// nothing.
std::string MessageGap(const std::string& path, const McapContents& contents, const RecordingPlan& plan) try {
  const auto topics = TopicsByName(plan);
  const RecordedTicks ticks = TicksIn(contents, plan);
  std::map<std::uint16_t, Times> times;
  std::map<std::uint16_t, TopicKind> kinds;
  for (const auto& [id, channel] : contents.channels)
    if (const auto topic = topics.find(channel.topic); topic != topics.end()) {
      kinds[id] = topic->second.kind;
      if (topic->second.kind != TopicKind::kEvent) times.try_emplace(id, topic->second, plan, ticks);
    }
  const bool has_both = std::ranges::any_of(plan.topics, [](const Topic& t) { return t.kind == TopicKind::kEvent; }) &&
                        std::ranges::any_of(plan.topics, [](const Topic& t) { return t.kind == TopicKind::kState; });
  EventsCheck events(plan);
  std::string gap;
  ReadMcap(path, [&](const McapContents::Message& message) {
    const auto kind = kinds.find(message.channel);
    if (!gap.empty() || kind == kinds.end()) return;
    if (kind->second == TopicKind::kState) events.TakeState(message);
    gap = kind->second == TopicKind::kEvent ? events.TakeEvent(message)
                                            : times.at(message.channel).Take(message.log_time);
  });
  return gap.empty() && has_both ? events.Finish() : gap;
} catch (const std::runtime_error& error) {  // of a sample that is none
  return error.what();
}

/// The plan of the recording; nothing if no MASCOT experiment is attached.
std::optional<RecordingPlan> PlanIn(const McapContents& contents, const std::string& path) try {
  return PlanOf(contents, path);
} catch (const ConfigError&) {
  return std::nullopt;
}

std::string WhyIncomplete(const std::string& path, const McapContents& contents, const Verdict& verdict) {
  if (std::string why = TooNew(contents); !why.empty()) return why;
  const Proof proof = verdict.plan ? Prove(contents, *verdict.plan) : Proof{};
  if (const std::string loss = LossOf(contents); !loss.empty()) {
    const std::string end = proof.End(verdict.plan ? std::optional(verdict.plan->ticks) : std::nullopt);
    return end.empty() ? loss : loss + "; " + end;
  }
  if (std::string gap = SequenceGap(contents); !gap.empty()) return gap;
  if (!verdict.plan) return "no experiment is attached, which would say what there must be";
  if (!proof.gap.empty()) return proof.gap;
  if (std::string gap = EndGap(contents, *verdict.plan, proof.ticks); !gap.empty()) return gap;
  return MessageGap(path, contents, *verdict.plan);
}

}  // namespace

bool RecordingPlan::IsInEveryRow(const Topic& topic) const {
  if (topic.kind == TopicKind::kTf) return true;  // on the wire it comes as often as viewers need it
  const TopicRhythm rhythm = topic.traits().rhythm;
  return rhythm == TopicRhythm::kTick || (rhythm == TopicRhythm::kAnswer && !realtime && !lost.contains(topic.agent));
}

std::string TooNew(const McapContents& contents) {
  const std::string* format = MetadataEntry(contents, kMetadata, kFormatKey);
  if (format == nullptr) return "";
  if (const auto version = NumberFrom<int>(*format); version && *version <= kFormat) return "";
  return fmt::format("it is of format {}, newer than the {} that this version of MASCOT reads", *format, kFormat);
}

std::string LossOf(const McapContents& contents) {
  if (!contents.damage.empty()) return contents.damage;
  const std::string* recovered = MetadataEntry(contents, kMetadata, kRecoveredKey);
  return recovered == nullptr ? "" : "recovered from a file that was damaged: " + *recovered;
}

std::optional<std::uint64_t> TicksOfEarlyEnd(const McapContents& contents) {
  const std::string* ticks = MetadataEntry(contents, kEarlyEnd, kTicksKey);
  return ticks == nullptr ? std::nullopt : NumberFrom<std::uint64_t>(*ticks);
}

std::uint64_t TicksBegun(const McapContents& contents, const RecordingPlan& plan) {
  std::optional<std::uint64_t> last_ns;
  for (const auto& [id, channel] : contents.channels)
    if (channel.messages > 0) last_ns = std::max(last_ns.value_or(0), channel.last_time);
  return last_ns ? static_cast<std::uint64_t>(TickAt(*last_ns, plan)) + 1 : 0;
}

RecordedTicks TicksIn(const McapContents& contents, const RecordingPlan& plan) {
  const auto planned = static_cast<std::int64_t>(std::min(TicksOfEarlyEnd(contents).value_or(plan.ticks), plan.ticks));
  if (LossOf(contents).empty()) return {planned, plan.ticks_per_row};
  std::uint64_t last_ns = 0;  // of rows, not of events, which have ticks of their own
  for (const auto& [id, channel] : contents.channels)
    if (const auto topic = Topic::Parse(channel.topic); topic && topic->kind != TopicKind::kEvent)
      last_ns = std::max(last_ns, channel.last_time);
  const std::int64_t last = TickAt(last_ns, plan);
  return {last % plan.ticks_per_row == 0 ? planned : last + 1, plan.ticks_per_row};
}

RecordingPlan PlanOf(const McapContents& contents, const std::string& path) {
  if (const std::string why = TooNew(contents); !why.empty()) throw ConfigError({path + ": " + why});
  const auto attached = contents.attachments.find(kConfigFile);
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
  Section record = config.Child("record");
  const std::vector<std::string> patterns = record.Texts("topics");
  plan.ros_types = record.Boolean("ros_types");
  const auto rows_hz = static_cast<int>(record.Integer("rate_hz"));
  config.ThrowIfWrong();  // before `agents` is used as a size, and rates to divide by
  plan.ticks_per_row = rows_hz == 0 ? 1 : std::max(plan.rate_hz / rows_hz, 1);
  plan.lost = LostIn(config);
  const auto agents = static_cast<std::size_t>(plan.agents);
  plan.topics = TopicsOf(patterns, plan.ros_types, TakersIn(contents, agents), SendersOf(config, contents, agents));
  config.ThrowIfWrong();
  return plan;
}

std::string Proof::End(std::optional<std::uint64_t> planned_ticks) const {
  if (!ticks) return "";
  if (*ticks == 0) return "no tick is whole";
  return fmt::format("whole up to tick {}{}", *ticks - 1,
                     planned_ticks ? fmt::format(" of {}", *planned_ticks - 1) : "");
}

Proof Prove(const McapContents& contents, const RecordingPlan& plan) {
  const Counts counts = CountMessages(contents, plan);
  Proof proof{.gap = SequenceGap(contents), .rows = {}, .ticks = {}};
  if (proof.gap.empty() && LossOf(contents).empty())
    proof.gap = TopicGap(plan, counts, TicksOfEarlyEnd(contents).has_value());
  for (const Topic& topic : plan.topics)
    if (plan.IsInEveryRow(topic)) proof.rows = std::min(proof.rows.value_or(UINT64_MAX), counts.at(topic.Name()));
  if (proof.rows) proof.ticks = TicksUpTo(*proof.rows, TicksIn(contents, plan));
  return proof;
}

Verdict Judge(const std::string& path, const McapContents& contents) {
  Verdict verdict{.plan = PlanIn(contents, path), .reason = {}, .ticks = {}};
  verdict.reason = WhyIncomplete(path, contents, verdict);
  if (verdict.reason.empty()) verdict.ticks = Prove(contents, *verdict.plan).ticks;
  return verdict;
}

}  // namespace mascot
