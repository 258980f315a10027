#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "experiment/link.h"
#include "experiment/motion.h"
#include "experiment/random.h"

namespace mascot {

/// What one agent sends at one tick: where it is, and its law's last message.
struct Sample {
  const Motion* motion = nullptr;
  std::span<const double> message = {};
};

/// What happened on one directed edge so far.
struct EdgeCount {
  std::uint64_t sent = 0;
  std::uint64_t lost = 0;
  std::uint64_t late = 0;     ///< arrived after one that was sent later, and were not used
  std::uint64_t numbers = 0;  ///< in the messages sent
};

/// The way from one agent to one that hears it: loses and delays samples, in simulated time. The fate of the sample
/// sent at a tick depends on the seed, the edge and the tick alone.
class Link {
 public:
  /// A sample on its way, or arrived.
  struct Packet {
    std::int64_t sent = -1;  ///< tick; -1: there is none
    double weight = 0;       ///< a_ij when it was sent
    Motion motion;
    std::vector<double> message;
  };

  Link(const LinkConfig& config, int rate_hz, std::uint64_t seed, int hearer, int heard);
  /// One sample, at most one per tick, ticks increasing.
  void Send(std::int64_t tick, double weight, const Sample& sample);
  /// The newest sample that has arrived at `tick` (increasing), if it is fresh: arrived at this tick, or held. Null:
  /// none.
  const Packet* Receive(std::int64_t tick);
  const EdgeCount& count() const { return count_; }
  /// After how many ticks a sample arrives that is `time_s` on its way.
  static std::int64_t Ticks(double time_s, int rate_hz);

 private:
  enum Draw : std::uint64_t { kLoss, kChange, kDelay, kReordering };

  bool Loses(std::int64_t tick);
  void Collect(std::int64_t tick);  // takes in what arrived up to then
  std::int64_t DelayTicks(std::int64_t tick) const;
  Packet& ArrivalAt(std::int64_t tick) { return arrivals_[static_cast<std::size_t>(tick) % arrivals_.size()]; }

  LinkConfig config_;
  int rate_hz_;
  std::int64_t hold_ticks_;
  Dice dice_;
  EdgeCount count_;
  bool bad_ = false;               // state of a link that loses in bursts
  std::int64_t changed_ = -1;      // tick up to which that state is known
  std::vector<Packet> arrivals_;   // what arrives at tick t, in place t modulo its size
  std::int64_t looked_ = -1;       // tick up to which arrivals were received
  Packet newest_;                  // of those received
  std::int64_t newest_since_ = 0;  // tick at which it arrived
};

}  // namespace mascot
