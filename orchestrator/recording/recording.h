#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/recording/completeness.h"
#include "orchestrator/team/row.h"

namespace mascot {

// What cannot be read is no run: the folder of another user, or one that is being removed.

/// Whether a folder is that of a run: it has a config.toml or a recording.
bool IsARun(const std::filesystem::path& folder);
/// When the config.toml of a run, or else its folder, was written last.
std::filesystem::file_time_type WrittenAt(const std::filesystem::path& folder);
/// The folders of runs in a folder, at most two folders deep (`runs`, `runs/NAME`); that folder itself, if it is one.
std::vector<std::filesystem::path> RunsIn(const std::filesystem::path& folder);

/// The path of the run that a user means by `run`: `run` itself if it is a run folder or a file; if it is a folder with
/// runs in it, at most two folders deep (`runs`, `runs/NAME`), the newest of them; for "latest", unless something has
/// this name, the newest in `runs`. Any other text is returned as it is. Throws ConfigError for "latest" if there is no
/// folder `runs`.
std::string FindRun(const std::string& run);

/// Path of the recording of FindRun(`run`): a file, or a run folder. In a folder it is run.mcap, or else the only .mcap
/// file (record.file may have another name). Throws ConfigError if there is no run.mcap and not exactly one .mcap file.
std::string FindRecording(const std::string& run);

/// Returns `contents`, which are those of `path`. If the recording was cut, they also have the config.toml that it
/// would have, had the run ended there.
McapContents WithConfig(McapContents contents, const std::string& path);
/// What `path` holds, as ReadMcap, WithConfig(). Throws ConfigError if it cannot be read or is no MCAP file.
McapContents ReadRecording(const std::string& path);

/// The rows that a recording holds.
struct RowsOf {
  RecordingPlan plan = {};    ///< with the topics of states and commands only
  bool has_commands = false;  ///< whether every agent's commands were recorded
  RecordedTicks ticks;        ///< those of the complete rows
};
/// Throws ConfigError if it is not the recording of a run, and std::runtime_error if it has gaps, no complete tick, or
/// not the states of all agents. `path` names it in messages.
RowsOf RowsIn(const McapContents& contents, const std::string& path);

/// Reads a recording tick by tick, also an incomplete one. Needs no other file of the run.
class Recording {
 public:
  /// Reads through the whole file. Throws ConfigError if `run` is not a recording of a run, and std::runtime_error if
  /// the recording has gaps, no complete tick, or not the states of all agents.
  explicit Recording(const std::string& run);

  const std::string& path() const { return path_; }
  /// The resolved experiment as TOML; name() is its run.name.
  const std::string& config() const { return contents_.attachments.at(kConfigFile); }
  const std::string& name() const { return rows_.plan.name; }
  int agents() const { return rows_.plan.agents; }
  int rate_hz() const { return rows_.plan.rate_hz; }
  double time_s(std::int64_t tick) const { return static_cast<double>(tick) / rate_hz(); }
  /// Whether every agent's commands were recorded.
  bool has_commands() const { return rows_.has_commands; }
  /// The ticks of which it has complete rows.
  const RecordedTicks& ticks() const { return rows_.ticks; }
  /// Whether some ticks have no row (record.rate_hz).
  bool is_sparse() const { return rows_.plan.ticks_per_row > 1; }
  /// Why later ticks may be missing (LossOf); empty if the recording was closed properly.
  std::string loss() const { return LossOf(contents_); }

  /// Passes every complete row to `on_row`, in order. Rows have no clock and no messages, and commands only if
  /// has_commands(). Throws std::runtime_error if a sample is missing.
  void ForEachRow(const std::function<void(const Row&)>& on_row) const;

 private:
  std::string path_;
  McapContents contents_;
  RowsOf rows_;
};

}  // namespace mascot
