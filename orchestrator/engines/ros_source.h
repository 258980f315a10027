#pragma once

#include <cstdint>
#include <vector>

namespace mascot {

/// What RViz2 is shown of a run: makes samples for DDS (the 4-byte encapsulation header, then CDR) of the tick that it
/// stands at. Used by one thread.
class RosSource {
 public:
  using Bytes = std::vector<std::uint8_t>;
  virtual ~RosSource() = default;
  /// Goes on to the newest tick, and returns its number; -1: there is none yet. Throws what has ended the view.
  virtual std::int64_t TakeNewest() = 0;
  /// A sample of /tf. To be called when there is a tick.
  virtual Bytes Transforms() const = 0;
  /// A sample of /scene, with all that there is to see. Likewise.
  virtual Bytes Scene() const = 0;
};

}  // namespace mascot
