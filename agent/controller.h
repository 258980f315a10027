#pragma once

#include <memory>

#include "agent/laws/law.h"
#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// The low-level stack of one agent: turns a wanted acceleration or velocity into its model's actuator commands.
class Controller {
 public:
  struct Output {
    Actuation actuator{};
    std::uint32_t flags = 0;  ///< kTiltLimited, kRotorLimited
  };
  virtual ~Controller() = default;
  /// Called once per tick. `self`: the measured motion. `wanted_W`: the acceleration (m/s^2) or velocity (m/s) that
  /// drives the model (ModelTraits::driven_by), in W, already limited. With law.axes = "xy" its z is ignored, and the
  /// initial height is held.
  virtual Output Actuate(const Motion& self, const Eigen::Vector3d& wanted_W) = 0;
};

/// The controller for the model of agent `id`. Throws std::invalid_argument for an unknown model.
std::unique_ptr<Controller> MakeController(const Experiment& experiment, int id);

}  // namespace mascot
