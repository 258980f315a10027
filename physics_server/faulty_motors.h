#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "base/motion.h"
#include "base/random.h"
#include "experiment/experiment.h"

namespace mascot {

/// What the motors of a team carry out of their commands: all of them, but for motors with a fault
/// (FaultPart::kMotor), and for lost agents whose motors stop (run.on_agent_loss = "drop"). Depends only on the seed,
/// the agents, the ticks and the commands.
class FaultyMotors {
 public:
  explicit FaultyMotors(const Experiment& experiment);
  /// Call it when events have changed the experiment.
  void Adopt(const Experiment& now);
  /// What is carried out at `tick` (increasing by one) of `commands`, by id - 1. Valid until the next call, and as long
  /// as `commands`.
  std::span<const Actuation> CarriedOut(std::int64_t tick, std::span<const Actuation> commands);

 private:
  /// A motor with a fault.
  struct Motor {
    PartFault fault;
    Dice dice;
    double held = 0;               ///< what it carries out until there is something new
    std::deque<double> late = {};  ///< commands on their way
  };
  double CarriedOut(std::int64_t tick, double command, Motor& motor) const;

  int rate_hz_;
  std::uint64_t seed_;
  bool drops_;
  std::vector<std::size_t> stopped_;             // agents whose motors stop
  std::map<std::pair<int, int>, Motor> faulty_;  // by agent and motor
  std::vector<Actuation> last_;                  // what was carried out at the tick before
};

}  // namespace mascot
