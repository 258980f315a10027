#pragma once

#include <chrono>
#include <cstdint>

#include "experiment/experiment.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/processes/console.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// The progress line of a run: simulated time, real-time factor, agents, disagreement.
class Progress final : public RowSink {
 public:
  /// `meter` is fed before this.
  Progress(const Experiment& experiment, const RunMeter& meter, Console& console)
      : experiment_(experiment), meter_(meter), console_(console) {}
  /// Shows every tenth of a second where the run is.
  void Add(const FlownRow& row) override;

 private:
  using WallClock = std::chrono::steady_clock;
  const Experiment& experiment_;
  const RunMeter& meter_;
  Console& console_;
  WallClock::time_point start_{}, next_{};
};

}  // namespace mascot
