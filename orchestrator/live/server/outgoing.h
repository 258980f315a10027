#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>

#include "orchestrator/live/server/socket.h"

namespace mascot {

/// Counts the memory of the frames that wait for all clients of a server. The body that several clients share counts
/// once.
class OutgoingMemory {
 public:
  void Add(const Frame& frame) {
    bytes_ += OwnBytes(frame);
    if (frame.body && holders_[frame.body.get()]++ == 0) bytes_ += frame.body->size();
  }
  /// `frame` was added before.
  void Remove(const Frame& frame) {
    bytes_ -= OwnBytes(frame);
    if (!frame.body) return;
    const auto shared = holders_.find(frame.body.get());
    if (--shared->second > 0) return;
    holders_.erase(shared);
    bytes_ -= frame.body->size();
  }
  std::size_t bytes() const { return bytes_; }

 private:
  static std::size_t OwnBytes(const Frame& frame) { return sizeof frame + frame.head.size(); }

  std::size_t bytes_ = 0;
  std::unordered_map<const std::string*, std::size_t> holders_;  // of each body: how many frames have it
};

}  // namespace mascot
