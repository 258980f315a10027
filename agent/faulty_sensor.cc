#include "agent/faulty_sensor.h"

#include "base/ticks.h"

namespace mascot {

FaultySensor::FaultySensor(const PartFault& fault, int rate_hz, std::uint64_t seed, const std::optional<Motion>& last)
    : fault_(fault),
      rate_hz_(rate_hz),
      period_ticks_(PeriodInTicks(fault.fault.period_s, rate_hz)),
      delay_ticks_(TicksRoundedUp(fault.fault.delay_s, rate_hz)),
      dice_(seed, Dice::Stream::kFaultySensor, static_cast<std::uint64_t>(fault.fault.agent)),
      last_(last),
      last_tick_(fault.since - 1) {}

Motion FaultySensor::Measure(std::int64_t tick, const Motion& right) {
  if (!last_) {
    last_ = right;
    last_tick_ = tick;
  }
  Motion measured = right;
  const Motion reading = ReadingAt(tick, right);
  measured.p_WB = reading.p_WB;
  measured.v_WB = reading.v_WB;
  measured.a_WB = reading.a_WB;
  return measured;
}

Motion FaultySensor::ReadingAt(std::int64_t tick, const Motion& right) {
  Motion reading = right;
  const auto offset = [&](Eigen::Index axis) { return fault_.fault.false_data.offset_m[axis]; };
  switch (fault_.fault.kind) {
    case FaultKind::kOff:
      reading = *last_;
      reading.p_WB += static_cast<double>(tick - last_tick_) / rate_hz_ * last_->v_WB;
      reading.a_WB.setZero();
      return reading;
    case FaultKind::kStuck:
      return *last_;
    case FaultKind::kGarbage:
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const auto draw = static_cast<std::uint64_t>(axis);
        reading.p_WB[axis] += offset(axis) * (2 * dice_.Unit(tick, draw) - 1);
        reading.v_WB[axis] += offset(axis) * (2 * dice_.Unit(tick, draw + 3) - 1);
      }
      return reading;
    case FaultKind::kWrong:
      reading.p_WB += fault_.fault.false_data.offset_m;
      return reading;
    case FaultKind::kSlow:
      if ((tick - fault_.since) % period_ticks_ == 0) last_ = right;
      return *last_;
    case FaultKind::kIntermittent:
      if (dice_.Unit(tick, 0) >= fault_.fault.probability) last_ = right;
      return *last_;
    case FaultKind::kDelayed:
      late_.push_back(right);
      if (std::ssize(late_) > delay_ticks_ + 1) late_.pop_front();
      return late_.front();
    default:
      return right;
  }
}

}  // namespace mascot
