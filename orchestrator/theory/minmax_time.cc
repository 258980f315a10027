#include "orchestrator/theory/minmax_time.h"

#include <cmath>

namespace mascot {

double MinmaxTime(double z, double w, double alpha, double beta) {
  const double side = 2 * alpha * z + w * std::abs(w);
  if (side == 0) return std::abs(w) / alpha;  // on the switching curve: slow down with alpha
  if (side < 0) return MinmaxTime(-z, -w, alpha, beta);
  // Here a_c = -beta, so that top = z + w^2 / (2 beta) is constant until the curve is reached at w = w_curve.
  const double top = z + w * w / (2 * beta);
  if (top >= 0) {  // beyond the turning point, on the branch z = w^2 / (2 alpha), w < 0
    const double w_curve = -std::sqrt(2 * top / (1 / alpha + 1 / beta));
    return (w - w_curve) / beta - w_curve / alpha;
  }
  // Approaching too fast for alpha but not for beta: the branch z = -w^2 / (2 alpha), w > 0.
  const double w_curve = std::sqrt(-2 * top / (1 / alpha - 1 / beta));
  return (w - w_curve) / beta + w_curve / alpha;
}

double MinmaxBound(double z, double w, double alpha) {
  const double side = 2 * alpha * z + w * std::abs(w);
  if (side < 0) return MinmaxBound(-z, -w, alpha);
  // Bang-bang with alpha: first towards the parent, then braking. The peak of |w| is sqrt(alpha z + w^2 / 2).
  return (w + 2 * std::sqrt(alpha * z + w * w / 2)) / alpha;
}

}  // namespace mascot
