#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "bus/stop_signal.h"
#include "orchestrator/sweeping/plan.h"

namespace mascot {

/// Flies the runs of a sweep, each in one process, on several workers at once, and grows their table.
class Sweeper {
 public:
  struct Options {
    int jobs = 0;  ///< processes at work; 0: one per core
    std::string out;
    bool force = false;  ///< begin anew where `out` holds another sweep
    bool quiet = false;
  };
  struct Outcome {
    std::size_t flown = 0;                ///< by this call
    std::size_t failed = 0;               ///< of those
    std::optional<std::size_t> in_table;  ///< rows of the table, also of earlier calls; absent: it ended before one
    int signal = 0;                       ///< the signal that ended it early; 0: none
  };

  /// `name` of the experiment file as typed, and its text as it was at the start, whoever edits it meanwhile. (Files
  /// that it names are read for each run.)
  Sweeper(std::string name, std::string text, SweepPlan plan);

  /// Flies every run that the table lacks. Throws ConfigError if no run is a valid experiment, with the mistakes of the
  /// first, and for a table that SweepFile refuses; std::runtime_error if the table cannot be written.
  Outcome Fly(const Options& options, StopSignal& stop) const;
  const SweepPlan& plan() const { return plan_; }

 private:
  std::string name_, text_;
  SweepPlan plan_;
};

}  // namespace mascot
