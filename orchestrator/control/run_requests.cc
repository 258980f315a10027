#include "orchestrator/control/run_requests.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include "agent/laws/laws.h"
#include "experiment/toml/section.h"

namespace mascot {
namespace {

constexpr const char* kByHand = "event by hand";
constexpr double kMaxSteps = 1e9;
/// How long a request that comes early waits for the first tick.
constexpr auto kStartPatience = std::chrono::seconds(5);

/// The row of run.pace.
const Key& PaceRow() {
  const std::span<const Key> run = std::ranges::find(ExperimentKeys(), "run", &Key::name)->keys;
  return *std::ranges::find(run, "pace", &Key::name);
}

std::string Refusal(const ConfigError& error) {
  std::string text;
  for (const std::string& line : error.mistakes()) text += (text.empty() ? "" : "\n") + line;
  return text;
}

}  // namespace

RunRequests::RunRequests(const Experiment& experiment, double pace, bool paused)
    : experiment_(experiment),
      ahead_(Ahead{.live = LiveExperiment(experiment, &LawTable(), /*checked=*/true)}),
      status_{.paused = paused, .pace = experiment.run.mode == Mode::kRealtime ? experiment.run.speed : pace},
      live_(ahead_->live) {}

void RunRequests::CheckPace(double pace) {
  if (PaceRow().range.Holds(pace)) return;
  throw std::invalid_argument(
      fmt::format("pace: expected a number in {}, got {}", PaceRow().range.Text(), ShortestFloat(pace)));
}

Answer RunRequests::Ask(const Request& request) {
  const std::lock_guard one_at_a_time(asking_);
  const Answer too_late{false, "the run is over"};
  {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kStartPatience, [this] { return is_open_ || is_over_; });
    if (is_over_) return too_late;
    if (!is_open_) return {false, "the run has not begun yet"};
  }
  for (std::int64_t from = 0;;) {
    Order checked;
    try {
      checked = Checked(request, from);
    } catch (const ConfigError& error) {
      return {false, Refusal(error)};
    } catch (const std::invalid_argument& error) {
      return {false, error.what()};
    }
    std::unique_lock lock(mutex_);
    if (is_over_) return too_late;
    answer_.reset();
    order_ = checked;
    changed_.notify_all();
    if (wake_) wake_();
    changed_.wait(lock, [this] { return answer_ || is_over_ || !order_; });
    if (std::exchange(order_, std::nullopt) || is_over_) return answer_.value_or(too_late);
    from = std::llround(checked.number);
  }
}

RunRequests::Order RunRequests::Checked(const Request& request, std::int64_t from) {
  const bool realtime = experiment_.run.mode == Mode::kRealtime;
  switch (request.kind) {
    case Request::Kind::kResume:
    case Request::Kind::kStop:
      break;
    case Request::Kind::kPause:
      CheckPause("pause");
      break;
    case Request::Kind::kStep:
      CheckPause("step");
      if (!(request.number >= 1 && request.number <= kMaxSteps && request.number == std::floor(request.number)))
        throw std::invalid_argument(
            fmt::format("step: expected an integer in [1, {:.0f}], got {}", kMaxSteps, ShortestFloat(request.number)));
      break;
    case Request::Kind::kPace:
      if (realtime) throw std::invalid_argument("pace: expected a run in lockstep, got one in real time (run.speed)");
      CheckPace(request.number);
      break;
    case Request::Kind::kStart:
    case Request::Kind::kLand:
    case Request::Kind::kKill:
      CheckVehicle(request);
      break;
    case Request::Kind::kSeek:
      throw std::invalid_argument("seek: expected a recording, got a run: nobody can go back in it, or ahead");
    case Request::Kind::kEvent:
      return CheckedEvent(request.toml, from);
  }
  return {.kind = request.kind, .number = request.number};
}

void RunRequests::CheckPause(const std::string& what) const {
  if (!AgentsWithVehicles(experiment_).empty())
    throw std::invalid_argument(
        what + ": expected a run without vehicles, got one with [[vehicles]]: in a pause they would get no set-points");
}

