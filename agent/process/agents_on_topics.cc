#include "agent/process/agents_on_topics.h"

#include <algorithm>
#include <utility>

#include "agent/process/action_readers.h"

namespace mascot {

AgentsOnTopics::AgentsOnTopics(Domain& domain, const Experiment& experiment, AgentRange agents,
                               const std::function<void()>& on_first_answer)
    : experiment_(experiment) {
  for (int id = agents.first; id <= agents.last; ++id)
    runners_.push_back(std::make_unique<AgentRunner>(domain, experiment, id, on_first_answer));
  for (const auto& runner : runners_) runner->AwaitLaw();
  ListenToStates(domain);
  ListenToMessages(domain);
  ListenToActions(domain, agents);
}

std::map<int, std::vector<AgentsOnTopics::Listener>> AgentsOnTopics::Listeners(bool own) const {
  std::map<int, std::vector<Listener>> listeners;
  for (const auto& runner : runners_) {
    if (own) listeners[runner->id()].push_back({runner.get(), 0});
    const auto& heard = experiment_.graph.HeardBy(runner->id());
    for (std::size_t k = 0; k < heard.size(); ++k) listeners[heard[k].id].push_back({runner.get(), k + 1});
  }
  return listeners;
}

void AgentsOnTopics::ListenToStates(Domain& domain) {
  for (auto& [id, listeners] : Listeners(/*own=*/true))
    readers_.push_back(std::make_unique<Reader<StateType>>(
        domain, Topic::State(id),
        [topic = Topic::State(id), last = experiment_.ticks(),
         listeners = std::move(listeners)](const mascot_msgs::msg::AgentState& state) {
          const std::int64_t tick = CheckedTick(topic, state.agent(), state.tick(), last);
          const Motion motion = FromWire(state);
          for (const Listener& listener : listeners)
            listener.runner->OnState(listener.source, tick, motion, static_cast<int>(state.events()));
        }));
}

void AgentsOnTopics::ListenToMessages(Domain& domain) {
  for (auto& [id, listeners] : Listeners(/*own=*/false)) {
    if (!experiment_.agent(id).sends_messages) continue;
    readers_.push_back(std::make_unique<Reader<MessageType>>(
        domain, Topic::Message(id),
        [topic = Topic::Message(id), last = experiment_.ticks(),
         listeners = std::move(listeners)](const mascot_msgs::msg::AgentMessage& message) {
          const std::int64_t tick = CheckedTick(topic, message.agent(), message.tick(), last);
          const std::span<const double> data(message.data().begin(), message.data().end());
          for (const Listener& listener : listeners) listener.runner->OnMessage(listener.source, tick, data);
        }));
  }
}

void AgentsOnTopics::ListenToActions(Domain& domain, AgentRange agents) {
  for (auto& reader : ActionReaders(domain, experiment_, agents,
                                    [this, agents](int id, std::int64_t tick, std::span<const double> action) {
                                      runners_[static_cast<std::size_t>(id - agents.first)]->OnAction(tick, action);
                                    }))
    readers_.push_back(std::move(reader));
}

void AgentsOnTopics::OnEvent(int number, const Event& event, const std::shared_ptr<const Experiment>& now) {
  for (const auto& runner : runners_) runner->OnEvent(number, event, now);
}

bool AgentsOnTopics::HaveAnswered() const {
  return std::ranges::all_of(runners_, [](const auto& runner) { return runner->has_answered(); });
}

bool AgentsOnTopics::Matched() const {
  return std::ranges::all_of(runners_, [](const auto& runner) { return runner->Matched(); }) &&
         std::ranges::all_of(readers_, [](const auto& reader) { return reader->matched() >= 1; });
}

}  // namespace mascot
