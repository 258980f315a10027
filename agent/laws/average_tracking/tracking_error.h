#pragma once

#include <span>
#include <utility>
#include <vector>

#include "agent/laws/law_figures.h"
#include "agent/laws/parts/inputs.h"

namespace mascot {

// How well estimates follow the average of the inputs: of agents that say their estimates, 3 numbers, at each tick.

inline constexpr LawFigure kTrackingErrorFigures[] = {
    {.name = "tracking_error_m", .meaning = "most that an estimate was off the average, in the second half"},
    {.name = "sum_off_m", .meaning = "most that the sum of estimates was off the sum of inputs, at any tick"},
};

/// The figures for estimates
///   x(k) = r(k) + q(k),  q(k+1) = q(k) - step L x(k),  q(0) = 0
/// on a connected undirected graph with a stable step. The error in the second half is at most the steady state that
/// the inputs keep up, plus what is left of the start. With inputs of one frequency the first is exact; with several,
/// it is their sum at its worst. The sum of estimates is off by no more than rounding.
std::vector<PredictedFigure> PredictTrackingError(const Experiment& experiment, const std::vector<Input>& inputs,
                                                  double step);

class TrackingErrorMeter final : public LawMeter {
 public:
  TrackingErrorMeter(const Experiment& experiment, std::span<const int> ids, std::vector<Input> inputs)
      : experiment_(experiment),
        inputs_(std::move(inputs)),
        axes_(experiment.agent(ids.front()).law.axes),
        ids_(ids.begin(), ids.end()) {}

  void Add(const TeamRow& row) override;
  std::vector<FigureValues> Figures() const override { return {{error_m_}, {sum_off_m_}}; }
  std::optional<double> Curve() const override { return now_m_; }

 private:
  const Experiment& experiment_;
  std::vector<Input> inputs_;
  Axes axes_;
  std::vector<int> ids_;
  std::optional<double> now_m_;  // error in the newest row
  double error_m_ = 0, sum_off_m_ = 0;
};

}  // namespace mascot
