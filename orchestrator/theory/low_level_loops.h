#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/lane_numbers.h"
#include "base/motion.h"
#include "experiment/experiment.h"
#include "orchestrator/theory/lanes/loop_kernel.h"

namespace mascot {

/// How much bodies of LowLevelLoops differ from their airframes: the parts that its model leaves out may have this
/// effect.
struct LoopError {
  double turn = 0;  ///< share by which a torque turns the body more
  double push = 0;  ///< share by which the body accelerates more, along x and y
};

/// Bodies that follow the commands of their laws by their low-level stacks, as theory sees both. A model driven by
/// velocity has the commanded velocity, one without airframe the commanded acceleration. For a quadrotor, roll and
/// pitch are two loops by themselves (agent/controllers/quadrotor.cc has the equations): a reference that integrates
/// the command, PD law towards it, tilt, PD law of the tilt, torque. Each is computed once in a control period and
/// held, and the body moves in the steps of the physics.
///
/// The limits of the airframe are part of the model: tilt, rate of turning, torque, thrust, restart of the reference.
/// The model leaves out the yaw, gyroscopic torques, effects of the rotors together that none has alone, and contacts.
class LowLevelLoops {
 public:
  /// No agent may be a unicycle; a quadrotor has its wanted heading, or turns to it at once. The experiment must
  /// outlive this object.
  LowLevelLoops(const Experiment& experiment, const LoopError& error);

  std::span<const Motion> motions() const { return motions_; }  ///< by id - 1
  /// The larger of roll and pitch (rad).
  double tilt_rad(std::size_t body) const;
  /// How many bodies' last commands the limit of the tilt cut.
  int tilts_cut() const { return tilts_cut_; }
  /// Goes on to the next tick with these commands held, by id - 1: their limited velocities or accelerations.
  void Step(std::span<const Command> commands);

 private:
  struct Body {
    const AgentConfig& agent;
    Eigen::Matrix3d R_WH;  // the heading frame: x ahead, y left
    bool holds_altitude;
    // The members below are used for quadrotors only.
    std::size_t place = 0;  // in numbers_
    Eigen::Vector3d p_ref_W, v_ref_W;
  };

  void Glide(const Eigen::Vector3d& v_W, Motion& motion) const;
  void Accelerate(const Body& body, const Eigen::Vector3d& a_W, Motion& motion) const;
  void Hold(Body& body, const Eigen::Vector3d& a_W, const Motion& motion);
  Eigen::Vector3d Correction_W(Body& body, const Motion& motion) const;
  Eigen::Vector2d Target_rad(const Body& body, const Eigen::Vector3d& a_W);
  double Thrust_n(const Body& body, double a_up) const;
  Eigen::Vector2d TurnAccel(const Body& body, const Eigen::Vector2d& target_rad, double thrust_n) const;
  Eigen::Vector2d Two(std::size_t place, int field) const {
    return {numbers_.At(place, field), numbers_.At(place, field + 1)};
  }
  template <class Vector>
  void Put(const Vector& vector, std::size_t place, int field) {
    for (Eigen::Index k = 0; k < vector.size(); ++k) numbers_.At(place, field + static_cast<int>(k)) = vector[k];
  }
  void Begin(const Experiment& experiment, const Body& body);
  void Take(const Body& body, Motion& motion) const;

  LoopError error_;
  double h_, gravity_;
  int steps_;  // of the physics, in a control period
  std::vector<Body> bodies_;
  std::vector<Motion> motions_;
  std::vector<Eigen::Vector3d> before_W_;  // scratch: velocities
  LoopKernel kernel_;
  LaneNumbers numbers_;  // of the quadrotors
  int tilts_cut_ = 0;
};

}  // namespace mascot
