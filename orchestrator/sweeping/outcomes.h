#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "orchestrator/sweeping/plan.h"
#include "orchestrator/sweeping/run_laws.h"

namespace mascot {

/// Whether a column is the time of something that may not have come to pass by the end of a run: a run without error
/// that has no value there counts as later than all others.
bool IsTimeOfEvent(std::string_view column);

/// The rows of a sweep's table as numbers, and what they say together.
class Outcomes {
 public:
  using Cells = std::vector<std::string>;

  /// `laws`: of the runs; outlives this object, as does `plan`. `columns`: of the table. `rows`: all, by the number of
  /// the run.
  Outcomes(const SweepPlan& plan, const SweepLaws& laws, Cells columns, std::vector<Cells> rows);

  /// For the terminal: how many runs failed and why, and how many did not settle by the end, of those that may: by its
  /// row the team's law makes agents agree, or another run of that law has settled.
  std::vector<std::string> Lines() const;
  /// CSV with one row for each combination of keys but run.seed, and each of `metrics` that has values: mean with its
  /// confidence interval, median, deciles. The figures of a law have rows only for combinations that fly it, settling
  /// times only for those whose runs may settle.
  std::string StatisticsCsv(const std::vector<std::string>& metrics) const;

 private:
  std::size_t PlaceOf(std::string_view column) const;
  bool HasFailed(const Cells& row) const { return !row[error_].empty(); }
  /// Whether the settling time of a run says something: if it has none, the run is late.
  bool MaySettle(std::size_t run) const;
  /// Whether a run could have a value of `metric`.
  bool CanHave(std::size_t run, std::string_view metric) const;
  void AddStatistics(const std::string& metric, const std::vector<std::size_t>& group, std::string& csv) const;

  const SweepPlan& plan_;
  const SweepLaws& laws_;
  Cells columns_;
  std::vector<Cells> rows_;
  std::size_t error_;
  std::set<std::string> settled_;  // laws of teams of which a run has settled
};

}  // namespace mascot
