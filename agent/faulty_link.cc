#include "agent/faulty_link.h"

#include "base/ticks.h"

namespace mascot {
namespace {

bool IsFalse(FaultKind kind) { return kind == FaultKind::kGarbage || kind == FaultKind::kWrong; }

}  // namespace

FaultyLink::FaultyLink(const PartFault& fault, int rate_hz, std::uint64_t seed)
    : fault_(fault),
      rate_hz_(rate_hz),
      period_ticks_(PeriodInTicks(fault.fault.period_s, rate_hz)),
      dice_(seed, Dice::Stream::kFaultyLink, static_cast<std::uint64_t>(fault.fault.agent)) {
  if (IsFalse(fault.fault.kind)) false_data_.emplace(fault.fault.false_data, seed, fault.fault.agent);
}

bool FaultyLink::Sends(std::int64_t tick) const {
  switch (fault_.fault.kind) {
    case FaultKind::kOff:
      return false;
    case FaultKind::kSlow:
      return (tick - fault_.since) % period_ticks_ == 0;
    case FaultKind::kIntermittent:
      return dice_.Unit(tick, 0) >= fault_.fault.probability;
    default:
      return true;
  }
}

Sample FaultyLink::SentFor(std::int64_t tick, const Sample& sample) {
  const bool is_stuck = fault_.fault.kind == FaultKind::kStuck;
  if (!is_stuck && !false_data_) return sample;
  if (!is_stuck || !is_kept_) {
    motion_ = *sample.motion;
    message_.assign(sample.message.begin(), sample.message.end());
    is_kept_ = true;
  }
  if (false_data_) false_data_->Tell(tick, static_cast<double>(tick) / rate_hz_, motion_, message_);
  return {&motion_, message_, sample.message_age};
}

}  // namespace mascot
