#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Keeps the curve of the team's law (LawEntry::curve) over a run, for its pictures: a value of every tick, or, of a
/// long run, of every 2nd, 4th, ...
class LawCurveRecord final : public RowSink {
 public:
  static constexpr std::size_t kMaxPoints = 4000;

  /// `meter`, which must outlive this object, gets each row first.
  LawCurveRecord(const Experiment& experiment, const RunMeter& meter) : experiment_(experiment), meter_(meter) {}

  void Add(const FlownRow& row) override;
  /// False: no law had a curve, or none had a value.
  bool has_values() const { return !points_.empty(); }
  /// Text of law_curve.csv; docs/recording.md describes the columns.
  std::string Csv() const;

 private:
  const Experiment& experiment_;
  const RunMeter& meter_;
  std::vector<std::pair<std::int64_t, double>> points_;  // tick and value
  std::int64_t every_ = 1;
};

}  // namespace mascot
