#include "agent/user_code/last_words.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <utility>

namespace mascot {
namespace {

std::atomic<const LastWords*> living = nullptr;

void WriteAll(int file, const char* text, std::size_t size) {
  while (size > 0) {
    const ssize_t put = write(file, text, size);
    if (put <= 0) return;
    text += put;
    size -= static_cast<std::size_t>(put);
  }
}

/// A reason, as it may stand within a text of JSON.
void WriteReason(int file, const char* text) {
  for (; *text != 0; ++text) {
    const bool is_plain = *text >= ' ' && *text <= '~' && *text != '\\';
    const char byte = *text == '"' ? '\'' : is_plain ? *text : '?';
    WriteAll(file, &byte, 1);
  }
}

/// Called by exit(), which our own code does not call while there are words to leave.
void OnExit(int status, void* /*nothing*/) {
  if (living == nullptr) return;
  const char* const reason = "a law, or what it has called, has ended the process by exit()";
  for (const char* piece : {"error: ", reason, "\n"}) WriteAll(STDERR_FILENO, piece, std::strlen(piece));
  const int code = status != 0 ? status : 1;
  LastWords::Leave(&reason, 1, code);
  _exit(code);
}

std::terminate_handler before_terminate = nullptr;

[[noreturn]] void OnTerminate() {
  const char* const reason =
      "an exception that nobody has caught, in a thread of a law or of ours, has ended the process";
  LastWords::Leave(&reason, 1, 1);
  before_terminate();
  std::abort();
}

}  // namespace

LastWords::LastWords(std::string path, std::string_view text) : path_(std::move(path)) {
  static const int registered = on_exit(OnExit, nullptr);
  (void)registered;
  const std::string code = std::to_string(kExitCode);
  while (true) {
    const std::size_t reason = text.find(kReason), exit = text.find(code), end = std::min({reason, exit, text.size()});
    parts_.emplace_back(text.substr(0, end));
    behind_.push_back(end == text.size() ? '\0' : end == reason ? 'r' : 'e');
    if (end == text.size()) break;
    text.remove_prefix(end + (end == reason ? kReason.size() : code.size()));
  }
  before_terminate = std::set_terminate(OnTerminate);
  living = this;
}

LastWords::~LastWords() {
  living = nullptr;
  std::set_terminate(before_terminate);
}

void LastWords::Leave(const char* const* reason, std::size_t pieces, int exit_code) {
  const LastWords* const words = living.exchange(nullptr);
  if (words != nullptr) words->Write(reason, pieces, exit_code);
}

void LastWords::Write(const char* const* reason, std::size_t pieces, int exit_code) const {
  const int file = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file < 0) return;
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    WriteAll(file, parts_[part].data(), parts_[part].size());
    if (behind_[part] == 'r')
      for (std::size_t piece = 0; piece < pieces; ++piece) WriteReason(file, reason[piece]);
    if (behind_[part] != 'e') continue;
    std::array<char, 16> digits{};
    const char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), exit_code).ptr;
    WriteAll(file, digits.data(), static_cast<std::size_t>(end - digits.data()));
  }
  close(file);
}

}  // namespace mascot
