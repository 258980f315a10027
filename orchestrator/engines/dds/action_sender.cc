#include "orchestrator/engines/dds/action_sender.h"

#include <algorithm>

#include "bus/sample_layout.h"
#include "bus/wire.h"
#include "experiment/processes.h"

namespace mascot {

ActionSender::ActionSender(Domain& domain, const Experiment& experiment, Recorder& recorder, ActionSource* source,
                           Stepper* stepper)
    : domain_(domain),
      experiment_(experiment),
      recorder_(recorder),
      feed_(experiment, source),
      stepper_(stepper),
      motions_(stepper == nullptr ? 0 : experiment.agents.size()) {
  for (const AgentRange& process : AgentProcesses(experiment))
    for (int id = process.first; id <= process.last; ++id)
      if (experiment.agent(id).takes_actions)
        takers_.push_back({.id = id,
                           .process = ProcessName(process),
                           .writer = std::make_unique<RawWriter>(domain, Topic::Action(id))});
}

bool ActionSender::Matched() const {
  return std::ranges::all_of(takers_, [](const Taker& taker) { return taker.writer->HasReaderOf(taker.process); });
}

void ActionSender::Send(std::int64_t rows) {
  const bool realtime = experiment_.run.mode == Mode::kRealtime;
  bool acted = false;
  for (; recorder_.HasStates(next_tick_) && (realtime || rows == next_tick_) && MayAct(); ++next_tick_, acted = true)
    Act(next_tick_);
  if (acted && recorder_.HasStates(next_tick_)) domain_.Wake();  // nobody has answered: all agents are lost
  for (Taker& taker : takers_) SendTo(taker);
}

bool ActionSender::MayAct() {
  TakeEvents(next_tick_);
  if (stepper_ == nullptr) return true;
  if (shown_ < next_tick_) {
    recorder_.StatesOf(next_tick_, motions_);
    stepper_->See(next_tick_, motions_, events_now_, feed_.now());
    events_now_.clear();
    shown_ = next_tick_;
  }
  return stepper_->MayGoOn(next_tick_);
}

void ActionSender::Act(std::int64_t tick) {
  feed_.GoTo(tick);
  for (Taker& taker : takers_) {
    const std::span<const double> action = feed_.Of(taker.id);
    PutMessage(tick, experiment_.control.rate_hz, taker.id, action, BodyIn(taker.sample, MessageBody(action.size())));
    taker.is_sent = !recorder_.TakeAction(taker.id, tick, taker.sample);
    SendTo(taker);
  }
  recorder_.EndActions(tick);
}

void ActionSender::TakeEvents(std::int64_t tick) {
  for (const mascot_msgs::msg::Event& sample : recorder_.Events(events_)) {
    const Event event = FromWire(sample, experiment_.size());
    if (event.tick > tick) return;
    ++events_;
    feed_.Take(event);
    if (stepper_ != nullptr) events_now_.push_back(event);
    if (event.restart)
      for (Taker& taker : takers_) taker.is_found = taker.is_found && taker.id != *event.restart;
  }
}

/// A reader that is not matched yet does not get what is written before: its sample waits for it.
void ActionSender::SendTo(Taker& taker) {
  if (taker.is_sent) return;
  taker.is_found = taker.is_found || taker.writer->HasReaderOf(taker.process);
  if (!taker.is_found) return;
  taker.writer->Write(taker.sample);
  taker.is_sent = true;
}

}  // namespace mascot
