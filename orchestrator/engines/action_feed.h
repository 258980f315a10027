#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "experiment/live_experiment.h"
#include "orchestrator/engines/held_actions.h"
#include "orchestrator/team/action_source.h"

namespace mascot {

/// The actions of a run that other processes fly, tick by tick: those that a source gives, to the laws that agents have
/// by then.
class ActionFeed {
 public:
  /// `source` null: all actions are 0. Both arguments must outlive this object.
  ActionFeed(const Experiment& experiment, ActionSource* source)
      : experiment_(experiment), source_(source), held_(experiment) {}

  /// The next event.
  void Take(const Event& event);
  /// Asks the source for the actions of `tick`, once all events up to it are taken; call it for each tick, in order.
  /// Throws what the source throws, and std::invalid_argument for an action that does not fit its law.
  void GoTo(std::int64_t tick);
  /// The experiment as the events so far have changed it; null: there was none.
  std::shared_ptr<const Experiment> now() const { return live_ ? live_->now() : nullptr; }
  /// The action of agent `id` at that tick.
  std::span<const double> Of(int id) const { return held_.Of(id); }

 private:
  const Experiment& experiment_;
  ActionSource* const source_;
  HeldActions held_;
  std::optional<LiveExperiment> live_;  // absent before the first event
};

}  // namespace mascot
