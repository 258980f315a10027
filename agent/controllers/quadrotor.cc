// The low-level stack of the MASCOT paper (Pandit, Njattuvetty, Mulla): PD loops turn a wanted acceleration into rotor
// speeds. With our axes (x forward, y left, z up; phi, theta, psi: roll, pitch, yaw about them):
//   reference:  a   = a_W + kp (p* - p) + kd (v* - v) + B v / m    with p*'' = a_W; in z, the altitude loop
//   thrust:     T   = m (a_z + g)
//   inversion:  a in the heading frame -> phi*, theta*             small: phi* = -a_left / g, theta* = a_forward / g
//   attitude:   tau = J (kp (phi* - phi) - kd phi')                same for theta; psi goes to control.heading_rad
//   rotors:     [w1^2 .. w4^2] = A^-1 [T, tau]
// The reference p*, v* is the ideal double integrator of the theory: it starts where the agent starts, and integrates
// the limited accelerations of the law. Tracking it gives back the velocity that the body loses while it tilts. With
// law.axes = "xy", z* stays the initial height and v_z* = 0. Gains: airframe.position in x and y, airframe.altitude in
// z.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "agent/controllers/mixer.h"

namespace mascot {
namespace {

// Largest correction towards the reference, per axis (m/s^2). A body that would need more has been held or pushed: the
// reference restarts from the body.
constexpr double kMaxCorrection = 1.0;
// Lower limit of cos(tilt) where thrust is divided by it: beyond 60 degrees of tilt, thrust is not raised further.
constexpr double kMinUprightness = 0.5;

struct Tilt {
  double roll_rad = 0;
  double pitch_rad = 0;
};

/// A wanted acceleration in the heading frame, which is W turned by the body's yaw (m/s^2).
struct HeadingAccel {
  double forward, left, up;
};

HeadingAccel AlongHeading(const Eigen::Vector3d& a_W, double yaw_rad) {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {.forward = c * a_W.x() + s * a_W.y(), .left = c * a_W.y() - s * a_W.x(), .up = a_W.z()};
}

// The paper's inversion: sin(angle) = angle, cos(angle) = 1, thrust = weight. `min_up`: what the smallest thrust gives
// (m/s^2). Where that is more than the weight, for example without gravity, it is what accelerates a tilted body.
Tilt SmallAngleTilt(const HeadingAccel& a, double gravity, double min_up) {
  const double up = std::max(gravity, min_up);
  return {.roll_rad = -a.left / up, .pitch_rad = a.forward / up};
}

// Roll and pitch that point z_B = (cos(roll) sin(pitch), -sin(roll), cos(roll) cos(pitch)) along a + g. `min_up`:
// smallest vertical component (m/s^2), what the smallest thrust gives.
Tilt ExactTilt(const HeadingAccel& a, double gravity, double min_up) {
  const double up = std::max(a.up + gravity, min_up);
  return {.roll_rad = std::atan2(-a.left, std::hypot(a.forward, up)), .pitch_rad = std::atan2(a.forward, up)};
}

// R_WB = Rz(yaw) Ry(pitch) Rx(roll).
double Roll(const Eigen::Matrix3d& R_WB) { return std::atan2(R_WB(2, 1), R_WB(2, 2)); }
double Pitch(const Eigen::Matrix3d& R_WB) { return std::asin(std::clamp(-R_WB(2, 0), -1.0, 1.0)); }
double Yaw(const Eigen::Matrix3d& R_WB) { return std::atan2(R_WB(1, 0), R_WB(0, 0)); }

double Pd(PdGains gains, double error, double error_rate) { return gains.kp * error + gains.kd * error_rate; }

// PD law with a limited proportional part, so that the rate towards the target settles at kMaxTurnRate at most
// (without damping there is no such limit).
double TiltAccel(PdGains gains, double error_rad, double rate) {
  const double most = gains.kd > 0 ? gains.kd * Airframe::kMaxTurnRate : std::numeric_limits<double>::infinity();
  return std::clamp(gains.kp * error_rad, -most, most) - gains.kd * rate;
}

class QuadrotorController final : public Controller {
 public:
  QuadrotorController(const Experiment& experiment, const AgentConfig& agent)
      : airframe_(agent.airframe),
        mixer_(agent.airframe),
        gravity_(experiment.physics.gravity_m_per_s2),
        period_s_(experiment.period_s()),
        heading_rad_(agent.control.heading_rad),
        drag_per_s_(agent.control.drag_compensation ? airframe_.linear_drag_kg_per_s / airframe_.mass_kg : 0),
        exact_(agent.control.inversion == Inversion::kExact),
        holds_altitude_(agent.law.axes == Axes::kXy),
        p_ref_W_(agent.p_W),
        v_ref_W_(agent.v_W) {
    if (holds_altitude_) v_ref_W_.z() = 0;
  }

