#include "orchestrator/measuring/run_meter.h"

#include <utility>

#include "experiment/phase.h"

namespace mascot {

RunMeter::RunMeter(const Experiment& experiment, Crew& crew)
    : experiment_(experiment),
      metrics_(experiment, crew),
      links_(experiment),
      incidents_(experiment),
      laws_(experiment) {
  Begin(experiment, 0, MotionsAtStart(experiment));
}

void RunMeter::Begin(const Experiment& now, std::int64_t tick, std::span<const Motion> motions) {
  laws_.Begin(now, tick, motions);
  phases_.emplace_back(PhaseAsExperiment(experiment_, now, tick, EndOfPhase(experiment_, tick), motions), tick);
}

void RunMeter::Adopt(const LiveExperiment& live, std::span<const Event> /*events*/) {
  now_ = live.now();
  metrics_.Adopt(now_);
  links_.Adopt(now_);
}

void RunMeter::Add(const FlownRow& row) {
  const DecodedRow& decoded = row.decoded();
  metrics_.Add(decoded);
  links_.Add(row.tick(), decoded);
  incidents_.Add(row, links_);
  if (now_ && now_->phase == phases_.size()) {
    phases_.back().End(decoded.motions, laws_.Result());
    Begin(*now_, row.tick(), decoded.motions);
  } else if (!decoded.events.empty()) {
    phases_.back().Adopt(*now_);
    laws_.Adopt(*now_);
  }
  phases_.back().Add(decoded.motions);
  laws_.Add(row.tick(), decoded);
}

void RunMeter::OnVehicle(const VehicleNews& news) {
  metrics_.OnVehicle(news);
  incidents_.OnVehicle(news);
}

std::vector<LawMeasured> RunMeter::LawsOf(std::size_t phase) const {
  return phase + 1 == phases_.size() ? laws_.Result() : phases_[phase].laws();
}

}  // namespace mascot
