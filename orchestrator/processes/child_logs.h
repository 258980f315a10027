#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace mascot {

/// Copies what children print to their log files, hands every line to a sink, and keeps each child's last lines.
class ChildLogs {
 public:
  /// Called for each whole line, in the thread that copies.
  using LineSink = std::function<void(const std::string& process, const std::string& line)>;

  explicit ChildLogs(LineSink on_line);
  ~ChildLogs();  ///< when what is in the pipes is copied; for after the children have gone
  ChildLogs(const ChildLogs&) = delete;
  ChildLogs& operator=(const ChildLogs&) = delete;

  /// A pipe whose reading end this copies to the file `log`; returns the end to write to, which the caller closes.
  /// Throws std::runtime_error if the file cannot be written.
  int Open(const std::string& process, const std::filesystem::path& log);
  /// The last lines that `process` printed. Waits, briefly, for those still in the pipe of a dead child.
  std::vector<std::string> LastLines(const std::string& process);

 private:
  struct Stream;
  void Copy();
  void Read(Stream& stream);
  void Close(Stream& stream);
  void TakeLine(Stream& stream, const std::string& line);

  const LineSink on_line_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Stream>> streams_;
  int wake_[2];
  bool closing_ = false;
  std::thread thread_;  // last
};

}  // namespace mascot
