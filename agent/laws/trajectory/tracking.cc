#include "agent/laws/trajectory/tracking.h"

#include <algorithm>
#include <cmath>

namespace mascot {

void TrackingMeter::Add(const PathPoint& r, const Eigen::Vector3d& q_W, Axes axes) {
  if (flown_.ticks == 0) origin_W_ = r.p_W;
  const Eigen::Vector3d error_W = Along(axes, r.p_W - q_W), speed_W = Along(axes, r.v_W);
  flown_.Add(Along(axes, q_W - origin_W_));
  reference_.Add(Along(axes, r.p_W - origin_W_));
  error_squares_ += error_W.squaredNorm();
  error_along_ += error_W.dot(speed_W);
  speed_squares_ += speed_W.squaredNorm();
}

TrackingFigures TrackingMeter::Figures() const {
  if (flown_.ticks == 0) return {};
  TrackingFigures figures{.rms_m = std::sqrt(error_squares_ / flown_.ticks)};
  if (speed_squares_ > 0) figures.lag_s = error_along_ / speed_squares_;
  if (reference_.square() > 0)
    figures.amplitude_ratio = std::sqrt(std::max(0.0, flown_.square()) / reference_.square());
  return figures;
}

std::optional<TrackingFigures> SteadyTracking(const ReferencePath& path, const SampledPd& loop, bool feed_forward,
                                              double limit_m_per_s2) {
  double squares = 0, along = 0, speed_squares = 0, flown_squares = 0, path_squares = 0;
  Eigen::Vector3d needed = Eigen::Vector3d::Zero();  // largest acceleration, per axis
  for (const auto& [w, size_W] : path.oscillations) {
    const double size = size_W.squaredNorm() / 2;  // mean square of this part of the position
    const Complex z(std::cos(w * loop.h), std::sin(w * loop.h));
    const Complex middle(std::cos(w * loop.h / 2), std::sin(w * loop.h / 2));
    const Complex u = Complex(loop.p, loop.d * w) - (feed_forward ? w * w * middle : 0.0);
    const Complex gain = loop.Response(z) * u;  // p = gain r
    const Complex error = 1.0 - gain;
    squares += std::norm(error) * size;
    along += (error * Complex(0, -w)).real() * size;  // r - p, times the conjugate of v_r = j w r
    speed_squares += w * w * size;
    flown_squares += std::norm(gain) * size;
    path_squares += size;
    const Complex held = gain * 2.0 * (z - 1.0) * (z - 1.0) / (loop.h * loop.h * (z + 1.0));
    needed += std::sqrt(std::norm(held)) * size_W.cwiseAbs2().cwiseSqrt();
  }
  if (needed.maxCoeff() > limit_m_per_s2) return std::nullopt;
  return TrackingFigures{.rms_m = std::sqrt(squares),
                         .lag_s = along / speed_squares,
                         .amplitude_ratio = std::sqrt(flown_squares / path_squares)};
}

}  // namespace mascot
