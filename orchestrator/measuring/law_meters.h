#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "agent/laws.h"
#include "experiment/experiment.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// The figures of one law, as measured.
struct LawMeasured {
  const LawEntry* law = nullptr;
  std::vector<FigureValues> figures;  ///< in the order of law->figures
};

/// Measures, row by row, what the laws in flight measure beyond the figures that all laws share.
class LawMeters {
 public:
  explicit LawMeters(const Experiment& experiment);
  /// Events have changed the experiment: from the next row on it is `now`.
  void Adopt(std::shared_ptr<const Experiment> now);
  /// Adds the next tick.
  void Add(std::int64_t tick, const DecodedRow& row);
  /// One entry for each law that has figures, in the order of LawsIn().
  std::vector<LawMeasured> Result() const;

 private:
  struct Meter {
    const LawEntry* law;
    std::unique_ptr<LawMeter> meter;
  };

  std::shared_ptr<const Experiment> now_;  // null before the first event
  std::vector<Meter> meters_;
};

}  // namespace mascot
