#include "vehicle/frames.h"

#include <cmath>
#include <numbers>

namespace mascot {
namespace {

/// `motion` turned by `q_to_from` in the world; its position then moved by `shift`.
Motion Turned(const Motion& motion, const Eigen::Quaterniond& q_to_from, const Eigen::Vector3d& shift) {
  Motion turned = motion;
  turned.p_WB = q_to_from * motion.p_WB + shift;
  turned.q_WB = q_to_from * motion.q_WB;
  turned.v_WB = q_to_from * motion.v_WB;
  turned.a_WB = q_to_from * motion.a_WB;
  return turned;
}

Eigen::Quaterniond AboutUp(double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
}

}  // namespace

Eigen::Vector3d SwapWorldAxes(const Eigen::Vector3d& vector) { return {vector.y(), vector.x(), -vector.z()}; }

Eigen::Vector3d SwapBodyAxes(const Eigen::Vector3d& vector) { return {vector.x(), -vector.y(), -vector.z()}; }

Eigen::Quaterniond SwapOrientation(const Eigen::Quaterniond& q) {
  // q_NW * q_WB * q_BF, where N is W turned by pi about (1, 1, 0), and F is B turned by pi about x; both turns are
  // their own inverse but for the sign of the quaternion. Their product by hand has no rounding but one factor,
  // sqrt(1/2).
  const double r = std::numbers::sqrt2 / 2;
  return {r * (q.w() + q.z()), r * (q.x() + q.y()), r * (q.x() - q.y()), r * (q.w() - q.z())};
}

double SwapYaw(double yaw_rad) { return std::remainder(std::numbers::pi / 2 - yaw_rad, 2 * std::numbers::pi); }

Motion LocalFrame::ToWorld(const Motion& in_L) const { return Turned(in_L, AboutUp(yaw_WL), p_WL); }

Motion LocalFrame::FromWorld(const Motion& in_W) const {
  const Eigen::Quaterniond q_LW = AboutUp(-yaw_WL);
  return Turned(in_W, q_LW, q_LW * -p_WL);
}

}  // namespace mascot
