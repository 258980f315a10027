#include "orchestrator/engines/dds/recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "bus/bundle.h"
#include "bus/wire.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

/// In real time, a row that lacks a command is written when the newest tick is this far ahead. Smaller than the
/// window of the server's flow control: otherwise the server would wait for the recorder.
constexpr std::int64_t kPatience = kRecorderWindow / 2;
/// Number of complete rows at which the writing thread is woken; well below the same window.
constexpr std::int64_t kBatch = 8;
/// Longest time that Drain takes before it returns, so that the server learns what has been recorded. A row may be
/// slow: the metrics evaluate the laws of all agents for it, one after the other.
constexpr auto kLongEnough = std::chrono::milliseconds(50);

// Places in a sample, after the encapsulation (idl/mascot.idl). An event has its number in the place of the agent.
constexpr std::size_t kStamp = 4, kTick = 12, kAgent = 20, kEvents = 24;

template <class T>
T ReadAt(const RawReader::Bytes& bytes, std::size_t offset) {
  T value;
  if (bytes.size() < offset + sizeof value)
    throw std::runtime_error("a sample of only " + std::to_string(bytes.size()) + " bytes");
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

RowWindow::Rules WindowRules(const Experiment& experiment, bool stepped) {
  RowWindow::Rules rules{.topics = {Topic::Clock()},
                         .agents = experiment.size(),
                         .last_tick = experiment.ticks(),
                         .realtime = experiment.run.mode == Mode::kRealtime,
                         .ticks = kHistoryDepth,
                         .patience = kPatience,
                         .batch = kBatch,
                         .stepped = stepped};
  // What is sent in bundles has gone through the server, which leaves out what an event leaves unanswered.
  rules.doubts =
      !experiment.network.is_bundled() && !rules.realtime && experiment.run.on_agent_loss != OnAgentLoss::kAbort;
  for (const AgentConfig& agent : experiment.agents) {
    rules.topics.push_back(Topic::State(agent.id));
    rules.topics.push_back(Topic::Command(agent.id));
    if (agent.sends_messages) rules.topics.push_back(Topic::Message(agent.id));
    if (agent.takes_actions) rules.topics.push_back(Topic::Action(agent.id));
  }
  return rules;
}

}  // namespace

Recorder::Recorder(Domain& domain, const Experiment& experiment, RowFeed& feed, bool stepped)
    : domain_(domain),
      experiment_(experiment),
      feed_(feed),
      window_(WindowRules(experiment, stepped)),
      taken_(experiment.size()) {
  for (std::vector<std::size_t>* indices : {&states_, &commands_, &messages_, &actions_})
    indices->resize(experiment.agents.size());
  for (std::size_t index = 0; index < window_.topics().size(); ++index)
    if (const Topic& topic = window_.topics()[index]; topic.agent > 0)
      IndicesOf(topic.kind)[static_cast<std::size_t>(topic.agent - 1)] = index;
  if (experiment.network.is_bundled())
    ListenToRows();
  else
    ListenToTopics();
  readers_.push_back(std::make_unique<RawReader>(
      domain, Topic::Event(),
      [this](const RawReader::Bytes& bytes, const Sender& sender) { OnEvent(bytes, sender.sequence); }));
}

std::vector<std::size_t>& Recorder::IndicesOf(TopicKind kind) {
  return kind == TopicKind::kState     ? states_
         : kind == TopicKind::kCommand ? commands_
         : kind == TopicKind::kMessage ? messages_
                                       : actions_;
}

void Recorder::ListenToTopics() {
  const std::vector<Topic>& topics = window_.topics();
  for (std::size_t index = 0; index < topics.size(); ++index) {
    if (topics[index].kind == TopicKind::kAction) continue;  // comes from here (TakeAction)
    readers_.push_back(std::make_unique<RawReader>(
        domain_, topics[index],
        [this, index, topic = topics[index]](const RawReader::Bytes& bytes, const Sender& sender) {
          OnSample(index, topic, bytes, sender.sequence);
        }));
  }
}

void Recorder::ListenToRows() {
  readers_.push_back(std::make_unique<RawReader>(
      domain_, Topic::Row(),
      [this](const RawReader::Bytes& bytes, const Sender& sender) { OnRow(bytes, sender.sequence); }));
}

bool Recorder::Matched() const {
  return std::all_of(readers_.begin(), readers_.end(), [](const auto& reader) { return reader->matched() >= 1; });
}

std::int64_t Recorder::TickOf(const Topic& topic, const RawReader::Bytes& bytes) const {
  if (topic.kind != TopicKind::kClock)
    return CheckedTick(topic, ReadAt<std::uint32_t>(bytes, kAgent), ReadAt<std::uint64_t>(bytes, kTick),
                       experiment_.ticks());
  const auto rate = static_cast<std::uint64_t>(experiment_.control.rate_hz);
  const auto seconds = ReadAt<std::uint32_t>(bytes, kStamp);
  const auto nanoseconds = ReadAt<std::uint32_t>(bytes, kStamp + 4);
  return CheckedTick(topic, 0, seconds * rate + (nanoseconds * rate + 500'000'000) / 1'000'000'000,
                     experiment_.ticks());
}

void Recorder::OnSample(std::size_t index, const Topic& topic, const RawReader::Bytes& bytes, std::int64_t sequence) {
  const std::int64_t tick = TickOf(topic, bytes);
  const std::int64_t events = topic.kind == TopicKind::kState ? ReadAt<std::uint32_t>(bytes, kEvents) : 0;
  const std::lock_guard lock(mutex_);
  window_.CheckSequence(index, sequence);
  if (Take(index, tick, bytes, events)) domain_.Wake();
}

