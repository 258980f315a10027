#pragma once

#include <cstdint>
#include <mutex>
#include <string>

namespace mascot {

/// What a person sees of a run, on stderr: one progress line that is rewritten in place on a terminal (a
/// line every 10 % otherwise), and lines of logs above it. Thread-safe.
class Console {
 public:
  /// `quiet`: errors only.
  explicit Console(bool quiet);
  ~Console() { EndProgress(); }

  /// An ordinary line.
  void Line(const std::string& text);
  /// A line of a child's log, with its name in front.
  void ChildLine(const std::string& process, const std::string& text);
  /// `fraction` of the run is done; `text` says more. Cheap to call often.
  void Progress(double fraction, const std::string& text);
  /// Leaves the progress line as it stands, and the cursor on the next.
  void EndProgress();

 private:
  void Print(const std::string& line);
  void EraseProgress();

  std::mutex mutex_;
  const bool quiet_;
  const bool terminal_;
  const bool colour_;
  std::string progress_;  // on the screen now
  int tenths_ = -1;       // last printed when there is no terminal
};

}  // namespace mascot
