#include "agent/process/node.h"

#include "agent/laws/laws.h"
#include "agent/process/agents_on_bundles.h"
#include "agent/process/agents_on_topics.h"

namespace mascot {

using namespace std::chrono_literals;

namespace {

std::unique_ptr<AgentsOnWire> MakeAgents(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment,
                                         AgentRange agents) {
  const auto on_first_answer = [&lifecycle] { lifecycle.Wake(); };
  if (experiment.network.is_bundled())
    return std::make_unique<AgentsOnBundles>(domain, experiment, agents, on_first_answer);
  return std::make_unique<AgentsOnTopics>(domain, experiment, agents, on_first_answer);
}

}  // namespace

Node::Node(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment, AgentRange agents)
    : lifecycle_(lifecycle),
      experiment_(experiment),
      live_(experiment, &LawTable(), /*checked=*/true),
      agents_(MakeAgents(domain, lifecycle, experiment, agents)),
      events_(domain, Topic::Event(), [this](const mascot_msgs::msg::Event& event) { OnEvent(event); }) {}

void Node::OnEvent(const mascot_msgs::msg::Event& event) {
  const int number = live_.count() + 1;
  agents_->OnEvent(number, live_.After(FromWire(event, experiment_.size(), number, experiment_.ticks())));
}

void Node::Run() {
  lifecycle_.Set(Life::kMatching);
  while (!Matched()) lifecycle_.Wait(50ms);
  lifecycle_.Set(Life::kReady);
  while (!agents_->HaveAnswered()) lifecycle_.Wait(1s);
  lifecycle_.Set(Life::kRunning);
  for (;;) lifecycle_.Wait(1s);
}

}  // namespace mascot
