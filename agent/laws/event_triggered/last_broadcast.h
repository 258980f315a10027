#pragma once

#include <map>
#include <span>
#include <vector>

#include "agent/laws/law.h"

namespace mascot {

/// The last message of each neighbour that an agent has heard. A tick without a message changes nothing.
class LastBroadcast {
 public:
  void Hear(std::span<const Heard> heard) {
    for (const Heard& j : heard)
      if (!j.message.empty()) last_[j.id].assign(j.message.begin(), j.message.end());
  }
  /// The last message of agent `id`; empty: none has arrived. Valid until the next Hear().
  std::span<const double> By(int id) const {
    const auto last = last_.find(id);
    return last != last_.end() ? std::span<const double>(last->second) : std::span<const double>();
  }

 private:
  std::map<int, std::vector<double>> last_;  // by id
};

}  // namespace mascot
