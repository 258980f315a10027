#pragma once

#include <cstdint>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/measuring/link_meter.h"
#include "orchestrator/measuring/metrics.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Measures a run row by row: metrics and link traffic.
class RunMeter final : public RowSink {
 public:
  explicit RunMeter(const Experiment& experiment) : metrics_(experiment), links_(experiment) {}

  void Adopt(const LiveExperiment& live) override {
    metrics_.Adopt(live.now());
    links_.Adopt(live.now());
  }
  void Add(const FlownRow& row) override {
    metrics_.Add(row.decoded());
    links_.Add(row.tick(), row.decoded());
  }
  Measured Result() const { return metrics_.Result(); }
  std::vector<EdgeTraffic> Traffic() const { return links_.Result(); }
  void EdgesNow(std::vector<EdgeNow>& edges) const { links_.EdgesNow(edges); }
  /// Disagreement in the newest row, for those who watch.
  double disagreement_m() const { return metrics_.disagreement_m(); }

 private:
  Metrics metrics_;
  LinkMeter links_;
};

}  // namespace mascot
