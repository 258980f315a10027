#pragma once

#include <span>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/measuring/link_meter.h"
#include "orchestrator/recording/edge_queue.h"
#include "orchestrator/ros/scene_rhythm.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Follows the edges of a run, with all its events, for the recording's /scene. It must get each row before whoever
/// writes or compares the recording.
class SceneEdges final : public RowSink {
 public:
  /// Both must outlive this object.
  SceneEdges(const Experiment& experiment, EdgeQueue& to) : to_(to), rhythm_(experiment), links_(experiment) {}

  void Adopt(const LiveExperiment& live, std::span<const Event> /*events*/) override { links_.Adopt(live.now()); }
  void Add(const FlownRow& row) override {
    links_.Add(row.tick(), row.decoded());
    if (!rhythm_.ShowsEdges(row.tick())) return;
    links_.EdgesNow(edges_);
    to_.Put(row.tick(), edges_);
  }

 private:
  EdgeQueue& to_;
  SceneRhythm rhythm_;
  LinkMeter links_;
  std::vector<EdgeNow> edges_;  // scratch
};

}  // namespace mascot
