#include "agent/laws/parts/stable_period.h"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <limits>

#include "base/linear_algebra.h"

namespace mascot {

double LongestPeriodOf(const Eigen::MatrixXd& rates) {
  double longest_s = std::numeric_limits<double>::infinity();
  for (const std::complex<double>& rate : Eigenvalues(rates))
    longest_s = std::min(longest_s, 2 * rate.real() / std::norm(rate));
  return longest_s;
}

std::optional<LawTheory> WhyUnstable(const Experiment& experiment, double longest_s) {
  if (experiment.period_s() < longest_s) return std::nullopt;
  return LawTheory{.silent = kUnstable,
                   .warnings = {fmt::format("control.rate_hz: unstable at this rate, it must be above {:.4g}, got {}",
                                            1 / longest_s, experiment.control.rate_hz)}};
}

}  // namespace mascot
