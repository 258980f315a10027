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

/// Receives every per-tick topic as raw bytes and assembles rows (RowWindow). Samples arrive in DDS threads; rows go to
/// the feed in the thread that calls Drain.
class Recorder {
 public:
  Recorder(Domain& domain, const Experiment& experiment, RowFeed& feed);

  /// Whether every reader has matched a writer.
  bool Matched() const;
  /// Feeds complete rows, in tick order; in real time also rows that have waited long enough for missing commands, or,
  /// with `give_up`, that lack commands. Returns the number of rows fed since the start. Returns after 50 ms even if
  /// rows are left, and then wakes the loop to call it again. Throws what the feed throws.
  std::int64_t Drain(bool give_up = false);
  /// Number of samples that are known to be missing, or that came too late for their row.
  std::uint64_t lost() const;
  /// Wall-clock time from the first sample to the newest command (s).
  double wall_s() const;
  /// When the first sample came.
  std::chrono::steady_clock::time_point started() const;
  /// Newest tick with a sample; -1 before the first sample.
  std::int64_t newest_tick() const;

 private:
  using Time = std::chrono::steady_clock::time_point;

  /// `index` is the index of the topic's reader in readers_.
  void OnEvent(const RawReader::Bytes& bytes, std::int64_t sequence);
  void OnSample(std::size_t index, const Topic& topic, const RawReader::Bytes& bytes, std::int64_t sequence);
  /// Throws std::runtime_error unless the sample is of this topic's agent and of a tick of the run.
  std::int64_t TickOf(const Topic& topic, const RawReader::Bytes& bytes) const;

  Domain& domain_;
  const Experiment& experiment_;
  RowFeed& feed_;
  mutable std::mutex mutex_;  // guards window_, started_ and last_command_
  RowWindow window_;
  Time started_{}, last_command_{};

  Row taken_;                                        // used only by the thread that calls Drain
  std::vector<std::unique_ptr<RawReader>> readers_;  // last: their callbacks use the members above
};

}  // namespace mascot
