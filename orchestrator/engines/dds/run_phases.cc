#include "orchestrator/engines/dds/run_phases.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "experiment/toml/section.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using Seconds = std::chrono::duration<double>;

/// How long an orderly stop may take before the run is ended by force; also how long the server may be silent beyond
/// the agents' timeout, and, in lockstep, how long the last rows may take.
constexpr auto kGrace = 5s;
/// In real time, how long the last rows wait for missing commands, which may never have been sent. A sample that was
/// lost on its way is repaired after about 1.1 s (bus/qos.cc).
constexpr auto kRealtimeDrain = 3s;
/// Time beyond run.start_timeout_s. The server itself fails after that timeout, with a better error message than ours.
constexpr auto kStartGrace = 5s;
/// When systemd or a batch system ends a job, it signals all processes of the job, and the orchestrator perhaps a
/// little later than its children. For this long, an exit by a signal may thus be part of an orderly stop.
constexpr auto kSameSignal = 100ms;
/// How long the server's report may take: a killed process may have held a shared-memory lock that delays the server.
constexpr auto kReport = 10s;
/// How long the report of a server that has exited may take to arrive.
constexpr auto kLateReport = 1s;

RunPhases::Time After(RunPhases::Time time, Seconds span) {
  return time + std::chrono::duration_cast<RunPhases::Time::duration>(span);
}

std::string DiffersFromTheGraph(const std::string& how) { return "the wire differs from the graph: " + how; }

}  // namespace

std::string StoryOfEnd(const std::string& process, const std::string& end, std::vector<std::string> lines) {
  constexpr std::string_view kError = "error: ";
  std::string story = process + " " + end;
  const auto error = std::ranges::find_if(lines, [&](const std::string& line) { return line.starts_with(kError); });
  if (error != lines.end()) {
    story = process + ": " + error->substr(kError.size()) + " (" + end + ")";
    lines.erase(error);
  }
  for (const std::string& line : lines) story += "\n  " + process + " | " + line;
  return story;
}

RunPhases::RunPhases(Rules rules, Time launched)
    : rules_(std::move(rules)),
      launched_(launched),
      watch_(Seconds(rules_.agent_timeout_s + rules_.period_s) + kGrace) {}

void RunPhases::Finish() { phase_ = std::max(phase_, Phase::kCollecting); }

void RunPhases::Note(const std::string& why) {
  if (!failure_.empty()) return;
  const std::string violation = rules_.violation();
  failure_ = !violation.empty() ? DiffersFromTheGraph(violation)
             : !why.empty()     ? why
                                : "something failed without a word";
}

void RunPhases::OnViolation(const std::string& violation) {
  if (failure_.empty()) failure_ = DiffersFromTheGraph(violation);
  Finish();
}

void RunPhases::Fail(const std::string& why) {
  JudgeExits();  // they happened first
  Note(why);
  Finish();
}

RunPhases::Actions RunPhases::OnSignal(int signal, Time now) {
  if (phase_ >= Phase::kReporting) {
    phase_ = Phase::kEnding;
    return {};
  }
  if (signal_ != 0) {
    server_silent_ = true;
    Finish();
    return {.kill = true};
  }
  signal_ = signal;
  JudgeExits();
  if (phase_ == Phase::kStarting) Finish();  // no tick yet: there is nothing to stop in order
  stop_deadline_ = now + kGrace;
  return {.ask_to_stop = true};
}

RunPhases::Actions RunPhases::OnRequestToStop(Time now) {
  if (IsOver() || stop_deadline_) return {};
  if (phase_ == Phase::kStarting) Finish();  // as OnSignal does
  stop_deadline_ = now + kGrace;
  return {.ask_to_stop = true};
}

void RunPhases::OnExits(const std::vector<Exit>& exits, Time now) {
  for (const Exit& exit : exits)
    if (exit.process == "physics_server") (exit.code ? server_exited_ : server_silent_) = true;
  if (exits.empty() || IsOver()) return;
  exits_.insert(exits_.end(), exits.begin(), exits.end());
  const bool by_signal = std::ranges::any_of(exits_, [](const Exit& exit) { return exit.code.value_or(0) > 128; });
  if (by_signal && signal_ == 0)
    exits_deadline_ = exits_deadline_.value_or(now + kSameSignal);
  else
    JudgeExits();
}

