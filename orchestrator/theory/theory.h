#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"
#include "orchestrator/theory/delay_margin.h"
#include "orchestrator/theory/persistence.h"
#include "orchestrator/theory/response.h"
#include "orchestrator/theory/safety.h"

namespace mascot {

/// How the lag of a quadrotor's attitude makes it tremble around a parent that does not accelerate.
struct Trembling {
  double lag_s = 0;     ///< lag of the quadrotor's acceleration (flight_envelope.h)
  double radius_m = 0;  ///< largest distance from the parent in the end, per axis
  /// Time from which on it stays within 2 radius_m; absent: it takes too long to compute.
  std::optional<double> time_s;
};

/// Prediction for one edge of the tree of min-max time consensus.
struct MinmaxEdge {
  int child = 0;
  int parent = 0;
  double time_s = 0;   ///< time until the child has the position and velocity of its parent, along the slowest axis
  bool exact = false;  ///< time_s is exact for the initial condition; else it is a bound for any motion of the parent
  std::optional<Trembling> trembling = {};  ///< only for quadrotors whose time is exact, with a law that switches
};

/// The largest component of the command that a law wants at tick 0, if each agent hears all its neighbours without
/// delay, and its limit; for the agent with the largest ratio of the two.
struct FirstCommand {
  int agent = 0;
  double asked = 0;
  double limit = 0;
};

struct LaterPhase;

/// Predictions about an experiment; docs/theory.md has the formulas and sources. Absent values cannot be predicted.
struct Prediction {
  /// Where agents meet, in W (m); in a formation, as p - d. With axes "xy", z is the mean of the heights that the
  /// agents hold.
  std::optional<Eigen::Vector3d> value_m;
  std::optional<bool> stable;  ///< whether all modes decay, sampled and with the delays of the experiment
  /// Decay rate (1/s) of the slowest mode: agents agree at least as fast in the long run. With `of_agreement` false,
  /// the rate of each agent's flight to its waypoint.
  std::optional<double> slowest_rate_per_s;
  /// The decay rate (1/s) that a run measures: that of a linear team that starts as the experiment's agents do, which
  /// may hardly excite the slowest mode. With `of_agreement` false, the rate of the slowest mode.
  std::optional<double> rate_per_s;
  /// Time (s) at which the agents settle, as AgreementMeter measures it.
  std::optional<double> settling_time_s;
  /// Whether `settling_time_s` and `rate_per_s` are of a linear team that starts as the experiment's agents do.
  /// Otherwise there is no rate, and the time is that until the slowest mode has decayed from rest to 2 %; along
  /// directed chains agents settle later than that, because the modes of a directed graph are not orthogonal.
  bool from_start = false;
  /// The disagreement over time, of the same team from the same start, up to the end of the run.
  std::optional<Response> response;
  /// The time from which on the law's predictions about the end hold (short_phase.h).
  std::optional<HoldsFrom> holds_from;
  std::optional<double> control_period_bound_s;    ///< the loop is unstable from this control period on, without delays
  std::optional<DelayMargin> delay_margin;         ///< delay of neighbours' samples
  std::optional<double> own_delay_margin_s;        ///< equal delay of neighbours' samples and own states
  std::optional<double> minmax_time_s;             ///< latest of `minmax_edges`
  std::vector<MinmaxEdge> minmax_edges;            ///< by child; only edges whose time can be predicted
  std::optional<FirstCommand> first_acceleration;  ///< m/s^2
  std::optional<FirstCommand> first_speed;         ///< m/s: laws that want a velocity, on models driven by velocity
  std::optional<FirstCommand> first_lean;  ///< m/s^2: horizontal, after limits; `limit` follows from the tilt limit
  std::optional<Persistence> persistence;
  std::optional<SafetyPrediction> safety;  ///< absent: no agent has law.safety
  /// The figures that the team's law measures, in the order of its row; empty: theory predicts none of them.
  std::vector<PredictedFigure> law_figures;
  bool of_agreement = true;  ///< false: rate and settling time are those of each agent's flight to its waypoint
  bool on_average = false;   ///< samples are lost or noisy, so that the above holds on average
  std::string silent;        ///< why predictions are missing; empty: none is missing
  /// Why theory predicts something, but not the figures of the law; empty: it predicts them.
  std::string figures_silent;
  std::vector<std::string> warnings;  ///< "key: text": what will not work, or will not work as expected
  /// The phases of [[law.schedule]] after the first. All of the above is about the first phase, except `safety` and the
  /// warnings, which are about all phases.
  std::vector<LaterPhase> later;
};

/// A phase of [[law.schedule]] as an experiment of its own, which begins at the places that ideal bodies have reached
/// by then.
struct LaterPhase {
  std::int64_t from = 0;  ///< tick
  std::shared_ptr<const Experiment> experiment;
  Prediction prediction;  ///< times count from the beginning of the phase
};
/// The prediction for phase `index`; 0 is the first. If theory looks at no phase, because the run is a user's code that
/// does not run here, what it says of the whole run.
inline const Prediction& PredictionOf(const Prediction& run, std::size_t index) {
  return index == 0 || run.later.empty() ? run : run.later.at(index - 1).prediction;
}

/// Why theory is silent about a run that events change from `tick` on.
std::string SilentFrom(const Experiment& experiment, std::int64_t tick);

/// Predicts an experiment that LoadExperiment returned. Above kLargestSpectrum agents, no eigenvalues are computed.
Prediction Predict(const Experiment& experiment);

inline constexpr int kLargestSpectrum = 1000;

}  // namespace mascot
