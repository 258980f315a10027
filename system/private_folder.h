#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string_view>

#include "system/folder_lock.h"

namespace mascot {

/// A folder for files of this process, in the system's folder for temporary files. Nobody else may look into it. The
/// destructor removes it with all that is in it; if the process ends without one, SweepPrivateFolders() does. A copy of
/// the process (fork) may use the folder, and does not remove it.
class PrivateFolder {
 public:
  /// Throws std::runtime_error if it cannot be made.
  PrivateFolder();
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file that is only to be read, or executed. `name`: its path from the folder. Throws std::runtime_error.
  void Write(const std::filesystem::path& name, std::string_view bytes, bool is_executable = false) const;

 private:
  std::filesystem::path path_;
  std::optional<FolderLock> lock_;  // held as long as the folder is in use, by copies of the process too
  pid_t maker_;
};

/// Removes the private folders of this user whose processes have ended.
void SweepPrivateFolders();

}  // namespace mascot
