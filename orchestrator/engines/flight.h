#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/agent_range.h"
#include "base/crew.h"
#include "experiment/experiment.h"
#include "experiment/live_experiment.h"
#include "orchestrator/engines/held_actions.h"
#include "orchestrator/team/row.h"
#include "orchestrator/team/team.h"
#include "physics_server/world.h"

namespace mascot {

/// An agent is lost, and run.on_agent_loss ends the run.
class LossEndsRun : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A run in this process that somebody steps, tick by tick, without DDS: the same World and Agent classes as in the
/// processes of the other engine, and the events of the file. The buffers are reused, so that ticks do not allocate.
///
/// An agent whose law fails is lost, with all agents of its process (AgentProcesses()), as over DDS, where the process
/// ends: run.on_agent_loss says what follows.
class Flight {
 public:
  using Tell = std::function<void(const std::string& words)>;

  /// The experiment and `crew`, in whose threads the run computes, must outlive this object. `tell` gets words for the
  /// user about agents that are lost.
  explicit Flight(
      const Experiment& experiment, Crew& crew = Crew::Alone(), Tell tell = [](const std::string&) {});

  /// The states of the current tick, and its events; the agents measure and hear. Exchange() does it otherwise. Valid
  /// until the next call. Throws LossEndsRun.
  const DecodedRow& Sense();
  /// Agent `id` as it is after Sense().
  const Agent& agent(int id) const { return team_.agent(id); }
  /// What agent `id` is to do (Law::Act), from the current tick on; after Sense(). Throws std::invalid_argument, with
  /// the agent, if its law takes none, or not of this size. An action holds until the next one; at first it is 0.
  void Act(int id, std::span<const double> action);
  /// The states of the current tick, and the commands and messages that answer them. Valid until the next call. Throws
  /// LossEndsRun, or std::runtime_error if a law fails and run.on_agent_loss is "abort".
  const DecodedRow& Exchange();
  /// Moves the bodies from the current tick to the next one, by the commands of the last Exchange().
  void Step() {
    world_.Step(actuation_);
    has_begun_ = false;
  }
  /// The experiment as the events up to this tick have changed it. Valid until the next one.
  const Experiment& now() const { return live_ ? live_->current() : experiment_; }
  /// The current tick; 0 at first.
  std::int64_t tick() const { return world_.tick(); }

  /// An event by hand. It takes effect at the current tick, unless that has begun with Sense() or Exchange(): then at
  /// the next.
  void Take(Event event);
  /// The experiment as it will be when the events of that tick have taken effect, those by hand so far among them.
  LiveExperiment Ahead();
  /// The row of the newest Sense() or Exchange().
  const DecodedRow& row() const { return row_; }
  /// The pace that an event of the newest tick has set; nullopt: none has.
  std::optional<double> new_pace() const { return new_pace_; }
  Contacts contacts() const { return world_.contacts(); }
  /// EngineResult::unanswered, if the row of the last Exchange() is the last.
  std::vector<Event> unanswered() const;

 private:
  /// The tick of events that are given by hand now.
  std::int64_t NextEventTick() const { return world_.tick() + (has_begun_ ? 1 : 0); }
  LiveExperiment& Live();
  std::span<const int> SilentAt(std::int64_t tick);
  void Begin();
  void HoldActions();
  void LoseThoseThatFailed(std::int64_t tick);
  void Lose(int id, std::int64_t tick);
  void TakeEvents(std::int64_t tick);
  void TakeEvent(const Event& event);

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
  bool has_begun_ = false;  // Begin() at this tick
  std::vector<int> silent_;
  std::vector<Actuation> actuation_;
  HeldActions actions_;
  DecodedRow row_;
};

}  // namespace mascot
