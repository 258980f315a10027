#pragma once

#include <cstdint>
#include <string>

#include "orchestrator/formats/bytes.h"

namespace mascot {

/// A regular file, read at any place. Its size is taken once: a file that is still growing reads as cut.
/// Failures throw std::runtime_error with the file's name and the system's reason.
class InputFile {
 public:
  explicit InputFile(const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::uint64_t size() const { return size_; }
  /// Up to `bytes` from `offset`, fewer only at the end of the file, into `out`, which they fill exactly.
  void Read(std::uint64_t offset, std::uint64_t bytes, Bytes& out) const;

 private:
  std::string path_;
  int fd_;
  std::uint64_t size_ = 0;
};

}  // namespace mascot
