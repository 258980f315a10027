#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "orchestrator/engines/episodes.h"
#include "orchestrator/report/episode_record.h"

namespace mascot {

/// Records every episode that leaves its tick 0 as a run, in a folder that is named by its number: "1", "2", ...
class RecordedSeries final : public EpisodeWitness {
 public:
  /// `folder`: of these folders. `engine`: the name of the one that flies them.
  RecordedSeries(std::filesystem::path folder, std::string engine)
      : folder_(std::move(folder)), engine_(std::move(engine)) {}

  std::vector<RowSink*> Begin(const Experiment& experiment) override;
  void End(const EngineResult& result) override;
  /// The folder of the newest episode; empty: none was recorded.
  const std::filesystem::path& newest() const { return newest_; }

 private:
  const std::filesystem::path folder_;
  const std::string engine_;
  std::filesystem::path newest_;
  int number_ = 0;
  std::unique_ptr<EpisodeRecord> record_;  // of the episode that goes on
};

}  // namespace mascot
