#include "orchestrator/serving/recorded_series.h"

namespace mascot {

std::vector<RowSink*> RecordedSeries::Begin(const Experiment& experiment) {
  newest_ = folder_ / std::to_string(++number_);
  record_ = std::make_unique<EpisodeRecord>(newest_.string(), experiment, /*force=*/false, RunFolder::Words(), engine_);
  return record_->Begin(experiment);
}

void RecordedSeries::End(const EngineResult& result) {
  const std::unique_ptr<EpisodeRecord> record = std::move(record_);
  record->End(result);
}

}  // namespace mascot
