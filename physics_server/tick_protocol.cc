#include "physics_server/tick_protocol.h"

#include <algorithm>

#include "experiment/toml/section.h"
#include "physics_server/agents_text.h"

namespace mascot {

namespace {
constexpr auto kLookEvery = std::chrono::milliseconds(50);
}  // namespace

TickProtocol::TickProtocol(const Rules& rules)
    : rules_(rules),
      barrier_(rules.agents),
      answered_(static_cast<std::size_t>(rules.agents), -1),
      watch_(ProgressWatch::Seconds(rules.agent_timeout_s)) {}

TickProtocol::Actions TickProtocol::Start() {
  running_ = true;
  return {.publish = Publish()};
}

TickProtocol::Actions TickProtocol::OnRecorded(std::int64_t rows) {
  recorded_rows_ = rows;
  return {.publish = running_ && !finished_ && Publish(), .wake = IsRealtime()};  // the loop may wait for this row
}

TickProtocol::Actions TickProtocol::OnCommand(int id, std::int64_t tick, bool stop_requested) {
  std::int64_t& last = answered_[static_cast<std::size_t>(id - 1)];
  if (finished_ || tick > published_ || tick <= last) return {};
  last = tick;
  Actions actions;
  if (barrier_.Answer(id, tick)) {
    if (tick == rules_.last_tick || (stop_requested && !IsRealtime()))
      actions.wake = finished_ = true;
    else if (!IsRealtime())
      actions = Step();
    else if (tick == 0)
      actions.wake = paced_ = true;
  }
  actions.take = true;
  return actions;
}

bool TickProtocol::Publish() {
  if (!AwaitsRecorder() || recorded_rows_ <= tick_ - rules_.recorder_window) return false;
  published_ = tick_;
  barrier_.Open(tick_);
  return true;
}

TickProtocol::Actions TickProtocol::Step() {
  ++tick_;
  return {.step = true, .publish = Publish()};
}

TickProtocol::Turn TickProtocol::Look(Time now, bool stop_requested) {
  if (!running_ || finished_) return {};
  if (!paced_) return Watch(now);
  if (stop_requested && (!timetable_ || AwaitsRecorder())) {
    finished_ = true;
    return {};
  }
  if (AwaitsRecorder()) return Watch(now);
  if (!timetable_) timetable_.emplace(*rules_.period_s, now);
  const Time due = timetable_->Due(tick_ + 1);
  return now < due ? Turn{.look_again = due} : EndTick(due, now, stop_requested);
}

TickProtocol::Turn TickProtocol::Watch(Time now) {
  // Before it confirms a row, the recorder may run the laws of all agents, one after the other, to measure.
  const ProgressWatch::Seconds grace(AwaitsRecorder() ? (rules_.agents - 1) * rules_.agent_timeout_s : 0);
  const std::int64_t progress = tick_ + published_;  // agents have their time from a tick's publication
  const bool overdue = watch_.IsOverdue(progress, now, grace);
  return {.look_again = now + kLookEvery, .failure = overdue ? WhoIsLate() : ""};
}

TickProtocol::Turn TickProtocol::EndTick(Time due, Time now, bool stop_requested) {
  if (const auto silent = HeldTooLong(); !silent.empty()) return {.due = due, .failure = NoCommandFrom(silent)};
  timetable_->OnTick(tick_ + 1, now);
  Turn turn{.actions = Step(), .due = due};
  paced_ = tick_ < rules_.last_tick;
  finished_ = stop_requested;
  if (!finished_) turn.look_again = now;
  return turn;
}

std::vector<int> TickProtocol::HeldTooLong() const {
  std::vector<int> ids;
  for (int id = 1; id <= rules_.agents; ++id)
    if (static_cast<double>(published_ - answered(id)) * *rules_.period_s > rules_.agent_timeout_s) ids.push_back(id);
  return ids;
}

std::string TickProtocol::NoCommandFrom(const std::vector<int>& agents) const {
  return "tick " + std::to_string(tick_) + ": no command from " + AgentsText(agents) +
         " within run.agent_timeout_s = " + ShortestFloat(rules_.agent_timeout_s) + " s";
}

std::string TickProtocol::WhoIsLate() const {
  if (!AwaitsRecorder()) return NoCommandFrom(barrier_.Late());
  return "tick " + std::to_string(tick_) + ": the recorder has confirmed only " + std::to_string(recorded_rows_) +
         " ticks, nothing within " + std::to_string(rules_.agents) +
         " times run.agent_timeout_s = " + ShortestFloat(rules_.agent_timeout_s) + " s";
}

}  // namespace mascot
