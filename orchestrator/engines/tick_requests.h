#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "experiment/experiment.h"
#include "orchestrator/control/run_requests.h"
#include "physics_server/process/tick_gate.h"

namespace mascot {

/// Carries out what people ask of a run that flies in one process, between its ticks, and says when it is time for the
/// next tick. Of the run's thread.
class TickRequests {
 public:
  /// `requests` must outlive this object, at whose end nothing more can be asked. `take` gives the run an event, which
  /// takes effect at its next tick; it throws ConfigError or std::invalid_argument if the event is not legal any more.
  TickRequests(const Experiment& experiment, RunRequests& requests, std::function<void(const Event& event)> take)
      : requests_(requests), take_(std::move(take)), gate_(experiment.period_s(), requests.status().pace) {
    if (requests.status().paused) gate_.Pause();
  }
  ~TickRequests() { requests_.Close(); }
  TickRequests(const TickRequests&) = delete;
  TickRequests& operator=(const TickRequests&) = delete;

  enum class Next {
    kTick,  ///< it is time for the next tick
    kStop,  ///< the run is to end: somebody has asked for it
    kLeave  ///< `go_on` says so
  };
  /// Waits for what is next. `tick`: the next one, from 1. `new_pace`: what an event of the tick before has set.
  /// `go_on` is asked again and again.
  Next Await(std::int64_t tick, std::optional<double> new_pace, const std::function<bool()>& go_on);

 private:
  /// Returns false if the run is to end.
  bool CarryOutAll(std::int64_t tick);
  void Take(const Event& event, std::int64_t tick);
  void SayStatus() { requests_.SetStatus(gate_.paused(), gate_.pace()); }

  RunRequests& requests_;
  const std::function<void(const Event&)> take_;
  TickGate gate_;
};

}  // namespace mascot
