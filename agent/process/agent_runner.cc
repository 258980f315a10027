#include "agent/process/agent_runner.h"

#include "experiment/processes.h"

namespace mascot {
namespace {

std::vector<TickInbox::Peer> PeersOf(const Experiment& experiment, int id) {
  std::vector<TickInbox::Peer> peers;
  for (const Graph::Neighbour& heard : experiment.graph.HeardBy(id))
    peers.push_back({.id = heard.id, .sends_messages = experiment.agent(heard.id).sends_messages});
  return peers;
}

}  // namespace

AgentRunner::AgentRunner(Domain& domain, const Experiment& experiment, int id, std::function<void()> on_first_answer)
    : experiment_(experiment),
      id_(id),
      on_first_answer_(std::move(on_first_answer)),
      agent_(experiment, id),
      low_level_(experiment, {id, id}),
      inbox_(id, PeersOf(experiment, id), experiment.run.mode == Mode::kRealtime, experiment.agent(id).takes_actions),
      commands_(domain, Topic::Command(id)) {
  if (!experiment.agent(id).sends_messages) return;
  messages_.emplace(domain, Topic::Message(id));
  const int recorder = 1;
  message_readers_ = HearingProcesses(experiment, /*heard_only=*/true)[static_cast<std::size_t>(id - 1)] + recorder;
}

bool AgentRunner::Matched() const {
  const int command_readers = 2;  // the physics server and the recorder
  return commands_.matched() >= command_readers && (!messages_ || messages_->matched() >= message_readers_);
}

void AgentRunner::OnState(std::size_t source, std::int64_t tick, const Motion& motion, int events) {
  const std::lock_guard lock(mutex_);
  if (const auto complete = inbox_.OnState(source, tick, motion, events)) Answer(*complete);
}

void AgentRunner::OnEvent(int number, const Event& event, const std::shared_ptr<const Experiment>& now) {
  const std::lock_guard lock(mutex_);
  events_.emplace_back(number, now);
  if (const auto complete = inbox_.OnEvent(number, event)) Answer(*complete);
}

void AgentRunner::OnMessage(std::size_t source, std::int64_t tick, std::span<const double> data) {
  const std::lock_guard lock(mutex_);
  if (const auto complete = inbox_.OnMessage(source, tick, data)) Answer(*complete);
}

void AgentRunner::OnAction(std::int64_t tick, std::span<const double> action) {
  const std::lock_guard lock(mutex_);
  if (const auto complete = inbox_.OnAction(tick, action)) Answer(*complete);
}

void AgentRunner::TakeEvents(int events) {
  std::shared_ptr<const Experiment> now;
  for (; !events_.empty() && events_.front().first <= events; events_.pop_front())
    if (events_.front().second) now = events_.front().second;
  if (!now) return;
  agent_.Adopt(now);
  low_level_.Adopt(*now);
}

void AgentRunner::Answer(const TickInbox::CompleteTick& complete) {
  const std::int64_t tick = complete.tick;
  TakeEvents(complete.events);
  if (agent_.is_lost()) return;
  if (!complete.action.empty()) agent_.Act(complete.action);
  Command command = agent_.Want(tick, *complete.self, complete.samples);
  const Controller::Input driven = agent_.Driven(command);
  low_level_.Actuate({&driven, 1}, {&command, 1});
  if (messages_) {  // before the command: the next tick, which the command brings, needs it
    ToWire(tick, experiment_.control.rate_hz, id_, agent_.message(), message_);
    messages_->Write(message_);
  }
  ToWire(tick, experiment_.control.rate_hz, id_, command, command_);
  commands_.Write(command_);
  if (!has_answered_.exchange(true)) on_first_answer_();
}

}  // namespace mascot