void RunRequests::CheckVehicle(const Request& request) const {
  const std::vector<int> vehicles = AgentsWithVehicles(experiment_);
  const bool means_all =
      request.kind == Request::Kind::kStart || (request.kind == Request::Kind::kLand && request.number == 0);
  const bool fits = means_all ? !vehicles.empty() : std::ranges::find(vehicles, request.number) != vehicles.end();
  if (fits) return;
  const std::string what = request.kind == Request::Kind::kStart  ? "start"
                           : request.kind == Request::Kind::kLand ? "land"
                                                                  : "kill";
  throw std::invalid_argument(vehicles.empty() ? what + ": expected a run with vehicles ([[vehicles]]), got one without"
                                               : fmt::format("{}: expected an agent with a vehicle ({}), got {}", what,
                                                             fmt::join(vehicles, ", "), ShortestFloat(request.number)));
}

RunRequests::Order RunRequests::CheckedEvent(const std::string& toml, std::int64_t from) {
  from = std::max(from, LookAhead());
  const std::int64_t last = experiment_.ticks();
  const Event event = EventFrom(std::min(from, last), toml, experiment_.size(), kByHand);
  if (event.law)
    throw std::invalid_argument(std::string(kByHand) +
                                ": law: expected a phase in [[law.schedule]] of the file, got one by hand");
  if (event.after_loss)
    throw std::invalid_argument(std::string(kByHand) + ": after_loss: expected of the run alone, got it by hand");
  const std::vector<Event>& file = experiment_.events;
  Ahead ahead = *ahead_;
  if (ahead.by_hand + file.size() >= LiveExperiment::kMaxEvents)
    throw std::invalid_argument(
        fmt::format("{}: expected at most {} events in a run, got one more", kByHand, LiveExperiment::kMaxEvents));
  TakeFile(ahead, from);
  const std::int64_t before = ahead.of_file < file.size() ? file[ahead.of_file].tick : last + 1;
  ahead.live.CheckAll();
  ahead.live.Take(event);
  for (const Event& later : std::span(file).subspan(ahead.of_file))  // what is legal there stays legal in other tables
    if (ShareATable(event, later)) ahead.live.Take(later);
  return {.kind = Request::Kind::kEvent, .number = static_cast<double>(before), .event = event};
}

std::int64_t RunRequests::LookAhead() {
  std::unique_lock lock(mutex_);
  if (ahead_->by_hand <= by_hand_.size()) ahead_.emplace(Ahead{*live_, of_file_, by_hand_.size()});
  const auto known = static_cast<std::ptrdiff_t>(ahead_->by_hand - by_hand_.size());
  const std::vector<Event> granted(granted_.begin() + known, granted_.end());
  const std::int64_t first = granted_.empty() ? status_.tick + 1 : granted_.back().tick;
  lock.unlock();
  for (const Event& event : granted) {
    TakeFile(*ahead_, event.tick);
    ahead_->live.Take(event);
    ++ahead_->by_hand;
  }
  return first;
}

void RunRequests::TakeFile(Ahead& ahead, std::int64_t until) const {
  const std::vector<Event>& file = experiment_.events;
  while (ahead.of_file < file.size() && file[ahead.of_file].tick <= until) ahead.live.Take(file[ahead.of_file++]);
}

Answer RunRequests::AnswerTo(const Order& order, std::optional<std::int64_t> tick) const {
  if (!tick) return {false, "the run is over"};
  const auto at = [&](std::int64_t k) {
    return fmt::format("tick {} ({} s)", k, ShortestFloat(experiment_.time_s(k)));
  };
  switch (order.kind) {
    case Request::Kind::kPause:
      return {true, "paused after " + at(*tick - 1)};
    case Request::Kind::kResume:
      return {true, "goes on with " + at(*tick)};
    case Request::Kind::kStep:
      return {true, "pauses after " +
                        at(std::min<std::int64_t>(*tick - 1 + std::llround(order.number), experiment_.ticks()))};
    case Request::Kind::kPace:
      return {true, order.number > 0 ? fmt::format("{} simulated seconds a second", ShortestFloat(order.number))
                                     : "as fast as it goes"};
    case Request::Kind::kStop:
      return {true, "the run stops, and its results are written"};
    default:
      return {true, "takes effect at " + at(*tick)};
  }
}

