#include "agent/process/bundle_inbox.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "bus/bundle.h"
#include "experiment/processes.h"

namespace mascot {

BundleInbox::BundleInbox(const Experiment& experiment, AgentRange agents)
    : agents_(agents),
      last_tick_(experiment.ticks()),
      realtime_(experiment.run.mode == Mode::kRealtime),
      sources_(SourcesOf(experiment, agents)),
      motions_(sources_.size()),
      messages_(sources_.size()),
      actions_(static_cast<std::size_t>(agents.size())) {
  for (std::size_t k = 0; k < sources_.size(); ++k) index_[sources_[k]] = k;
  std::vector<bool> is_heard(sources_.size());
  for (int id = agents.first; id <= agents.last; ++id) {
    if (experiment.agent(id).takes_actions) takers_.push_back(id);
    std::vector<std::size_t>& heard = heard_.emplace_back();
    for (const Graph::Neighbour& neighbour : experiment.graph.HeardBy(id)) heard.push_back(index_.at(neighbour.id));
    for (const std::size_t k : heard) is_heard[k] = true;
  }
  for (std::size_t k = 0; k < sources_.size(); ++k)
    if (is_heard[k] && experiment.agent(sources_[k]).sends_messages) senders_.push_back(sources_[k]);
}

BundleInbox::News BundleInbox::OnBundle(std::span<const std::uint8_t> bytes) {
  BundleReader bundle(bytes);
  const BundleReader::Section states = bundle.Next(kStateBody);
  const auto messages = bundle.NextMessages();
  bundle.End();
  if (std::cmp_greater(bundle.tick(), last_tick_))
    throw std::runtime_error(fmt::format("a bundle of tick {}, the last one is {}", bundle.tick(), last_tick_));
  if (states.count != sources_.size() || std::cmp_not_equal(states.number, agents_.size()))
    throw std::runtime_error(fmt::format("a bundle of {} states, {} of them of its own agents; expected {} and {}",
                                         states.count, states.number, sources_.size(), agents_.size()));
  for (std::size_t k = 0; k < sources_.size(); ++k)
    if (const BodyHead head = HeadOf(states[k].data());
        std::cmp_not_equal(head.agent, sources_[k]) || head.tick != bundle.tick())
      throw std::runtime_error(
          fmt::format("a bundle of tick {} with a state of agent {} at tick {} in the place of agent "
                      "{}'s",
                      bundle.tick(), head.agent, head.tick, sources_[k]));
  const auto tick = static_cast<std::int64_t>(bundle.tick());
  if (tick < tick_) return News::kOld;
  if (tick == tick_) return tick == answered_ ? News::kAgain : News::kWaits;
  const auto events = static_cast<int>(HeadOf(states[0].data()).more);
  RequireMessages(tick, messages);
  if (events <= known_events_) RequireAllMessages(tick, messages);
  tick_ = tick;
  events_ = events;
  for (std::size_t k = 0; k < sources_.size(); ++k) GetState(states[k].data(), motions_[k]);
  for (const auto& body : messages) {
    const BodyHead head = HeadOf(body.data());
    Message& message = messages_[index_.at(static_cast<int>(head.agent))];
    if (std::cmp_less_equal(head.tick, message.tick)) continue;
    message.tick = static_cast<std::int64_t>(head.tick);
    GetMessage(body.data(), message.data);
  }
  return IsComplete() ? News::kComplete : News::kWaits;
}

void BundleInbox::RequireMessages(std::int64_t tick, std::span<const std::span<const std::uint8_t>> messages) const {
  const auto refuse = [tick](const BodyHead& message) {
    throw std::runtime_error(
        fmt::format("a bundle of tick {} with a message of agent {} at tick {}", tick, message.agent, message.tick));
  };
  auto from = senders_.begin();  // in lockstep: of the next message
  for (const auto& message : messages) {
    const BodyHead head = HeadOf(message.data());
    const auto sender = std::find(realtime_ ? senders_.begin() : from, senders_.end(), static_cast<int>(head.agent));
    const bool in_time = realtime_ ? std::cmp_less(head.tick, tick) : std::cmp_equal(head.tick, tick - 1);
    if (sender == senders_.end() || !in_time) refuse(head);
    from = std::next(sender);
  }
}

void BundleInbox::RequireMessageOf(int sender, std::int64_t tick, bool has_come) const {
  if (!has_come && !realtime_ && tick > 0 && !silences_.Has(sender, tick - 1))
    throw std::runtime_error(fmt::format("a bundle of tick {} without a message of agent {}", tick, sender));
}

void BundleInbox::RequireAllMessages(std::int64_t tick, std::span<const std::span<const std::uint8_t>> messages) const {
  std::size_t next = 0;  // of the messages, which are in the order of the senders
  for (const int sender : senders_) {
    const bool has_come = next < messages.size() && std::cmp_equal(HeadOf(messages[next].data()).agent, sender);
    next += has_come;
    RequireMessageOf(sender, tick, has_come);
  }
}

bool BundleInbox::OnEvent(int number, const Event& event) {
  known_events_ = number;
  silences_.Take(event);
  return IsCompleteNow();
}

bool BundleInbox::OnAction(int id, std::int64_t tick, std::span<const double> action) {
  Message& newest = actions_[static_cast<std::size_t>(id - agents_.first)];
  if (tick <= newest.tick) return false;
  newest.tick = tick;
  newest.data.assign(action.begin(), action.end());
  return IsCompleteNow();
}

std::span<const double> BundleInbox::ActionOf(int id) const {
  const Message& newest = actions_[static_cast<std::size_t>(id - agents_.first)];
  return newest.tick == tick_ ? std::span<const double>(newest.data) : std::span<const double>();
}

bool BundleInbox::IsComplete() const {
  return tick_ > answered_ && events_ <= known_events_ && std::ranges::all_of(takers_, [this](int id) {
           return actions_[static_cast<std::size_t>(id - agents_.first)].tick == tick_ || silences_.Has(id, tick_);
         });
}

bool BundleInbox::IsCompleteNow() const {
  if (!IsComplete()) return false;
  for (const int sender : senders_) RequireMessageOf(sender, tick_, messages_[index_.at(sender)].tick == tick_ - 1);
  return true;
}

std::span<const Sample> BundleInbox::SamplesOf(int id) {
  samples_.clear();
  for (const std::size_t k : heard_[static_cast<std::size_t>(id - agents_.first)]) {
    const Message& message = messages_[k];
    if (message.tick < 0)
      samples_.push_back({.motion = &motions_[k]});
    else
      samples_.push_back({.motion = &motions_[k], .message = message.data, .message_age = tick_ - message.tick});
  }
  return samples_;
}

}  // namespace mascot
