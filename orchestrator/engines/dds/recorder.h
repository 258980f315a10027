#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "bus/bus.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/dds/row_window.h"
#include "orchestrator/engines/row_feed.h"

namespace mascot {

/// Hears every per-tick topic as raw bytes and makes rows of them (RowWindow). Samples arrive in DDS threads; rows go
/// to the feed in the thread that calls Drain.
class Recorder {
 public:
  Recorder(Domain& domain, const Experiment& experiment, RowFeed& feed);

  /// Every reader has its writer.
  bool Matched() const;
  /// Feeds the rows that are complete; in real time also those that have waited long enough for a command that an agent
  /// never gave, or have waited at all if `give_up`. Returns the number of rows fed so far, after a while also before
  /// all are: call it again.
  std::int64_t Drain(bool give_up = false);
  std::uint64_t lost() const;
  /// From the first sample of tick 0 to the newest command (s); when tick 0 came.
  double wall_s() const;
  std::chrono::steady_clock::time_point started() const;
  /// Newest tick of which a sample has come; -1 before the first.
  std::int64_t newest_tick() const;

 private:
  using Time = std::chrono::steady_clock::time_point;

  /// `index`: the topic's place among the readers.
  void OnSample(std::size_t index, const Topic& topic, const RawReader::Bytes& bytes, std::int64_t sequence);
  std::int64_t TickOf(const Topic& topic, const RawReader::Bytes& bytes) const;

  Domain& domain_;
  const Experiment& experiment_;
  RowFeed& feed_;
  mutable std::mutex mutex_;  // guards what follows
  RowWindow window_;
  Time started_{}, last_command_{};

  Row taken_;                                        // of the thread that calls Drain
  std::vector<std::unique_ptr<RawReader>> readers_;  // last: they call what is above
};

}  // namespace mascot
