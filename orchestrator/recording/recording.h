#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "orchestrator/formats/mcap/writer.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// The recording that `run` means: the file itself, or a run folder's run.mcap, or the only .mcap in it if record.file
/// named it otherwise. Throws ConfigError if there is no telling.
std::string FindRecording(const std::string& run);

/// A run's recording, also one that was cut short, to be read tick by tick. Needs nothing else of the run.
class Recording {
 public:
  /// Looks through the whole file. Throws ConfigError if `run` is no recording of a run, std::runtime_error if that
  /// has no states or has gaps.
  explicit Recording(const std::string& run);

  const std::string& path() const { return path_; }
  /// The resolved experiment, as TOML, and its name.
  const std::string& config() const { return contents_.attachments.at("config.toml"); }
  const std::string& name() const { return plan_.name; }
  int agents() const { return plan_.agents; }
  double time_s(std::int64_t tick) const { return static_cast<double>(tick) / plan_.rate_hz; }
  /// Whether record.topics wanted every agent's commands too.
  bool has_commands() const { return has_commands_; }
  /// Ticks that are wholly there: 0 to ticks() - 1.
  std::int64_t ticks() const { return ticks_; }
  /// Why there may be no more of them than that; empty if the recording was closed as it should.
  const std::string& damage() const { return contents_.damage; }

  /// Hands every whole tick to `on_row`, in order; without commands if not has_commands(), without clock. Throws
  /// std::runtime_error if a sample is missing in between.
  void ForEachRow(const std::function<void(const Row&)>& on_row) const;

 private:
  std::string path_;
  McapContents contents_;
  RecordingPlan plan_;  // its topics are those that rows are made of
  bool has_commands_ = false;
  std::int64_t ticks_ = 0;
};

}  // namespace mascot
