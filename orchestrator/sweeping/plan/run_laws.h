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

/// The laws that a run ends with: those of its last phase, whose figures its summary has.
struct RunLaws {
  std::string team;                ///< that of [law]
  bool team_agrees = false;        ///< by its row, agents that fly it agree
  std::vector<std::string> names;  ///< of all agents: the team's, and those of agents with their own
  bool depend_on_numbers = false;  ///< times or ids of agents decide which laws they are
};
RunLaws LawsAtTheEnd(const Experiment& experiment);

/// The laws of the first of those runs of a sweep that are alike.
struct KnownLaws {
  SweepPlan::Alike alike = SweepPlan::Alike::kInWords;  ///< in this way: alike runs have the same laws
  std::unordered_map<std::size_t, RunLaws> of_run;      ///< by number; of those that are valid experiments
};

/// The laws of every run of a sweep.
class SweepLaws {
 public:
  /// `plan` and `known` must outlive this object.
  SweepLaws(const SweepPlan& plan, const KnownLaws& known);

  /// The laws of a run; null: it is not a valid experiment.
  const RunLaws* Of(std::size_t run) const;
  /// Whether a run has figures of `law`. A run that is not a valid experiment would have those of its law.name; of any
  /// law if the sweep does not set it.
  bool Has(std::size_t run, std::string_view law) const;
  /// The names of all laws, sorted.
  std::set<std::string> AllNames() const;

 private:
  const SweepPlan& plan_;
  const KnownLaws& known_;
  SweepPlan::Representatives representatives_;
};

}  // namespace mascot
