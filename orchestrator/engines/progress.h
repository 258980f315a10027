#pragma once

#include <chrono>
#include <cstdint>

#include "experiment/experiment.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/team/row_sink.h"
#include "system/console.h"

namespace mascot {

/// Shows the progress line of a run: simulated time (s), real-time factor, agents, disagreement (m).
class Progress final : public RowSink {
 public:
  /// `meter` must get each row before this object does.
  Progress(const Experiment& experiment, const RunMeter& meter, Console& console)
      : experiment_(experiment), meter_(meter), console_(console) {}
  /// Updates the line at most ten times a second, and at the last tick.
  void Add(const FlownRow& row) override;

 private:
  using WallClock = std::chrono::steady_clock;
  const Experiment& experiment_;
  const RunMeter& meter_;
  Console& console_;
  WallClock::time_point start_{}, next_{};
};

}  // namespace mascot
