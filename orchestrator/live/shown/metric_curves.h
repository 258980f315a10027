#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "agent/python/metrics.h"
#include "orchestrator/recording/run_arrays.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// The metrics of a user's Python file as curves: the value of each at a time is that of the run up to then. A thread
/// of this object evaluates them, so that nobody waits for the user's code.
class MetricCurves final : public RowSink {
 public:
  /// Rows at which the metrics are evaluated.
  static constexpr std::int64_t kPoints = 200;

  enum class Rows {
    kAsTheyCome,  ///< of a run: if evaluating is slow, times are left out, so that it takes a tenth of one core
    kAllAtOnce,   ///< of a recording
  };

  /// `last_row`: number of the run's last row, from 0. `publish` takes the message of /ui/metrics whenever there is
  /// more, and `log` a line if the metrics go on failing, both from this object's thread. All arguments but `last_row`
  /// and `rows` must outlive this object.
  MetricCurves(const Experiment& experiment, const PythonMetrics& metrics, std::int64_t last_row, Rows rows,
               std::function<void(std::string)> publish, std::function<void(const std::string&)> log);
  MetricCurves(const MetricCurves&) = delete;
  MetricCurves& operator=(const MetricCurves&) = delete;

  /// The message where there are no metrics.
  static std::string NoMetrics();

  // From one thread.
  void Add(const FlownRow& row) override { Add(row.tick(), row.decoded()); }
  /// Takes the next row: that of tick 0, of every tick or, of a recording, of some.
  void Add(std::int64_t tick, const DecodedRow& row);

  // From any thread.
  /// Waits until the metrics of all rows that were added are published. For tests.
  void Wait();

 private:
  using WallClock = std::chrono::steady_clock;
  struct Point {
    std::int64_t tick = 0;
    std::vector<std::optional<double>> values;  ///< of metrics_.list()
  };

  void Run(const std::stop_token& over);
  std::optional<std::int64_t> NextRow() const;
  void Evaluate(std::int64_t row);
  std::string Message() const;

  const Experiment& experiment_;
  const PythonMetrics& metrics_;
  const std::int64_t last_row_, every_;
  const Rows rows_;
  const std::function<void(std::string)> publish_;
  const std::function<void(const std::string&)> log_;

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  RunArrays arrays_;                 // guarded by mutex_ but for rows that are there
  std::vector<std::int64_t> ticks_;  // of the rows; guarded by mutex_
  std::int64_t evaluated_ = 0;       // guarded by mutex_: the row of the last evaluation
  bool is_idle_ = true;              // guarded by mutex_
  std::vector<Point> points_;        // of the thread
  std::string error_;                // of the thread: why the last evaluation failed
  int failures_ = 0;                 // of the thread: evaluations that failed since one did not
  std::string logged_;               // of the thread: the error that was logged last
  WallClock::time_point published_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace mascot
