#include "agent/user_code/last_words.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <exception>
#include <utility>

#include "system/left_file.h"

namespace mascot {
namespace {

std::atomic<const LastWords*> living = nullptr;

/// Writes a reason, as it may stand within a text of JSON.
void WriteReason(LeftFile& file, const char* text) {
  for (; *text != 0; ++text) {
    const bool is_plain = *text >= ' ' && *text <= '~' && *text != '\\';
    const char byte = *text == '"' ? '\'' : is_plain ? *text : '?';
    file.Write({&byte, 1});
  }
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

bool LastWords::Await() { return living != nullptr; }

void LastWords::Write(const char* const* reason, std::size_t pieces, int exit_code) const {
  LeftFile file(path_.c_str());
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    file.Write(parts_[part]);
    if (behind_[part] == 'r')
      for (std::size_t piece = 0; piece < pieces; ++piece) WriteReason(file, reason[piece]);
    if (behind_[part] != 'e') continue;
    std::array<char, 16> digits{};
    const char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), exit_code).ptr;
    file.Write({digits.data(), end});
  }
}

}  // namespace mascot
