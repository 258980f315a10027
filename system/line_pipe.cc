#include "system/line_pipe.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>

namespace mascot {
namespace {

constexpr std::size_t kLongest = 4U << 20U;
constexpr std::size_t kAtOnce = 64U << 10U;  // what a pipe takes: many lines at once cost little more than one

void DoNotBlock(int descriptor) { fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) | O_NONBLOCK); }

}  // namespace

LineReader::LineReader(int descriptor) : descriptor_(descriptor) { DoNotBlock(descriptor); }

std::optional<std::string> LineReader::Next() {
  std::size_t end = text_.find('\n', taken_);
  std::array<char, kAtOnce> buffer;
  while (end == text_.npos && !ended_) {
    const ssize_t got = read(descriptor_, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno == EAGAIN) return std::nullopt;
    ended_ = got <= 0;
    text_.erase(0, std::exchange(taken_, 0));
    const std::size_t seen = text_.size();
    if (got > 0) text_.append(buffer.data(), static_cast<std::size_t>(got));
    end = text_.find('\n', seen);
    if (end == text_.npos && text_.size() > kLongest) throw std::runtime_error("a line of a pipe is too long");
  }
  if (end == text_.npos) return std::nullopt;
  const std::size_t begin = std::exchange(taken_, end + 1);
  return text_.substr(begin, end - begin);
}

LineWriter::LineWriter(int descriptor, std::chrono::milliseconds last_words)
    : descriptor_(descriptor), last_words_(last_words) {
  DoNotBlock(descriptor);
  thread_ = std::thread([this] { Run(); });
}

LineWriter::~LineWriter() {
  {
    const std::lock_guard lock(mutex_);
    until_ = std::chrono::steady_clock::now() + last_words_;
  }
  changed_.notify_one();
  thread_.join();
}

void LineWriter::Write(const std::string& line) {
  {
    const std::lock_guard lock(mutex_);
    if (broken_) return;
    lines_ += line;
    lines_ += '\n';
    waiting_ += line.size() + 1;
  }
  changed_.notify_one();
}

std::size_t LineWriter::waiting() const {
  const std::lock_guard lock(mutex_);
  return waiting_;
}

bool LineWriter::broken() const {
  const std::lock_guard lock(mutex_);
  return broken_;
}

/// Writes as much of `bytes` as the pipe takes now, after a short wait for room. Returns how much that was; nothing if
/// the reader has gone.
std::optional<std::size_t> LineWriter::WriteSome(std::string_view bytes) const {
  pollfd room{descriptor_, POLLOUT, 0};
  constexpr int kMoment_ms = 50;
  if (poll(&room, 1, kMoment_ms) == 0) return 0;
  const ssize_t put = write(descriptor_, bytes.data(), bytes.size());
  if (put >= 0) return static_cast<std::size_t>(put);
  return errno == EAGAIN || errno == EINTR ? std::optional<std::size_t>(0) : std::nullopt;
}

void LineWriter::Run() {
  for (std::unique_lock lock(mutex_);;) {
    changed_.wait(lock, [this] { return until_ || !lines_.empty(); });
    if (lines_.empty() || broken_) return;  // the end
    const std::string lines = std::exchange(lines_, {});
    for (std::string_view rest = lines; !rest.empty() && !broken_;) {
      lock.unlock();
      const auto done = WriteSome(rest);
      lock.lock();
      rest.remove_prefix(done.value_or(0));
      waiting_ -= done.value_or(0);
      if (until_ && done.value_or(0) > 0) until_ = std::chrono::steady_clock::now() + last_words_;
      broken_ = !done || (until_ && std::chrono::steady_clock::now() > *until_);
    }
  }
}

}  // namespace mascot
