#include "agent/link.h"

#include <algorithm>
#include <utility>

#include "base/ticks.h"

namespace mascot {
namespace {

Dice DiceOf(const LinkConfig& config, std::uint64_t seed, int hearer, int heard) {
  const bool swapped = config.symmetric && hearer > heard;
  const auto [a, b] = swapped ? std::pair(heard, hearer) : std::pair(hearer, heard);
  return Dice(seed, Dice::Stream::kLink, static_cast<std::uint64_t>(a), static_cast<std::uint64_t>(b));
}

}  // namespace

Link::Link(const LinkConfig& config, int rate_hz, std::uint64_t seed, int hearer, int heard)
    : rate_hz_(rate_hz), dice_(DiceOf(config, seed, hearer, heard)), arrivals_(1) {
  Adopt(config);
}

void Link::Adopt(const LinkConfig& config, double late_s) {
  config_ = config;
  hold_ticks_ = TicksRoundedDown(config.hold_s, rate_hz_);
  late_ticks_ = TicksRoundedUp(late_s, rate_hz_);
  const auto places =
      static_cast<std::size_t>(TicksRoundedUp(config.delay_s + config.jitter_s, rate_hz_) + late_ticks_) + 1;
  if (places <= arrivals_.size()) return;
  std::vector<Packet> arrivals(places);
  for (std::int64_t t = collected_tick_ + 1; t <= collected_tick_ + std::ssize(arrivals_); ++t)
    arrivals[static_cast<std::size_t>(t) % places] = std::move(ArrivalAt(t));
  arrivals_ = std::move(arrivals);
}

bool Link::Loses(std::int64_t tick) {
  if (!config_.bursts) return dice_.Unit(tick, kLoss) < config_.loss;
  for (; state_tick_ < tick; ++state_tick_) {  // the state also changes at ticks at which nothing is sent
    const double change = bad_ ? config_.bursts->bad_to_good : config_.bursts->good_to_bad;
    if (dice_.Unit(state_tick_ + 1, kChange) < change) bad_ = !bad_;
  }
  return dice_.Unit(tick, kLoss) < (bad_ ? config_.bursts->loss_bad : config_.bursts->loss_good);
}

std::int64_t Link::DelayTicks(std::int64_t tick) const {
  if (config_.reordering > 0 && dice_.Unit(tick, kReordering) < config_.reordering) return 0;
  if (config_.jitter_s == 0) return TicksRoundedUp(config_.delay_s, rate_hz_);
  return TicksRoundedUp(config_.delay_s + config_.jitter_s * (2 * dice_.Unit(tick, kDelay) - 1), rate_hz_);
}

void Link::Send(std::int64_t tick, double weight, const Sample& sample) {
  Collect(tick - 1);  // frees places: in real time a tick may have been skipped
  ++count_.sent;
  count_.numbers += sample.message.size();
  if (Loses(tick)) {
    ++count_.lost;
    return;
  }
  Packet& packet = ArrivalAt(tick + DelayTicks(tick) + late_ticks_);
  if (packet.sent >= 0) ++count_.late;  // the older sample that arrives at the same tick is dropped
  packet.sent = tick;
  packet.weight = weight;
  packet.motion = *sample.motion;
  packet.message.assign(sample.message.begin(), sample.message.end());
  packet.message_age = sample.message_age;
}

void Link::Collect(std::int64_t tick) {
  const std::int64_t last = std::min(tick, collected_tick_ + std::ssize(arrivals_));
  for (std::int64_t t = collected_tick_ + 1; t <= last; ++t) {
    Packet& packet = ArrivalAt(t);
    if (packet.sent > newest_.sent) {
      std::swap(packet, newest_);
      newest_since_ = t;
    } else if (packet.sent >= 0) {
      ++count_.late;
    }
    packet.sent = -1;
  }
  collected_tick_ = tick;
}

const Link::Packet* Link::Receive(std::int64_t tick) {
  Collect(tick);
  return newest_.sent >= 0 && tick - newest_since_ <= hold_ticks_ ? &newest_ : nullptr;
}

}  // namespace mascot
