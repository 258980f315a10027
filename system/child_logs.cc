#include "system/child_logs.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "base/utf8.h"

namespace mascot {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

struct ChildLogs::Stream {
  std::string process;
  Descriptor output;
  LogFile file;
  std::string partial = {};           // what came since the last line
  std::deque<std::string> last = {};  // the last kLastLines lines
};

namespace {

constexpr std::size_t kLastLines = 10;
constexpr std::size_t kLongestLine = 4096;  // a longer one is taken for several
constexpr auto kPipeIsEmpty = 2s;           // by then, the last output of a dead child has been copied from its pipe

/// Takes the next line off the front of `text`; nothing if it is not over.
std::optional<std::string> NextLine(std::string& text) {
  const auto end = text.find('\n');
  if (end == std::string::npos && text.size() <= kLongestLine) return std::nullopt;
  const bool is_long = end > kLongestLine;
  std::string line(is_long ? CutUtf8(text, kLongestLine) : std::string_view(text).substr(0, end));
  text.erase(0, line.size() + (is_long ? 0 : 1));
  return line;
}

}  // namespace

ChildLogs::ChildLogs(LineSink on_line, LogFile::Tell on_loss)
    : on_line_(std::move(on_line)), on_loss_(std::move(on_loss)) {
  thread_ = std::thread([this] { Copy(); });
}

ChildLogs::~ChildLogs() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  if (write(wake_.writes.number(), "", 1) < 0) std::perror("pipe");
  thread_.join();
}

Descriptor ChildLogs::Open(const std::string& process, const std::filesystem::path& log) {
  LogFile file(log, on_loss_);
  Pipe pipe = MakePipe();
  fcntl(pipe.reads.number(), F_SETFL, O_NONBLOCK);
  auto stream = std::make_unique<Stream>(Stream{process, std::move(pipe.reads), std::move(file)});
  {
    const std::lock_guard lock(mutex_);
    streams_.push_back(std::move(stream));
  }
  if (write(wake_.writes.number(), "", 1) < 0) throw std::runtime_error("cannot wake the thread that copies logs");
  return std::move(pipe.writes);
}

void ChildLogs::Copy() {
  for (bool closing = false;;) {
    std::vector<pollfd> polled{{wake_.reads.number(), POLLIN, 0}};
    {
      const std::lock_guard lock(mutex_);
      for (const auto& stream : streams_) polled.push_back({stream->output.number(), POLLIN, 0});
      closing = closing_;
    }
    // At closing the children have ended, but processes that they started may hold the pipes open for ever: do not
    // wait.
    if (poll(polled.data(), polled.size(), closing ? 0 : -1) == 0) break;
    char buffer[256];
    if (polled[0].revents != 0 && read(wake_.reads.number(), buffer, sizeof buffer) < 0) break;
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 1; i < polled.size(); ++i)
      if (polled[i].revents != 0) Read(*streams_[i - 1]);
  }
  const std::lock_guard lock(mutex_);
  for (const auto& stream : streams_) Close(*stream);
}

void ChildLogs::Close(Stream& stream) {
  if (!stream.partial.empty()) {
    stream.file.Write("\n");
    TakeLine(stream, std::exchange(stream.partial, {}));
  }
  stream.output = Descriptor();
}

void ChildLogs::Read(Stream& stream) {
  char buffer[4096];
  const ssize_t size = read(stream.output.number(), buffer, sizeof buffer);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) return Close(stream);
  const std::string_view text(buffer, static_cast<std::size_t>(size));
  stream.file.Write(text);
  stream.partial += text;
  while (const auto line = NextLine(stream.partial)) TakeLine(stream, *line);
}

void ChildLogs::TakeLine(Stream& stream, const std::string& bytes) {
  const std::string line = Plain(bytes);
  stream.last.push_back(line);
  if (stream.last.size() > kLastLines) stream.last.pop_front();
  on_line_(stream.process, line);
}

std::vector<std::string> ChildLogs::LastLines(const std::string& process) {
  for (const auto deadline = WallClock::now() + kPipeIsEmpty;; poll(nullptr, 0, 1)) {
    const std::lock_guard lock(mutex_);
    for (const auto& stream : streams_)
      if (stream->process == process && (!stream->output.is_open() || WallClock::now() > deadline))
        return {stream->last.begin(), stream->last.end()};
    if (WallClock::now() > deadline) return {};
  }
}

}  // namespace mascot
