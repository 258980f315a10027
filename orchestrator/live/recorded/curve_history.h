#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "experiment/experiment.h"
#include "orchestrator/live/shown/curves.h"
#include "orchestrator/measuring/law_meters.h"
#include "orchestrator/recording/recorded_ticks.h"

namespace mascot {

/// The curves of a whole recording. The curve of a law may depend on all rows before, so they are followed from the
/// start, in pieces; of laws without a curve only the rows are read that give a point.
class CurveHistory {
 public:
  /// Where rows and changes come from.
  struct Source {
    std::function<void(std::int64_t tick, DecodedRow& row)> read;
    /// The experiment as it is at a tick.
    std::function<std::shared_ptr<const Experiment>(std::int64_t tick)> at;
    /// The first tick after this one at which events change the experiment; INT64_MAX: none.
    std::function<std::int64_t(std::int64_t tick)> next_change;
  };
  /// `experiment`, which must outlive this object: as it was at the start. `ticks`: those of which the recording has
  /// rows.
  CurveHistory(const Experiment& experiment, const RecordedTicks& ticks, Source source);

  /// Goes on by at most this many rows. Throws what reading throws; the curves then end there.
  void Follow(int rows);
  bool is_whole() const { return next_ > ticks_.last(); }
  const Curves& curves() const { return curves_; }

 private:
  void TakeChanges(std::int64_t tick);
  std::int64_t After(std::int64_t tick) const;

  const Experiment& experiment_;
  RecordedTicks ticks_;
  Source source_;
  bool has_curve_;                         // a law of some phase has one
  std::shared_ptr<const Experiment> now_;  // null before the first row
  std::int64_t changes_at_ = 0;            // next
  DecodedRow row_;
  LawMeters meters_;
  Curves curves_;
  std::int64_t next_ = 0;
};

}  // namespace mascot
