#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/theory/delay_margin.h"
#include "orchestrator/theory/persistence.h"

namespace mascot {

/// One edge of the tree of min-max consensus.
struct MinmaxEdge {
  int child = 0;
  int parent = 0;
  double time_s = 0;   ///< until the child moves as the parent does, the slowest axis
  bool exact = false;  ///< a closed form from the initial condition; else a bound that holds whatever the parent does
};

/// The largest component that an agent's law asks for at tick 0, if it hears all its neighbours at once, and what it is
/// allowed; of the agent for which the former is the largest part of the latter.
struct FirstCommand {
  int agent = 0;
  double asked = 0;
  double limit = 0;
};

/// What theory says about an experiment before it runs; docs/theory.md has the formulas. Absent where theory is silent.
struct Prediction {
  /// Where agents meet (z: mean start height where held); of a formation: p - d.
  std::optional<Eigen::Vector3d> value_m;
  std::optional<bool> stable;        ///< all modes decay, sampled and with the delays that there are
  std::optional<double> rate_per_s;  ///< of the slowest mode
  /// Of the slowest mode, from rest, to 2 %. Agents that only follow along a chain settle later: the modes of a
  /// directed graph do not stay apart.
  std::optional<double> settling_time_s;
  std::optional<double> control_period_bound_s;    ///< from this control period on the loop is unstable, without delays
  std::optional<DelayMargin> delay_margin;         ///< of what is heard
  std::optional<double> own_delay_margin_s;        ///< of what is heard and what is measured, both as late
  std::optional<double> minmax_time_s;             ///< latest of `minmax_edges`
  std::vector<MinmaxEdge> minmax_edges;            ///< by child; only edges of which theory knows the time
  std::optional<FirstCommand> first_acceleration;  ///< m/s^2
  std::optional<FirstCommand> first_speed;         ///< m/s: where a law wants a velocity of a model driven by it
  std::optional<FirstCommand> first_lean;          ///< m/s^2: sideways, after limits; what the tilt limit gives
  std::optional<Persistence> persistence;
  bool of_agreement = true;           ///< false: rate and settling time are of each agent's own flight to a waypoint
  bool on_average = false;            ///< samples are lost, or measured with noise: the above holds on average
  std::string silent;                 ///< why theory says less than it could; empty: it does not
  std::vector<std::string> warnings;  ///< "key: text": what will not work, or not as the user may think
};

/// For an experiment that LoadExperiment returned. Eigenvalues are left out above kLargestSpectrum agents.
Prediction Predict(const Experiment& experiment);

inline constexpr int kLargestSpectrum = 1000;

}  // namespace mascot
