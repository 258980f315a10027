#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"

namespace mascot {

/// The swing of a velocity at a known frequency, among samples that need not fill whole periods: the least squares of
///   v = c + Re(swing exp(j w t))
class SwingFit {
 public:
  void Add(double angle_rad, double v) {
    const Eigen::Vector3d row(1, std::cos(angle_rad), -std::sin(angle_rad));
    normal_ += row * row.transpose();
    right_ += v * row;
  }
  std::complex<double> Swing() const;

 private:
  Eigen::Matrix3d normal_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
};

/// Measures how a swing of the speed along x grows from each agent i - 1 to agent i in the long run: in the last whole
/// periods of the run, once they are as the same number of periods before. It looks at half of the run, or at two
/// periods. It also measures the smallest distance by which an agent is behind the one before it. The order of the
/// figures: amplification of each follower, the largest of them, the distance, and the least headway, which no run
/// shows: none.
class SwingMeter final : public LawMeter {
 public:
  /// `w` is the frequency of the swing (rad/s); 0: nothing swings. `forward` is 1 for agents that drive along x, -1 for
  /// agents that drive against it.
  SwingMeter(const Experiment& experiment, std::span<const int> ids, double w, double forward);
  void Adopt(const Experiment& now) override { experiment_ = &now; }
  void Add(const TeamRow& row) override;
  std::vector<FigureValues> Figures() const override;
  std::optional<double> Curve() const override { return gap_m_; }

 private:
  /// The swing of an agent at the end; nullopt: there is none, or it still changes.
  std::optional<std::complex<double>> SwingOf(int id) const;

  const Experiment* experiment_;
  double w_, forward_;
  std::vector<int> followers_;
  std::vector<std::array<SwingFit, 2>> fits_;  // of all agents, by id - 1, in the periods before and in the last ones
  std::optional<double> gap_m_, least_gap_m_;  // the smallest of the newest row, and of all
};

}  // namespace mascot
