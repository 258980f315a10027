#pragma once

#include <cstdint>
#include <vector>

namespace mascot {

/// Knows which agents have answered the current tick, and which are late. No DDS, no clock.
class TickBarrier {
 public:
  explicit TickBarrier(int agents);
  /// From now on agent `id` is not waited for, or is again.
  void Exclude(int id);
  void Include(int id);
  bool Excludes(int id) const { return is_excluded_.at(static_cast<std::size_t>(id - 1)) != 0; }
  /// Starts waiting for the answers to `tick`, of all agents that are not excluded.
  void Open(std::int64_t tick);
  /// Notes that agent `id` (1..N) answered `tick`. Returns true if this was the last answer for which the open tick
  /// waited. An answer to another tick, or a second one, changes nothing.
  bool Answer(int id, std::int64_t tick);
  /// Whether nobody is waited for.
  bool IsComplete() const { return missing_ == 0; }
  /// Agents that have not answered the open tick, and are waited for, in increasing id.
  std::vector<int> Late() const;

 private:
  std::int64_t tick_ = -1;
  int missing_ = 0;
  int excluded_ = 0;
  std::vector<char> is_excluded_;       // by id - 1
  std::vector<std::int64_t> answered_;  // last tick answered, by id - 1
};

}  // namespace mascot
