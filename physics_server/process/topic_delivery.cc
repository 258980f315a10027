#include "physics_server/process/topic_delivery.h"

#include "experiment/processes.h"

namespace mascot {

TopicDelivery::TopicDelivery(Domain& domain, const Experiment& experiment, const OnAnswers& on_answers)
    : experiment_(experiment), clock_(domain, Topic::Clock()) {
  const int recorder = 1;
  for (const int processes : HearingProcesses(experiment, /*heard_only=*/false))
    state_readers_.push_back(recorder + processes);
  for (int id = 1; id <= experiment.size(); ++id) {
    states_.push_back(std::make_unique<Writer<StateType>>(domain, Topic::State(id)));
    command_readers_.push_back(std::make_unique<Reader<CommandType>>(
        domain, Topic::Command(id),
        [on_answers, topic = Topic::Command(id),
         last_tick = experiment.ticks()](const mascot_msgs::msg::AgentCommand& command) {
          const Answer answer{.id = topic.agent,
                              .tick = CheckedTick(topic, command.agent(), command.tick(), last_tick),
                              .actuator = command.actuator()};
          on_answers({&answer, 1});
        }));
  }
}

bool TopicDelivery::Matched() const {
  if (clock_.matched() < 1) return false;
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (states_[i]->matched() < state_readers_[i] || command_readers_[i]->matched() < 1) return false;
  return true;
}

bool TopicDelivery::Matched(AgentRange agents) const {
  const std::string process = ProcessName(agents);
  for (const int id : SourcesOf(experiment_, agents))
    if (!states_[static_cast<std::size_t>(id - 1)]->HasReaderOf(process)) return false;
  for (int id = agents.first; id <= agents.last; ++id)
    if (command_readers_[static_cast<std::size_t>(id - 1)]->matched() < 1) return false;
  return true;
}

void TopicDelivery::Publish(const World& world, int events) {
  const int rate_hz = experiment_.control.rate_hz;
  rosgraph_msgs::msg::Clock clock;
  ToWire(world.tick(), rate_hz, clock);
  clock_.Write(clock);
  for (int id = 1; id <= experiment_.size(); ++id) {
    ToWire(world.tick(), rate_hz, id, events, world.State(id), state_);
    states_[static_cast<std::size_t>(id - 1)]->Write(state_);
  }
}

}  // namespace mascot
