#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/plan/run_laws.h"

namespace mascot {

/// Whether a column is the time of something that may not have come to pass by the end of a run: a run without error
/// that has no value there counts as later than all others.
bool IsTimeOfEvent(std::string_view column);

/// The number in a cell of a table, 1 and 0 for true and false; nothing: there is none.
std::optional<double> NumberInCell(const std::string& cell);

/// The rows of a sweep's table as numbers, and what they say together. There may be up to kMaxRuns of them.
class Outcomes {
 public:
  using Cells = std::vector<std::string>;

  /// `columns`: names of the columns of the table. `plan` and `laws`, those of its runs, must outlive this object.
  Outcomes(const SweepPlan& plan, const SweepLaws& laws, Cells columns);
  /// Adds the row of the next run. Call it for all runs of the plan, in order of their number.
  void Add(const Cells& row);

  /// For the terminal: how many runs failed and why, and how many did not settle by the end, of those that may: by its
  /// row the team's law makes agents agree, or another run of that law has settled.
  std::vector<std::string> Lines() const;
  /// Hands over the lines of a CSV table with one row for each combination of keys but run.seed, and each of `metrics`
  /// that has values: mean with its confidence interval, median, deciles. The figures of a law have rows only for
  /// combinations that fly it, settling times only for those whose runs may settle.
  void WriteStatistics(std::span<const std::string> metrics, const std::function<void(std::string_view)>& write) const;

 private:
  struct Reason {
    std::string text;
    std::size_t first_run = 0, runs = 0;
  };
  /// The runs of a combination, which differ in their seeds alone.
  using Group = std::vector<std::size_t>;

  /// The values of a column by the number of the run, NaN for none; empty: no run has one.
  const std::vector<double>& ValuesOf(std::string_view column) const;
  void AddFailure(const std::string& why);
  std::vector<Group> Groups() const;
  /// Whether the settling time of a run says something: if it has none, the run is late.
  bool MaySettle(std::size_t run) const;
  /// Whether a run could have a value of `metric`.
  bool CanHave(std::size_t run, std::string_view metric) const;
  std::string StatisticsLine(const std::string& metric, const std::vector<double>& values, const Group& group) const;

  const SweepPlan& plan_;
  const SweepLaws& laws_;
  Cells columns_;
  std::size_t error_;                        // index of the column kErrorColumn
  std::vector<std::vector<double>> values_;  // of the columns behind error_, each by the number of the run
  std::vector<bool> has_failed_;             // by the number of the run
  std::vector<Reason> reasons_;              // in order of their first runs
  std::unordered_map<std::string, std::size_t> place_of_reason_;
  std::set<std::string> settled_;  // laws of teams of which a run has settled
};

}  // namespace mascot
