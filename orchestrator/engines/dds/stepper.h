#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/motion.h"
#include "experiment/events.h"
#include "experiment/experiment.h"
#include "orchestrator/team/action_source.h"

namespace mascot {

/// Steps a run over DDS in lockstep from outside: he sees each tick, and no row of it goes to the sinks, and no agent
/// gets an action, before he lets it. All functions are called in the thread of the run, which must not wait in them.
class Stepper : public ActionSource {
 public:
  /// The states of `tick` have come, by id - 1, and its events, which have made the experiment `now` (null: there was
  /// none so far); the sinks have the rows of all ticks before. Called once at each tick, in order.
  virtual void See(std::int64_t tick, std::span<const Motion> motions, const std::vector<Event>& events,
                   const std::shared_ptr<const Experiment>& now) = 0;
  /// Whether the tick that he has seen last may go on: then At() is asked. Asked again when the run's StopSignal is
  /// woken.
  virtual bool MayGoOn(std::int64_t tick) = 0;
};

}  // namespace mascot
