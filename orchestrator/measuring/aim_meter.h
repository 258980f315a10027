#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/motion.h"
#include "experiment/experiment.h"
#include "orchestrator/measuring/agreement_meter.h"
#include "orchestrator/measuring/pursuit_meter.h"

namespace mascot {

/// How far the agents have reached the aim of the team's law, in one phase of a run; docs/recording.md has the
/// definitions.
struct Aim {
  std::int64_t rows = 0;
  Eigen::Vector3d value_m = Eigen::Vector3d::Zero();  ///< mean position at the end
  double final_disagreement_m = 0;                    ///< largest distance from the mean, or the leader, along
                                                      ///< law.axes; in a formation, of p_i - d_i
  double final_speed_m_per_s = 0;                     ///< largest speed of an agent that is not lost, along law.axes
  std::optional<double> settling_time_s;              ///< since the phase began; absent: not settled by the end
  std::optional<double> rate_per_s;                   ///< decay rate of the disagreement (decay_meter.h)
  std::vector<PursuitMeter::Edge> minmax_edges;       ///< for min-max consensus
  /// Formation error: rms over edges of |(p_i - p_j) - (d_i - d_j)|, along law.axes.
  struct Formation {
    std::vector<Eigen::Vector3d> offsets_m;  ///< d_i, by id - 1
    double final_rms_m = 0;
    double worst_rms_m = 0;  ///< largest in the second half of run.duration_s
  };
  std::optional<Formation> formation;  ///< absent: the law has no formation
};

/// Measures the Aim of a phase row by row. Memory does not grow with the number of rows.
class AimMeter {
 public:
  /// `phase`: the phase as an experiment of its own (experiment/phase.h), which must outlive this object.
  explicit AimMeter(const Experiment& phase);
  /// Call it when events have changed the experiment, but not the law: from the next row on, the experiment is `now`.
  void Adopt(const Experiment& now);
  /// Adds the next tick.
  void Add(std::span<const Motion> motions);
  Aim Result() const;
  /// Disagreement in the newest row.
  double disagreement_m() const { return agreement_.disagreement_m(); }

 private:
  void MeasureFormation(std::span<const Motion> motions);
  /// The position on which the agents agree: p_i, or p_i - d_i in a formation.
  Eigen::Vector3d Agreed(std::size_t i, const Motion& motion) const;

  const Experiment& experiment_;
  std::int64_t rows_ = 0;
  AgreementMeter agreement_;
  std::vector<char> is_lost_;  // by id - 1
  double speed_m_per_s_ = 0;
  PursuitMeter pursuit_;
  Aim::Formation formation_;
  std::vector<Eigen::Vector3d> agreed_W_;  // scratch
};

}  // namespace mascot
