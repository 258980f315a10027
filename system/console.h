#pragma once

#include <cstdint>
#include <mutex>
#include <string>

namespace mascot {

/// Prints the progress of a run on stderr, fit for a terminal (Plain()) but for colours of its own: log lines, and
/// below them one progress line that is rewritten in place on a terminal (elsewhere, a line every 10 %). Thread-safe.
class Console {
 public:
  /// `quiet`: print nothing but warnings.
  explicit Console(bool quiet);
  ~Console() { EndProgress(); }

  /// Whether somebody sees lines on a terminal.
  bool is_on_terminal() const { return terminal_ && !quiet_; }
  /// Prints a line.
  void Line(const std::string& text);
  /// Prints a line also if the console is quiet: something is lost.
  void Warning(const std::string& text);
  /// Prints a line of a child's output, with the child's name in front.
  void ChildLine(const std::string& process, const std::string& text);
  /// Shows `text` as the progress line; `fraction` (0 to 1) of the run is done. Without a terminal, prints only when
  /// another 10 % are done.
  void Progress(double fraction, const std::string& text);
  /// Ends the progress line and moves to the next line.
  void EndProgress();

 private:
  void Print(const std::string& line);
  void EraseProgress();

  std::mutex mutex_;
  const bool quiet_;
  const bool terminal_;
  const bool colour_;
  std::string progress_;  // whole text of the progress line on the terminal, which shows as much of it as fits
  int tenths_ = -1;       // without a terminal: tenths of the run done at the last line
};

}  // namespace mascot
