#include "system/standard_streams.h"

#include <fcntl.h>
#include <poll.h>
#include <stdio_ext.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <system_error>
#include <utility>

#include "base/utf8.h"

namespace mascot {
namespace {

/// Passes text on to another buffer, made fit. Bytes that begin a character wait for those that end it.
class FitBuffer final : public std::streambuf {
 public:
  explicit FitBuffer(std::streambuf& sink) : sink_(sink) {}

  bool PassAsIs(std::string_view bytes) {
    const std::lock_guard lock(mutex_);
    return Put(Plain(std::exchange(begun_, {}))) && Put(bytes) && sink_.pubsync() == 0;
  }

 protected:
  int_type overflow(int_type byte) override {
    if (traits_type::eq_int_type(byte, traits_type::eof())) return traits_type::not_eof(byte);
    const char c = traits_type::to_char_type(byte);
    return xsputn(&c, 1) == 1 ? byte : traits_type::eof();
  }
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    const std::lock_guard lock(mutex_);
    begun_.append(bytes, static_cast<std::size_t>(count));
    const std::size_t whole = begun_.size() - UnfinishedUtf8(begun_);
    const bool done = Put(Plain(std::string_view(begun_).substr(0, whole)));
    begun_.erase(0, whole);
    return done ? count : 0;
  }
  int sync() override {
    const std::lock_guard lock(mutex_);
    return Put(Plain(std::exchange(begun_, {}))) ? sink_.pubsync() : -1;
  }

 private:
  bool Put(std::string_view text) {
    const auto count = static_cast<std::streamsize>(text.size());
    return sink_.sputn(text.data(), count) == count;
  }

  std::streambuf& sink_;
  std::mutex mutex_;  // several threads print
  std::string begun_;
};

FitBuffer* fit_errors = nullptr;

/// The buffer is not destroyed: std::cout and std::cerr are used until the very end.
FitBuffer* Fit(std::ostream& stream) {
  auto* fit = new FitBuffer(*stream.rdbuf());
  stream.rdbuf(fit);
  return fit;
}

bool NobodyReads(int descriptor) {
  pollfd end{descriptor, 0, 0};
  return ::poll(&end, 1, 0) > 0 && (end.revents & (POLLERR | POLLHUP)) != 0;
}

}  // namespace

void OpenStandardStreams() {
  for (int descriptor = ::open("/dev/null", O_RDWR); descriptor >= 0; descriptor = ::open("/dev/null", O_RDWR))
    if (descriptor > STDERR_FILENO) {
      ::close(descriptor);
      return;
    }
}

void FitStandardStreams() {
  static FitBuffer* const fit_output = Fit(std::cout);
  if (fit_output != nullptr && fit_errors == nullptr) fit_errors = Fit(std::cerr);
}

bool IsInputATerminal() { return isatty(STDIN_FILENO) != 0; }

void PrintToTerminal(std::string_view bytes) {
  if (fit_errors == nullptr)
    std::cerr << bytes << std::flush;
  else if (!fit_errors->PassAsIs(bytes))
    std::cerr.setstate(std::ios::badbit);
}

void FlushStandardOutput() {
  const bool failed_before = !std::cout;
  std::cout.clear();
  errno = 0;
  if (std::cout.flush() && !failed_before) return;
  const int error = errno;
  std::cout.clear();
  ::__fpurge(stdout);
  if (NobodyReads(STDOUT_FILENO)) return;
  throw std::runtime_error("cannot write to standard output" +
                           (error != 0 ? ": " + std::generic_category().message(error) : std::string()));
}

}  // namespace mascot
