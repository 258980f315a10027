#pragma once

#include <string>

namespace mascot {

/// Temporary name of a file until it is complete. The file at `path` is thus always complete: other programs never see
/// half of it, and after a failure the earlier file at `path`, if any, is still there.
class PartFile {
 public:
  /// Throws std::runtime_error if `path` is the name of a folder, a device or the like.
  explicit PartFile(std::string path);
  ~PartFile();  ///< removes the unfinished file
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// `path`.part: the name to write to.
  const std::string& name() const { return part_; }
  /// Renames the finished file to `path`, replacing any earlier file. Throws std::runtime_error.
  void Commit();

 private:
  std::string path_, part_;
};

}  // namespace mascot
