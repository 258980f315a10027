#pragma once

#include <atomic>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// A file that this process leaves if it ends by force, as a user's law can cause it: by a signal such as SIGSEGV,
/// because the law cannot be interrupted, because an exception was not caught, or because code in C has called exit().
/// At most one object of this class lives at a time. It does nothing if the process ends by itself, later, or by
/// SIGKILL, which no process can see coming.
class LastWords {
 public:
  /// The placeholders in the text of the file for the reason and the exit code: characters that JSON writes as they
  /// are.
  static constexpr std::string_view kReason = "LAST_WORDS_REASON";
  static constexpr int kExitCode = -987654321;

  /// `text` is the contents of the file, with these placeholders. `path` is absolute, since a law may change the
  /// current folder.
  LastWords(std::string path, std::string_view text);
  ~LastWords();
  LastWords(const LastWords&) = delete;
  LastWords& operator=(const LastWords&) = delete;

  /// Writes the file of the object that lives, if one does. `reason` has the pieces of a text, in which characters that
  /// are not printable ASCII are replaced, and quotes too. Calls only functions that a signal handler may call. The
  /// file is not written twice, and never replaces another.
  static void Leave(const char* const* reason, std::size_t pieces, int exit_code);
  /// Whether an object lives whose file has not been written: the process is not to end now.
  static bool Await();

 private:
  void Write(const char* const* reason, std::size_t pieces, int exit_code) const;

  const std::string path_;
  std::vector<std::string> parts_;  // of the file: with a reason, an exit code, or nothing behind
  std::vector<char> behind_;        // each: 'r', 'e', or 0
};

}  // namespace mascot
