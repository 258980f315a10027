#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/sweeping/plan/plan.h"

namespace mascot {

/// The laws of the last phase of a run, which are those whose figures its summary has.
struct RunLaws {
  std::string team;                ///< the law of [law]
  bool team_agrees = false;        ///< whether the row of this law says that its agents agree
  std::vector<std::string> names;  ///< the laws of all agents: the team's, and those of agents with their own
  bool depend_on_numbers = false;  ///< whether numbers of the run (times, ids of agents) decide which laws these are
};
RunLaws LawsAtTheEnd(const Experiment& experiment);

/// The laws of the representatives of a sweep: of the first of those runs that are alike.
struct KnownLaws {
  SweepPlan::Alike alike = SweepPlan::Alike::kInWords;  ///< runs that are alike in this way have the same laws
  std::unordered_map<std::size_t, RunLaws> of_run;  ///< by the number of the run; only runs that are valid experiments
};

/// The laws of every run of a sweep.
class SweepLaws {
 public:
  /// `plan` and `known` must outlive this object.
  SweepLaws(const SweepPlan& plan, const KnownLaws& known);

  /// The laws of a run; null: it is not a valid experiment.
  const RunLaws* Of(std::size_t run) const;
  /// Whether a run has figures of `law`. A run that is not a valid experiment counts as one of the law that it names
  /// (law.name), or of every law if the sweep does not set law.name.
  bool Has(std::size_t run, std::string_view law) const;
  /// The names of all laws, sorted.
  std::set<std::string> AllNames() const;

 private:
  const SweepPlan& plan_;
  const KnownLaws& known_;
  SweepPlan::Representatives representatives_;
};

}  // namespace mascot
