#include "orchestrator/theory/lagged_pursuit.h"

#include <array>
#include <cmath>

#include "orchestrator/theory/minmax_time.h"

namespace mascot {

// In units of beta lag^2 and beta lag, with r = alpha / beta, the child moves by
//   Z'' = -sgn(2 r Z(t - 1) + W |W|(t - 1))
// A symmetric cycle consists of two parabolas, from (0, -W_m) to (0, W_m) and back. The relay switches at Z = 0, 1
// after the state crossed the switching curve at W = W_m - 1, Z = 1/2 - W_m:
//   2 r (1/2 - W_m) + (W_m - 1)^2 = 0    =>    W_m = 1 + r + sqrt(r (1 + r)),    Z_m = W_m^2 / 2
double TrembleRadius(double alpha, double beta, double lag_s) {
  const double r = alpha / beta;
  const double fastest = 1 + r + std::sqrt(r * (1 + r));
  return beta * lag_s * lag_s * fastest * fastest / 2;
}

std::optional<double> LaggedMinmaxTime(double z, double w, double alpha, double beta, double lag_s, double within_m) {
  constexpr int kStepsOfLag = 20;
  constexpr double kLongestInSteps = 5e6;
  const double dt_s = lag_s / kStepsOfLag;
  const double end_s = 3 * MinmaxTime(z, w, alpha, beta) + 100 * lag_s;  // by then it trembles, or never will
  if (!(end_s / dt_s <= kLongestInSteps)) return std::nullopt;
  const auto steps = static_cast<int>(end_s / dt_s);
  std::array<double, kStepsOfLag> coming{};  // the accelerations of the next steps; the first lag has none
  int last_outside = -1;
  for (int step = 0; step < steps; ++step) {
    if (std::abs(z) > within_m) last_outside = step;
    double& next = coming[static_cast<std::size_t>(step % kStepsOfLag)];
    const double a = next;
    const double side = 2 * alpha * z + w * std::abs(w);
    next = side > 0 ? -beta : side < 0 ? beta : 0;
    z += dt_s * w + dt_s * dt_s / 2 * a;
    w += dt_s * a;
  }
  constexpr int kLagsOfACycle = 14;  // 4 W_m, at r = 1
  if (steps - last_outside <= kLagsOfACycle * kStepsOfLag) return std::nullopt;
  return (last_outside + 1) * dt_s;
}

}  // namespace mascot
