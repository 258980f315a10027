#pragma once

#include <Eigen/Core>
#include <optional>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"

namespace mascot {

/// p+ = p - T rates p decays for all control periods T below this (s); `rates` in 1/s, eigenvalues with positive real
/// parts.
double LongestPeriodOf(const Eigen::MatrixXd& rates);
/// Why theory says nothing of a team whose modes do not all decay.
inline constexpr const char* kUnstable = "the sampled team is unstable";
/// What theory says of a law whose control period must be below `longest_s`; absent: the period is below.
std::optional<LawTheory> WhyUnstable(const Experiment& experiment, double longest_s);

}  // namespace mascot
