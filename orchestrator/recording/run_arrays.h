#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "agent/python/metrics.h"
#include "orchestrator/recording/state_arrays.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Keeps the arrays of states.npz of a run in memory, for metrics in Python.
class RunArrays final : public RowSink {
 public:
  RunArrays(int agents, int rate_hz);
  explicit RunArrays(const Experiment& experiment);

  void Add(const FlownRow& row) override { Add(row.tick(), row.decoded()); }
  void Add(std::int64_t tick, const DecodedRow& row);
  /// How many rows there are.
  std::size_t rows() const { return values_[0].size(); }
  /// The arrays as np.load() would read them from states.npz. Valid until the next Add().
  std::vector<RunArray> All() const { return First(rows()); }
  /// The arrays of the first rows alone. If that many rows were announced by Reserve(), they stay valid.
  std::vector<RunArray> First(std::size_t rows) const;
  /// Makes room for so many rows.
  void Reserve(std::size_t rows);

 private:
  int rate_hz_;
  StateRow row_;
  std::vector<double> ids_;
  std::array<std::vector<double>, kStateArrays.size()> values_;  // row after row
};

}  // namespace mascot
