#include "orchestrator/engines/inprocess.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "agent/laws/laws.h"
#include "experiment/live_experiment.h"
#include "experiment/processes.h"
#include "orchestrator/engines/row_feed.h"
#include "orchestrator/team/team.h"
#include "physics_server/process/tick_gate.h"
#include "physics_server/world.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

/// World, agents and buffers of a run; the buffers are reused, so that ticks do not allocate.
class Flight {
 public:
  using Tell = std::function<void(const std::string& words)>;

  Flight(const Experiment& experiment, Crew& crew, Tell tell)
      : experiment_(experiment),
        tell_(std::move(tell)),
        processes_(AgentProcesses(experiment)),
        may_lose_(experiment.run.on_agent_loss != OnAgentLoss::kAbort),
        world_(experiment, World::LookForContacts::kWhenClose, World::kAllLanes, crew),
        team_(experiment, crew),
        actuation_(static_cast<std::size_t>(experiment.size())),
        row_(experiment.size()) {}

  /// States of the current tick, and the commands and messages that answer them. Valid until the next call.
  const DecodedRow& Exchange() {
    const std::int64_t tick = world_.tick();
    TakeEvents(tick);
    for (const AgentConfig& agent : experiment_.agents)
      row_.motions[static_cast<std::size_t>(agent.id - 1)] = world_.State(agent.id);
    if (may_lose_) kept_ = row_.commands;
    team_.Decide(tick, row_.motions, row_.commands, SilentAt(tick), may_lose_ ? &failures_ : nullptr);
    LoseThoseThatFailed(tick);
    for (const AgentConfig& agent : experiment_.agents) {
      const auto i = static_cast<std::size_t>(agent.id - 1);
      row_.has_answered[i] = team_.HasAnswered(agent.id);
      row_.messages[i].clear();
      if (!team_.HasAnswered(agent.id)) continue;
      row_.commands[i].v_law_W.setZero();  // as over DDS, where velocities are not sent
      row_.commands[i].v_limited_W.setZero();
      actuation_[i] = row_.commands[i].actuator;
      const std::span<const double> message = team_.message(agent.id);
      row_.messages[i].assign(message.begin(), message.end());
    }
    return row_;
  }

  void Step() { world_.Step(actuation_); }
  /// An event by hand, which takes effect at the next Exchange().
  void Take(Event event) {
    event.tick = world_.tick();
    by_hand_.push_back(std::move(event));
  }
  /// The pace that an event of the newest tick has set; nullopt: none has.
  std::optional<double> new_pace() const { return new_pace_; }
  Contacts contacts() const { return world_.contacts(); }

 private:
  /// The experiment as events change it. It is read at the first event: most runs have none, and to read a file is
  /// slow.
  LiveExperiment& Live() {
    if (!live_) live_.emplace(experiment_, &LawTable(), /*checked=*/true);
    return *live_;
  }

  /// The agents that do not answer this tick, as the events of the next one say.
  std::span<const int> SilentAt(std::int64_t tick) {
    silent_.clear();
    for (std::size_t k = next_event_; k < experiment_.events.size() && experiment_.events[k].tick == tick + 1; ++k)
      if (const auto& fault = experiment_.events[k].fault; fault && fault->unanswered) silent_.push_back(fault->agent);
    return silent_;
  }

  /// Laws have failed at `tick`: nobody in their processes answers, and the next tick's events say so. Throws
  /// std::runtime_error if there is no next tick.
  void LoseThoseThatFailed(std::int64_t tick) {
    if (failures_.empty()) return;
    if (tick == experiment_.ticks()) throw std::runtime_error(failures_.front().words);
    const auto has_failed = [this](int id) {
      return std::ranges::find(failures_, id, &Team::Failure::agent) != failures_.end();
    };
    for (const AgentRange& agents : processes_) {
      const auto failure =
          std::ranges::find_if(failures_, [&](const Team::Failure& any) { return agents.Holds(any.agent); });
      if (failure == failures_.end()) continue;
      tell_(fmt::format("lost: agent {}: {}\n{}", IdsText(agents), failure->words, WhatFollowsALoss(experiment_)));
      for (int id = agents.first; id <= agents.last; ++id)
        if (team_.HasAnswered(id) || has_failed(id)) Lose(id, tick);
    }
  }

  void Lose(int id, std::int64_t tick) {
    const auto i = static_cast<std::size_t>(id - 1);
    team_.TakeBack(id);
    row_.commands[i] = kept_[i];
    const Fault fault{.agent = id, .kind = FaultKind::kKill, .unanswered = true};
    by_hand_.push_back({.tick = tick + 1, .fault = fault, .where = fmt::format("agent {}", id)});
  }

