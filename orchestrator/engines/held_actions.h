#pragma once

#include <span>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// The actions that hold for the agents whose laws take some (LawParams::action): the newest that each was given; at
/// first 0.
class HeldActions {
 public:
  explicit HeldActions(const Experiment& experiment);

  /// Call it when events have changed the experiment. A law that begins anew keeps its action; one that takes another
  /// number of them than the law before begins with 0.
  void Adopt(const Experiment& now);
  /// The action of agent `id` from now on. Throws std::invalid_argument, with the agent, if its law takes none, or not
  /// of this size.
  void Act(int id, std::span<const double> action);
  /// Empty: the agent's law takes none.
  const std::vector<double>& Of(int id) const { return actions_[static_cast<std::size_t>(id - 1)]; }

 private:
  std::vector<std::vector<double>> actions_;  // by id - 1
};

}  // namespace mascot
