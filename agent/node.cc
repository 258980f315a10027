#include "agent/node.h"

#include <algorithm>

namespace mascot {

using namespace std::chrono_literals;

Node::Node(Domain& domain, Lifecycle& lifecycle, Experiment& experiment, int id)
    : lifecycle_(lifecycle),
      experiment_(experiment),
      id_(id),
      agent_(experiment, id),
      neighbours_(experiment.graph.HeardBy(id).size()),
      commands_(domain, Topic::Command(id)) {
  for (const Graph::Neighbour& neighbour : experiment.graph.HeardBy(id))
    heard_.push_back({neighbour.id, neighbour.weight, Motion{}});
  auto read = [&](int source_id, std::size_t source) {
    states_.push_back(std::make_unique<Reader<StateType>>(
        domain, Topic::State(source_id),
        [this, source](const mascot_msgs::msg::AgentState& state) { Hear(source, state); }));
  };
  read(id, 0);
  for (std::size_t i = 0; i < heard_.size(); ++i) read(heard_[i].id, i + 1);
}

void Node::Run() {
  lifecycle_.Set(Life::kMatching);
  while (!Matched()) lifecycle_.Wait(50ms);
  lifecycle_.Set(Life::kReady);
  while (!flies_) lifecycle_.Wait(1s);
  lifecycle_.Set(Life::kRunning);
  for (;;) lifecycle_.Wait(1s);
}

bool Node::Matched() const {
  const int command_readers = 2;  // the physics server and the recorder
  return commands_.matched() >= command_readers &&
         std::all_of(states_.begin(), states_.end(), [](const auto& reader) { return reader->matched() >= 1; });
}

void Node::Hear(std::size_t source, const mascot_msgs::msg::AgentState& state) {
  const std::lock_guard lock(mutex_);
  Latest& latest = source == 0 ? self_ : neighbours_[source - 1];
  const auto tick = static_cast<std::int64_t>(state.tick());
  if (tick <= latest.tick) return;
  latest.tick = tick;
  latest.motion = FromWire(state);
  // Answer the newest tick of which every state that the graph lets us hear is here. In real time a tick
  // that is overtaken by the next one stays unanswered: the server holds the last command.
  const bool complete = std::all_of(neighbours_.begin(), neighbours_.end(),
                                    [this](const Latest& neighbour) { return neighbour.tick == self_.tick; });
  if (complete && self_.tick > answered_) Answer(self_.tick);
}

void Node::Answer(std::int64_t tick) {
  for (std::size_t i = 0; i < heard_.size(); ++i) heard_[i].motion = neighbours_[i].motion;
  const Command command = agent_.Decide(tick, self_.motion, heard_);
  answered_ = tick;
  ToWire(tick, experiment_.control.rate_hz, id_, command, command_);
  commands_.Write(command_);
  if (!flies_.exchange(true)) lifecycle_.Wake();
}

}  // namespace mascot
