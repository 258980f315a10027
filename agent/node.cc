#include "agent/node.h"

#include <algorithm>

namespace mascot {

using namespace std::chrono_literals;

Node::Node(Domain& domain, Lifecycle& lifecycle, Experiment& experiment, int id)
    : lifecycle_(lifecycle),
      experiment_(experiment),
      id_(id),
      realtime_(experiment.run.mode == Mode::kRealtime),
      agent_(experiment, id),
      sources_(experiment.graph.HeardBy(id).size() + 1),
      samples_(experiment.graph.HeardBy(id).size()),
      commands_(domain, Topic::Command(id)) {
  if (experiment.agent(id).sends_messages) {
    messages_.emplace(domain, Topic::Message(id));
    for (int other = 1; other <= experiment.size(); ++other)
      hearers_ += std::ranges::count(experiment.graph.HeardBy(other), id, &Graph::Neighbour::id);
  }
  Listen(domain, 0, id);
  const auto& may_hear = experiment.graph.HeardBy(id);
  for (std::size_t k = 0; k < may_hear.size(); ++k) Listen(domain, k + 1, may_hear[k].id);
}

void Node::Listen(Domain& domain, std::size_t source, int id) {
  state_readers_.push_back(std::make_unique<Reader<StateType>>(
      domain, Topic::State(id), [this, source](const mascot_msgs::msg::AgentState& state) { OnState(source, state); }));
  sources_[source].sends_messages = source > 0 && experiment_.agent(id).sends_messages;
  if (!sources_[source].sends_messages) return;
  message_readers_.push_back(std::make_unique<Reader<MessageType>>(
      domain, Topic::Message(id),
      [this, source](const mascot_msgs::msg::AgentMessage& message) { OnMessage(source, message); }));
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
  const auto has_writer = [](const auto& reader) { return reader->matched() >= 1; };
  return commands_.matched() >= command_readers && (!messages_ || messages_->matched() > hearers_) &&
         std::ranges::all_of(state_readers_, has_writer) && std::ranges::all_of(message_readers_, has_writer);
}

void Node::OnState(std::size_t source, const mascot_msgs::msg::AgentState& state) {
  const std::lock_guard lock(mutex_);
  Source& from = sources_[source];
  const auto tick = static_cast<std::int64_t>(state.tick());
  if (tick <= from.tick) return;
  from.tick = tick;
  from.motion = FromWire(state);
  AnswerIfComplete();
}

void Node::OnMessage(std::size_t source, const mascot_msgs::msg::AgentMessage& message) {
  const std::lock_guard lock(mutex_);
  const auto tick = static_cast<std::int64_t>(message.tick());
  Source::Message& place = sources_[source].messages[static_cast<std::size_t>(tick % 2)];
  if (tick <= place.tick) return;
  place.tick = tick;
  place.data.assign(message.data().begin(), message.data().end());
  AnswerIfComplete();
}

bool Node::IsComplete(const Source& source, std::int64_t tick) const {
  if (source.tick != tick) return false;
  if (!source.sends_messages || tick == 0 || realtime_) return true;  // in real time an agent may have missed a tick
  return source.messages[static_cast<std::size_t>((tick - 1) % 2)].tick == tick - 1;
}

std::span<const double> Node::MessageBefore(const Source& source, std::int64_t tick) const {
  const Source::Message* last = nullptr;
  for (const Source::Message& message : source.messages)
    if (message.tick >= 0 && message.tick < tick && (last == nullptr || message.tick > last->tick)) last = &message;
  return last == nullptr ? std::span<const double>() : last->data;
}

// Answers the newest tick of which everything that the graph lets us hear is here. In real time a tick that is
// overtaken by the next one stays unanswered: the server holds the last command.
void Node::AnswerIfComplete() {
  const std::int64_t tick = sources_.front().tick;
  if (tick <= answered_) return;
  if (std::ranges::all_of(sources_, [&](const Source& source) { return IsComplete(source, tick); })) Answer(tick);
}

void Node::Answer(std::int64_t tick) {
  for (std::size_t k = 0; k < samples_.size(); ++k)
    samples_[k] = {&sources_[k + 1].motion, MessageBefore(sources_[k + 1], tick)};
  const Command command = agent_.Decide(tick, sources_.front().motion, samples_);
  answered_ = tick;
  if (messages_) {  // before the command, so that it is there when the next tick is
    ToWire(tick, experiment_.control.rate_hz, id_, agent_.message(), message_);
    messages_->Write(message_);
  }
  ToWire(tick, experiment_.control.rate_hz, id_, command, command_);
  commands_.Write(command_);
  if (!flies_.exchange(true)) lifecycle_.Wake();
}

}  // namespace mascot
