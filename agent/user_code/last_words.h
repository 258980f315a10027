#pragma once

#include <atomic>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// A file that this process leaves if it ends by force, as a law of a user can make it: by a signal such as SIGSEGV,
/// because the law cannot be interrupted, because nobody has caught an exception, or because code in C has called
/// exit(). At most one object of this class lives at a time. It does nothing if the process ends by itself, later, or
/// by SIGKILL, which nothing can see.
class LastWords {
 public:
  /// In the text of the file, what the reason and the exit code stand in place of: letters that JSON writes as they
  /// are.
  static constexpr std::string_view kReason = "LAST_WORDS_REASON";
  static constexpr int kExitCode = -987654321;

  /// `text`: the file but for reason and exit code. `path`: absolute, since a law may change the current folder.
  LastWords(std::string path, std::string_view text);
  ~LastWords();
  LastWords(const LastWords&) = delete;
  LastWords& operator=(const LastWords&) = delete;

  /// Writes the file of the object that lives, if one does. `reason`: pieces of a text, in which what is no printable
  /// ASCII is replaced, and quotes too. Calls only what a signal handler may call. The file is not written twice, nor
  /// over another.
  static void Leave(const char* const* reason, std::size_t pieces, int exit_code);

 private:
  void Write(const char* const* reason, std::size_t pieces, int exit_code) const;

  const std::string path_;
  std::vector<std::string> parts_;  // of the file: with a reason, an exit code, or nothing behind
  std::vector<char> behind_;        // each: 'r', 'e', or 0
};

}  // namespace mascot
