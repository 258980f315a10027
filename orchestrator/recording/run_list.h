#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mascot {

/// What is told of a run folder without reading its recording. What it does not say, or what cannot be read, is empty.
struct ListedRun {
  std::string folder;
  std::string name;                               ///< run.name
  std::chrono::system_clock::time_point written;  ///< when its config.toml was
  std::uint64_t bytes = 0;                        ///< of all its files
  std::optional<double> sim_s;                    ///< simulated time that was flown
  std::optional<int> exit;                        ///< exit code of `up`
  bool is_alive = false;                          ///< a process of this machine writes to it
  std::string note;                               ///< what NoteRun() kept
};

/// The runs in a folder, at most two folders deep, as FindRun() finds them; the newest first. The folder itself, if it
/// is a run. Throws ConfigError if there is no such folder.
std::vector<ListedRun> ListRuns(const std::string& folder);

/// Removes the files of a run, as `up` wrote them, with its pictures and note, and the folders that are empty then: its
/// own, and the one around it. Other files stay. Throws ConfigError if `folder` is not that of a run, if a process
/// writes to it, or if something that no run has made has the name of such a file.
void RemoveRun(const std::string& folder);

/// Keeps a note beside the run; an empty one is removed. Throws ConfigError if `folder` is not that of a run.
void NoteRun(const std::string& folder, const std::string& note);

}  // namespace mascot
