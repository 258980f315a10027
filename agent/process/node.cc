#include "agent/process/node.h"

#include <utility>

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

Node::Node(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment, AgentRange agents,
           std::span<const mascot_msgs::msg::Event> history)
    : lifecycle_(lifecycle),
      experiment_(experiment),
      ids_(agents),
      live_(experiment, &LawTable(), /*checked=*/true),
      agents_(MakeAgents(domain, lifecycle, experiment, agents)),
      events_(domain, Topic::Event(), [this](const mascot_msgs::msg::Event& event) { OnEvent(event); }) {
  for (const mascot_msgs::msg::Event& event : history) {
    const Event taken = FromWire(event, experiment.size(), live_.count() + 1, experiment.ticks());
    live_.Take(taken);
    const bool is_last = std::cmp_equal(live_.count(), history.size());
    agents_->OnEvent(live_.count(), taken, is_last ? live_.now() : nullptr);
  }
}

void Node::OnEvent(const mascot_msgs::msg::Event& event) {
  const int number = live_.count() + 1;
  const Event taken = FromWire(event, experiment_.size(), number, experiment_.ticks());
  const auto& now = live_.After(taken);
  agents_->OnEvent(number, taken, now);
  if (taken.fault && taken.fault->kind == FaultKind::kKill && AreKilled(*now)) {
    is_killed_ = true;
    lifecycle_.Wake();
  }
}

bool Node::AreKilled(const Experiment& now) const {
  for (int id = ids_.first; id <= ids_.last; ++id)
    if (const AgentFaults& faults = now.agent(id).faults; !faults.is_lost() || faults.hangs) return false;
  return true;
}

void Node::Wait(std::chrono::nanoseconds timeout) {
  lifecycle_.Wait(timeout);
  if (is_killed_) throw KilledByEvent();
}

void Node::Run() {
  lifecycle_.Set(Life::kMatching);
  while (!Matched()) Wait(50ms);
  lifecycle_.Set(Life::kReady);
  while (!agents_->HaveAnswered()) Wait(1s);
  lifecycle_.Set(Life::kRunning);
  for (;;) Wait(1s);
}

}  // namespace mascot
