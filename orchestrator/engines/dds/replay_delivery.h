#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "bus/bus.h"
#include "experiment/experiment.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// What reaches the process of one agent at a tick of a recording, and what it answers, as in its run. There is one
/// class for each network.delivery.
class ReplayDelivery {
 public:
  /// The samples of an answer, with their encapsulation.
  struct Answer {
    std::int64_t tick = -1;
    Row::Bytes command;
    Row::Bytes message = {};  ///< empty: its law sends none
  };
  /// Called in a thread of DDS. An answer may come twice.
  using OnAnswer = std::function<void(const Answer&)>;

  virtual ~ReplayDelivery() = default;
  /// Whether the process of the agent has found all readers and writers, and they it.
  virtual bool Matched() const = 0;
  /// Publishes the states of `row`, and the messages that were sent with the answers to the tick before, by id - 1:
  /// those that the agent may hear.
  virtual void Publish(const Row& row, std::span<const Row::Bytes> messages) = 0;
  /// Sends the newest tick again, if nothing else sees to it that what was lost comes again.
  virtual void AskAgain() = 0;
};

/// `experiment`, which must outlive the result, is what the agent's process has: it says which delivery.
std::unique_ptr<ReplayDelivery> MakeReplayDelivery(Domain& domain, const Experiment& experiment, int agent,
                                                   ReplayDelivery::OnAnswer on_answer);

}  // namespace mascot
