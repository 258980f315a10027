#pragma once

#include "physics_server/model.h"

namespace mascot {

/// The body of every model without rotors: a solid sphere (2/5 m r^2) that feels neither gravity nor air.
class Ball : public Model {
 public:
  double mass_kg() const override { return kDoubleIntegratorMass_kg; }
  Eigen::Vector3d inertia_kg_m2() const override {
    return Eigen::Vector3d::Constant(0.4 * mass_kg() * kBallRadius_m * kBallRadius_m);
  }
  Eigen::Vector3d half_size_m() const override { return Eigen::Vector3d::Zero(); }
  bool feels_gravity() const override { return false; }
};

}  // namespace mascot
