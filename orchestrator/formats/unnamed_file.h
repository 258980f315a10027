#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "orchestrator/formats/part_file.h"

namespace mascot {

/// A file that is written anywhere, and gets its name when it is complete. Until then it has none, so that nothing is
/// left of it, however the process ends. On a file system without such files its name is `path`.part, which a process
/// that is killed leaves. Failures throw std::runtime_error with this name and the system's reason.
class UnnamedFile {
 public:
  /// kNever: as on a file system without them.
  enum class WithoutName { kIfPossible, kNever };
  explicit UnnamedFile(const std::string& path, WithoutName without_name = WithoutName::kIfPossible);
  ~UnnamedFile();
  UnnamedFile(const UnnamedFile&) = delete;
  UnnamedFile& operator=(const UnnamedFile&) = delete;

  void WriteAt(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  /// Makes the file longer or shorter. What is added are zeros, without room on disk where the file system can do so.
  void Resize(std::uint64_t size);
  /// False, with errno, if the system refuses it.
  bool TryResize(std::uint64_t size);
  /// Moves `size` bytes from `from` to `to`. The two may overlap.
  void Move(std::uint64_t from, std::uint64_t to, std::uint64_t size);
  /// Ends the file after `size` bytes, flushes it to disk and gives it its name, in place of any earlier file.
  void Commit(std::uint64_t size);

 private:
  [[noreturn]] void Fail(const char* what) const;

  PartFile part_;
  int fd_ = -1;
  bool has_name_ = false;
};

}  // namespace mascot
