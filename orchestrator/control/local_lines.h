#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "system/local_socket.h"

namespace mascot {

/// Sends and receives lines over a local socket. Every call returns by its deadline, however slowly, and in however
/// small pieces, the other process reads or writes.
class LocalLines {
 public:
  using Time = std::chrono::steady_clock::time_point;
  enum class End { kLine, kGone, kLate };

  /// `socket` must be connected, and made with SOCK_NONBLOCK.
  explicit LocalLines(Descriptor socket) : socket_(std::move(socket)) {}

  /// Sends `line` and an end of line. Returns whether the kernel took all of it before `until`.
  bool Write(std::string line, Time until) const;
  /// Reads a line, without its end, into `line`. kGone: the connection is closed, or the line is longer than
  /// kLongestLine bytes. kLate: `until` has passed; the next call goes on with the same line.
  End Read(Time until, std::string& line);

  static constexpr std::size_t kLongestLine = 1 << 20;

 private:
  bool Await(short what, Time until) const;

  Descriptor socket_;
  std::string read_;  // what has come so far
};

}  // namespace mascot
