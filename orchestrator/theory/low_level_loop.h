#pragma once

#include <Eigen/Core>

#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// How much a LowLevelLoop differs from its airframe: the parts that its model leaves out may have this effect.
struct LoopError {
  double turn = 0;  ///< share by which a torque turns the body more
  double push = 0;  ///< share by which the body accelerates more, along x and y
};

/// A body that follows the commands of its law by its low-level stack, as theory sees both. A model driven by velocity
/// has the commanded velocity, one without airframe the commanded acceleration. For a quadrotor, roll and pitch are two
/// loops by themselves (agent/controllers/quadrotor.cc has the equations): a reference that integrates the command, PD
/// law towards it, tilt, PD law of the tilt, torque. Each is computed once in a control period and held, and the body
/// moves in the steps of the physics.
///
/// The limits of the airframe are part of the model: tilt, rate of turning, torque, thrust, restart of the reference.
/// The model leaves out the yaw, gyroscopic torques, effects of the rotors together that none has alone, and contacts.
class LowLevelLoop {
 public:
  /// `agent` must not be a unicycle; a quadrotor has its wanted heading, or turns to it at once. The experiment must
  /// outlive this object.
  LowLevelLoop(const Experiment& experiment, const AgentConfig& agent, const LoopError& error);

  const Motion& motion() const { return motion_; }
  /// The larger of roll and pitch (rad).
  double tilt_rad() const { return tilt_rad_.cwiseAbs().maxCoeff(); }
  /// Whether the limit of the tilt cut the last command.
  bool is_tilt_cut() const { return is_tilt_cut_; }
  /// Goes on to the next tick with `command` held: its limited velocity or acceleration.
  void Step(const Command& command);

 private:
  void Glide(const Eigen::Vector3d& v_W);
  void Accelerate(const Eigen::Vector3d& a_W);
  void Fly(const Eigen::Vector3d& a_W);
  Eigen::Vector3d Correction_W();
  Eigen::Vector2d Target_rad(const Eigen::Vector3d& a_W);
  double Thrust_n(double a_up) const;
  Eigen::Vector2d TurnAccel(const Eigen::Vector2d& target_rad, double thrust_n) const;
  Eigen::Vector3d ThrustDirection_W() const;
  void Move(double thrust_n, const Eigen::Vector2d& turn_accel);

  const AgentConfig& agent_;
  LoopError error_;
  double h_, gravity_;
  int steps_;  // of the physics, in a control period
  bool holds_altitude_;
  Eigen::Vector3d wind_W_;
  Eigen::Matrix3d R_WH_;  // the heading frame: x ahead, y left
  Motion motion_;
  Eigen::Vector3d p_ref_W_, v_ref_W_;
  Eigen::Vector2d tilt_rad_ = Eigen::Vector2d::Zero();   // roll, pitch
  Eigen::Vector2d tilt_rate_ = Eigen::Vector2d::Zero();  // rad/s
  Eigen::Vector2d turning_ = Eigen::Vector2d::Zero();    // angular acceleration that the rotors give now (rad/s^2)
  double lift_n_;                                        // thrust that the rotors give now (N)
  bool is_tilt_cut_ = false;
};

}  // namespace mascot
