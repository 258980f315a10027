#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "agent/neighbours.h"

namespace mascot {

/// The states of edges on their way from the thread that flies a run to the one that writes it. Thread-safe.
class EdgeQueue {
 public:
  /// Adds those of a tick, later than all before.
  void Put(std::int64_t tick, const std::vector<EdgeNow>& edges) {
    const std::lock_guard lock(mutex_);
    waiting_.emplace_back(tick, edges);
  }
  /// Takes those of a tick, which must be the first in the queue.
  std::vector<EdgeNow> Take(std::int64_t tick) {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty() || waiting_.front().first != tick)
      throw std::logic_error("nobody has said how the edges are at tick " + std::to_string(tick));
    std::vector<EdgeNow> edges = std::move(waiting_.front().second);
    waiting_.pop_front();
    return edges;
  }

 private:
  std::mutex mutex_;
  std::deque<std::pair<std::int64_t, std::vector<EdgeNow>>> waiting_;
};

}  // namespace mascot
