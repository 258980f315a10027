#pragma once

#include <memory>
#include <span>
#include <vector>

#include "agent/laws/law.h"
#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// The low-level stacks of agents that have the same model: each turns a wanted acceleration or velocity into the
/// model's actuator commands. They know nothing of each other; together they are faster.
class Controller {
 public:
  /// What an agent has measured, and the acceleration (m/s^2) or velocity (m/s) that drives its model
  /// (ModelTraits::driven_by), in W, already limited. With law.axes = "xy" its z is ignored, and the initial height is
  /// held.
  struct Input {
    const Motion* self;
    Eigen::Vector3d wanted_W;
  };
  struct Output {
    Actuation actuator{};
    std::uint32_t flags = 0;  ///< kTiltLimited, kRotorLimited
  };
  virtual ~Controller() = default;
  /// Called once per tick, with an input and an output for each agent.
  virtual void Actuate(std::span<const Input> inputs, std::span<Output> outputs) = 0;
  /// The stack of agent `i` of them forgets all: what it keeps begins anew from what the next Actuate() gets.
  virtual void Restart(std::size_t /*i*/) {}
};

/// A controller whose agents' stacks are computed one after the other: objects with an Actuate() of their own.
template <class Stack>
class EachByItself final : public Controller {
 public:
  explicit EachByItself(std::vector<Stack> stacks) : stacks_(std::move(stacks)) {}
  void Actuate(std::span<const Input> inputs, std::span<Output> outputs) override {
    for (std::size_t i = 0; i < stacks_.size(); ++i)
      outputs[i] = {.actuator = stacks_[i].Actuate(*inputs[i].self, inputs[i].wanted_W), .flags = 0};
  }

 private:
  std::vector<Stack> stacks_;
};

/// The controller for the agents `ids`, which have the same model. Throws std::invalid_argument for an unknown model.
std::unique_ptr<Controller> MakeController(const Experiment& experiment, std::span<const int> ids);

/// The controller of agent `id` alone.
class ControllerOfOne {
 public:
  ControllerOfOne(const Experiment& experiment, int id) : all_(MakeController(experiment, {&id, 1})) {}
  Controller::Output Actuate(const Motion& self, const Eigen::Vector3d& wanted_W) {
    const Controller::Input input{&self, wanted_W};
    Controller::Output output;
    all_->Actuate({&input, 1}, {&output, 1});
    return output;
  }

 private:
  std::unique_ptr<Controller> all_;
};

}  // namespace mascot
