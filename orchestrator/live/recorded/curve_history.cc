#include "orchestrator/live/recorded/curve_history.h"

#include <algorithm>
#include <utility>

#include "agent/laws/laws.h"
#include "experiment/phase.h"
#include "orchestrator/measuring/agreement_meter.h"

namespace mascot {
namespace {

/// Whether an agent may fly a law with a curve at some time. Phases may name any law.
bool MayHaveCurve(const Experiment& experiment) {
  return !PhasesOf(experiment).empty() ||
         std::ranges::any_of(LawsIn(experiment), [](const LawEntry* law) { return law->curve.has_value(); });
}

}  // namespace

CurveHistory::CurveHistory(const Experiment& experiment, const RecordedTicks& ticks, Source source)
    : experiment_(experiment),
      ticks_(ticks),
      source_(std::move(source)),
      has_curve_(MayHaveCurve(experiment)),
      row_(experiment.size()),
      meters_(experiment) {}

void CurveHistory::Follow(int rows) {
  for (; rows > 0 && !is_whole(); --rows) {
    const std::int64_t tick = std::exchange(next_, ticks_.last() + 1);  // which it stays if reading fails
    source_.read(tick, row_);
    if (tick >= changes_at_) TakeChanges(tick);
    if (has_curve_) meters_.Add(tick, row_);
    if (curves_.Wants(tick)) {
      const auto of_law = has_curve_ ? meters_.CurveOf(EntryOf(now_->law)) : std::nullopt;
      curves_.Add(tick, DisagreementOf(*now_, row_.motions), of_law, row_.motions);
    }
    next_ = After(tick);
  }
}

/// The next tick whose row is needed: any that there is, or one that gives a point of the curves.
std::int64_t CurveHistory::After(std::int64_t tick) const {
  if (has_curve_) return ticks_.TickAfter(tick);
  const std::int64_t step = curves_.every();
  std::int64_t next = (tick / step + 1) * step;
  while (next <= ticks_.last() && !ticks_.Has(next)) next += step;
  return next;
}

void CurveHistory::TakeChanges(std::int64_t tick) {
  const std::shared_ptr<const Experiment> before = std::exchange(now_, source_.at(tick));
  changes_at_ = source_.next_change(tick);
  if (!has_curve_) return;
  if (!before)
    meters_.Begin(*now_, tick, MotionsAtStart(experiment_));
  else if (now_->phase != before->phase)
    meters_.Begin(*now_, tick, row_.motions);
  else
    meters_.Adopt(*now_);
}

}  // namespace mascot
