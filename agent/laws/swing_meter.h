#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agent/law_figures.h"
#include "experiment/experiment.h"

namespace mascot {

/// Measures how a swing of the speed along x grows from each agent i - 1 to agent i, in the last whole periods of the
/// second half of the run, and the smallest distance along x between the two. The order of figures: amplification of
/// each follower, the largest of them, the distance.
class SwingMeter final : public LawMeter {
 public:
  /// `w`: of the swing (rad/s); `v_x`: the speed about which it swings.
  SwingMeter(const Experiment& experiment, std::span<const int> ids, double w, double v_x);
  void Adopt(const Experiment& now) override { experiment_ = &now; }
  void Add(const TeamRow& row) override;
  std::vector<FigureValues> Figures() const override;

  /// The first tick of the periods that are measured; nullopt: the run is shorter than one.
  static std::optional<std::int64_t> FirstTick(const Experiment& experiment, double w);

 private:
  const Experiment* experiment_;
  double w_, v_x_;
  std::vector<int> followers_;
  std::vector<std::complex<double>> swings_;  // Fourier sums of all agents, by id - 1
  std::optional<double> least_gap_m_;
};

}  // namespace mascot
