#pragma once

#include <chrono>
#include <cstdint>

#include "experiment/experiment.h"
#include "orchestrator/processes/console.h"
#include "orchestrator/recording/run_writer.h"

namespace mascot {

/// The progress line of a run: simulated time, real-time factor, agents, disagreement.
class Progress {
 public:
  Progress(const Experiment& experiment, const RunWriter& writer, Console& console)
      : experiment_(experiment), writer_(writer), console_(console) {}
  /// Rows up to `tick` are recorded. Cheap to call often.
  void Show(std::int64_t tick);

 private:
  using WallClock = std::chrono::steady_clock;
  const Experiment& experiment_;
  const RunWriter& writer_;
  Console& console_;
  WallClock::time_point start_{}, next_{};
};

}  // namespace mascot
