#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "orchestrator/sweeping/cluster/shard.h"
#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/sweep_work.h"
#include "orchestrator/sweeping/table/sweep_identity.h"
#include "system/stop_signal.h"

namespace mascot {

/// Executes the runs of a sweep, each in one process, with several processes in parallel, and writes their table.
class Sweeper {
 public:
  struct Options {
    int jobs = 0;                     ///< number of processes; 0: one per core
    std::string out;                  ///< path of the table
    std::optional<Shard> shard = {};  ///< fly only the runs of this share; nothing: all
    std::string metric;               ///< a column that the table must have; "": none, or of a search the user's first
    MetricFile metric_file = {};
    bool force = false;  ///< overwrite the table of another sweep
    bool quiet = false;
    /// Not empty: the plan is one of a search, and this says which (SweepIdentity::search). The table may have the rows
    /// of the first runs; runs that are no valid experiments fail alone.
    std::string search = {};
    /// Called now and then with the number of rows in the table; nothing: a line shows the progress.
    std::function<void(std::size_t rows)> watch = {};
  };
  struct Outcome {
    std::size_t flown = 0;                ///< runs executed by this call
    std::size_t failed = 0;               ///< how many of these failed
    std::optional<std::size_t> in_table;  ///< rows in the table, also from earlier calls; absent: no table was opened
    std::vector<std::string> lines;       ///< what became of the runs of a whole sweep that came to its end
    SweepIdentity identity = {};
    std::string column = {};                         ///< of a search: the column of Options::metric
    std::vector<std::optional<double>> values = {};  ///< of a search: the numbers in it, by run
    int signal = 0;                                  ///< the signal that ended the sweep early; 0: none
  };

  /// `name`: path of the experiment file as typed. `text`: its contents, read once, so that later edits have no effect.
  /// (Files that the experiment names are read for each run.)
  Sweeper(std::string name, std::string text, SweepPlan plan);

  /// Executes every run that is missing in the table. Only the table of a whole sweep gets statistics beside it. Throws
  /// ConfigError if no run is a valid experiment (with the mistakes of the first run), if the table would not have the
  /// column `metric`, or if SweepFile refuses the table; std::runtime_error if the table cannot be written.
  Outcome Fly(const Options& options, StopSignal& stop) const;
  /// Makes the checks that Fly() makes before it opens the table, and flies nothing. Throws ConfigError. The outcome
  /// says whether a signal came.
  Outcome Check(const Options& options, StopSignal& stop) const;
  const SweepPlan& plan() const { return plan_; }

 private:
  Outcome Do(const Options& options, bool fly, StopSignal& stop) const;

  std::string name_, text_;
  SweepPlan plan_;
};

}  // namespace mascot
