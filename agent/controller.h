#pragma once

#include <memory>

#include "agent/law.h"
#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

/// Low-level stack of one agent: wanted acceleration or velocity -> actuators of its model.
class Controller {
 public:
  struct Output {
    Actuation actuator{};
    std::uint32_t flags = 0;  ///< kTiltLimited, kRotorLimited
  };
  virtual ~Controller() = default;
  /// `wanted_W`: what the model is driven by (ModelTraits), already limited, in W (m/s^2 or m/s). With law.axes = "xy"
  /// its z is ignored and the altitude loop holds the initial height.
  virtual Output Actuate(const Motion& self, const Eigen::Vector3d& wanted_W) = 0;
};

/// The stack for the model of agent `id`.
std::unique_ptr<Controller> MakeController(const Experiment& experiment, int id);

}  // namespace mascot
