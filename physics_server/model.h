#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "base/motion.h"
#include "experiment/experiment.h"
#include "physics_server/rotors.h"

namespace mascot {

/// How a model moves its body during one physics step: by a wrench on the centre of mass, or by a velocity.
struct Push {
  Eigen::Vector3d f_W = Eigen::Vector3d::Zero();    ///< N, expressed in W, gravity not included
  Eigen::Vector3d tau_B = Eigen::Vector3d::Zero();  ///< N m, expressed in B
  struct Velocity {
    Eigen::Vector3d v_W;  ///< m/s, in W
    Eigen::Vector3d w_B;  ///< rad/s, expressed in B
  };
  /// If set, the velocity of the body from the start of the step, unless a contact stops it.
  std::optional<Velocity> velocity = std::nullopt;
};

/// Time and wind of one physics step.
struct Surroundings {
  double t_s = 0;                                    ///< simulated time at which the step begins
  double dt_s = 0;                                   ///< length of the step
  Eigen::Vector3d wind_W = Eigen::Vector3d::Zero();  ///< m/s
};

/// State of a body at the start of a physics step.
struct BodyNow {
  Eigen::Matrix3d R_WB;  ///< takes B components to W
  Eigen::Vector3d v_WB;  ///< m/s, in W
};

/// The most that a model does to its body at each step of a tick. A bound: it may be too large, never too small.
struct PushLimit {
  double force_n = 0;  ///< besides gravity and drag
  double torque_nm = 0;
  double drag_kg_per_s = 0;  ///< force per airspeed
  /// If set, the model sets the velocity, to at most this, and what it is at the tick does not count.
  std::optional<double> speed_m_per_s = std::nullopt;
};

/// How an agent's actuators move its body. One object per agent; may own internal state (rotor speeds).
class Model {
 public:
  virtual ~Model() = default;
  virtual double mass_kg() const = 0;
  virtual Eigen::Vector3d inertia_kg_m2() const = 0;  ///< principal moments about x, y, z of B
  virtual Eigen::Vector3d half_size_m() const = 0;    ///< half of the collision box; zero: a sphere of kBallRadius_m
  virtual bool feels_gravity() const = 0;
  /// False: the body rolls on the ground without contacts with it; it keeps its height and stays upright, even if other
  /// bodies hit it.
  virtual bool touches_ground() const { return true; }
  /// Advances the actuators by one step and returns how they move the body. `command`: the model's four inputs
  /// (ModelTraits::actuator).
  virtual Push Apply(const Actuation& command, const BodyNow& self, const Surroundings& around) = 0;
  /// What Apply() with this command does at most.
  virtual PushLimit LimitOf(const Actuation& command) const = 0;
  /// If the body is driven by rotors and feels gravity, and Apply() is what `Rotors` describes: these, which World may
  /// then turn itself, for many bodies at once. Else null.
  virtual Rotors* rotors() { return nullptr; }
};

/// The model of agent `id`. Throws std::invalid_argument for an unknown model.
std::unique_ptr<Model> MakeModel(const Experiment& experiment, int id);

}  // namespace mascot
