#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"

namespace mascot {

/// Mean of the starting positions, in W (m), at which a team meets that keeps its mean.
Eigen::Vector3d MeanStart(const Experiment& experiment);
/// The largest distance along one axis of the law between the starts of agents `ids` (m).
double LargestSpread(const Experiment& experiment, std::span<const int> ids);

/// The largest sum of weights that an agent hears: the largest entry of the Laplacian's diagonal.
double LargestDegree(const Graph& graph);
/// Root of the sum over all agents of their starts' squared distances from the mean, along the axes of the law (m).
double StartDisagreement_m(const Experiment& experiment);
/// Sum over agents `ids` of their squared distances from their mean, along `axes` (m^2).
double SquaredDisagreement(std::span<const Motion> motions, std::span<const int> ids, Axes axes);

/// Measures the time from which on agents agree, which they do if along each axis of their law all of them are within a
/// tolerance for good; and how far apart they are in the end.
class AgreementTime final : public LawMeter {
 public:
  /// The tolerance is `share` of LargestSpread(), but at least `min_m`.
  AgreementTime(const Experiment& experiment, std::span<const int> ids, double share, double min_m);
  void Add(const TeamRow& row) override;
  std::vector<FigureValues> Figures() const override { return {{time_s()}, {band_m_}}; }
  /// The time from which on the agents agree (s); absent: they do not agree in the newest row.
  std::optional<double> time_s() const;
  /// The largest distance of two agents along an axis of the law, in the last tenth of the run; of a shorter run, at
  /// its end (m).
  double band_m() const { return band_m_; }
  double tolerance_m() const { return tolerance_m_; }

 private:
  const Experiment& experiment_;
  std::vector<int> ids_;
  double tolerance_m_;
  std::int64_t newest_ = -1, last_apart_ = -1;  // ticks
  double band_m_ = 0;
};

}  // namespace mascot
