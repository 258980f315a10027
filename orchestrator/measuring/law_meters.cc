#include "orchestrator/measuring/law_meters.h"

#include <cassert>
#include <utility>

namespace mascot {

LawMeters::LawMeters(const Experiment& experiment) {
  for (const LawEntry* law : LawsIn(experiment))
    if (law->meter != nullptr) meters_.push_back({law, law->meter(experiment, AgentsWith(*law, experiment))});
}

void LawMeters::Adopt(std::shared_ptr<const Experiment> now) {
  for (const Meter& meter : meters_) meter.meter->Adopt(*now);
  now_ = std::move(now);  // the last one ends here: no meter refers to it any more
}

void LawMeters::Add(std::int64_t tick, const DecodedRow& row) {
  const TeamRow team{.tick = tick, .motions = row.motions, .commands = row.commands, .messages = row.messages};
  for (const Meter& meter : meters_) meter.meter->Add(team);
}

std::vector<LawMeasured> LawMeters::Result() const {
  std::vector<LawMeasured> measured;
  for (const Meter& meter : meters_) {
    measured.push_back({meter.law, meter.meter->Figures()});
    assert(measured.back().figures.size() == meter.law->figures.size());
  }
  return measured;
}

}  // namespace mascot
