#include "agent/process/node.h"

#include <algorithm>

#include "agent/laws/laws.h"

namespace mascot {

using namespace std::chrono_literals;

Node::Node(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment, AgentRange agents)
    : lifecycle_(lifecycle), experiment_(experiment), live_(experiment, &LawTable(), /*checked=*/true) {
  for (int id = agents.first; id <= agents.last; ++id)
    runners_.push_back(std::make_unique<AgentRunner>(domain, experiment, id, [this] { lifecycle_.Wake(); }));
  experiment.network.delivery == Delivery::kBundled ? ListenToBundles(domain) : ListenToStates(domain);
  ListenToMessages(domain);
  ListenToEvents(domain);
}

std::map<int, std::vector<Node::Listener>> Node::Listeners(bool own) const {
  std::map<int, std::vector<Listener>> listeners;
  for (const auto& runner : runners_) {
    if (own) listeners[runner->id()].push_back({runner.get(), 0});
    const auto& heard = experiment_.graph.HeardBy(runner->id());
    for (std::size_t k = 0; k < heard.size(); ++k) listeners[heard[k].id].push_back({runner.get(), k + 1});
  }
  return listeners;
}

void Node::ListenToStates(Domain& domain) {
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

void Node::ListenToBundles(Domain& domain) {
  for (const auto& runner : runners_)
    readers_.push_back(std::make_unique<Reader<BundleType>>(
        domain, Topic::Bundle(runner->id()),
        [runner = runner.get()](const mascot_msgs::msg::AgentBundle& bundle) { runner->OnBundle(bundle); }));
}

void Node::ListenToMessages(Domain& domain) {
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

void Node::ListenToEvents(Domain& domain) {
  readers_.push_back(
      std::make_unique<Reader<EventType>>(domain, Topic::Event(), [this](const mascot_msgs::msg::Event& event) {
        const int number = live_.count() + 1;
        const auto now = live_.After(FromWire(event, experiment_.size(), number, experiment_.ticks()));
        for (const auto& runner : runners_) runner->OnEvent(number, now);
      }));
}

void Node::Run() {
  lifecycle_.Set(Life::kMatching);
  while (!Matched()) lifecycle_.Wait(50ms);
  lifecycle_.Set(Life::kReady);
  while (!std::ranges::all_of(runners_, [](const auto& runner) { return runner->has_answered(); })) lifecycle_.Wait(1s);
  lifecycle_.Set(Life::kRunning);
  for (;;) lifecycle_.Wait(1s);
}

bool Node::Matched() const {
  return std::ranges::all_of(runners_, [](const auto& runner) { return runner->Matched(); }) &&
         std::ranges::all_of(readers_, [](const auto& reader) { return reader->matched() >= 1; });
}

}  // namespace mascot
