#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/sweeping/plan.h"

namespace mascot {

/// The laws that a run ends with: those of its last phase, whose figures its summary has.
struct RunLaws {
  std::string team;                ///< that of [law]
  bool team_agrees = false;        ///< by its row, agents that fly it agree
  std::vector<std::string> names;  ///< of all agents: the team's, and those of agents with their own
  bool depend_on_numbers = false;  ///< times or ids of agents decide which laws they are
};
RunLaws LawsAtTheEnd(const Experiment& experiment);

/// The laws of every run of a sweep.
class SweepLaws {
 public:
  /// Laws by the number of the run.
  using Known = std::unordered_map<std::size_t, RunLaws>;

  /// `firsts`: for each run of `plan`, which must outlive this object, the run that has the same laws. `known`: the
  /// laws of those runs that are valid experiments.
  SweepLaws(const SweepPlan& plan, SweepPlan::Firsts firsts, Known known);

  /// The laws of a run; null: it is not a valid experiment.
  const RunLaws* Of(std::size_t run) const;
  /// Whether a run has figures of `law`. A run that is not a valid experiment would have those of its law.name; of any
  /// law if the sweep does not set it.
  bool Has(std::size_t run, std::string_view law) const;
  /// The names of all laws; perhaps several times.
  std::vector<std::string> AllNames() const;

 private:
  const SweepPlan& plan_;
  SweepPlan::Firsts firsts_;
  Known known_;
};

}  // namespace mascot
