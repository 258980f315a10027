#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "experiment/live_experiment.h"
#include "orchestrator/live/recorded/curve_history.h"
#include "orchestrator/live/recorded/edge_history.h"
#include "orchestrator/live/shown/ui_channels.h"
#include "orchestrator/recording/indexed_rows.h"

namespace mascot {

/// A recording as viewers see it, tick by tick in any order. What is shown of a tick depends on that tick alone. Reads
/// only the parts of the file that are asked for.
class RecordedRun {
 public:
  /// Throws what IndexedRows throws, and ConfigError if its experiment cannot be read.
  explicit RecordedRun(const std::string& run);
  RecordedRun(const RecordedRun&) = delete;
  RecordedRun& operator=(const RecordedRun&) = delete;

  /// The experiment at the start.
  const Experiment& experiment() const { return experiment_; }
  const IndexedRows& rows() const { return rows_; }
  std::int64_t last_tick() const { return rows_.ticks().last(); }
  RecordedPart part() const;
  /// All events. The events.csv beside the recording says which of them were given by hand. The recording does not say
  /// it: it is the same, byte for byte, when the run is flown again from its config.toml.
  std::vector<ShownEvent> Events() const;

  /// The experiment as events have changed it up to and at `tick`. Throws ConfigError for an event that this version
  /// does not understand. This object keeps only some of these experiments; a caller that needs one for longer keeps
  /// it.
  std::shared_ptr<const Experiment> At(std::int64_t tick);
  /// The live keys with their values at `tick`. Throws as At() does.
  std::vector<ShownKey> KeysAt(std::int64_t tick);
  /// The row of `tick`, or the newest before it, as viewers see it, without its edges. Throws std::runtime_error if the
  /// file is damaged there.
  void Show(std::int64_t tick, ShownRow& row);
  /// Goes on to compute the edges of the row that Show() returned, by at most this many rows of the recording. Returns
  /// whether row.edges are known now, or never will be because there are more than kMaxEdgesShown. Throws as Show()
  /// does.
  bool FollowEdges(ShownRow& row, int rows);
  /// The curves from the start, as far as FollowCurves() has come.
  const CurveHistory& curves() const { return curves_; }
  /// Goes on to compute them, by at most this many rows. Throws as Show() does; the curves then end there.
  void FollowCurves(int rows) { curves_.Follow(rows); }

 private:
  /// The experiment from this event on; null: that of the start.
  std::shared_ptr<const Experiment> StateAfter(std::size_t events);
  /// How many events have taken effect up to and at `tick`.
  std::size_t EventsUpTo(std::int64_t tick) const;
  /// The first tick after this one at which an event takes effect; INT64_MAX: none.
  std::int64_t NextChange(std::int64_t tick) const;

  IndexedRows rows_;
  const Experiment experiment_;
  const std::string incidents_;
  const std::vector<IndexedRows::EventAt> events_;
  static constexpr std::size_t kBetweenMarks = 64;
  std::optional<LiveExperiment> live_;  // after the events that were asked for last; never empty
  std::vector<LiveExperiment> marks_;   // as it was before the first event and every kBetweenMarks events later
  EdgeHistory edges_;
  CurveHistory curves_;
};

}  // namespace mascot
