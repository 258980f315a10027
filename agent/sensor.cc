#include "agent/sensor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "agent/link.h"
#include "experiment/obstacles.h"

namespace mascot {
namespace {

constexpr std::int64_t kOnce = -1;  // in place of a tick, for what is drawn once

Eigen::Vector3d Normal3(const Dice& dice, std::int64_t n, std::uint64_t first, double std) {
  if (std == 0) return Eigen::Vector3d::Zero();
  return std * Eigen::Vector3d(dice.Normal(n, first), dice.Normal(n, first + 1), dice.Normal(n, first + 2));
}

}  // namespace

Noise::Noise(const NoiseConfig& config, Dice dice)
    : config_(config),
      dice_(dice),
      bias_p_W_(Normal3(dice, kOnce, kPosition, config.position_bias_std_m)),
      bias_v_W_(Normal3(dice, kOnce, kVelocity, config.velocity_bias_std_m_per_s)) {}

void Noise::AddTo(Motion& motion, std::int64_t tick) const {
  motion.p_WB += bias_p_W_ + Normal3(dice_, tick, kPosition, config_.position_std_m);
  motion.v_WB += bias_v_W_ + Normal3(dice_, tick, kVelocity, config_.velocity_std_m_per_s);
}

OwnSensor::OwnSensor(const SensorConfig& config, int rate_hz, std::uint64_t seed, int id)
    : noise_(config.own, Dice(seed, Dice::Stream::kOwnSensor, static_cast<std::uint64_t>(id))),
      exact_(config.own.IsNone()),
      delay_ticks_(TicksRoundedUp(config.own_delay_s, rate_hz)),
      past_(static_cast<std::size_t>(delay_ticks_) + 1) {}

Motion OwnSensor::Measure(std::int64_t tick, const Motion& self) {
  Motion measured = self;
  if (delay_ticks_ > 0) Delay(tick, measured);
  if (!exact_) noise_.AddTo(measured, tick);
  return measured;
}

void OwnSensor::Delay(std::int64_t tick, Motion& motion) {
  const auto place = [this](std::int64_t t) -> Motion& { return past_[static_cast<std::size_t>(t) % past_.size()]; };
  if (last_tick_ < 0) std::ranges::fill(past_, motion);  // the agent has always been where it started
  for (std::int64_t t = std::max(last_tick_ + 1, tick - delay_ticks_); t < tick; ++t)
    place(t) = place(last_tick_);  // a skipped tick
  place(tick) = motion;
  last_tick_ = tick;
  const Motion& then = place(std::max<std::int64_t>(0, tick - delay_ticks_));
  motion.p_WB = then.p_WB;
  motion.v_WB = then.v_WB;
  motion.a_WB = then.a_WB;
}

RangeSensor::RangeSensor(double range_m, std::vector<Obstacle> obstacles)
    : range_m_(range_m), obstacles_(std::move(obstacles)) {
  nearest_W_.reserve(obstacles_.size());
}

std::span<const Eigen::Vector3d> RangeSensor::Sense(const Eigen::Vector3d& p_W) {
  nearest_W_.clear();
  for (const Obstacle& obstacle : obstacles_) {
    const Eigen::Vector3d nearest_W = NearestPoint_W(obstacle, p_W);
    if ((nearest_W - p_W).norm() <= range_m_) nearest_W_.push_back(nearest_W);
  }
  return nearest_W_;
}

}  // namespace mascot