/// Children that were ended by the signal that also stopped the run have not failed.
void RunPhases::JudgeExits() {
  exits_deadline_.reset();
  if (exits_.empty()) return;
  std::string why;
  bool goes_on = true;
  for (const Exit& exit : std::exchange(exits_, {})) {
    const bool by_the_signal = signal_ != 0 && exit.code == 128 + signal_;
    std::string story = by_the_signal ? "" : StoryOfEnd(exit.process, exit.text, rules_.last_lines(exit.process));
    // Once it has begun, an event may have ended it.
    const bool has_begun = phase_ == Phase::kFlying || phase_ == Phase::kDraining || rules_.waits_for_people();
    if (!by_the_signal && has_begun && rules_.is_loss(exit.process)) {
      losses_.emplace_back(exit.process, std::move(story));
      continue;
    }
    goes_on = false;
    if (by_the_signal) continue;
    why += (why.empty() ? "" : "\n") + story;
  }
  if (goes_on) return;
  if (!why.empty()) Note(why);
  Finish();
}

RunPhases::Actions RunPhases::Look(const View& view, Time now) {
  if (phase_ == Phase::kReporting) LookAtReport(view, now);
  if (IsOver()) return {};
  if (exits_deadline_) {
    if (now > *exits_deadline_) JudgeExits();
    return {};
  }
  if (view.newest_tick >= 0 && phase_ == Phase::kStarting) phase_ = Phase::kFlying;
  const bool ready = phase_ == Phase::kStarting && view.everybody_found;
  found_everybody_ |= ready;
  LookAtDraining(view, now);
  if (!IsOver()) LookAtDeadlines(view, now);
  rows_ = view.rows;
  return {.say_ready = ready};
}

void RunPhases::LookAtDraining(const View& view, Time now) {
  if (!view.last_tick) return;
  const std::int64_t rows = *view.last_tick + 1;
  if (view.rows == rows) return Finish();
  if (view.gave_up && view.rows <= rows_)
    return Fail(fmt::format("the recording is not complete: {} of {} ticks", view.rows, rows));
  if (drain_deadline_) return;
  phase_ = Phase::kDraining;
  drain_deadline_ = rules_.period_s > 0 ? now + kRealtimeDrain : now + kGrace;
}

void RunPhases::LookAtDeadlines(const View& view, Time now) {
  if (stop_deadline_ && now > *stop_deadline_)  // and record what has come
    return signal_ != 0 ? Finish() : Fail("asked to stop, physics_server did not within 5 s");
  if (phase_ == Phase::kStarting) {
    if (found_everybody_ && rules_.waits_for_people()) return;
    if (now > After(launched_, Seconds(rules_.start_timeout_s) + kStartGrace))
      Fail("not started within run.start_timeout_s = " + ShortestFloat(rules_.start_timeout_s) +
           " s: " + rules_.missing());
    return;
  }
  // The server reports silent agents; a silent server must be noticed here.
  if (phase_ != Phase::kFlying || !watch_.IsOverdue(view.newest_tick + view.rows + view.server_words, now)) return;
  server_silent_ = true;
  const Seconds limit = Seconds(rules_.agent_timeout_s + rules_.period_s) + kGrace;
  const std::string lacking = rules_.lacking();
  Fail("nothing came from physics_server for " + ShortestFloat(limit.count()) + " s" +
       (lacking.empty() ? "" : ", and the recording waits for " + lacking));
}

RunPhases::Actions RunPhases::Collected(const View& view, Time now) {
  const bool wait = !in_order() && !view.reported && !server_silent_ && view.newest_tick >= 0;
  phase_ = wait ? Phase::kReporting : Phase::kEnding;
  report_deadline_ = now + kReport;
  return {.ask_to_end = wait && !server_exited_};
}

void RunPhases::LookAtReport(const View& view, Time now) {
  if (server_exited_) report_deadline_ = std::min(*report_deadline_, now + kLateReport);
  if (view.reported || server_silent_ || now > *report_deadline_) phase_ = Phase::kEnding;
}

}  // namespace mascot
