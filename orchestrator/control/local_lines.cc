#include "orchestrator/control/local_lines.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>

namespace mascot {

/// Returns whether the socket is ready for `what` before `until`.
bool LocalLines::Await(short what, Time until) const {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now()).count();
    pollfd socket{socket_.number(), what, 0};
    const int ready = ::poll(&socket, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, INT_MAX)));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

bool LocalLines::Write(std::string line, Time until) const {
  line += '\n';
  for (std::size_t sent = 0; sent < line.size();) {
    if (!Await(POLLOUT, until)) return false;
    const ssize_t count = ::send(socket_.number(), line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

LocalLines::End LocalLines::Read(Time until, std::string& line) {
  std::array<char, 4096> buffer{};
  while (read_.size() <= kLongestLine) {
    if (!Await(POLLIN, until)) return End::kLate;
    const ssize_t count = ::recv(socket_.number(), buffer.data(), buffer.size(), 0);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return End::kGone;
    const auto begin = read_.size();
    read_.append(buffer.data(), static_cast<std::size_t>(count));
    if (const auto end = read_.find('\n', begin); end != std::string::npos) {
      line = read_.substr(0, end);
      return End::kLine;
    }
  }
  return End::kGone;
}

}  // namespace mascot
