#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"

namespace mascot {

// Agents that tell the truth, and those that lie (experiment/false_data.h).

/// The experiment without the lies: all agents tell the truth.
Experiment WithoutFalseData(Experiment experiment);
/// The honest agent that hears the most agents that lie, and how many these are.
std::pair<int, std::size_t> MaxLiarsHeard(const Experiment& experiment);

/// Warnings if W-MSR against `f` liars needs more than a graph of this robustness; nullopt: it is not known.
std::vector<std::string> RobustnessWarnings(std::optional<int> robustness, int f);

/// Measures how honest agents stay within the hull of their starts, per axis of their law.
class InitialHull {
 public:
  InitialHull(const Experiment& experiment, std::span<const int> ids);
  void Add(const TeamRow& row);
  /// The largest distance by which an honest agent was outside (m), 0 if below 1 nm; absent: all agents lie.
  std::optional<double> outside_m() const;
  /// The largest distance between honest agents along an axis in the newest row (m).
  std::optional<double> apart_m() const;

 private:
  std::vector<int> ids_;  // of honest agents
  Axes axes_;
  Eigen::Vector3d min_W_ = Eigen::Vector3d::Zero(), max_W_ = Eigen::Vector3d::Zero();  // of the starts
  double outside_m_ = 0, apart_m_ = 0;
};

}  // namespace mascot
