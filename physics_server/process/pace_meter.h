#pragma once

#include <cstdint>
#include <vector>

#include "base/pacing.h"
#include "physics_server/process/time_histogram.h"

namespace mascot {

/// Collects the timing statistics of a run in real time. No clock: the caller passes in the times.
class PaceMeter {
 public:
  explicit PaceMeter(double rate_hz) : rate_hz_(rate_hz) {}

  /// Notes that the states of a tick were sent `lateness_s` after the tick was due.
  void AddTick(double lateness_s) { lateness_.Add(lateness_s); }
  /// Notes that at `tick` the world is stepped with a command of `agent` that answered the states of `age` ticks ago.
  void AddCommand(int agent, std::int64_t tick, std::int64_t age);
  Pacing Result() const;

 private:
  void NoteLate(int agent, std::int64_t tick);
  std::vector<LateCommands> Late() const;

  const double rate_hz_;
  TimeHistogram lateness_;
  std::vector<std::uint64_t> commands_;  // by age in ticks
  std::vector<LateCommands> late_;       // that are over
  std::vector<Episode> lasting_;         // by agent - 1
};

}  // namespace mascot
