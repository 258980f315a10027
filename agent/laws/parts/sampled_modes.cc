#include "agent/laws/parts/sampled_modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "agent/laws/parts/stable_period.h"

namespace mascot {

double LargestRoot(const Experiment& experiment) {
  const Eigen::VectorXcd lambda = experiment.graph.Eigenvalues();
  return lambda(lambda.size() - 1).real();
}

double SlowestFactor(const Experiment& experiment, double step) {
  const Eigen::VectorXcd lambda = experiment.graph.Eigenvalues();
  double factor = 0;
  for (Eigen::Index n = 1; n < lambda.size(); ++n) factor = std::max(factor, std::abs(1 - step * lambda(n).real()));
  return factor;
}

LawTheory UnstableGain(const Experiment& experiment) {
  return {.silent = kUnstable,
          .warnings = {fmt::format("law.gain: unstable: expected below {:.4g} 1/s at this control period and graph",
                                   2 / (experiment.period_s() * LargestRoot(experiment)))}};
}

}  // namespace mascot
