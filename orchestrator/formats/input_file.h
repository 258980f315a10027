#pragma once

#include <cstdint>
#include <string>

#include "orchestrator/formats/bytes.h"

namespace mascot {

/// Reads a regular file at any offset. Its size is that at the opening: bytes that are appended later are not read.
/// Failures throw std::runtime_error with the file's name and the system's reason.
class InputFile {
 public:
  explicit InputFile(const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::uint64_t size() const { return size_; }
  /// Reads up to `bytes` bytes from `offset` into `out`, which is resized to what was read: fewer only at the end of
  /// the file.
  void Read(std::uint64_t offset, std::uint64_t bytes, Bytes& out) const;

 private:
  std::string path_;
  int fd_;
  std::uint64_t size_ = 0;
};

}  // namespace mascot
