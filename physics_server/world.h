#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "base/contacts.h"
#include "base/crew.h"
#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// All bodies of an experiment, its obstacles and its wind in one Bullet world (double precision). Deterministic: the
/// same experiment and commands give the same bits. No clock, no DDS.
class World {
 public:
  /// When to run Bullet's contact detection and solver: at steps at which bodies are close enough to touch, or at every
  /// step. As long as nothing touches, both give the same bits.
  enum class LookForContacts { kWhenClose, kAlways };
  /// For how many bodies at once: what the processor can do.
  static constexpr int kAllLanes = 64;
  /// Bodies start exactly at their configured state. `max_lanes`: how many bodies a thread computes at once at most.
  /// `crew`: the threads that compute; it must outlive the world. The bits depend on neither.
  explicit World(const Experiment& experiment, LookForContacts look = LookForContacts::kWhenClose,
                 int max_lanes = kAllLanes, Crew& crew = Crew::Alone());
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Call it when events have changed the experiment: from the next Step() on, the wind and the faults of motors are
  /// those of `now`.
  void Adopt(const Experiment& now);
  /// Motion of agent `id` (1..N) at the current tick. a_WB is (v(k) - v(k-1)) * control rate, 0 at tick 0.
  Motion State(int id) const;
  /// Runs exactly one tick (physics rate / control rate steps) with `commands[id - 1]` held, as far as the agent's
  /// motors carry it out (FaultyMotors). Throws std::runtime_error naming agent and tick if a command or a resulting
  /// state is not finite, std::invalid_argument if there is not one command per agent.
  void Step(std::span<const Actuation> commands);
  /// Where the body of an agent that is a vehicle (AgentConfig::vehicle) is at the end of the next Step(): it has
  /// moved there along a straight line, whatever its command is. Without a new place it stays where it is. a_WB is not
  /// looked at.
  void Move(int id, const Motion& to);
  /// Puts the body of an agent with a vehicle there at once: before the first tick.
  void Place(int id, const Motion& at);
  /// The current tick: 0, then one more after each Step().
  std::int64_t tick() const;
  /// Contacts begun so far.
  const Contacts& contacts() const;
  std::int64_t collisions() const { return contacts().total(); }
  /// Physics steps so far at which Bullet looked for contacts, of all bodies or of some.
  std::int64_t steps_with_contacts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mascot
