#include "agent/process/tick_inbox.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace mascot {

TickInbox::TickInbox(int id, const std::vector<Peer>& peers, bool realtime, bool takes_actions)
    : realtime_(realtime), takes_actions_(takes_actions), samples_(peers.size()) {
  sources_.push_back({.agent = {.id = id}});
  for (const Peer& peer : peers) sources_.push_back({.agent = peer});
}

std::optional<TickInbox::CompleteTick> TickInbox::OnState(std::size_t source, std::int64_t tick, const Motion& motion,
                                                          int events) {
  return Take(sources_[source], tick, motion, events) ? TakeIfComplete() : std::nullopt;
}

std::optional<TickInbox::CompleteTick> TickInbox::OnMessage(std::size_t source, std::int64_t tick,
                                                            std::span<const double> data) {
  if (tick < 0) return std::nullopt;
  Message& place = sources_[source].messages[static_cast<std::size_t>(tick % 2)];
  if (tick <= place.tick) return std::nullopt;
  place.tick = tick;
  place.data.assign(data.begin(), data.end());
  return TakeIfComplete();
}

std::optional<TickInbox::CompleteTick> TickInbox::OnAction(std::int64_t tick, std::span<const double> action) {
  if (tick <= action_.tick) return std::nullopt;
  action_.tick = tick;
  action_.data.assign(action.begin(), action.end());
  return TakeIfComplete();
}

std::optional<TickInbox::CompleteTick> TickInbox::OnEvent(int number, const Event& event) {
  events_ = number;
  silences_.Take(event);
  return TakeIfComplete();
}

bool TickInbox::Take(Source& source, std::int64_t tick, const Motion& motion, int events) {
  if (tick <= source.tick) return false;
  source.tick = tick;
  source.motion = motion;
  source.events = events;
  return true;
}

bool TickInbox::IsComplete(const Source& source, std::int64_t tick) const {
  if (source.tick != tick) return false;
  if (!source.agent.sends_messages || tick == 0 || realtime_)
    return true;  // in real time a peer may have missed a tick
  return source.messages[static_cast<std::size_t>((tick - 1) % 2)].tick == tick - 1 ||
         silences_.Has(source.agent.id, tick - 1);
}

Sample TickInbox::SampleAt(const Source& source, std::int64_t tick) {
  const Message* last = nullptr;
  for (const Message& message : source.messages)
    if (message.tick < tick && (last == nullptr || message.tick > last->tick)) last = &message;
  if (last == nullptr) return {.motion = &source.motion};
  return {.motion = &source.motion, .message = last->data, .message_age = tick - last->tick};
}

std::optional<TickInbox::CompleteTick> TickInbox::TakeIfComplete() {
  const std::int64_t tick = sources_.front().tick;
  const int events = sources_.front().events;
  if (tick <= answered_ || events > events_) return std::nullopt;
  if (!std::ranges::all_of(sources_, [&](const Source& source) { return IsComplete(source, tick); }))
    return std::nullopt;
  if (takes_actions_ && action_.tick != tick && !silences_.Has(sources_.front().agent.id, tick)) return std::nullopt;
  answered_ = tick;
  for (std::size_t k = 0; k < samples_.size(); ++k) samples_[k] = SampleAt(sources_[k + 1], tick);
  return CompleteTick{
      .tick = tick,
      .self = &sources_.front().motion,
      .samples = samples_,
      .events = events,
      .action = action_.tick == tick ? std::span<const double>(action_.data) : std::span<const double>()};
}

}  // namespace mascot
