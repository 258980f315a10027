#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string_view>

#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

/// Force and torque on a body's centre of mass for one physics step.
struct Wrench {
  Eigen::Vector3d f_W = Eigen::Vector3d::Zero();    ///< N, expressed in W, gravity not included
  Eigen::Vector3d tau_B = Eigen::Vector3d::Zero();  ///< N m, expressed in B
};

/// How actuators move one body. One object per agent; may own internal state (rotor speeds).
class Model {
 public:
  virtual ~Model() = default;
  virtual double mass_kg() const = 0;
  virtual Eigen::Vector3d inertia_kg_m2() const = 0;
  virtual Eigen::Vector3d half_size_m() const = 0;  ///< of the collision box; zero: a sphere of 0.1 m
  virtual bool feels_gravity() const = 0;
  /// The wrench to apply during one physics step of `dt_s`.
  virtual Wrench Apply(const Actuation& command, const Motion& self, double dt_s) = 0;
};

struct ModelEntry {
  std::string_view name;
  std::string_view summary;
  std::string_view actuator;  ///< what the four actuator values are, with units
  std::unique_ptr<Model> (*make)(const Experiment& experiment, int id);
};

/// Every model there is. `orchestrator models` prints this.
std::span<const ModelEntry> Models();
std::unique_ptr<Model> MakeModel(const Experiment& experiment, int id);

}  // namespace mascot
