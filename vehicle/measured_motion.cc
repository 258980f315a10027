#include "vehicle/measured_motion.h"

#include <Eigen/Core>
#include <cmath>

namespace mascot {
namespace {

constexpr double kBeyondReason = 1e6;  // m, m/s, rad/s

}  // namespace

std::string WhyNotMeasured(const Motion& motion) {
  constexpr double kRounding = 0.01;
  const auto known = [](const Eigen::Vector3d& vector) { return (vector.array().abs() < kBeyondReason).all(); };
  if (!known(motion.p_WB)) return "its position is unknown";
  if (!known(motion.v_WB) || !known(motion.w_WB_B)) return "its velocity is unknown";
  if (!(std::abs(motion.q_WB.norm() - 1) < kRounding)) return "its orientation is unknown";
  return "";
}

}  // namespace mascot