bool Recorder::Take(std::size_t index, std::int64_t tick, std::span<const std::uint8_t> bytes, std::int64_t events) {
  const bool first = window_.newest_tick() < 0, in_time = tick >= window_.rows();
  const bool wake = window_.Take(index, tick, bytes, events);
  if (first && in_time) started_ = WallClock::now();
  if (window_.topics()[index].kind == TopicKind::kCommand && in_time) last_command_ = WallClock::now();
  return wake;
}

bool Recorder::TakeBody(std::size_t index, std::span<const std::uint8_t> body) {
  const Topic& topic = window_.topics()[index];
  const BodyHead head = HeadOf(body.data());
  const std::int64_t tick = CheckedTick(topic, head.agent, head.tick, experiment_.ticks());
  std::ranges::copy(body, BodyIn(sample_, body.size()));
  return Take(index, tick, sample_, topic.kind == TopicKind::kState ? head.more : 0);
}

void Recorder::OnRow(const RawReader::Bytes& bytes, std::int64_t sequence) {
  BundleReader row(bytes);
  const BundleReader::Section states = row.Next(kStateBody), commands = row.Next(kCommandBody);
  const auto messages = row.NextMessages();
  row.End();
  const auto index_of = [&](const std::vector<std::size_t>& indices, std::span<const std::uint8_t> body) {
    const std::size_t i = HeadOf(body.data()).agent - std::size_t{1};
    const std::size_t index = i < indices.size() ? indices[i] : 0;
    if (index == 0) throw std::runtime_error(fmt::format("/row: a sample of agent {}, which sends none", i + 1));
    return index;
  };
  const std::lock_guard lock(mutex_);
  if (sequence != newest_row_ + 1)
    throw std::runtime_error(
        fmt::format("the recording is not complete: /row: sample {} came after sample {}", sequence, newest_row_));
  newest_row_ = sequence;
  bool wake = false;
  for (std::size_t k = 0; k < commands.count; ++k) wake |= TakeBody(index_of(commands_, commands[k]), commands[k]);
  for (const auto& message : messages) wake |= TakeBody(index_of(messages_, message), message);
  if (states.count > 0) {
    const auto tick = static_cast<std::int64_t>(row.tick());
    PutClock(tick, experiment_.control.rate_hz, BodyIn(sample_, kClockBody));
    wake |= Take(/*index=*/0, tick, sample_, /*events=*/0);
  }
  for (std::size_t k = 0; k < states.count; ++k) wake |= TakeBody(index_of(states_, states[k]), states[k]);
  if (wake) domain_.Wake();
}

void Recorder::OnEvent(const RawReader::Bytes& bytes, std::int64_t sequence) {
  CheckedTick(Topic::Event(), 0, ReadAt<std::uint64_t>(bytes, kTick), experiment_.ticks());
  mascot_msgs::msg::Event sample;
  Deserialize(bytes, sample);
  const Event event = FromWire(sample, experiment_.size());
  const std::lock_guard lock(mutex_);
  const bool wake = window_.TakeEvent(event, bytes, sequence);
  events_.push_back(std::move(sample));
  if (wake) domain_.Wake();
}

std::vector<mascot_msgs::msg::Event> Recorder::Events(std::size_t skip) const {
  const std::lock_guard lock(mutex_);
  if (skip >= events_.size()) return {};
  return {events_.begin() + static_cast<std::ptrdiff_t>(skip), events_.end()};
}

bool Recorder::HasStates(std::int64_t tick) const {
  const std::lock_guard lock(mutex_);
  return window_.HasStates(tick);
}

void Recorder::StatesOf(std::int64_t tick, std::span<Motion> motions) const {
  const std::lock_guard lock(mutex_);
  DecodeStates(window_.RowOf(tick), motions);
}

bool Recorder::TakeAction(int agent, std::int64_t tick, std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  if (window_.IsSilent(Topic::Action(agent), tick)) return false;
  window_.Take(actions_[static_cast<std::size_t>(agent - 1)], tick, bytes);
  return true;
}

void Recorder::EndActions(std::int64_t tick) {
  const std::lock_guard lock(mutex_);
  window_.EndActions(tick);
}

void Recorder::Settle() {
  const std::lock_guard lock(mutex_);
  window_.Settle();
}

bool Recorder::AreLost(AgentRange agents) const {
  const std::lock_guard lock(mutex_);
  for (int id = agents.first; id <= agents.last; ++id)
    if (!window_.IsLost(id)) return false;
  return true;
}

std::int64_t Recorder::Drain(bool give_up) {
  for (const auto enough = WallClock::now() + kLongEnough;;) {
    const bool is_late = WallClock::now() > enough;
    {
      const std::lock_guard lock(mutex_);
      if (is_late) domain_.Wake();  // there may be more rows
      if (is_late || !window_.Next(give_up, taken_)) return window_.rows();
    }
    feed_.Add(taken_);
  }
}

std::string Recorder::Lacking() const {
  const std::lock_guard lock(mutex_);
  return window_.Lacking();
}

std::uint64_t Recorder::lost() const {
  const std::lock_guard lock(mutex_);
  return window_.lost();
}

double Recorder::wall_s() const {
  const std::lock_guard lock(mutex_);
  return std::max(0.0, std::chrono::duration<double>(last_command_ - started_).count());
}

std::chrono::steady_clock::time_point Recorder::started() const {
  const std::lock_guard lock(mutex_);
  return started_;
}

std::int64_t Recorder::newest_tick() const {
  const std::lock_guard lock(mutex_);
  return window_.newest_tick();
}

}  // namespace mascot
