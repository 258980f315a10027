#pragma once

#include <sys/types.h>

#include <filesystem>

#include "system/descriptor.h"

namespace mascot {

/// A lock on a folder, which leaves no file. This object holds it until its end, or that of the process; processes that
/// we start do not get it. On a network file system it counts on this machine alone.
class FolderLock {
 public:
  /// Takes the lock, or finds that another FolderLock has it. Throws std::filesystem::filesystem_error if `folder` is
  /// none, or its file system knows no locks.
  explicit FolderLock(const std::filesystem::path& folder);

  bool is_ours() const { return is_ours_; }
  /// Id of the process that has the lock, when this is asked; 0: none, or it is unknown here.
  pid_t Holder() const;

 private:
  Descriptor folder_;
  bool is_ours_ = false;
};

}  // namespace mascot
