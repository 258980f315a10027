#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "system/local_socket.h"

namespace mascot {

/// Passes lines to and fro over a local socket. Every call returns by its deadline, however slowly, and in however
/// small pieces, the other side reads or writes.
class LocalLines {
 public:
  using Time = std::chrono::steady_clock::time_point;
  enum class End { kLine, kGone, kLate };

  /// `socket`: with SOCK_NONBLOCK, connected.
  explicit LocalLines(Descriptor socket) : socket_(std::move(socket)) {}

  /// Sends `line` and an end of line. Returns whether all of it is on its way.
  bool Write(std::string line, Time until) const;
  /// Reads a line, without its end, into `line`: at most kLongestLine bytes. May be called again after kLate: goes on.
  End Read(Time until, std::string& line);

  static constexpr std::size_t kLongestLine = 1 << 20;

 private:
  bool Await(short what, Time until) const;

  Descriptor socket_;
  std::string read_;  // what has come so far
};

}  // namespace mascot
