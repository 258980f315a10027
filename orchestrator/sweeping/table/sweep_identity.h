#pragma once

#include <optional>
#include <string>
#include <vector>

#include "agent/python/metrics.h"
#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/plan/run_laws.h"

namespace mascot {

/// Tells which sweep a table is of: all that its rows depend on, and what else the statistics need. It is kept as JSON
/// beside the table (TABLE.plan), and beside the table of every share.
struct SweepIdentity {
  std::string build;                   ///< BuildText() of the program that flies the runs
  std::string experiment;              ///< text of the experiment file
  std::string first_run;               ///< the first valid run, with all defaults and the files that it names
  std::string metric_file;             ///< text of the file with the user's metrics
  SweepPlan::Words words;              ///< what each run sets
  std::vector<PythonMetric> own;       ///< the user's metrics
  std::vector<std::string> law_names;  ///< names of the laws whose figures have columns
  KnownLaws laws;
  /// What chooses the runs, in words, if it is a search (orchestrator/searching/): its plan grows, so that a table of
  /// its first runs is one of this sweep. Empty: it is no search.
  std::string search = {};

  std::string Text() const;
  /// The inverse of Text(); nothing if `text` is not that of an identity.
  static std::optional<SweepIdentity> FromText(const std::string& text);

  /// How the sweep of another table differs from this one, in words: "--set law.beta: 0.3 there and 0.5 here"; empty:
  /// not at all. `theirs`: the text of its TABLE.plan.
  std::string DifferenceFrom(const std::string& theirs) const;

  /// Names of the columns of numbers: measured, predicted and the user's, at the end those that depend on the machine.
  std::vector<std::string> Metrics() const;
};

/// Names of all columns of a table of `plan`; `metrics`: those of its columns of numbers.
std::vector<std::string> SweepColumns(const SweepPlan& plan, const std::vector<std::string>& metrics);

}  // namespace mascot
