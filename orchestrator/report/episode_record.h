#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "orchestrator/engines/episodes.h"
#include "orchestrator/recording/run_folder.h"

namespace mascot {

/// Records one episode: its folder is that of a run, without pictures and logs.
class EpisodeRecord final : public EpisodeWitness {
 public:
  /// Creates the folder `out`, as RunFolder does, for an episode of `experiment`, or of one with other values.
  /// `engine`: the name of the one that flies it.
  EpisodeRecord(const std::optional<std::string>& out, const Experiment& experiment, bool force,
                const RunFolder::Words& words, std::string engine = kInProcess);
  ~EpisodeRecord() override;

  std::vector<RowSink*> Begin(const Experiment& experiment) override;
  /// Completes the folder. Throws std::runtime_error if a file cannot be written.
  void End(const EngineResult& result) override;
  const std::filesystem::path& folder() const { return path_; }
  /// Whether an episode was recorded: then this object passes over all others.
  bool is_complete() const { return !folder_; }

 private:
  struct Running;
  std::optional<const RunFolder> folder_;  // absent when it is complete: another run may take it
  const std::filesystem::path path_;
  const std::string engine_;
  std::chrono::steady_clock::time_point began_;
  std::unique_ptr<Running> running_;  // null: no episode is being recorded
};

}  // namespace mascot
