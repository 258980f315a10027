#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/contacts.h"
#include "physics_server/bullet/body.h"

class btDispatcher;

namespace mascot {

// Bullet user indices of bodies that are no agents; an agent has its id.
constexpr int kGroundIndex = Contact::kGround;
constexpr int kObstacleIndex = -1;  // the first obstacle; the next is one less, and so on

/// Counts contacts when they begin. A contact begins when two surfaces touch, and ends when Bullet drops all its
/// points, some millimetres apart (20 at most). So resting, sliding and rattling count once.
class ContactCounter {
 public:
  explicit ContactCounter(std::size_t bodies);
  using Pair = std::pair<int, int>;  ///< user indices, in order; at least one is an agent's

  /// To be called after each step. `tick`: the one before the step; `bodies`: the agents', by id - 1.
  void Update(btDispatcher& dispatcher, std::int64_t tick, std::span<const Body> bodies);
  const Contacts& begun() const { return begun_; }
  /// The pairs of bodies that are so close that Bullet kept contact points for them after the last step.
  std::span<const Pair> kept() const { return kept_; }

 private:
  void Begin(const Pair& pair, std::int64_t tick, std::span<const Body> bodies, bool tells);

  // Buffers with capacity, so that a step allocates nothing.
  std::vector<Pair> kept_;
  std::vector<Pair> lasting_, now_;  // sorted
  Contacts begun_;
};

}  // namespace mascot
