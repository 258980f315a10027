#include "orchestrator/engines/dds/recorder.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "bus/wire.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

/// Rows a command may lag behind in real time before its row is written without it. Below the window of
/// the server's flow control, which would otherwise wait for us.
constexpr std::int64_t kPatience = kRecorderWindow / 2;
/// Complete rows that are worth waking the writing thread for; well below that window.
constexpr std::int64_t kBatch = 8;
/// After so long the server is told what has been written. A slow law makes rows slow: what is measured beside them
/// asks the laws of all agents, one after the other.
constexpr auto kLongEnough = std::chrono::milliseconds(50);

template <class T>
T ReadAt(const RawReader::Bytes& bytes, std::size_t offset) {
  T value;
  if (bytes.size() < offset + sizeof value)
    throw std::runtime_error("a sample of only " + std::to_string(bytes.size()) + " bytes");
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace

Recorder::Recorder(Domain& domain, const Experiment& experiment, RowFeed& feed)
    : domain_(domain),
      experiment_(experiment),
      feed_(feed),
      realtime_(experiment.run.mode == Mode::kRealtime),
      slots_(kHistoryDepth),
      taken_(experiment.size()) {
  for (Slot& slot : slots_) slot.row = Row(experiment.size());
  std::vector<Topic> topics{Topic::Clock()};
  for (const AgentConfig& agent : experiment.agents) {
    topics.push_back(Topic::State(agent.id));
    topics.push_back(Topic::Command(agent.id));
    if (agent.sends_messages) topics.push_back(Topic::Message(agent.id));
  }
  sequences_.assign(topics.size(), 0);
  for (std::size_t index = 0; index < topics.size(); ++index)
    readers_.push_back(std::make_unique<RawReader>(
        domain, topics[index],
        [this, index, topic = topics[index]](const RawReader::Bytes& bytes, std::int64_t sequence) {
          OnSample(index, topic, bytes, sequence);
        }));
}

bool Recorder::Matched() const {
  return std::all_of(readers_.begin(), readers_.end(), [](const auto& reader) { return reader->matched() >= 1; });
}

std::int64_t Recorder::TickOf(const Topic& topic, const RawReader::Bytes& bytes) const {
  constexpr std::size_t kEncapsulation = 4, kStamp = 8;  // idl/mascot.idl: stamp first, then tick
  if (topic.kind != TopicKind::kClock) return ReadAt<std::int64_t>(bytes, kEncapsulation + kStamp);
  const auto rate = static_cast<std::uint64_t>(experiment_.control.rate_hz);
  const auto seconds = ReadAt<std::uint32_t>(bytes, kEncapsulation);
  const auto nanoseconds = ReadAt<std::uint32_t>(bytes, kEncapsulation + 4);
  return static_cast<std::int64_t>(seconds * rate + (nanoseconds * rate + 500'000'000) / 1'000'000'000);
}

void Recorder::CheckSequence(std::size_t index, const Topic& topic, std::int64_t sequence) {
  const std::int64_t missing = sequence - sequences_[index] - 1;
  const bool may_lack = realtime_ && topic.kind != TopicKind::kClock && topic.kind != TopicKind::kState;
  if (missing > 0 && may_lack) {  // nobody waits for these: agents that hurry may write over what is not read yet
    lost_ += static_cast<std::uint64_t>(missing);
  } else if (missing != 0) {
    lost_ += static_cast<std::uint64_t>(std::max<std::int64_t>(missing, 1));
    throw std::runtime_error("the recording is not complete: " + topic.Name() + ": sample " + std::to_string(sequence) +
                             " came after sample " + std::to_string(sequences_[index]));
  }
  sequences_[index] = sequence;
}

void Recorder::OnSample(std::size_t index, const Topic& topic, const RawReader::Bytes& bytes, std::int64_t sequence) {
  const std::int64_t tick = TickOf(topic, bytes);
  const std::lock_guard lock(mutex_);
  CheckSequence(index, topic, sequence);
  if (tick < written_) {  // its row is closed: only in real time, after kPatience
    ++lost_;
    return;
  }
  Slot& slot = SlotOf(tick);
  if (slot.tick != tick) {
    if (slot.tick >= written_ || tick >= written_ + std::ssize(slots_))
      throw std::runtime_error("the recorder was overrun: tick " + std::to_string(tick) + " came while tick " +
                               std::to_string(written_) + " was not written");
    slot.tick = tick;
    slot.samples = slot.states = 0;
    for (auto& command : slot.row.commands) command.clear();
    for (auto& message : slot.row.messages) message.clear();
  }
  SampleOf(slot.row, topic).assign(bytes.begin(), bytes.end());
  ++slot.samples;
  if (topic.kind == TopicKind::kState || topic.kind == TopicKind::kClock) ++slot.states;
  if (newest_ < 0) started_ = WallClock::now();
  newest_ = std::max(newest_, tick);
  if (topic.kind == TopicKind::kCommand) last_command_ = WallClock::now();
  if (slot.samples == std::ssize(sequences_)) ++complete_;
  if (complete_ >= kBatch || tick == experiment_.ticks() || newest_ - written_ == kPatience) domain_.Wake();
}

bool Recorder::IsReady(const Slot& slot, bool give_up) const {
  if (slot.tick != written_) return false;
  if (slot.samples == std::ssize(sequences_)) return true;
  const bool states_complete = slot.states == experiment_.size() + 1;
  return realtime_ && states_complete && (give_up || newest_ - slot.tick >= kPatience);
}

std::int64_t Recorder::Drain(bool give_up) {
  for (const auto enough = WallClock::now() + kLongEnough;;) {
    if (WallClock::now() > enough) {
      domain_.Wake();  // there may be more
      return written_;
    }
    {
      const std::lock_guard lock(mutex_);
      complete_ = 0;
      Slot& slot = SlotOf(written_);
      if (!IsReady(slot, give_up)) return written_;
      taken_.tick = slot.tick;
      std::swap(taken_.clock, slot.row.clock);
      std::swap(taken_.states, slot.row.states);
      std::swap(taken_.commands, slot.row.commands);
      std::swap(taken_.messages, slot.row.messages);
      ++written_;
    }
    feed_.Add(taken_);
  }
}

std::uint64_t Recorder::lost() const {
  const std::lock_guard lock(mutex_);
  return lost_;
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
  return newest_;
}

}  // namespace mascot
