#include "agent/seat.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "experiment/processes.h"

namespace mascot {

Seat::Seat(Domain& domain, const Experiment& experiment, int id, std::function<void()> on_first_answer)
    : experiment_(experiment),
      id_(id),
      realtime_(experiment.run.mode == Mode::kRealtime),
      on_first_answer_(std::move(on_first_answer)),
      agent_(experiment, id),
      commands_(domain, Topic::Command(id)) {
  sources_.push_back({.id = id});
  for (const Graph::Neighbour& heard : experiment.graph.HeardBy(id))
    sources_.push_back({.id = heard.id, .sends_messages = experiment.agent(heard.id).sends_messages});
  samples_.resize(sources_.size() - 1);
  if (!experiment.agent(id).sends_messages) return;
  messages_.emplace(domain, Topic::Message(id));
  const int recorder = 1;
  message_readers_ = HearingProcesses(experiment, /*heard_only=*/true)[static_cast<std::size_t>(id - 1)] + recorder;
}

bool Seat::Matched() const {
  const int command_readers = 2;  // the physics server and the recorder
  return commands_.matched() >= command_readers && (!messages_ || messages_->matched() >= message_readers_);
}

void Seat::OnState(std::size_t source, std::int64_t tick, const Motion& motion) {
  const std::lock_guard lock(mutex_);
  Source& from = sources_[source];
  if (tick <= from.tick) return;
  from.tick = tick;
  from.motion = motion;
  AnswerIfComplete();
}

void Seat::OnBundle(const mascot_msgs::msg::AgentBundle& bundle) {
  const std::lock_guard lock(mutex_);
  const auto& states = bundle.states();
  if (states.size() != sources_.size())
    throw std::runtime_error("a bundle of " + std::to_string(states.size()) + " states came for agent " +
                             std::to_string(id_) + ", who hears " + std::to_string(samples_.size()));
  for (std::size_t k = 0; k < states.size(); ++k) {
    Source& from = sources_[k];
    if (static_cast<int>(states[k].agent()) != from.id)
      throw std::runtime_error("a state of agent " + std::to_string(states[k].agent()) + " came for agent " +
                               std::to_string(id_) + " in place of that of agent " + std::to_string(from.id));
    from.tick = static_cast<std::int64_t>(states[k].tick());
    from.motion = FromWire(states[k]);
  }
  AnswerIfComplete();
}

void Seat::OnMessage(std::size_t source, std::int64_t tick, std::span<const double> data) {
  const std::lock_guard lock(mutex_);
  Source::Message& place = sources_[source].messages[static_cast<std::size_t>(tick % 2)];
  if (tick <= place.tick) return;
  place.tick = tick;
  place.data.assign(data.begin(), data.end());
  AnswerIfComplete();
}

bool Seat::IsComplete(const Source& source, std::int64_t tick) const {
  if (source.tick != tick) return false;
  if (!source.sends_messages || tick == 0 || realtime_) return true;  // in real time an agent may have missed a tick
  return source.messages[static_cast<std::size_t>((tick - 1) % 2)].tick == tick - 1;
}

std::span<const double> Seat::MessageBefore(const Source& source, std::int64_t tick) const {
  const Source::Message* last = nullptr;
  for (const Source::Message& message : source.messages)
    if (message.tick >= 0 && message.tick < tick && (last == nullptr || message.tick > last->tick)) last = &message;
  return last == nullptr ? std::span<const double>() : last->data;
}

// Answers the newest tick of which everything that the graph lets us hear is here. In real time a tick that is
// overtaken by the next one stays unanswered: the server holds the last command.
void Seat::AnswerIfComplete() {
  const std::int64_t tick = sources_.front().tick;
  if (tick <= answered_) return;
  if (std::ranges::all_of(sources_, [&](const Source& source) { return IsComplete(source, tick); })) Answer(tick);
}

void Seat::Answer(std::int64_t tick) {
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
  if (!has_answered_.exchange(true)) on_first_answer_();
}

}  // namespace mascot
