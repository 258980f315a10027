#pragma once

#include <cstdint>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/measuring/law_meters.h"
#include "orchestrator/measuring/link_meter.h"
#include "orchestrator/measuring/metrics.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Measures a run row by row: metrics, link traffic, figures of laws.
class RunMeter final : public RowSink {
 public:
  explicit RunMeter(const Experiment& experiment) : metrics_(experiment), links_(experiment), laws_(experiment) {}

  void Adopt(const LiveExperiment& live) override {
    metrics_.Adopt(live.now());
    links_.Adopt(live.now());
    laws_.Adopt(live.now());
  }
  void Add(const FlownRow& row) override {
    metrics_.Add(row.decoded());
    links_.Add(row.tick(), row.decoded());
    laws_.Add(row.tick(), row.decoded());
  }
  Measured Result() const { return metrics_.Result(); }
  /// What the laws measure of themselves.
  std::vector<LawMeasured> Laws() const { return laws_.Result(); }
  std::vector<EdgeTraffic> Traffic() const { return links_.Result(); }
  void EdgesNow(std::vector<EdgeNow>& edges) const { links_.EdgesNow(edges); }
  /// Disagreement in the newest row, for those who watch.
  double disagreement_m() const { return metrics_.disagreement_m(); }

 private:
  Metrics metrics_;
  LinkMeter links_;
  LawMeters laws_;
};

}  // namespace mascot
