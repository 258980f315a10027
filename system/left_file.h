#pragma once

#include <string_view>

namespace mascot {

/// Writes all of `bytes`. Returns false on failure, with errno set. May be called by a signal handler.
[[nodiscard]] bool WriteAll(int descriptor, std::string_view bytes);

/// A small file that a process leaves behind at its end. Signal handlers may use this class. The file is made only if
/// nothing has its name; a link in its place is not followed. A file that cannot be written whole is removed, because
/// the process can report it no more.
class LeftFile {
 public:
  explicit LeftFile(const char* path);
  ~LeftFile();
  LeftFile(const LeftFile&) = delete;
  LeftFile& operator=(const LeftFile&) = delete;

  void Write(std::string_view bytes);

 private:
  const char* const path_;
  int file_;
  bool is_whole_ = true;
};

}  // namespace mascot