  /// Takes the events of this tick: first the file's, then those given by hand, then what run.on_agent_loss brings.
  void TakeEvents(std::int64_t tick) {
    row_.events.clear();
    new_pace_.reset();
    while (next_event_ < experiment_.events.size() && experiment_.events[next_event_].tick == tick)
      TakeEvent(experiment_.events[next_event_++]);
    for (const Event& event : std::exchange(by_hand_, {})) TakeEvent(event);
    if (live_)
      for (const Event& event : live_->RestartsAt(tick)) TakeEvent(event);
    if (row_.events.empty()) return;
    if (const std::string loss = LossThatEndsTheRun(Live().current()); !loss.empty())
      throw std::runtime_error(fmt::format("tick {}: {}", tick, loss));
    world_.Adopt(*Live().now());
    team_.Adopt(Live().now());
  }

  void TakeEvent(const Event& event) {
    Live().Take(event);
    if (event.set.contains("run.pace")) new_pace_ = Live().now()->run.pace.value_or(0);
    row_.events.push_back({++row_.events_so_far, event});
  }

  const Experiment& experiment_;
  const Tell tell_;
  const std::vector<AgentRange> processes_;
  const bool may_lose_;  // the run goes on without agents that are lost
  World world_;
  Team team_;
  std::vector<Team::Failure> failures_;  // at the newest tick
  std::vector<Command> kept_;            // the commands before it, if may_lose_
  std::optional<LiveExperiment> live_;   // absent before the first event
  std::size_t next_event_ = 0;           // in experiment_.events
  std::vector<Event> by_hand_;
  std::optional<double> new_pace_;
  std::vector<int> silent_;
  std::vector<Actuation> actuation_;
  DecodedRow row_;
};

/// Carries out what people ask of the run, and says when it is time for the next tick.
class Steering {
 public:
  Steering(const Experiment& experiment, RunRequests& requests, Flight& flight)
      : requests_(requests), flight_(flight), gate_(experiment.period_s(), requests.status().pace) {}
  ~Steering() { requests_.Close(); }
  Steering(const Steering&) = delete;
  Steering& operator=(const Steering&) = delete;

  /// Waits until it is time for tick `tick`, the next one. Returns false if the run is to end before: by a request, or
  /// because `go_on` says so.
  bool Await(std::int64_t tick, const std::function<bool()>& go_on) {
    if (tick == 0) return go_on();
    requests_.Open();
    if (const auto pace = flight_.new_pace()) SetPace(*pace);
    while (go_on()) {
      if (!CarryOutRequests(tick)) return false;
      const auto now = WallClock::now();
      const auto opens = gate_.Opens(now);
      if (opens && now >= *opens) {
        gate_.OnTick(now);
        return true;
      }
      requests_.WaitUntil(std::min(now + kLookEvery, opens.value_or(now + kLookEvery)));
    }
    return false;
  }

 private:
  static constexpr auto kLookEvery = std::chrono::milliseconds(50);  // whether to go on

  void SetPace(double pace) {
    gate_.SetPace(pace);
    requests_.SetStatus(gate_.paused(), pace);
  }

  /// Returns false if the run is to end.
  bool CarryOutRequests(std::int64_t tick) {
    while (const auto order = requests_.Next()) {
      if (order->kind == Request::Kind::kEvent && static_cast<double>(tick) >= order->number) {
        requests_.CheckAgain();
        continue;
      }
      const bool goes_on = CarryOut(*order);
      requests_.SetStatus(gate_.paused(), gate_.pace());
      requests_.Done(tick);
      if (!goes_on) return false;
    }
    return true;
  }

  bool CarryOut(const RunRequests::Order& order) {
    switch (order.kind) {
      case Request::Kind::kPause:
        gate_.Pause();
        return true;
      case Request::Kind::kResume:
        gate_.Resume();
        return true;
      case Request::Kind::kStep:
        gate_.Step(std::llround(order.number));
        return true;
      case Request::Kind::kPace:
        gate_.SetPace(order.number);
        return true;
      case Request::Kind::kEvent:
        flight_.Take(*order.event);
        return true;
      default:
        return false;
    }
  }

  RunRequests& requests_;
  Flight& flight_;
  TickGate gate_;
};

}  // namespace

EngineResult RunInProcess(const Experiment& experiment, const std::vector<RowSink*>& sinks,
                          const std::function<bool()>& go_on, RunRequests* requests, Crew& crew,
                          const std::function<void(const std::string& words)>& tell) {
  EngineResult result;
  const auto launched = WallClock::now();
  auto start = launched;
  std::optional<Flight> flight;
  std::optional<Steering> steering;
  try {
    flight.emplace(experiment, crew, tell);
    if (requests != nullptr) steering.emplace(experiment, *requests, *flight);
    RowFeed feed(experiment, sinks);
    start = WallClock::now();
    for (std::int64_t tick = 0; steering ? steering->Await(tick, go_on) : go_on(); ++tick) {
      feed.Add(tick, flight->Exchange());
      if (tick == experiment.ticks()) break;
      flight->Step();
    }
  } catch (const std::exception& failure) {
    result.failure = failure.what();
  }
  result.wall_s = std::chrono::duration<double>(WallClock::now() - start).count();
  result.startup_s = std::chrono::duration<double>(start - launched).count();
  if (flight) result.contacts = flight->contacts();
  return result;
}

}  // namespace mascot
