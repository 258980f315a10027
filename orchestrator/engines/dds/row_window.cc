#include "orchestrator/engines/dds/row_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "orchestrator/recording/row_codec.h"

namespace mascot {

RowWindow::RowWindow(Rules rules)
    : rules_(std::move(rules)),
      awaits_actions_(rules_.stepped || std::ranges::count(rules_.topics, TopicKind::kAction, &Topic::kind) > 0),
      slots_(static_cast<std::size_t>(rules_.ticks)),
      sequences_(rules_.topics.size(), 0) {
  for (Slot& slot : slots_) slot.row = Row(rules_.agents);
}

void RowWindow::CheckSequence(std::size_t index, std::int64_t sequence) {
  const TopicKind kind = rules_.topics[index].kind;
  const std::int64_t missing = sequence - sequences_[index] - 1;
  const bool may_lack = rules_.realtime && TraitsOf(kind).rhythm == TopicRhythm::kAnswer;
  if (missing > 0 && may_lack) {  // no flow control here: a writer may overwrite samples that are not read yet
    lost_ += static_cast<std::uint64_t>(missing);
  } else if (missing != 0) {
    lost_ += static_cast<std::uint64_t>(std::max<std::int64_t>(missing, 1));
    throw std::runtime_error(fmt::format("the recording is not complete: {}: sample {} came after sample {}",
                                         rules_.topics[index].Name(), sequence, sequences_[index]));
  }
  sequences_[index] = sequence;
}

void RowWindow::Begin(Slot& slot, std::int64_t tick) const {
  if (slot.tick >= rows_ || tick >= rows_ + std::ssize(slots_))
    throw std::runtime_error(
        fmt::format("the recorder was overrun: tick {} came while tick {} was not written", tick, rows_));
  slot.tick = tick;
  slot.row.tick = tick;
  slot.samples = 0;
  slot.states = 0;
  slot.events = 0;
  slot.row.clock.clear();
  slot.row.events.clear();
  for (auto* const samples : {&slot.row.states, &slot.row.commands, &slot.row.messages, &slot.row.actions})
    for (Row::Bytes& sample : *samples) sample.clear();
}

bool RowWindow::Take(std::size_t index, std::int64_t tick, std::span<const std::uint8_t> bytes, std::int64_t events) {
  if (tick < rows_) {  // its row was taken without it: only in real time
    ++lost_;
    return false;
  }
  Slot& slot = SlotOf(tick);
  if (slot.tick != tick) Begin(slot, tick);
  const Topic& topic = rules_.topics[index];
  Row::Bytes& sample = SampleOf(slot.row, topic);
  if (!sample.empty())
    throw std::runtime_error(fmt::format("the recording is not complete: {}: tick {} came twice", topic.Name(), tick));
  sample.assign(bytes.begin(), bytes.end());
  ++slot.samples;
  slot.events = std::max(slot.events, events);
  if (topic.kind == TopicKind::kState || topic.kind == TopicKind::kClock) ++slot.states;
  newest_ = std::max(newest_, tick);
  const bool completes = slot.samples + silent_ == rules_.topics.size();
  complete_ += completes;
  return complete_ >= rules_.batch || tick == rules_.last_tick || newest_ - rows_ == rules_.patience ||
         (awaits_actions_ && (completes || (tick > acted_ && HasStates(tick))));
}

bool RowWindow::TakeEvent(const Event& event, std::span<const std::uint8_t> bytes, std::int64_t sequence) {
  if (sequence != newest_event_ + 1 || event.tick < rows_)
    throw std::runtime_error(fmt::format("the recording is not complete: {}: event {} came after event {}, at tick {}",
                                         Topic::Event().Name(), sequence, newest_event_, rows_));
  if (event.fault && event.fault->unanswered && event.tick <= rows_)
    throw std::runtime_error(
        fmt::format("the recording is not complete: it has a command of agent {} at tick {}, which "
                    "has not reached the physics server",
                    event.fault->agent, event.tick - 1));
  newest_event_ = sequence;
  silences_.Take(event);
  silent_ = silences_.empty() ? 0
                              : static_cast<std::size_t>(std::ranges::count_if(
                                    rules_.topics, [&](const Topic& topic) { return IsSilent(topic, event.tick); }));
  Slot& slot = SlotOf(event.tick);
  if (slot.tick != event.tick) Begin(slot, event.tick);
  slot.row.events.emplace_back(bytes.begin(), bytes.end());
  return true;
}

bool RowWindow::IsSilent(const Topic& topic, std::int64_t tick) const {
  return topic.traits().rhythm == TopicRhythm::kAnswer && silences_.Has(topic.agent, tick);
}

bool RowWindow::HasStates(std::int64_t tick) const {
  const Slot& slot = slots_[PlaceOf(tick)];
  return slot.tick == tick && slot.states == rules_.agents + 1 && slot.events <= newest_event_;
}

bool RowWindow::IsWhole(const Slot& slot) const {
  if (silences_.empty()) return slot.samples == rules_.topics.size();
  return slot.states == rules_.agents + 1 &&
         std::ranges::none_of(rules_.topics, [&](const Topic& topic) { return Lacks(slot, topic); });
}

bool RowWindow::Lacks(const Slot& slot, const Topic& topic) const {
  return topic.traits().rhythm == TopicRhythm::kAnswer && !IsSilent(topic, slot.tick) &&
         SampleOf(slot.row, topic).empty();
}

bool RowWindow::IsReady(const Slot& slot, bool give_up) {
  if (slot.tick != rows_ || slot.events > events_ + std::ssize(slot.row.events)) return false;
  if (awaits_actions_ && slot.tick > acted_) return false;
  if (rules_.doubts && !settled_ && !give_up && slot.tick < rules_.last_tick && !HasStates(slot.tick + 1)) return false;
  if (IsWhole(slot)) return true;
  const bool states_complete = slot.states == rules_.agents + 1;
  return rules_.realtime && states_complete && (give_up || newest_ - slot.tick >= rules_.patience);
}

std::string RowWindow::Lacking() const {
  const Slot& slot = slots_[PlaceOf(rows_)];
  if (slot.tick != rows_) return "";
  std::string names;
  for (const Topic& topic : rules_.topics)
    if (Lacks(slot, topic)) names += (names.empty() ? "" : ", ") + topic.Name();
  return names.empty() ? "" : fmt::format("{} of tick {}", names, rows_);
}

void RowWindow::LeaveOut(Slot& slot) {
  if (!silences_.empty())  // what came too late, and was not taken by the server
    for (const Topic& topic : rules_.topics)
      if (IsSilent(topic, slot.tick)) SampleOf(slot.row, topic).clear();
  if (rules_.realtime && awaits_actions_)  // an agent that has missed the tick did not take its action
    for (std::size_t i = 0; i < slot.row.actions.size(); ++i)
      if (slot.row.commands[i].empty()) slot.row.actions[i].clear();
}

bool RowWindow::Next(bool give_up, Row& row) {
  complete_ = 0;
  Slot& slot = SlotOf(rows_);
  if (!IsReady(slot, give_up)) return false;
  LeaveOut(slot);
  row.tick = slot.tick;
  std::swap(row.clock, slot.row.clock);
  std::swap(row.states, slot.row.states);
  std::swap(row.commands, slot.row.commands);
  std::swap(row.messages, slot.row.messages);
  std::swap(row.actions, slot.row.actions);
  std::swap(row.events, slot.row.events);
  events_ += std::ssize(row.events);
  ++rows_;
  return true;
}

}  // namespace mascot
