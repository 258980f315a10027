#include "agent/process/action_readers.h"

#include "bus/wire.h"

namespace mascot {

std::vector<std::unique_ptr<ReaderBase>> ActionReaders(Domain& domain, const Experiment& experiment, AgentRange agents,
                                                       const OnAction& on_action) {
  std::vector<std::unique_ptr<ReaderBase>> readers;
  for (int id = agents.first; id <= agents.last; ++id) {
    if (!experiment.agent(id).takes_actions) continue;
    readers.push_back(std::make_unique<Reader<ActionType>>(
        domain, Topic::Action(id),
        [on_action, topic = Topic::Action(id), last = experiment.ticks()](const mascot_msgs::msg::AgentAction& action) {
          const std::int64_t tick = CheckedTick(topic, action.agent(), action.tick(), last);
          on_action(topic.agent, tick, {action.data().begin(), action.data().end()});
        }));
  }
  return readers;
}

}  // namespace mascot
