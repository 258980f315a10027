#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bus/bus.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/action_feed.h"
#include "orchestrator/engines/dds/recorder.h"
#include "orchestrator/engines/dds/stepper.h"

namespace mascot {

/// Gives the agents of a run that take actions (AgentConfig::takes_actions) one at each tick, on /agent_<id>/action,
/// and has them recorded. An agent answers the tick with it alone. If somebody steps the run, shows him the ticks.
class ActionSender {
 public:
  /// `source` null: all actions are 0. `stepper`: who steps the run, and is the source; null: nobody does. All
  /// arguments must outlive this object.
  ActionSender(Domain& domain, const Experiment& experiment, Recorder& recorder, ActionSource* source,
               Stepper* stepper);

  /// Whether each agent has a reader.
  bool Matched() const;
  /// Asks for the actions of the next tick if all its states have come, and sends them; in lockstep only if the sinks
  /// have all rows before: they have `rows`; and only if the stepper lets it. Cheap to call often. Throws what
  /// ActionFeed::GoTo() throws.
  void Send(std::int64_t rows);

 private:
  struct Taker {
    int id = 0;
    std::string process;  // in which the agent is
    std::unique_ptr<RawWriter> writer;
    RawWriter::Bytes sample = {};  // the newest
    bool is_found = false;         // the process has a reader: a fresh one after a restart, too
    bool is_sent = true;           // the newest sample
  };

  /// Takes the events of the next tick, and shows it to the stepper, once. Returns whether it may go on.
  bool MayAct();
  void Act(std::int64_t tick);
  void TakeEvents(std::int64_t tick);
  static void SendTo(Taker& taker);

  const Domain& domain_;
  const Experiment& experiment_;
  Recorder& recorder_;
  ActionFeed feed_;
  Stepper* const stepper_;  // may be null
  std::vector<Taker> takers_;
  std::int64_t next_tick_ = 0;
  std::size_t events_ = 0;         // taken so far
  std::int64_t shown_ = -1;        // the newest tick that the stepper has seen
  std::vector<Event> events_now_;  // of that tick
  std::vector<Motion> motions_;    // scratch
};

}  // namespace mascot
