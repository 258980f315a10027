#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "orchestrator/measuring/left_out_meter.h"
#include "orchestrator/measuring/link_meter.h"

namespace mascot {

/// The state of each edge at any tick of a recording. What a link delivers depends on its past (samples on their way,
/// samples that it holds, bursts of losses), so the states of a tick follow from all rows up to it. They are computed
/// from the start, or from one of some ticks whose states are kept. As long as every sample arrives at once, and no law
/// leaves out what it hears, no row is needed.
class EdgeHistory {
 public:
  /// Where rows and changes come from.
  struct Source {
    std::function<void(std::int64_t tick, DecodedRow& row)> read;
    /// The experiment after the events of exactly this tick; null: there are none.
    std::function<std::shared_ptr<const Experiment>(std::int64_t tick)> adopted_at;
    /// The first tick after this one at which events change the experiment; INT64_MAX: none.
    std::function<std::int64_t(std::int64_t tick)> next_change;
  };
  /// `experiment`, which must outlive this object: as it was at the start. `last_tick`: of the recording.
  EdgeHistory(const Experiment& experiment, std::int64_t last_tick, Source source);

  /// Goes on towards `tick`, by at most this many rows. Returns whether it has reached `tick`; `edges` are then those
  /// of the tick, in increasing order of hearer, then of heard. Throws what reading throws.
  bool Follow(std::int64_t tick, int rows, std::vector<EdgeNow>& edges);

 private:
  struct Meters {
    explicit Meters(const Experiment& experiment) : links(experiment), left_out(experiment) {}
    LinkMeter links;
    LeftOutMeter left_out;
  };

  void GoNear(std::int64_t tick);

  Source source_;
  DecodedRow row_;
  std::int64_t keep_every_;                               // ticks
  std::map<std::int64_t, std::unique_ptr<Meters>> kept_;  // by the next tick to add; one is before tick 0
  std::unique_ptr<Meters> meters_;
  std::int64_t next_ = 0;  // tick to add to meters_
};

}  // namespace mascot
