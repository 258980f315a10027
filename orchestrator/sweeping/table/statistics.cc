#include "orchestrator/sweeping/table/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace mascot {
namespace {

constexpr double kConfidence = 0.95;

/// The probability that |t| < sqrt(degrees) tan(angle), as a finite sum (Abramowitz & Stegun 26.7.3, 26.7.4).
/// Boost.Math has it too, but takes functions of long double from libm, which base/libm.cc does not replace.
double ProbabilityWithin(double angle, std::size_t degrees) {
  const double cosine = std::cos(angle), sine = std::sin(angle);
  const bool odd = degrees % 2 == 1;
  double sum = 0, term = odd ? cosine : 1;  // terms with cos^1, cos^3, ... or cos^0, cos^2, ... up to degrees - 2
  for (std::size_t power = odd ? 1 : 0; power + 2 <= degrees; power += 2) {
    sum += term;
    const auto k = static_cast<double>(power);
    term *= cosine * cosine * (k + 1) / (k + 2);
  }
  return odd ? 2 / std::numbers::pi * (angle + sine * sum) : sine * sum;
}

}  // namespace

double StudentQuantile(double p, std::size_t degrees) {
  if (p < 0.5) return -StudentQuantile(1 - p, degrees);
  double low = 0, high = std::numbers::pi / 2;
  for (double angle = high / 2; angle > low && angle < high; angle = (low + high) / 2)
    (ProbabilityWithin(angle, degrees) < 2 * p - 1 ? low : high) = angle;
  return std::sqrt(static_cast<double>(degrees)) * std::tan(low);
}

double QuantileOf(ValueSample sample, double q) {
  std::vector<double>& values = sample.values;
  std::sort(values.begin(), values.end());
  values.resize(values.size() + sample.beyond, std::numeric_limits<double>::infinity());
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double fraction = place - std::floor(place);
  if (fraction == 0 || std::isinf(values[below])) return values[below];
  return values[below] + fraction * (values[below + 1] - values[below]);
}

Spread SpreadOf(const ValueSample& sample) {
  Spread spread;
  const auto n = static_cast<double>(sample.values.size());
  if (n > 0) spread.mean = std::accumulate(sample.values.begin(), sample.values.end(), 0.0) / n;
  if (n > 1) {
    double squares = 0;
    for (const double value : sample.values) squares += (value - *spread.mean) * (value - *spread.mean);
    const double t = StudentQuantile((1 + kConfidence) / 2, sample.values.size() - 1);
    spread.half_width = t * std::sqrt(squares / (n - 1) / n);
  }
  if (sample.values.size() + sample.beyond == 0) return spread;
  spread.median = QuantileOf(sample, 0.5);
  spread.decile_1 = QuantileOf(sample, 0.1);
  spread.decile_9 = QuantileOf(sample, 0.9);
  return spread;
}

}  // namespace mascot
