#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "agent/python/metrics.h"
#include "experiment/experiment.h"
#include "orchestrator/control/run_requests.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/live/server/address.h"
#include "orchestrator/live/shown/metric_curves.h"
#include "orchestrator/live/shown/run_view.h"
#include "orchestrator/recording/run_folder.h"
#include "system/console.h"
#include "system/log_file.h"
#include "system/stop_signal.h"

namespace CLI {
class App;
}

namespace mascot {

/// What --view, --allow-origin, --watch-only, --stay and --metric ask for.
struct ViewerArgs {
  std::optional<LiveAddress> at;
  std::vector<std::string> allowed_origins = {};
  bool watch_only = false;
  bool stay = false;
  std::string metric_file = {};  ///< empty: there is none
};

/// Adds the option --allow-origin, which may be given several times.
void AddAllowOrigin(CLI::App& command, std::vector<std::string>& origins);
/// Adds the flag --watch-only.
void AddWatchOnly(CLI::App& command, bool& watch_only);

/// Adds the option --metric.
void AddMetric(CLI::App& command, std::string& file);
/// The metrics of the file at `path`; null: it is empty. Throws ConfigError, naming --metric, for mistakes in the file.
std::unique_ptr<const PythonMetrics> MetricsOf(const std::string& path);

/// With --watch-only, viewers steer who know a new token; without, all.
Steering SteeringFor(bool watch_only);

/// Prints where the page is, and, if not all may steer, the address for those who may. If other machines may reach it,
/// and the output is a terminal, prints a QR code of it, too.
void PrintAddresses(const LiveView& view, Console& console);

/// The live view of a run of `up`, if the user asked for --view; else an object that does nothing.
class Viewers {
 public:
  /// Listens at `args.at`, if it is given, and prints where. All arguments but `engine` must outlive this object.
  /// Throws ConfigError if no viewer could watch.
  Viewers(const ViewerArgs& args, const std::string& engine, const Experiment& experiment, const Prediction& prediction,
          const RunMeter& meter, RunRequests& requests, Console& console);
  Viewers(const Viewers&) = delete;
  Viewers& operator=(const Viewers&) = delete;

  /// Address of the page; empty: there is none.
  std::string url() const { return view_ ? view_->page().addresses().front() : ""; }

  /// From now on, lines about viewers are also written to logs/viewers.log; the first line creates the file.
  void LogTo(const RunFolder& folder);
  /// Adds sinks that show viewers the rows and the events of the run. The RunRequests must be among `sinks` already,
  /// because they know which events were given by hand.
  void AddTo(std::vector<RowSink*>& sinks);
  /// Viewers see how the run ended until this object ends, or shows the recording.
  void SayHowItEnded(const EngineResult& result);
  /// Whether viewers shall see the recording when the run has ended: if --stay says so, or somebody watches and the
  /// terminal is there to end it.
  bool Stay() const;
  /// Closes the connections, and shows the recording of the run at the same address, to the same viewers, until a
  /// signal. An error ends it with a warning.
  void ShowRecording(const RunFolder& folder, StopSignal& stop);

 private:
  /// Prints a line about viewers, and keeps it in the log. From any thread.
  void Log(const std::string& line);
  /// Adds a line to the log, or to `lines_` until there is one. The caller holds `mutex_`.
  void Keep(const std::string& line);

  const ViewerArgs& args_;
  Console& console_;
  std::mutex mutex_;                // guards what follows
  std::vector<std::string> lines_;  // lines for the log, until its folder is known
  std::optional<std::filesystem::path> log_;
  std::optional<LogFile> file_;
  bool no_file_ = false;  // the log file could not be made

  const std::unique_ptr<const PythonMetrics> metrics_;
  std::optional<RunView> view_;
  std::optional<MetricCurves> metric_curves_;
};

}  // namespace mascot
