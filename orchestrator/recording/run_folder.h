#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "system/folder_lock.h"

namespace mascot {

/// The file of a run folder that has the user's note (run_list.h).
inline constexpr const char* kNoteFile = "note.txt";

/// Removes the files of a run from its folder, and no others. Throws ConfigError if a process writes to the folder, or
/// if something that no run has made has the name of such a file.
void RemoveRunFiles(const std::filesystem::path& folder);

/// Names of the pictures of a run that a browser can show, in the order in which they are drawn.
std::vector<std::string> PicturesIn(const std::filesystem::path& folder);

/// Folder for the results of a run: `runs/<name>/<time>/`, or the folder given with --out. As long as this object
/// lives, the folder is locked, and no other run of this machine takes it.
class RunFolder {
 public:
  /// What users call `out` and `force`, for messages.
  struct Words {
    std::string out = "--out";
    std::string force = "--force";
  };
  /// Creates the folder. Throws ConfigError if that fails, if another run writes to the folder, or if `out` exists and
  /// is not empty. With `force`, the files of an earlier run are removed from it instead, and no others; in a folder
  /// that no run has made, something with the name of such a file is an error.
  RunFolder(const std::optional<std::string>& out, const Experiment& experiment, bool force, const Words& words);
  RunFolder(const std::optional<std::string>& out, const Experiment& experiment, bool force)
      : RunFolder(out, experiment, force, Words()) {}

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path File(const std::string& name) const { return path_ / name; }
  /// logs/<process>.log
  std::filesystem::path Log(const std::string& process) const { return path_ / "logs" / (process + ".log"); }
  /// Writes a file completely or not at all. Throws std::runtime_error if that fails.
  void Write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
  FolderLock lock_;
};

}  // namespace mascot
