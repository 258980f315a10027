#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "system/descriptor.h"

namespace mascot {

/// A log, to which text is appended at once. A log that cannot be written any more, for example on a full disk, ends
/// there, without a gap, and says so once; the program goes on. Not thread-safe.
class LogFile {
 public:
  /// Called once, in the thread that writes, with the words "cannot write PATH: No space left on device: this log ends
  /// here, and what would follow is lost".
  using Tell = std::function<void(const std::string& words)>;

  /// Makes the file, or empties it. A link in its place is not followed. Throws std::runtime_error: "cannot write PATH:
  /// Too many levels of symbolic links".
  LogFile(const std::filesystem::path& path, Tell tell);

  void Write(std::string_view text);

 private:
  std::string path_;
  Descriptor file_;  // closed: the log has ended
  Tell tell_;
};

}  // namespace mascot
