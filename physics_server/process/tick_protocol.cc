#include "physics_server/process/tick_protocol.h"

#include <algorithm>
#include <utility>

#include "experiment/toml/section.h"
#include "physics_server/process/agents_text.h"

namespace mascot {

namespace {
constexpr auto kLookEvery = std::chrono::milliseconds(50);
/// The same while the gate holds a tick. It is also how often others learn that the run is held, not stuck.
constexpr auto kLookWhileHeldEvery = std::chrono::milliseconds(500);
/// The same while Hold() holds one, for processes that are about to be ready.
constexpr auto kLookForProcessesEvery = std::chrono::milliseconds(25);
/// Long beside most ticks, and short beside run.agent_timeout_s. After twice the time they are asked once more, and so
/// on: laws may be slow.
constexpr auto kAskAgainAfter = std::chrono::milliseconds(200);
}  // namespace

TickProtocol::TickProtocol(const Rules& rules)
    : rules_(rules),
      barrier_(rules.agents),
      answered_(static_cast<std::size_t>(rules.agents), -1),
      watch_(ProgressWatch::Seconds(rules.agent_timeout_s)),
      gate_(rules.period_s, rules.pace) {}

TickProtocol::Actions TickProtocol::Start() {
  running_ = true;
  NotePublished();
  return {.publish = true};
}

TickProtocol::Actions TickProtocol::OnRecorded(std::int64_t rows) {
  recorded_rows_ = rows;
  const bool may_wait = rules_.realtime || !gate_.IsOpen();  // the loop, for this row
  return {.publish = running_ && !finished_ && Publish(), .wake = may_wait};
}

TickProtocol::Actions TickProtocol::OnCommand(int id, std::int64_t tick, bool stop_requested) {
  std::int64_t& last = answered_[static_cast<std::size_t>(id - 1)];
  if (finished_ || tick > published_ || tick <= last || barrier_.Excludes(id)) return {};
  last = tick;
  Actions actions;
  if (barrier_.Answer(id, tick)) actions = EndOfAnswers(stop_requested);
  actions.take = true;
  return actions;
}

TickProtocol::Actions TickProtocol::EndOfAnswers(bool stop_requested) {
  Actions actions;
  if (published_ == rules_.last_tick || (stop_requested && !rules_.realtime))
    actions.wake = finished_ = true;
  else if (!rules_.realtime)
    actions = Step();
  else if (published_ == 0)
    actions.wake = paced_ = true;
  else
    actions.wake = gate_.paused();
  return actions;
}

TickProtocol::Actions TickProtocol::Lose(int id, bool unanswered) {
  barrier_.Exclude(id);
  if (unanswered) unanswered_ = published_;
  return {.wake = barrier_.IsComplete()};  // Look() goes on
}

void TickProtocol::NotePublished() {
  published_ = tick_;
  barrier_.Open(tick_);
}

bool TickProtocol::Publish() {
  if (!AwaitsPublication() || AwaitsRecorder() || held_ || !IsOpen()) return false;
  NotePublished();
  return true;
}

TickProtocol::Actions TickProtocol::Step() {
  ++tick_;
  return {.step = true, .publish = Publish(), .wake = !IsOpen()};
}

TickProtocol::Actions TickProtocol::Release() {
  held_ = false;
  if (rules_.realtime) gate_.SetPace(gate_.pace());  // the time that has gone by does not count
  return {.publish = running_ && !finished_ && Publish(), .wake = true};
}

TickProtocol::Turn TickProtocol::Look(Time now, bool stop_requested) {
  if (!running_ || finished_) return {};
  if (held_ && AwaitsPublication()) {
    finished_ = stop_requested;
    return finished_ ? Turn{} : Turn{.next_deadline = now + kLookForProcessesEvery, .held = true};
  }
  if (paced_) return LookAtClock(now, stop_requested);
  if (AwaitsPublication()) return AwaitsRecorder() ? Watch(now) : LookAtGate(now, stop_requested);
  if (!barrier_.IsComplete() && Rests(stop_requested)) {
    watch_.Rest();
    asked_ = -1;
    return {.next_deadline = now + kLookWhileHeldEvery, .held = true};
  }
  if (!barrier_.IsComplete()) return Watch(now);
  // The agents that had not answered are lost, so that the tick ends here and not in OnCommand().
  Turn turn{.actions = EndOfAnswers(stop_requested)};
  if (!finished_) turn.next_deadline = now;
  return turn;
}

bool TickProtocol::Rests(bool stop_requested) const {
  return !rules_.realtime && gate_.IsAtRest() && !stop_requested && published_ < rules_.last_tick;
}

TickProtocol::Turn TickProtocol::LookAtGate(Time now, bool stop_requested) {
  if (stop_requested) {
    finished_ = true;
    return {};
  }
  const std::optional<Time> opens = gate_.Opens(now);
  const Time next_deadline = now + kLookWhileHeldEvery;
  if (!opens || now < *opens)
    return {.next_deadline = std::min(next_deadline, opens.value_or(next_deadline)), .held = true};
  gate_.OnTick(now);
  NotePublished();
  return {.actions = {.publish = true}, .next_deadline = now + kLookEvery};
}

TickProtocol::Turn TickProtocol::LookAtClock(Time now, bool stop_requested) {
  if (stop_requested && (!timed_ || AwaitsRecorder() || gate_.paused())) {
    finished_ = true;
    return {};
  }
  // In real time a pause has no due times: its single steps wait for every command.
  if (AwaitsRecorder() || (gate_.paused() && !barrier_.Late().empty())) return Watch(now);
  const std::optional<Time> due = gate_.Opens(now);
  timed_ = true;
  if (!due) return {.next_deadline = now + kLookWhileHeldEvery, .held = true};
  return now < *due ? Turn{.next_deadline = due} : EndTick(*due, now, stop_requested);
}

TickProtocol::Turn TickProtocol::Watch(Time now) {
  // Before it confirms a row, the recorder may run the laws of all agents, one after the other, to measure.
  const ProgressWatch::Seconds grace(AwaitsRecorder() ? (rules_.agents - 1) * rules_.agent_timeout_s : 0);
  const std::int64_t progress = tick_ + published_;  // agents have their time from a tick's publication
  const bool overdue = watch_.IsOverdue(progress, now, grace);
  Turn turn{.actions = {.ask = AsksAgain(now)}, .next_deadline = now + kLookEvery};
  return overdue ? WithFailure(std::move(turn)) : turn;
}

bool TickProtocol::AsksAgain(Time now) {
  if (rules_.realtime || AwaitsPublication()) return false;
  if (std::exchange(asked_, published_) != published_) {
    asked_at_ = now;
    ask_after_ = kAskAgainAfter;
  }
  if (now - asked_at_ < ask_after_) return false;
  asked_at_ = now;
  ask_after_ *= 2;
  return true;
}

TickProtocol::Turn TickProtocol::EndTick(Time due, Time now, bool stop_requested) {
  if (const auto silent = HeldTooLong(); !silent.empty())
    return {.next_deadline = now, .failure = NoCommandFrom(silent), .late = silent};
  gate_.OnTick(now);
  Turn turn{.actions = Step(), .due = due};
  paced_ = tick_ < rules_.last_tick;
  finished_ = stop_requested;
  if (!finished_) turn.next_deadline = now;
  return turn;
}

std::vector<int> TickProtocol::HeldTooLong() const {
  const double period_s = rules_.period_s / gate_.pace();  // of the wall clock
  std::vector<int> ids;
  for (int id = 1; id <= rules_.agents; ++id)
    if (!barrier_.Excludes(id) && static_cast<double>(published_ - answered(id)) * period_s > rules_.agent_timeout_s)
      ids.push_back(id);
  return ids;
}

std::string TickProtocol::NoCommandFrom(const std::vector<int>& agents) const {
  return "tick " + std::to_string(tick_) + ": no command from " + AgentsText(agents) +
         " within run.agent_timeout_s = " + ShortestFloat(rules_.agent_timeout_s) + " s";
}

TickProtocol::Turn TickProtocol::WithFailure(Turn turn) const {
  if (AwaitsRecorder()) {
    turn.failure = "tick " + std::to_string(tick_) + ": the recorder has confirmed only " +
                   std::to_string(recorded_rows_) + " ticks, nothing within " + std::to_string(rules_.agents) +
                   " times run.agent_timeout_s = " + ShortestFloat(rules_.agent_timeout_s) + " s";
  } else {
    turn.late = barrier_.Late();
    turn.failure = NoCommandFrom(turn.late);
  }
  return turn;
}

}  // namespace mascot
