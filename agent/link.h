#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/motion.h"
#include "base/random.h"
#include "experiment/link.h"

namespace mascot {

/// What one agent sends at one tick: its motion and its law's last message.
struct Sample {
  const Motion* motion = nullptr;
  std::span<const double> message = {};
  /// Number of ticks since the answer with which the message was sent; more than 1 only in real time.
  std::int64_t message_age = 1;
};

/// Counters of one directed edge since the start of the run.
struct EdgeCount {
  std::uint64_t sent = 0;
  std::uint64_t lost = 0;
  std::uint64_t late = 0;     ///< number of samples that arrived after a newer sample, or with it, and were not used
  std::uint64_t numbers = 0;  ///< values in the messages sent

  EdgeCount& operator+=(const EdgeCount& other) {
    sent += other.sent;
    lost += other.lost;
    late += other.late;
    numbers += other.numbers;
    return *this;
  }
};

/// The communication link from one agent to an agent that hears it: loses and delays samples, in simulated time. What
/// happens to a sample depends only on the seed, the edge and the tick at which it was sent. Loss in bursts:
/// Gilbert-Elliott (experiment/link.h).
class Link {
 public:
  /// A sample in transit, or arrived.
  struct Packet {
    std::int64_t sent = -1;  ///< tick at which it was sent; -1: no sample
    double weight = 0;       ///< a_ij when it was sent
    Motion motion;
    std::vector<double> message;
    std::int64_t message_age = 1;  ///< Sample::message_age when it was sent
  };

  /// `hearer`, `heard`: ids; `heard` sends.
  Link(const LinkConfig& config, int rate_hz, std::uint64_t seed, int hearer, int heard);
  /// From now on the link has this configuration: samples in transit arrive as they would have. config.symmetric does
  /// not change. `late_s`: by how much later than the link says samples arrive from now on.
  void Adopt(const LinkConfig& config, double late_s = 0);
  /// Sends a sample; at most one per tick, ticks increasing. `weight`: a_ij at this tick.
  void Send(std::int64_t tick, double weight, const Sample& sample);
  /// The newest sample that has arrived by `tick` (increasing), if it arrived at this tick or is held (hold_s); else
  /// null. Valid until the next call.
  const Packet* Receive(std::int64_t tick);
  /// The newest sample that had arrived at the last Receive(); null: none.
  const Packet* newest() const { return newest_.sent >= 0 ? &newest_ : nullptr; }
  const EdgeCount& count() const { return count_; }

 private:
  enum Draw : std::uint64_t { kLoss, kChange, kDelay, kReordering };

  bool Loses(std::int64_t tick);
  void Collect(std::int64_t tick);  // takes the samples that arrived up to `tick`
  std::int64_t DelayTicks(std::int64_t tick) const;
  Packet& ArrivalAt(std::int64_t tick) { return arrivals_[static_cast<std::size_t>(tick) % arrivals_.size()]; }

  LinkConfig config_;
  int rate_hz_;
  std::int64_t hold_ticks_ = 0, late_ticks_ = 0;
  Dice dice_;
  EdgeCount count_;
  bool bad_ = false;                  // state of the Gilbert-Elliott model
  std::int64_t state_tick_ = -1;      // tick of bad_
  std::vector<Packet> arrivals_;      // the sample that arrives at tick t is at index t modulo the size
  std::int64_t collected_tick_ = -1;  // last tick whose arrival was taken
  Packet newest_;                     // the newest sample that arrived
  std::int64_t newest_since_ = 0;     // tick at which newest_ arrived
};

}  // namespace mascot
