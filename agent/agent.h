#pragma once

#include <memory>
#include <span>

#include "agent/controller.h"
#include "agent/law.h"
#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

/// One agent without a wire: law, acceleration limit, low-level stack. Both engines run this.
class Agent {
 public:
  Agent(Experiment& experiment, int id);

  int id() const { return id_; }
  /// Law and limit only: fills a_law_W, a_limited_W and kAccelerationLimited. Throws std::runtime_error
  /// naming agent and tick if the law's answer is not finite.
  Command Want(std::int64_t tick, const Motion& self, std::span<const Heard> heard);
  /// Want, then the low-level stack: the complete command. Throws likewise.
  Command Decide(std::int64_t tick, const Motion& self, std::span<const Heard> heard);

 private:
  int id_;
  double rate_hz_;
  double limit_;
  bool hold_altitude_;
  std::unique_ptr<Law> law_;
  std::unique_ptr<Controller> controller_;
};

}  // namespace mascot
