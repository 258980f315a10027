#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/flight_phase.h"
#include "experiment/experiment.h"
#include "orchestrator/measuring/separation.h"
#include "orchestrator/team/ideal_team.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// Metrics of a run as a whole, in SI units, whatever its laws are for; docs/recording.md has the definitions.
struct Measured {
  std::int64_t rows = 0;
  /// Integral of |acceleration command|^2, mean over the agents that are commanded accelerations; absent: there are
  /// none.
  std::optional<double> effort_m2_per_s3;
  double saturated_fraction = 0;           ///< fraction of commands cut at the acceleration limit
  double tilt_limited_fraction = 0;        ///< fraction of commands cut at the tilt limit
  double rotor_limited_fraction = 0;       ///< fraction of commands cut at a rotor's limit
  std::optional<double> min_separation_m;  ///< in space; absent for one agent
  /// The smallest distance along the axes of the agents' laws (m), in the plane if the law of one of the two is:
  /// law.safety limits this distance.
  std::optional<double> min_separation_along_axes_m;
  std::optional<double> filtered_fraction;  ///< fraction of commands that law.safety changed; absent: no agent has it
  /// Ticks at which some agent had no safe command; absent: no agent has law.safety.
  std::optional<std::int64_t> infeasible_ticks;
  double travelled_m = 0;  ///< mean path length of the agents
  /// Distance from ideal bodies under the same laws, over some agents and rows.
  struct Fidelity {
    double rms_m = 0;
    double max_m = 0;
  };
  std::optional<Fidelity> fidelity;  ///< of all agents and rows; absent: output.fidelity is off, or what follows
  std::string fidelity_failure;      ///< error of a law on ideal bodies, which ended the comparison
  std::string fidelity_fault;        ///< fault of a body, for which there is no ideal one, which ended it
  /// The distance of an agent with a vehicle from the ideal body, in one phase of its flight.
  struct Gap {
    int agent = 0;
    FlightPhase phase = FlightPhase::kFlying;
    std::int64_t rows = 0;
    Fidelity from_ideal = {};
  };
  std::vector<Gap> gaps;  ///< by agent, then by phase; empty where fidelity is absent
};

/// Measures a run row by row. Memory does not grow with the number of rows.
class Metrics {
 public:
  /// `crew`: as for Team, in the ideal team.
  explicit Metrics(const Experiment& experiment, Crew& crew = Crew::Alone());
  /// Call it when events have changed the experiment: from the next row on, the experiment is `now`.
  void Adopt(std::shared_ptr<const Experiment> now);
  /// Adds the next tick.
  void Add(const DecodedRow& row);
  void OnVehicle(const VehicleNews& news) { phases_[news.agent] = news.phase; }
  Measured Result() const;

 private:
  void Take(const Experiment& experiment);
  void MeasureControl(const DecodedRow& row);
  void MeasureFidelity(const DecodedRow& row);
  void StepIdeal();
  void MeasurePath(std::span<const Motion> motions);

  const Experiment& experiment_;
  std::shared_ptr<const Experiment> now_;  // not null: the ideal team has yet to adopt it
  std::optional<IdealTeam> ideal_;
  std::string ideal_failure_, fault_;
  std::int64_t rows_ = 0;
  std::int64_t accelerated_ = 0;                               // agents that are commanded accelerations
  double effort_m2_per_s3_ = 0, newest_effort_m2_per_s3_ = 0;  // sums over these agents
  std::int64_t saturated_ = 0, tilt_limited_ = 0, rotor_limited_ = 0;
  bool has_safety_ = false;  // some agent has, or had, law.safety
  std::int64_t filtered_ = 0, infeasible_ticks_ = 0;
  Separation separation_;
  double squared_deviation_ = 0;
  double max_deviation2_ = 0;
  std::map<int, FlightPhase> phases_;  // of vehicles, by id: now
  struct GapSums {
    std::int64_t rows = 0;
    double squared = 0, max2 = 0;
  };
  std::map<std::pair<int, FlightPhase>, GapSums> gaps_;
  double path_m_ = 0;
  std::vector<Eigen::Vector3d> last_p_W_;
  std::vector<Axes> axes_;     // of the agents' laws, by id - 1
  std::vector<char> is_lost_;  // by id - 1
};

}  // namespace mascot
