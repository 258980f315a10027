#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "agent/controller.h"
#include "base/agent_range.h"
#include "experiment/experiment.h"

namespace mascot {

/// The low-level stacks of agents, whatever their models.
class LowLevel {
 public:
  LowLevel(const Experiment& experiment, AgentRange agents);
  /// Call it when events have changed the experiment: the stacks of agents that are fresh forget all.
  void Adopt(const Experiment& now);
  /// Called once per tick, by agent: adds the actuators and the stack's flags to each command. Agent::Driven() tells
  /// the inputs.
  void Actuate(std::span<const Controller::Input> inputs, std::span<Command> commands);

 private:
  /// Agents of one model.
  struct Group {
    std::unique_ptr<Controller> controller;
    std::vector<std::size_t> places;
    std::vector<Controller::Input> inputs;
    std::vector<Controller::Output> outputs;
  };
  AgentRange agents_;
  std::vector<std::int64_t> restarted_;  // by agent: the tick at which it was fresh
  std::vector<Group> groups_;
};

}  // namespace mascot
