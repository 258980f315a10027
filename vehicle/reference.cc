#include "vehicle/reference.h"

namespace mascot {

void Reference::Take(std::int64_t tick, const Eigen::Vector3d& a_W) {
  if (tick < tick_) return;
  const double dt_s = static_cast<double>(tick - tick_) / rate_hz_;
  p_W_ += v_W_ * dt_s + a_W_ * (dt_s * dt_s / 2);
  v_W_ += a_W_ * dt_s;
  a_W_ = a_W;
  tick_ = tick;
}

}  // namespace mascot
