#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/measuring/decay_meter.h"
#include "orchestrator/measuring/pursuit_meter.h"
#include "orchestrator/team/ideal_team.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// What a run's rows say, in SI units; definitions as in docs/recording.md.
struct Measured {
  std::int64_t rows = 0;
  Eigen::Vector3d value_m = Eigen::Vector3d::Zero();  ///< mean position at the end
  double final_disagreement_m = 0;                    ///< largest distance from the mean, or the leader, over law.axes;
                                                      ///< of a formation: of p - d
  double final_speed_m_per_s = 0;                     ///< largest over agents, over law.axes
  std::optional<double> settling_time_s;
  std::optional<double> rate_per_s;              ///< at which the disagreement decays; decay_meter.h has the definition
  std::vector<PursuitMeter::Edge> minmax_edges;  ///< of min-max consensus
  double effort_m2_per_s3 = 0;                   ///< mean over agents of the integral of |acceleration command|^2
  double saturated_fraction = 0;  ///< of all commands: those that the acceleration limit cut; below, likewise
  double tilt_limited_fraction = 0;
  double rotor_limited_fraction = 0;
  std::optional<double> min_separation_m;  ///< absent for one agent
  double travelled_m = 0;
  struct Fidelity {
    double rms_m = 0;
    double max_m = 0;
  };
  std::optional<Fidelity> fidelity;  ///< absent without output.fidelity
  std::string fidelity_failure;      ///< what the law said that failed on ideal bodies, and so ended the comparison
  /// Of the formation law: rms over edges of |(p_i - p_j) - (d_i - d_j)|, over law.axes.
  struct Formation {
    std::vector<Eigen::Vector3d> offsets_m;  ///< d_i, by id - 1
    double final_rms_m = 0;
    double worst_rms_m = 0;  ///< from half of run.duration_s on
  };
  std::optional<Formation> formation;
};

/// Measures a run row by row, in memory that does not grow with it.
class Metrics {
 public:
  explicit Metrics(const Experiment& experiment);
  /// The next tick.
  void Add(const DecodedRow& row);
  Measured Result() const;
  /// Of the newest row, for the progress line.
  double disagreement_m() const { return disagreement_m_; }

 private:
  void MeasureAgreement(std::span<const Motion> motions);
  void MeasureControl(std::span<const Command> commands);
  void MeasureSeparation(std::span<const Motion> motions);
  void MeasureFidelity(std::span<const Motion> motions);
  void StepIdeal();
  void MeasurePath(std::span<const Motion> motions);
  void MeasureFormation(std::span<const Motion> motions);
  /// The part of a position that agents agree on: of a formation, without their places in it.
  Eigen::Vector3d Agreed(std::size_t i, const Motion& motion) const;

  const Experiment& experiment_;
  std::optional<IdealTeam> ideal_;
  std::string ideal_failure_;
  std::int64_t rows_ = 0;
  Eigen::Vector3d mean_W_ = Eigen::Vector3d::Zero();
  double disagreement_m_ = 0;
  double speed_m_per_s_ = 0;
  double first_disagreement_m_ = 0;
  DecayMeter decay_;
  PursuitMeter pursuit_;
  std::int64_t last_unsettled_ = -1;                           // newest row above 2 % of the first disagreement
  double effort_m2_per_s3_ = 0, newest_effort_m2_per_s3_ = 0;  // all agents together
  std::int64_t saturated_ = 0, tilt_limited_ = 0, rotor_limited_ = 0;
  double min_separation2_;
  double squared_deviation_ = 0;
  double max_deviation2_ = 0;
  double path_m_ = 0;
  Measured::Formation formation_;
  std::vector<Eigen::Vector3d> last_p_W_;
  std::vector<Eigen::Vector3d> by_x_;  // scratch
};

}  // namespace mascot
