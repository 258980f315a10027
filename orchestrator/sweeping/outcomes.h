#pragma once

#include <optional>
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

  /// For the terminal: how many runs failed and why, how many did not settle by the end.
  std::vector<std::string> Lines() const;
  /// CSV with one row for each combination of keys but run.seed, and each of `metrics` that has values: mean with its
  /// confidence interval, median, deciles. The figures of a law have rows only for combinations that fly it.
  std::string StatisticsCsv(const std::vector<std::string>& metrics) const;

 private:
  std::size_t PlaceOf(std::string_view column) const;
  bool HasFailed(const Cells& row) const { return !row[error_].empty(); }
  void AddStatistics(const std::string& metric, const std::vector<std::size_t>& group, std::string& csv) const;

  const SweepPlan& plan_;
  const SweepLaws& laws_;
  Cells columns_;
  std::vector<Cells> rows_;
  std::size_t error_;
};

}  // namespace mascot
