#include "orchestrator/processes/line_pipe.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>

namespace mascot {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLongest = 4U << 20U, kMostWaiting = 64U << 20U;
constexpr auto kLastWords = 1s;

void DoNotBlock(int descriptor) { fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) | O_NONBLOCK); }

}  // namespace

LineReader::LineReader(int descriptor) : descriptor_(descriptor) { DoNotBlock(descriptor); }

std::optional<std::string> LineReader::Next() {
  std::size_t end = text_.find('\n');
  std::array<char, 65536> buffer;
  while (end == text_.npos && !ended_) {
    const ssize_t got = read(descriptor_, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno == EAGAIN) return std::nullopt;
    ended_ = got <= 0;
    const std::size_t seen = text_.size();
    if (got > 0) text_.append(buffer.data(), static_cast<std::size_t>(got));
    end = text_.find('\n', seen);
    if (end == text_.npos && text_.size() > kLongest) throw std::runtime_error("a line of a pipe is too long");
  }
  if (end == text_.npos) return std::nullopt;
  std::string line = text_.substr(0, end);
  text_.erase(0, end + 1);
  return line;
}

LineWriter::LineWriter(int descriptor) : descriptor_(descriptor) {
  DoNotBlock(descriptor);
  thread_ = std::thread([this] { Run(); });
}

LineWriter::~LineWriter() {
  {
    const std::lock_guard lock(mutex_);
    until_ = std::chrono::steady_clock::now() + kLastWords;
  }
  changed_.notify_one();
  thread_.join();
}

void LineWriter::Write(const std::string& line) {
  {
    const std::lock_guard lock(mutex_);
    if (broken_ || waiting_ + line.size() > kMostWaiting) return;
    waiting_ += line.size() + 1;
    lines_.push_back(line + "\n");
  }
  changed_.notify_one();
}

bool LineWriter::broken() const {
  const std::lock_guard lock(mutex_);
  return broken_;
}

/// Writes as much of the rest of `bytes` as the pipe takes now, after a short wait for room. Returns whether the reader
/// is there.
bool LineWriter::WriteSome(const std::string& bytes, std::size_t& done) {
  pollfd room{descriptor_, POLLOUT, 0};
  constexpr int kMoment_ms = 50;
  if (poll(&room, 1, kMoment_ms) == 0) return true;
  const ssize_t put = write(descriptor_, bytes.data() + done, bytes.size() - done);
  if (put > 0) done += static_cast<std::size_t>(put);
  return put >= 0 || errno == EAGAIN || errno == EINTR;
}

void LineWriter::Run() {
  for (std::unique_lock lock(mutex_);;) {
    changed_.wait(lock, [this] { return until_ || !lines_.empty(); });
    if (lines_.empty()) return;  // the end
    const std::string line = std::move(lines_.front());
    lines_.pop_front();
    waiting_ -= line.size();
    for (std::size_t done = 0; done < line.size() && !broken_;) {
      lock.unlock();
      const std::size_t before = done;
      const bool there = WriteSome(line, done);
      lock.lock();
      if (until_ && done > before) until_ = std::chrono::steady_clock::now() + kLastWords;
      broken_ = !there || (until_ && std::chrono::steady_clock::now() > *until_);
    }
    if (broken_) lines_.clear();
    if (broken_ && until_) return;
  }
}

}  // namespace mascot
