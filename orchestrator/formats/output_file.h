#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace mascot {

/// Writes all of `bytes` to the open file `fd`. Returns false on failure, with errno set.
[[nodiscard]] bool WriteFully(int fd, std::span<const std::uint8_t> bytes);

/// Writes a file. Every system call is checked: failures throw std::runtime_error with the file's name and the system's
/// reason. After a failure every further write fails too, so that the file has no gaps.
class OutputFile {
 public:
  /// Makes the file anew (CreateFile).
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void Write(std::span<const std::uint8_t> bytes);
  /// Flushes the file to disk (fsync) and closes it. Throws for delayed write errors too.
  void SyncAndClose();
  /// Bytes written so far.
  std::uint64_t size() const { return size_; }
  const std::string& path() const { return path_; }

 private:
  [[noreturn]] void Fail(const std::string& what, int error);

  std::string path_;
  int fd_ = -1;
  int error_ = 0;  // errno of the first failure
  std::uint64_t size_ = 0;
};

}  // namespace mascot
