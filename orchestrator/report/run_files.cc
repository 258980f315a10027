#include "orchestrator/report/run_files.h"

#include "orchestrator/recording/attached_experiment.h"
#include "orchestrator/report/incident_report.h"

namespace mascot {
namespace {

const RunFolder& WithConfig(const RunFolder& folder, const Experiment& experiment) {
  folder.Write("config.toml", experiment.resolved);
  return folder;
}

}  // namespace

RunFiles::RunFiles(const Experiment& experiment, const RunFolder& folder, RunMeter& meter)
    : experiment_(experiment),
      folder_(WithConfig(folder, experiment)),
      meter_(meter),
      writer_(experiment, folder, WithoutEvents(experiment)),
      writes_(experiment, writer_),
      curve_(experiment, meter) {
  if (writer_.edges() != nullptr) edges_.emplace(experiment, *writer_.edges());
}

void RunFiles::AddTo(std::vector<RowSink*>& sinks) {
  if (edges_) sinks.push_back(&*edges_);
  sinks.insert(sinks.end(), {&writes_, &meter_, &curve_});
}

Experiment RunFiles::Complete(std::vector<Event> by_hand, const EngineResult& result) {
  by_hand.insert(by_hand.end(), result.unanswered.begin(), result.unanswered.end());
  Experiment flown = WithEvents(experiment_, by_hand);
  if (!by_hand.empty()) folder_.Write("config.toml", flown.resolved);
  writes_.Finish();
  const std::int64_t ticks = writer_.ticks() - 1;  // row 0 is the start
  if (result.failure.empty() && ticks > 0 && ticks < experiment_.ticks())
    folder_.Write("config.toml", StoppedAfter(flown, ticks));
  writer_.Close(WithoutDelivery(flown));
  return flown;
}

void RunFiles::WriteTables(const Incidents& incidents) const {
  folder_.Write("events.csv", IncidentsCsv(experiment_, incidents));
  if (curve_.has_values()) folder_.Write("law_curve.csv", curve_.Csv());
}

}  // namespace mascot
