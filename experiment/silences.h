#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "experiment/events.h"

namespace mascot {

/// Which agents answer nothing at which ticks, because they are lost, as the events so far say.
class Silences {
 public:
  /// Takes the next event.
  void Take(const Event& event);
  /// Whether the agent is silent at this tick.
  bool Has(int agent, std::int64_t tick) const;
  /// Whether no agent has ever been.
  bool empty() const { return spans_.empty(); }

 private:
  /// From the first tick up to the last without it; to = -1: for good, as far as is known.
  struct Span {
    std::int64_t from = 0, to = -1;
  };
  std::map<int, std::vector<Span>> spans_;  // by agent, in order
};

}  // namespace mascot