  Output Actuate(const Motion& self, const Eigen::Vector3d& a_W) override {
    const Eigen::Vector3d a_ideal_W(a_W.x(), a_W.y(), holds_altitude_ ? 0 : a_W.z());
    const Eigen::Vector3d a_wanted_W = a_ideal_W + Correction_W(self) + drag_per_s_ * self.v_WB;
    AdvanceReference(a_ideal_W);

    const Eigen::Matrix3d R_WB = self.q_WB.toRotationMatrix();
    const Tilt wanted = ToTilt(AlongHeading(a_wanted_W, Yaw(R_WB)));
    const double limit = airframe_.tilt_limit_rad;
    const Tilt target{std::clamp(wanted.roll_rad, -limit, limit), std::clamp(wanted.pitch_rad, -limit, limit)};
    Output output = mixer_.Mix(Thrust_N(a_wanted_W.z(), R_WB), Torque_B(target, R_WB, self.w_WB_B));
    if (target.roll_rad != wanted.roll_rad || target.pitch_rad != wanted.pitch_rad) output.flags |= kTiltLimited;
    return output;
  }

 private:
  // PD correction towards the reference (m/s^2). On an axis that the law steers, a reference that the body cannot
  // follow restarts from the body.
  Eigen::Vector3d Correction_W(const Motion& self) {
    Eigen::Vector3d correction_W;
    for (int axis = 0; axis < 3; ++axis) {
      const PdGains& gains = axis < 2 ? airframe_.position : airframe_.altitude;
      double& correction = correction_W[axis];
      correction = Pd(gains, p_ref_W_[axis] - self.p_WB[axis], v_ref_W_[axis] - self.v_WB[axis]);
      if (std::abs(correction) <= kMaxCorrection || (axis == 2 && holds_altitude_)) continue;
      p_ref_W_[axis] = self.p_WB[axis];
      v_ref_W_[axis] = self.v_WB[axis];
      correction = 0;
    }
    return correction_W;
  }

  // Integrates the reference over one tick with a_W held.
  void AdvanceReference(const Eigen::Vector3d& a_W) {
    p_ref_W_ += period_s_ * v_ref_W_ + period_s_ * period_s_ / 2 * a_W;
    v_ref_W_ += period_s_ * a_W;
  }

  Tilt ToTilt(const HeadingAccel& a) const {
    const double min_up = airframe_.MinCommandedThrust() / airframe_.mass_kg;
    return exact_ ? ExactTilt(a, gravity_, min_up) : SmallAngleTilt(a, gravity_, min_up);
  }

  // Thrust for the vertical acceleration a_z (N). R_WB(2, 2) = cos(roll) cos(pitch) is the part of it that points up,
  // by which the exact inversion divides.
  double Thrust_N(double a_z, const Eigen::Matrix3d& R_WB) const {
    const double vertical_n = airframe_.mass_kg * (a_z + gravity_);
    return exact_ ? vertical_n / std::max(R_WB(2, 2), kMinUprightness) : vertical_n;
  }

  // Torque that turns the body to `target` and the wanted yaw (N m). At small tilts the rates of roll, pitch and yaw
  // are those about the body's axes.
  Eigen::Vector3d Torque_B(const Tilt& target, const Eigen::Matrix3d& R_WB, const Eigen::Vector3d& w_WB_B) const {
    const double yaw_error = std::remainder(heading_rad_ - Yaw(R_WB), 2 * std::numbers::pi);
    const Eigen::Vector3d turn(TiltAccel(airframe_.attitude, target.roll_rad - Roll(R_WB), w_WB_B.x()),
                               TiltAccel(airframe_.attitude, target.pitch_rad - Pitch(R_WB), w_WB_B.y()),
                               Pd(airframe_.heading, yaw_error, -w_WB_B.z()));
    return airframe_.inertia_kg_m2.cwiseProduct(turn);
  }

  Airframe airframe_;
  Mixer mixer_;
  double gravity_;
  double period_s_;
  double heading_rad_;
  double drag_per_s_;  // B / m, 0 if not compensated
  bool exact_;
  bool holds_altitude_;
  Eigen::Vector3d p_ref_W_;  // p*
  Eigen::Vector3d v_ref_W_;  // v*
};

}  // namespace

std::unique_ptr<Controller> MakeQuadrotorController(const Experiment& experiment, int id) {
  return std::make_unique<QuadrotorController>(experiment, experiment.agent(id));
}

}  // namespace mascot
