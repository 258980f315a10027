#include "orchestrator/measuring/law_meters.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "experiment/phase.h"

namespace mascot {

bool LawMeters::Meter::GoesOn(const LawEntry* with, std::span<const int> of, const Experiment& in) const {
  return law == with && std::ranges::equal(ids, of) &&
         std::ranges::all_of(of, [&](int id) { return in.agent(id).law.since <= from; });
}

std::shared_ptr<const Experiment> LawMeters::Since(const Meter& meter, const Experiment& now) const {
  return std::make_shared<const Experiment>(PhaseAsExperiment(start_, now, meter.from, end_, meter.starts));
}

void LawMeters::Begin(const Experiment& now, std::int64_t tick, std::span<const Motion> motions) {
  end_ = EndOfPhase(start_, tick);
  std::vector<Meter> before = std::exchange(meters_, {});
  for (const LawEntry* law : LawsIn(now)) {
    if (law->meter == nullptr) continue;
    const std::vector<int> ids = AgentsWith(*law, now);
    const auto same = std::ranges::find_if(before, [&](const Meter& meter) { return meter.GoesOn(law, ids, now); });
    if (same != before.end()) {
      meters_.push_back(std::move(*same));
      continue;
    }
    Meter meter{.law = law, .ids = ids, .from = tick, .starts = {motions.begin(), motions.end()}};
    meter.first = Since(meter, now);
    meter.meter = law->meter(*meter.first, meter.ids);
    meters_.push_back(std::move(meter));
  }
  if (tick > 0) Adopt(now);
}

void LawMeters::Adopt(const Experiment& now) {
  for (Meter& meter : meters_) {
    auto next = Since(meter, now);
    meter.meter->Adopt(*next);
    meter.now = std::move(next);  // the last one ends here: the meter does not refer to it any more
  }
}

void LawMeters::Add(std::int64_t tick, const DecodedRow& row) {
  for (const Meter& meter : meters_)
    meter.meter->Add(
        {.tick = tick - meter.from, .motions = row.motions, .commands = row.commands, .messages = row.messages});
}

std::optional<double> LawMeters::CurveOf(const LawEntry& law) const {
  const auto meter = std::ranges::find(meters_, &law, &Meter::law);
  return meter == meters_.end() ? std::nullopt : meter->meter->Curve();
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
