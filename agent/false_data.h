#pragma once

#include <cstdint>
#include <span>

#include "base/motion.h"
#include "base/random.h"
#include "experiment/false_data.h"

namespace mascot {

/// What an agent that lies says instead of the truth: the same to all agents that hear it. Depends only on the seed,
/// the agent and the tick.
class FalseData {
 public:
  FalseData(const FalseDataConfig& config, std::uint64_t seed, int id);
  bool IsToldAt(double t_s) const { return config_.IsToldAt(t_s); }
  /// Makes what the agent sends at `tick` false: its position is off by the lie, its velocity by the rate of change of
  /// an oscillating lie, number n of its message by component n modulo 3 of the lie.
  void Tell(std::int64_t tick, double t_s, Motion& motion, std::span<double> message) const;

 private:
  FalseDataConfig config_;
  Dice dice_;
};

}  // namespace mascot