RunStatus RunRequests::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void RunRequests::Adopt(const LiveExperiment& live, std::span<const Event> events) {
  const std::lock_guard lock(mutex_);
  const std::vector<Event>& file = experiment_.events;
  int number = live.count() - static_cast<int>(events.size());
  for (const Event& event : events) {
    ++number;
    if (of_file_ < file.size() && file[of_file_].tick == event.tick) {  // those of the file come first
      ++of_file_;
    } else if (!event.after_loss) {
      by_hand_.push_back(event);
      numbers_by_hand_.push_back(number);
      const bool is_granted = !granted_.empty() && granted_.front().Toml() == event.Toml();
      if (is_granted) granted_.pop_front();  // else nobody has asked for it: an agent was lost for real
    }
  }
  live_.emplace(live);
}

void RunRequests::Add(const FlownRow& row) {
  const std::lock_guard lock(mutex_);
  status_.tick = row.tick();
}

void RunRequests::CallWhenAsked(std::function<void()> wake) {
  const std::lock_guard lock(mutex_);
  wake_ = std::move(wake);
}

void RunRequests::Open() {
  const std::lock_guard lock(mutex_);
  if (std::exchange(is_open_, true)) return;
  changed_.notify_all();
}

std::optional<RunRequests::Order> RunRequests::Next() const {
  const std::lock_guard lock(mutex_);
  return answer_ ? std::nullopt : order_;
}

void RunRequests::Done(std::optional<std::int64_t> tick) {
  const std::lock_guard lock(mutex_);
  if (!order_ || answer_) return;
  answer_ = AnswerTo(*order_, tick);
  if (tick && order_->event) {
    granted_.push_back(*order_->event);
    granted_.back().tick = *tick;
  }
  changed_.notify_all();
}

void RunRequests::CheckAgain() {
  const std::lock_guard lock(mutex_);
  if (!answer_) order_.reset();
  changed_.notify_all();
}

void RunRequests::Refuse(std::string words) { AnswerWith({false, std::move(words)}); }

void RunRequests::Tell(std::string words) { AnswerWith({true, std::move(words)}); }

void RunRequests::AnswerWith(Answer answer) {
  const std::lock_guard lock(mutex_);
  if (!order_ || answer_) return;
  answer_ = std::move(answer);
  changed_.notify_all();
}

void RunRequests::Refuse(const ConfigError& error) { Refuse(Refusal(error)); }

void RunRequests::SetVehicles(std::string words) {
  const std::lock_guard lock(mutex_);
  status_.vehicles = std::move(words);
}

void RunRequests::CallWhenChanged(std::function<void(const RunStatus&)> tell) {
  const std::lock_guard lock(mutex_);
  tell_ = std::move(tell);
}

void RunRequests::SetStatus(bool paused, double pace) {
  const std::lock_guard lock(mutex_);
  if (status_.paused == paused && status_.pace == pace) return;
  status_.paused = paused;
  status_.pace = pace;
  if (tell_) tell_(status_);
}

void RunRequests::SetDomain(int domain) {
  const std::lock_guard lock(mutex_);
  status_.domain = domain;
}

void RunRequests::Close() {
  const std::lock_guard lock(mutex_);
  is_over_ = true;
  wake_ = nullptr;
  changed_.notify_all();
}

void RunRequests::WaitUntil(Time time) const {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, time, [this] { return order_ && !answer_; });
}

std::vector<Event> RunRequests::by_hand() const {
  const std::lock_guard lock(mutex_);
  return by_hand_;
}

std::vector<int> RunRequests::numbers_by_hand() const {
  const std::lock_guard lock(mutex_);
  return numbers_by_hand_;
}

}  // namespace mascot
