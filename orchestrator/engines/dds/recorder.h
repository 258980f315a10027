#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "bus/bus.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/row_feed.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// Hears every per-tick topic as raw bytes and makes rows of them. Samples arrive in DDS threads; rows are
/// written by whoever calls Drain. That nothing is lost is proved by the sequence numbers of every writer.
class Recorder {
 public:
  Recorder(Domain& domain, const Experiment& experiment, RowFeed& feed);

  /// Every reader has its writer.
  bool Matched() const;
  /// Writes the rows that are complete; in real time also those that have waited long enough for a command
  /// that an agent never gave, or have waited at all if `give_up`. Returns the number of rows recorded so far, after
  /// a while also before all are: call it again.
  std::int64_t Drain(bool give_up = false);
  std::uint64_t lost() const;
  /// From the first sample of tick 0 to the newest command (s); when tick 0 came.
  double wall_s() const;
  std::chrono::steady_clock::time_point started() const;
  /// Newest tick of which a state has come; -1 before the first.
  std::int64_t newest_tick() const;

 private:
  using Time = std::chrono::steady_clock::time_point;
  /// One tick that is coming in.
  struct Slot {
    std::int64_t tick = -1;
    int samples = 0;
    int states = 0;  // and the clock
    Row row;
  };

  /// `index`: the topic's place among the readers.
  void OnSample(std::size_t index, const Topic& topic, const RawReader::Bytes& bytes, std::int64_t sequence);
  std::int64_t TickOf(const Topic& topic, const RawReader::Bytes& bytes) const;
  Slot& SlotOf(std::int64_t tick) { return slots_[static_cast<std::size_t>(tick) % slots_.size()]; }
  void CheckSequence(std::size_t index, const Topic& topic, std::int64_t sequence);
  bool IsReady(const Slot& slot, bool give_up) const;

  Domain& domain_;
  const Experiment& experiment_;
  RowFeed& feed_;
  const bool realtime_;
  mutable std::mutex mutex_;
  std::vector<Slot> slots_;
  std::vector<std::int64_t> sequences_;  // newest of each topic, by place among the readers
  std::int64_t written_ = 0;             // rows handed to the feed
  std::int64_t complete_ = 0;            // rows complete since the loop was last woken
  std::int64_t newest_ = -1;
  std::uint64_t lost_ = 0;
  Time started_{}, last_command_{};
  Row taken_;
  std::vector<std::unique_ptr<RawReader>> readers_;  // last: they call what is above
};

}  // namespace mascot
