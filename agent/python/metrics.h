#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "agent/python/python.h"

namespace mascot {

/// A measure of a run that a user wrote in Python: a function of the run's arrays that returns a number.
struct PythonMetric {
  std::string name;  ///< name of the function
  std::string unit;  ///< empty: METRICS names no unit
};

/// A Python file with metrics, and its contents, read once.
struct MetricFile {
  std::string path = {};  ///< empty: there is none
  std::string text = {};
};

/// An array of a run, in C order.
struct RunArray {
  std::string name;
  std::vector<std::size_t> shape;
  std::span<const double> values;
  bool of_integers = false;
};

/// The metrics of one Python file: the functions that its METRICS names, as {"overshoot": "m"} with units or
/// ["overshoot"] without; if it has no METRICS, every function that the file defines whose name does not begin with an
/// underscore.
class PythonMetrics {
 public:
  /// Runs `text`, which messages call `file` and whose modules are in `folder`. `limits` holds for this, and for each
  /// call of a metric. Throws std::runtime_error, "FILE:LINE: ...", for mistakes in the text.
  PythonMetrics(const std::string& text, const std::string& file, const std::string& folder, const LawLimits& limits);
  /// Within the limit of time that metrics have everywhere.
  explicit PythonMetrics(const MetricFile& file);
  ~PythonMetrics();
  PythonMetrics(const PythonMetrics&) = delete;
  PythonMetrics& operator=(const PythonMetrics&) = delete;

  /// The metrics, in the order of METRICS, or of the file.
  const std::vector<PythonMetric>& list() const { return list_; }
  /// The value of each metric for a run; nullopt for None and NaN. Each metric gets a dict of read-only NumPy arrays.
  /// Throws std::runtime_error, "FILE:LINE: metric NAME: ...", if one fails or returns anything else.
  std::vector<std::optional<double>> Of(std::span<const RunArray> arrays) const;

 private:
  struct Functions;

  std::string file_;
  LawLimits limits_;
  std::vector<PythonMetric> list_;
  std::unique_ptr<Functions> functions_;
};

}  // namespace mascot
