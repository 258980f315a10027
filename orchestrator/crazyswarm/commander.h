#pragma once

#include <Eigen/Core>
#include <optional>

#include "orchestrator/crazyswarm/trajectory.h"

namespace mascot::crazyswarm {

/// What a simulated Crazyflie is to do: of what is NaN, nothing.
struct Setpoint {
  Eigen::Vector3d p_W, v_W, a_W;  ///< m, m/s, m/s^2
};

/// What the commander of a Crazyflie makes of orders and of set-points that are streamed, as the firmware does: orders
/// are carried out along polynomials of fifth degree; set-points that are streamed come first, until
/// NotifySetpointsStop() or until they are too old. It arms itself, as a Crazyflie 2.1 does. Time is the caller's (s);
/// the frame is W. Source: commander and high-level planner of the Crazyflie's firmware, as Crazyswarm2 (July 2026)
/// uses them.
class Commander {
 public:
  static constexpr double kLevelAfter_s = 0.5, kStopAfter_s = 2;  ///< after the last set-point that was streamed

  /// `ground_W`: where it stands.
  explicit Commander(const Eigen::Vector3d& ground_W) : from_W_(ground_W), to_W_(ground_W) {}

  void Arm(bool arm);
  // Orders. They begin at `now`, where the vehicle is, and take `duration_s`, of 0 or more; heights are those of W.
  void TakeOff(double height_m, double duration_s, const Eigen::Vector3d& p_W, double now);
  void Land(double height_m, double duration_s, const Eigen::Vector3d& p_W, double now);
  void GoTo(const Eigen::Vector3d& goal_W, bool relative, double duration_s, const Eigen::Vector3d& p_W, double now);
  /// Along a trajectory, `timescale` (above 0) times as slow; backwards, if `reversed`; from where the vehicle is, if
  /// `relative`.
  void Follow(const Trajectory& trajectory, double timescale, bool reversed, bool relative, const Eigen::Vector3d& p_W,
              double now);
  void Emergency();
  /// It holds where it is, at `p_W`, until the next order.
  void NotifySetpointsStop(const Eigen::Vector3d& p_W, double now);
  void Stream(const Setpoint& setpoint, double now);

  /// What to do at `now`; nothing: the motors stand.
  std::optional<Setpoint> At(double now);

  bool is_armed() const { return is_armed_; }
  bool is_flying() const { return motors_run_; }
  bool is_locked() const { return is_locked_; }

 private:
  void Plan(const Eigen::Vector3d& to_W, double duration_s, const Eigen::Vector3d& p_W, double now);
  Setpoint OnTrajectory(double now) const;

  bool is_armed_ = true, is_locked_ = false, motors_run_ = false, lands_ = false;
  Eigen::Vector3d from_W_, to_W_;
  double begin_s_ = 0, duration_s_ = 0;
  Trajectory trajectory_;  // in the place of the line between these, if it is not empty
  double timescale_ = 1;
  bool is_reversed_ = false;
  Eigen::Vector3d shift_W_ = Eigen::Vector3d::Zero();  // of the trajectory
  std::optional<Setpoint> streamed_;
  double streamed_at_s_ = 0;
};

}  // namespace mascot::crazyswarm
