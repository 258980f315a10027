#pragma once

#include <string_view>

namespace mascot {

/// Writes all of `bytes`. Returns false on failure, with errno set. May be called by a signal handler.
[[nodiscard]] bool WriteAll(int descriptor, std::string_view bytes);

/// A small file that a process leaves at its end, maybe from a signal handler: it calls only what may be called there.
/// Made only if nothing has its name; no link is followed. What cannot be written whole is removed: nobody is there any
/// more to be told.
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
