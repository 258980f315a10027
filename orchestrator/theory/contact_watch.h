#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// Finds out, tick by tick, which bodies may touch each other, the ground or an obstacle, if the experiment's physics
/// lets them.
class ContactWatch {
 public:
  /// A body may touch another one, or an obstacle, if it is nearer than `margin_m`, and the ground if it is nearer than
  /// a quarter of that.
  ContactWatch(const Experiment& experiment, double margin_m) : experiment_(experiment), margin_m_(margin_m) {}

  /// "agents 1 and 2 may touch", "agent 3 may touch the ground", "agent 3 may touch an obstacle"; empty: nothing.
  /// Bodies with an airframe are boxes, tilted as they are; other bodies are balls. `motions` has one for each agent,
  /// by id - 1.
  std::string WhatMayTouch(std::span<const Motion> motions);

 private:
  const Experiment& experiment_;
  double margin_m_;
  std::vector<Eigen::Vector3d> halves_W_;  // of the boxes around bodies; scratch
};

}  // namespace mascot
