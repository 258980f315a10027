#include "orchestrator/report/deviation.h"

#include <algorithm>

namespace mascot {
namespace {

std::optional<double> Difference(std::optional<double> measured, std::optional<double> predicted) {
  if (!measured || !predicted) return std::nullopt;
  return *measured - *predicted;
}

}  // namespace

std::optional<double> MinmaxTime(const Aim& measured, const Prediction& prediction) {
  std::optional<double> latest_s;
  for (const MinmaxEdge& edge : prediction.minmax_edges) {
    const auto same = std::ranges::find(measured.minmax_edges, edge.child, &PursuitMeter::Edge::child);
    if (same == measured.minmax_edges.end() || !same->time_s) return std::nullopt;
    latest_s = std::max(latest_s.value_or(0), *same->time_s);
  }
  return latest_s;
}

Deviation Compare(const Experiment& experiment, const Aim& measured, const Prediction& prediction) {
  Deviation deviation;
  const Eigen::Index axes = CountOf(experiment.law.axes);
  if (prediction.value_m && measured.rows > 0)
    deviation.value_m = (measured.value_m - *prediction.value_m).head(axes).norm();
  if (!prediction.of_agreement)
    return deviation;  // the other predictions are then not about agreement, which is measured
  deviation.settling_time_s = Difference(measured.settling_time_s, prediction.settling_time_s);
  deviation.rate_per_s = Difference(measured.rate_per_s, prediction.rate_per_s);
  deviation.minmax_time_s = Difference(MinmaxTime(measured, prediction), prediction.minmax_time_s);
  return deviation;
}

}  // namespace mascot
