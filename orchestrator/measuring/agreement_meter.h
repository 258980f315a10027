#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/motion.h"
#include "experiment/experiment.h"
#include "orchestrator/measuring/decay_meter.h"

namespace mascot {

/// Disagreement of agents at one tick: that of their positions or, in a formation, of their positions less their
/// places.
double DisagreementOf(const Experiment& experiment, std::span<const Motion> motions);

/// Measures how far agents that neither lie nor are lost are from agreement, tick by tick. The disagreement is the
/// largest distance, along law.axes, from the mean, or from the leader if there is one.
class AgreementMeter {
 public:
  explicit AgreementMeter(const Experiment& experiment);
  /// Call it when events have changed the experiment: from the next tick on, the agents that count are those of `now`.
  void Adopt(const Experiment& now);
  /// Adds the next tick. `q_W` is what the agents agree on, by id - 1, in W (m): their positions, in a formation less
  /// their places.
  void Add(std::span<const Eigen::Vector3d> q_W);

  /// Mean of q in the newest tick.
  const Eigen::Vector3d& mean_W() const { return mean_W_; }
  /// Disagreement in the newest tick.
  double disagreement_m() const { return disagreement_m_; }
  /// Time (s) from which on the disagreement stays at or below 2 % of its first value. Nothing if it does not, or if it
  /// was 0 from the start.
  std::optional<double> settling_time_s() const;
  /// Decay rate (1/s) of the disagreement (decay_meter.h).
  std::optional<double> rate_per_s() const { return decay_.rate_per_s(); }

 private:
  const Experiment& experiment_;
  std::vector<std::size_t> counting_;  // index in the experiment's agents
  std::int64_t ticks_ = 0;
  Eigen::Vector3d mean_W_ = Eigen::Vector3d::Zero();
  double disagreement_m_ = 0;
  double first_disagreement_m_ = 0;
  std::int64_t last_unsettled_ = -1;  // newest tick with more than 2 % of the first disagreement
  DecayMeter decay_;
};

}  // namespace mascot
