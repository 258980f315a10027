#pragma once

#include <cstdint>
#include <vector>

namespace mascot {

/// The source of what RViz2 shows of a run: it makes samples for DDS (the 4-byte encapsulation header, then CDR) of its
/// current tick. Used by one thread.
class RosSource {
 public:
  using Bytes = std::vector<std::uint8_t>;
  virtual ~RosSource() = default;
  /// Goes on to the newest tick, and returns its number; -1: there is none yet. Throws the exception that has ended the
  /// view.
  virtual std::int64_t TakeNewest() = 0;
  /// A sample of /tf. Call it only when there is a tick.
  virtual Bytes Transforms() const = 0;
  /// A sample of /scene, with all markers. Call it only when there is a tick.
  virtual Bytes Scene() const = 0;
};

}  // namespace mascot
