#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// One edge of the tree of min-max consensus.
struct MinmaxEdge {
  int child = 0;
  int parent = 0;
  double time_s = 0;   ///< until the child moves as the parent does, the slowest axis
  bool exact = false;  ///< a closed form from the initial condition; else a bound that holds whatever the parent does
};

/// What theory says about an experiment before it runs. Absent where theory is silent.
struct Prediction {
  std::optional<Eigen::Vector3d> value_m;  ///< where agents meet (z: mean start height where held)
  std::optional<bool> stable;              ///< all modes decay, in continuous time and sampled
  /// Of the slowest mode, from rest, to 2 %. Agents that only follow along a chain settle later: the modes of a
  /// directed graph do not stay apart.
  std::optional<double> settling_time_s;
  std::optional<double> minmax_time_s;           ///< latest of `minmax_edges`
  std::vector<MinmaxEdge> minmax_edges;          ///< by child; only edges of which theory knows the time
  std::optional<double> first_command_m_per_s2;  ///< largest component any agent's law asks for at tick 0
  std::optional<double> first_command_limit_m_per_s2;  ///< of that agent
  std::vector<std::string> warnings;             ///< "key: text": what will not work, or not as the user may think
};

/// For an experiment that LoadExperiment returned. Eigenvalues are left out above kLargestSpectrum agents.
Prediction Predict(Experiment& experiment);

inline constexpr int kLargestSpectrum = 1000;

}  // namespace mascot
