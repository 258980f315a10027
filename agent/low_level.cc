#include "agent/low_level.h"

#include <map>
#include <string>
#include <utility>

namespace mascot {

LowLevel::LowLevel(const Experiment& experiment, AgentRange agents)
    : agents_(agents), restarted_(static_cast<std::size_t>(agents.size())) {
  std::map<std::string, std::vector<int>> by_model;
  for (int id = agents.first; id <= agents.last; ++id) by_model[experiment.agent(id).model].push_back(id);
  for (const auto& [model, ids] : by_model) {
    Group& group = groups_.emplace_back();
    group.controller = MakeController(experiment, ids);
    for (const int id : ids) group.places.push_back(static_cast<std::size_t>(id - agents.first));
    group.inputs.resize(ids.size());
    group.outputs.resize(ids.size());
  }
}

void LowLevel::Adopt(const Experiment& now) {
  for (Group& group : groups_)
    for (std::size_t k = 0; k < group.places.size(); ++k) {
      const std::size_t place = group.places[k];
      const std::int64_t restarted = now.agent(agents_.first + static_cast<int>(place)).faults.restarted;
      if (std::exchange(restarted_[place], restarted) != restarted) group.controller->Restart(k);
    }
}

void LowLevel::Actuate(std::span<const Controller::Input> inputs, std::span<Command> commands) {
  for (Group& group : groups_) {
    for (std::size_t k = 0; k < group.places.size(); ++k) group.inputs[k] = inputs[group.places[k]];
    group.controller->Actuate(group.inputs, group.outputs);
    for (std::size_t k = 0; k < group.places.size(); ++k) {
      Command& command = commands[group.places[k]];
      command.actuator = group.outputs[k].actuator;
      command.flags |= group.outputs[k].flags;
    }
  }
}

}  // namespace mascot
