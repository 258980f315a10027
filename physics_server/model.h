#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

/// What moves a body during one physics step: a wrench on its centre of mass or, of a body driven by velocity, that.
struct Push {
  Eigen::Vector3d f_W = Eigen::Vector3d::Zero();    ///< N, expressed in W, gravity not included
  Eigen::Vector3d tau_B = Eigen::Vector3d::Zero();  ///< N m, expressed in B
  struct Velocity {
    Eigen::Vector3d v_W;
    Eigen::Vector3d w_B;  ///< rad/s, expressed in B
  };
  /// The body has it from the start of the step, unless a contact stops it.
  std::optional<Velocity> velocity = std::nullopt;
};

/// Time and air of one physics step.
struct Surroundings {
  double t_s = 0;                                    ///< when the step begins
  double dt_s = 0;                                   ///< its length
  Eigen::Vector3d wind_W = Eigen::Vector3d::Zero();  ///< m/s
};

/// What a body does when a physics step begins.
struct BodyNow {
  Eigen::Matrix3d R_WB;  ///< takes B components to W
  Eigen::Vector3d v_WB;  ///< m/s, in W
};

/// How actuators move one body. One object per agent; may own internal state (rotor speeds).
class Model {
 public:
  virtual ~Model() = default;
  virtual double mass_kg() const = 0;
  virtual Eigen::Vector3d inertia_kg_m2() const = 0;
  virtual Eigen::Vector3d half_size_m() const = 0;  ///< of the collision box; zero: a sphere of kBallRadius_m
  virtual bool feels_gravity() const = 0;
  /// False: rolls on it, which is no contact, and stays at its height and upright, whatever hits it.
  virtual bool touches_ground() const { return true; }
  /// What moves the body during one physics step.
  virtual Push Apply(const Actuation& command, const BodyNow& self, const Surroundings& around) = 0;
};

/// The body of agent `id`, by the name of its model.
std::unique_ptr<Model> MakeModel(const Experiment& experiment, int id);

}  // namespace mascot
