#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/experiment.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// The figures of one law, as measured.
struct LawMeasured {
  const LawEntry* law = nullptr;
  std::vector<FigureValues> figures;  ///< in the order of law->figures
};

/// Measures, row by row, the figures of the laws that are flown, beyond those that all laws share: for each law from
/// when it began, also over phases of [[law.schedule]] in which it goes on with what it remembers.
class LawMeters {
 public:
  /// The experiment at tick 0 must outlive this object.
  explicit LawMeters(const Experiment& start) : start_(start) {}
  /// Call it when a phase begins at `tick`, with these motions (by id - 1): from then on the run flies `now`.
  void Begin(const Experiment& now, std::int64_t tick, std::span<const Motion> motions);
  /// Call it when events have changed the experiment, but begun no phase: from the next row on, the experiment is
  /// `now`.
  void Adopt(const Experiment& now);
  /// Adds the next tick.
  void Add(std::int64_t tick, const DecodedRow& row);
  /// The value of the curve of `law` in the newest row; nothing: it has none, or no agent flies the law.
  std::optional<double> CurveOf(const LawEntry& law) const;
  /// One entry for each law that has figures, in the order of LawsIn().
  std::vector<LawMeasured> Result() const;

 private:
  struct Meter {
    const LawEntry* law = nullptr;
    std::vector<int> ids = {};
    std::int64_t from = 0;
    std::vector<Motion> starts = {};
    std::shared_ptr<const Experiment> first = {}, now = {};  // from `from` on, as it began and as it is
    std::unique_ptr<LawMeter> meter = {};

    bool GoesOn(const LawEntry* with, std::span<const int> of, const Experiment& in) const;
  };
  std::shared_ptr<const Experiment> Since(const Meter& meter, const Experiment& now) const;

  const Experiment& start_;
  std::int64_t end_ = 0;  // of the phase
  std::vector<Meter> meters_;
};

}  // namespace mascot
