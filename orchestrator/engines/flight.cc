#include "orchestrator/engines/flight.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "agent/laws/laws.h"
#include "experiment/processes.h"

namespace mascot {

Flight::Flight(const Experiment& experiment, Crew& crew, Tell tell)
    : experiment_(experiment),
      tell_(std::move(tell)),
      processes_(AgentProcesses(experiment)),
      may_lose_(experiment.run.on_agent_loss != OnAgentLoss::kAbort),
      world_(experiment, World::LookForContacts::kWhenClose, World::kAllLanes, crew),
      team_(experiment, crew),
      actuation_(static_cast<std::size_t>(experiment.size())),
      actions_(experiment),
      row_(experiment.size()) {
  HoldActions();
}

/// The states and events of the tick.
void Flight::Begin() {
  if (std::exchange(has_begun_, true)) return;
  for (const AgentConfig& agent : experiment_.agents)
    row_.motions[static_cast<std::size_t>(agent.id - 1)] = world_.State(agent.id);
  TakeEvents(world_.tick());
}

const DecodedRow& Flight::Sense() {
  Begin();
  team_.Sense(world_.tick(), row_.motions);
  return row_;
}

/// Gives laws that have begun anew the actions that hold.
void Flight::HoldActions() {
  actions_.Adopt(now());
  for (const AgentConfig& agent : experiment_.agents)
    if (agent.takes_actions) team_.Act(agent.id, actions_.Of(agent.id));
}

void Flight::Act(int id, std::span<const double> action) {
  actions_.Act(id, action);
  team_.Act(id, action);
}

const DecodedRow& Flight::Exchange() {
  Begin();
  const std::int64_t tick = world_.tick();
  if (may_lose_) kept_ = row_.commands;
  team_.Decide(tick, row_.motions, row_.commands, SilentAt(tick), may_lose_ ? &failures_ : nullptr);
  LoseThoseThatFailed(tick);
  for (const AgentConfig& agent : experiment_.agents) {
    const auto i = static_cast<std::size_t>(agent.id - 1);
    row_.has_answered[i] = team_.HasAnswered(agent.id);
    row_.messages[i].clear();
    row_.actions[i].clear();
    if (!team_.HasAnswered(agent.id)) continue;
    row_.commands[i].v_law_W.setZero();  // as over DDS, where velocities are not sent
    row_.commands[i].v_limited_W.setZero();
    actuation_[i] = row_.commands[i].actuator;
    const std::span<const double> message = team_.message(agent.id);
    row_.messages[i].assign(message.begin(), message.end());
    row_.actions[i] = actions_.Of(agent.id);
  }
  return row_;
}

void Flight::Take(Event event) {
  event.tick = NextEventTick();
  by_hand_.push_back(std::move(event));
}

LiveExperiment Flight::Ahead() {
  LiveExperiment ahead = Live();
  for (std::size_t k = next_event_; k < experiment_.events.size() && experiment_.events[k].tick <= NextEventTick(); ++k)
    ahead.Take(experiment_.events[k]);
  for (const Event& event : by_hand_) ahead.Take(event);
  return ahead;
}

/// The experiment as events change it. It is read at the first event: most runs have none, and to read a file is
/// slow.
LiveExperiment& Flight::Live() {
  if (!live_) live_.emplace(experiment_, &LawTable(), /*checked=*/true);
  return *live_;
}

/// The agents that do not answer this tick, as the events of the next one say.
std::span<const int> Flight::SilentAt(std::int64_t tick) {
  silent_.clear();
  for (std::size_t k = next_event_; k < experiment_.events.size() && experiment_.events[k].tick == tick + 1; ++k)
    if (const auto& fault = experiment_.events[k].fault; fault && fault->unanswered) silent_.push_back(fault->agent);
  return silent_;
}

/// Laws have failed at `tick`: nobody in their processes answers, and the next tick's events say so. Throws
/// std::runtime_error if there is no next tick.
void Flight::LoseThoseThatFailed(std::int64_t tick) {
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

void Flight::Lose(int id, std::int64_t tick) {
  const auto i = static_cast<std::size_t>(id - 1);
  team_.TakeBack(id);
  row_.commands[i] = kept_[i];
  const Fault fault{.agent = id, .kind = FaultKind::kKill, .unanswered = true};
  by_hand_.push_back({.tick = tick + 1, .fault = fault, .where = fmt::format("agent {}", id)});
}

std::vector<Event> Flight::unanswered() const {
  std::vector<Event> losses;
  std::ranges::copy_if(by_hand_, std::back_inserter(losses),
                       [](const Event& event) { return event.fault && event.fault->unanswered; });
  return losses;
}

/// Takes the events of this tick: first the file's, then those given by hand, then what run.on_agent_loss brings.
void Flight::TakeEvents(std::int64_t tick) {
  row_.events.clear();
  new_pace_.reset();
  while (next_event_ < experiment_.events.size() && experiment_.events[next_event_].tick == tick)
    TakeEvent(experiment_.events[next_event_++]);
  for (const Event& event : std::exchange(by_hand_, {})) TakeEvent(event);
  if (live_)
    for (const Event& event : live_->RestartsAt(tick)) TakeEvent(event);
  if (row_.events.empty()) return;
  if (const std::string loss = LossThatEndsTheRun(Live().current()); !loss.empty())
    throw LossEndsRun(fmt::format("tick {}: {}", tick, loss));
  world_.Adopt(*Live().now());
  team_.Adopt(Live().now());
  HoldActions();
}

void Flight::TakeEvent(const Event& event) {
  Live().Take(event);
  if (event.set.contains("run.pace")) new_pace_ = Live().now()->run.pace.value_or(0);
  row_.events.push_back({++row_.events_so_far, event});
}

}  // namespace mascot
