#pragma once

#include <array>
#include <vector>

#include "agent/python/metrics.h"
#include "orchestrator/recording/state_arrays.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Keeps the arrays of states.npz of a run in memory, for metrics in Python.
class RunArrays final : public RowSink {
 public:
  explicit RunArrays(const Experiment& experiment);

  void Add(const FlownRow& row) override;
  /// The arrays as np.load() would read them from states.npz. Valid until the next Add().
  std::vector<RunArray> All() const;

 private:
  const Experiment& experiment_;
  StateRow row_;
  std::vector<double> ids_;
  std::array<std::vector<double>, kStateArrays.size()> values_;  // row after row
};

}  // namespace mascot
