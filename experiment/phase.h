#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// Motions of all agents at tick 0, by id - 1.
std::vector<Motion> MotionsAtStart(const Experiment& experiment);
/// The ticks at which phases of [[law.schedule]] begin: increasing, each once; without the first phase, which begins at
/// 0.
std::vector<std::int64_t> PhasesOf(const Experiment& experiment);
/// The tick at which the phase that begins at `from` ends: the next one's first, or the last of the run.
std::int64_t EndOfPhase(const Experiment& experiment, std::int64_t from);
/// The events of the ticks from `from` up to but without `to`.
std::span<const Event> EventsWithin(const Experiment& experiment, std::int64_t from, std::int64_t to);
/// The ticks from `from` to `to` as an experiment of its own, for meters and theory. `start` is the experiment at tick
/// 0, `now` the experiment that is flown at `from`, `starts` are the motions at tick `from` (by id - 1); times count
/// from `from`. The result has no headings and no phases, and its graph's schedule is not moved.
Experiment PhaseAsExperiment(const Experiment& start, const Experiment& now, std::int64_t from, std::int64_t to,
                             std::span<const Motion> starts);

}  // namespace mascot
