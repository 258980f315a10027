#pragma once

#include <functional>
#include <string>
#include <thread>

#include "orchestrator/live/shown/metric_curves.h"
#include "orchestrator/recording/indexed_rows.h"

namespace mascot {

/// Gives all rows of a recording to the curves of the user's own metrics, in a thread of its own.
class MetricReader {
 public:
  /// `curves` must outlive this object. `log` takes a line about a damaged file; the curves then end there. Throws what
  /// IndexedRows throws.
  MetricReader(const std::string& run, MetricCurves& curves, std::function<void(const std::string&)> log);

 private:
  void Run(const std::stop_token& over);

  IndexedRows rows_;  // of this object alone: another thread reads the file, too
  MetricCurves& curves_;
  const std::function<void(const std::string&)> log_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace mascot
