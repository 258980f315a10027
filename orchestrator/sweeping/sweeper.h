#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "agent/python_metrics.h"
#include "bus/stop_signal.h"
#include "orchestrator/sweeping/plan.h"

namespace mascot {

/// A file beside a table: sweep.png with the ending ".png" of sweep.csv. Of a table without the ending .csv the whole
/// name stays: gain.v1.png of gain.v1.
std::filesystem::path FileBeside(std::filesystem::path table, std::string_view ending);
/// The file with the statistics of a table: sweep.stats.csv of sweep.csv.
std::filesystem::path StatisticsBeside(const std::filesystem::path& table);

/// Executes the runs of a sweep, each in one process, with several processes in parallel, and writes their table.
class Sweeper {
 public:
  /// A Python file with the user's own metrics, and its contents, read once.
  struct MetricFile {
    std::string path;  ///< empty: there is none
    std::string text;
  };
  struct Options {
    int jobs = 0;        ///< number of processes; 0: one per core
    std::string out;     ///< path of the table
    std::string metric;  ///< a column that the table must have; "": none
    MetricFile metric_file = {};
    bool force = false;  ///< overwrite the table of another sweep
    bool quiet = false;
  };
  struct Outcome {
    std::size_t flown = 0;                ///< runs executed by this call
    std::size_t failed = 0;               ///< how many of these failed
    std::optional<std::size_t> in_table;  ///< rows in the table, also from earlier calls; absent: no table was opened
    std::vector<std::string> lines;       ///< of a sweep that was not interrupted: what became of its runs
    std::vector<PythonMetric> own;        ///< the user's metrics
    std::vector<std::string> laws;        ///< names of the laws that it goes over
    int signal = 0;                       ///< the signal that ended the sweep early; 0: none
  };

  /// `name`: path of the experiment file as typed. `text`: its contents, read once, so that later edits have no effect.
  /// (Files that it names are read for each run.)
  Sweeper(std::string name, std::string text, SweepPlan plan);

  /// Executes every run that is missing in the table. Throws ConfigError if no run is a valid experiment (with the
  /// mistakes of the first run), if the table would not have the column `metric`, or if SweepFile refuses the table;
  /// std::runtime_error if the table cannot be written.
  Outcome Fly(const Options& options, StopSignal& stop) const;
  const SweepPlan& plan() const { return plan_; }

 private:
  std::string name_, text_;
  SweepPlan plan_;
};

}  // namespace mascot
