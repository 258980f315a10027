#pragma once

#include <memory>
#include <vector>

#include "bus/wire.h"
#include "physics_server/process/delivery.h"

namespace mascot {

/// network.delivery = "topics": each agent's states on a topic of its own, for all that may hear it, and for the
/// recorder, which hears commands and messages by itself.
class TopicDelivery final : public Delivery {
 public:
  TopicDelivery(Domain& domain, const Experiment& experiment, const OnAnswers& on_answers);

  bool Matched() const override;
  bool Matched(AgentRange agents) const override;
  void Publish(const World& world, int events) override;
  void Take(const Event& /*event*/) override {}
  bool Lose(int /*id*/) override { return false; }  // the server does not wait for it
  void AskAgain() override {}
  void CompleteRow() override {}
  void Finish() override {}

 private:
  const Experiment& experiment_;
  Writer<ClockType> clock_;
  std::vector<std::unique_ptr<Writer<StateType>>> states_;
  std::vector<int> state_readers_;  // by id - 1: how many the writer must match
  mascot_msgs::msg::AgentState state_;
  std::vector<std::unique_ptr<Reader<CommandType>>> command_readers_;
};

}  // namespace mascot
