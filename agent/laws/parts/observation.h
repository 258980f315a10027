#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "agent/laws/law.h"
#include "experiment/experiment.h"

namespace mascot {

/// What an agent perceives at a tick, as a row of numbers: what it measures of itself, then a place for each agent that
/// it may hear, in increasing id. All agents of a team have the same layout: who may hear fewer agents than others has
/// places that stay empty. All numbers of a place are 0 while nothing was heard from its agent.
///
///   own:    p (3, m), v (3, m/s), attitude (4: x, y, z, w with w >= 0 of the unit quaternion that takes B to W)
///   places: p (3, m) and v (3, m/s) relative to the own ones, weight a_ij, heard (1 or 0), age (s), message
///
/// Vectors are in W. What the agent measures and hears is as its law gets it: with noise, delay and losses.
struct ObservationLayout {
  std::size_t places = 0;
  /// How many numbers of each message: a longer one is cut, a shorter one has zeros behind it.
  std::size_t message = 0;

  std::size_t size() const { return kOwn + places * (kOfNeighbour + message); }
  /// The layout in words:
  /// "mascot observation 1: own p 3, v 3, attitude 4; 5 x (p 3, v 3, weight, heard, age, message 2)".
  std::string Text() const;
  /// 16 hexadecimal digits that stand for Text(): a policy's file has them, and fits this layout alone.
  std::string Hash() const;
  /// What each number is: "p.x", "neighbour[0].v.z", "neighbour[1].message[0]".
  std::vector<std::string> Names() const;

  bool operator==(const ObservationLayout&) const = default;

  static constexpr std::size_t kOwn = 10, kOfNeighbour = 9;
};

/// The layout of a team: as many places as the agent may hear that may hear most.
ObservationLayout LayoutOf(const Experiment& experiment, std::size_t message);

/// Makes the observations of one agent.
class Observer {
 public:
  Observer(const Experiment& experiment, int id, const ObservationLayout& layout);
  const ObservationLayout& layout() const { return layout_; }
  /// Writes the observation of an agent that measures `self` and has `heard` this, both as for Law::Want_W(), to `to`,
  /// which has room for ObservationLayout::size() numbers.
  void Observe(const Motion& self, std::span<const Heard> heard, std::span<double> to) const;

 private:
  const ObservationLayout layout_;
  std::vector<int> ids_;  // of the agents in the places
};

}  // namespace mascot
