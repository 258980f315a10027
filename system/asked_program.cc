#include "system/asked_program.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "system/left_file.h"
#include "system/spawn.h"

namespace mascot {
namespace {

/// A file in memory, which holds `text`, and is read from its beginning.
Descriptor FileWith(std::string_view text) {
  Descriptor file(::memfd_create("mascot", MFD_CLOEXEC));
  if (!file.is_open() || !WriteAll(file.number(), text) || ::lseek(file.number(), 0, SEEK_SET) != 0)
    throw std::system_error(errno, std::generic_category(), "cannot make a file in memory");
  return file;
}

}  // namespace

AskedProgram::AskedProgram(std::vector<std::string> words, std::string_view question) : answer_(FileWith("")) {
  const Descriptor input = FileWith(question);
  words.push_back(std::to_string(answer_.number()));
  process_ = Spawn({.words = std::move(words),
                    .input = input.number(),
                    .output = Program::kNowhere,
                    .errors = Program::kNowhere,
                    .shared = {answer_.number()}});
}

AskedProgram::Answer AskedProgram::Wait() {
  const int status = process_.Reap().value_or(kUnknownEnd);
  if (::lseek(answer_.number(), 0, SEEK_SET) != 0) throw std::system_error(errno, std::generic_category(), "lseek");
  return {.text = ReadToEnd(answer_.number()), .end = status == 0 ? "" : EndText(status)};
}

}  // namespace mascot
