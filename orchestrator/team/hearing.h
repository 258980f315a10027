#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "agent/neighbours.h"
#include "base/motion.h"
#include "experiment/experiment.h"
#include "orchestrator/team/exchange.h"

namespace mascot {

/// What all agents of a run hear, worked out from its rows, without the agents: a link depends only on the seed, the
/// edge, the tick and the positions.
class Hearing {
 public:
  /// The experiment must outlive this object.
  explicit Hearing(const Experiment& experiment);

  /// Call it when events have changed the experiment: from the next tick on, the experiment is `now`.
  void Adopt(const std::shared_ptr<const Experiment>& now);
  /// Lets all agents hear at this tick (increasing), where their motions are these, by id - 1.
  void Hear(std::int64_t tick, std::span<const Motion> motions);
  /// The messages that they sent at this tick, by id - 1. They arrive at the next one.
  void Send(std::span<const std::vector<double>> messages);
  /// What agent `id` has heard at the tick of the last Hear(). Valid until the next one, and as long as its motions.
  std::span<const Heard> Of(int id) const { return heard_[static_cast<std::size_t>(id - 1)]; }
  /// By id - 1.
  std::span<const Neighbours> neighbours() const { return neighbours_; }

 private:
  std::vector<Neighbours> neighbours_;
  std::shared_ptr<const Experiment> now_;  // null before the first event
  Exchange exchange_;
  std::vector<std::span<const Heard>> heard_;  // by id - 1
  std::vector<Sample> samples_;                // scratch
};

}  // namespace mascot
