#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

namespace mascot {

/// Reads lines of a pipe without ever waiting for one. Does not own the descriptor, which becomes non-blocking.
class LineReader {
 public:
  explicit LineReader(int descriptor);
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;

  /// The next line, without its line break; nothing if none is complete. Throws std::runtime_error for a line longer
  /// than 4 MiB.
  std::optional<std::string> Next();
  /// Whether there will be no more lines.
  bool ended() const { return ended_; }

 private:
  int descriptor_;
  std::string text_;
  std::size_t taken_ = 0;  // bytes of text_ that Next() has given
  bool ended_ = false;
};

/// Writes lines into a pipe from a thread of its own, so that the caller never waits for the process that reads. Does
/// not own the descriptor, which becomes non-blocking.
class LineWriter {
 public:
  /// `last_words`: how long the destructor waits for a reader that takes nothing; on a busy machine it may take nothing
  /// for seconds.
  explicit LineWriter(int descriptor, std::chrono::milliseconds last_words = std::chrono::seconds(5));
  ~LineWriter();  ///< writes what is left, as long as the reader takes some of it within `last_words`
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;

  /// Appends a line; if the reader has closed the pipe, the line is lost.
  void Write(const std::string& line);
  /// How many bytes are not written yet.
  std::size_t waiting() const;
  /// Whether the reader has closed the pipe.
  bool broken() const;

 private:
  void Run();
  std::optional<std::size_t> WriteSome(std::string_view bytes) const;

  int descriptor_;
  std::chrono::milliseconds last_words_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::string lines_;  // lines that the thread has not taken yet
  std::size_t waiting_ = 0;
  std::optional<std::chrono::steady_clock::time_point> until_;  // set by the destructor: when to give up
  bool broken_ = false;
  std::thread thread_;  // last: it uses the members above
};

}  // namespace mascot
