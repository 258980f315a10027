#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/measuring/aim_meter.h"
#include "orchestrator/measuring/law_meters.h"

namespace mascot {

/// Measures one phase of a run ([[law.schedule]]; without it, the whole run) as an experiment of its own, whose time
/// counts from its first row.
class PhaseMeter {
 public:
  /// `phase`: the phase that begins at tick `from`, as an experiment of its own (experiment/phase.h).
  PhaseMeter(Experiment phase, std::int64_t from)
      : from_(from), experiment_(std::make_unique<const Experiment>(std::move(phase))), aim_(*experiment_) {}

  /// Call it when events have changed the experiment, but begun no phase: from the next row on, the experiment is
  /// `now`.
  void Adopt(const Experiment& now) { aim_.Adopt(now); }
  /// Adds the next row of the run.
  void Add(std::span<const Motion> motions) { aim_.Add(motions); }
  /// Call it when the next phase begins, with these motions, which are the last of this phase. `laws` is what the laws
  /// have measured.
  void End(std::span<const Motion> motions, std::vector<LawMeasured> laws) {
    aim_.Add(motions);
    laws_ = std::move(laws);
  }

  std::int64_t from() const { return from_; }
  /// The phase as an experiment of its own, as it began.
  const Experiment& experiment() const { return *experiment_; }
  Aim aim() const { return aim_.Result(); }
  /// What the laws had measured at the end of the phase.
  const std::vector<LawMeasured>& laws() const { return laws_; }
  double disagreement_m() const { return aim_.disagreement_m(); }

 private:
  std::int64_t from_;
  std::unique_ptr<const Experiment> experiment_;
  AimMeter aim_;
  std::vector<LawMeasured> laws_;
};

}  // namespace mascot
