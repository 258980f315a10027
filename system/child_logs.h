#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "system/descriptor.h"
#include "system/log_file.h"

namespace mascot {

/// Copies the output of children to their log files, byte for byte and at once; passes every line to a sink, as valid
/// UTF-8, and keeps each child's last 10 lines. A line of more than 4096 bytes is passed on in pieces, and an
/// unfinished one at the end of the output. Lines are passed on even if their log cannot be written any more (LogFile).
class ChildLogs {
 public:
  /// Called for each line, in the thread that copies.
  using LineSink = std::function<void(const std::string& process, const std::string& line)>;

  /// `on_loss` is called in the same thread, when a log cannot be written any more.
  ChildLogs(LineSink on_line, LogFile::Tell on_loss);
  ~ChildLogs();  ///< copies what is left in the pipes; call it after the children have ended
  ChildLogs(const ChildLogs&) = delete;
  ChildLogs& operator=(const ChildLogs&) = delete;

  /// Creates a pipe, whose output goes to the file `log`. Returns the end to write to. Throws std::runtime_error if the
  /// pipe or the file cannot be created.
  Descriptor Open(const std::string& process, const std::filesystem::path& log);
  /// The last lines that `process` printed. Waits up to 2 s for the end of its output, so that the lines in the pipe of
  /// a dead child are included.
  std::vector<std::string> LastLines(const std::string& process);

 private:
  struct Stream;
  void Copy();
  void Read(Stream& stream);
  void Close(Stream& stream);
  void TakeLine(Stream& stream, const std::string& bytes);

  const LineSink on_line_;
  const LogFile::Tell on_loss_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Stream>> streams_;
  Pipe wake_ = MakePipe();
  bool closing_ = false;
  std::thread thread_;  // last: it uses the members above
};

}  // namespace mascot
