#pragma once

#include <memory>

#include "experiment/experiment.h"

namespace mascot {

/// The agents of a process on the wire: what they may hear comes in, and their answers go out. There is one class for
/// each network.delivery. Answers are made and written in the threads that bring what they need.
class AgentsOnWire {
 public:
  virtual ~AgentsOnWire() = default;
  /// Whether all readers and writers are matched.
  virtual bool Matched() const = 0;
  /// Whether each agent has answered a tick.
  virtual bool HaveAnswered() const = 0;
  /// An event has come, whose number this is; `now` is the experiment after it, or null if another event takes effect
  /// with it and comes next. Events come in order.
  virtual void OnEvent(int number, const Event& event, const std::shared_ptr<const Experiment>& now) = 0;
};

}  // namespace mascot
