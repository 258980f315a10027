#pragma once

#include <compare>

namespace mascot {

/// The agents `first` to `last`, which share a process; both are among them.
struct AgentRange {
  int first = 0;
  int last = 0;

  bool Holds(int id) const { return id >= first && id <= last; }
  int size() const { return last - first + 1; }
  auto operator<=>(const AgentRange&) const = default;
};

}  // namespace mascot
