#include "agent/false_data.h"

#include <cmath>
#include <numbers>

namespace mascot {

FalseData::FalseData(const FalseDataConfig& config, std::uint64_t seed, int id)
    : config_(config), dice_(seed, Dice::Stream::kFalseData, static_cast<std::uint64_t>(id)) {}

void FalseData::Tell(std::int64_t tick, double t_s, Motion& motion, std::span<double> message) const {
  Eigen::Vector3d off_W = config_.offset_m;
  if (config_.kind == FalseDataKind::kOscillating) {
    const double rate = 2 * std::numbers::pi / config_.period_s, phase = rate * (t_s - config_.from_s);
    off_W *= std::sin(phase);
    motion.v_WB += rate * std::cos(phase) * config_.offset_m;
  } else if (config_.kind == FalseDataKind::kRandom) {
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      off_W[axis] *= 2 * dice_.Unit(tick, static_cast<std::uint64_t>(axis)) - 1;
  }
  motion.p_WB += off_W;
  for (std::size_t n = 0; n < message.size(); ++n) message[n] += off_W[static_cast<Eigen::Index>(n % 3)];
}

}  // namespace mascot
