#pragma once

#include <cstdint>
#include <vector>

namespace mascot {

/// Knows which agents have answered the current tick, and which are late. No DDS, no clock.
class TickBarrier {
 public:
  explicit TickBarrier(int agents);
  /// Starts waiting for the answers to `tick`.
  void Open(std::int64_t tick);
  /// Notes that agent `id` (1..N) answered `tick`. Returns true if this was the last answer for which the open tick
  /// waited. An answer to another tick, or a second one, changes nothing.
  bool Answer(int id, std::int64_t tick);
  /// Agents that have not answered the open tick, in increasing id.
  std::vector<int> Late() const;

 private:
  std::int64_t tick_ = -1;
  int missing_ = 0;
  std::vector<std::int64_t> answered_;  // last tick answered, by id - 1
};

}  // namespace mascot
