#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "base/motion.h"
#include "bus/bus.h"
#include "experiment/experiment.h"
#include "physics_server/world.h"

namespace mascot {

/// How states reach the agents and the recorder, and commands the server. There is one class for each network.delivery.
/// Each sends an agent's process what its agents may hear, and nothing else.
class Delivery {
 public:
  /// An agent's command for a tick.
  struct Answer {
    int id = 0;
    std::int64_t tick = 0;
    Actuation actuator{};
  };
  /// Called for commands that came in one sample, in a thread of DDS.
  using OnAnswers = std::function<void(std::span<const Answer>)>;

  virtual ~Delivery() = default;
  /// Whether all readers and writers are matched.
  virtual bool Matched() const = 0;
  /// Whether those of the process of these agents are.
  virtual bool Matched(AgentRange agents) const = 0;
  /// Publishes the states of the world's tick, of which `events` events have taken effect.
  virtual void Publish(const World& world, int events) = 0;
  /// An event takes effect at the tick that is published next.
  virtual void Take(const Event& event) = 0;
  /// From now on no answers of agent `id` are taken, until an event restarts it. Returns whether its answer to the
  /// newest tick is on its way to OnAnswers.
  virtual bool Lose(int id) = 0;
  /// Sends the states of the newest tick again to processes that have not answered it, if nothing else sees to it that
  /// what was lost comes again.
  virtual void AskAgain() = 0;
  /// The next tick is not published yet, after answers have come: if all agents have answered, the recorder gets the
  /// answers now. With the next tick it would get them late, because that is held: by people, or by the clock.
  virtual void CompleteRow() = 0;
  /// Gives the recorder all answers since the last Publish(), when there is no next tick.
  virtual void Finish() = 0;
};

std::unique_ptr<Delivery> MakeDelivery(Domain& domain, const Experiment& experiment, Delivery::OnAnswers on_answers);

}  // namespace mascot
