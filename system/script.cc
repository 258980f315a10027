#include "system/script.h"

#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "system/children.h"
#include "system/spawn.h"

namespace mascot {
namespace fs = std::filesystem;

fs::path FindShared(const std::string& name, const std::string& folder) {
  for (const fs::path& path : {ProgramFolder() / "../share/mascot" / name, fs::path(MASCOT_SOURCE_DIR) / folder / name})
    if (fs::exists(path)) return path;
  throw std::runtime_error(name + " is missing: neither beside this program (../share/mascot) nor in its source tree");
}

std::string AsWord(const fs::path& path) {
  const std::string word = path.string();
  return word.starts_with('-') ? "./" + word : word;
}

int RunProgram(const std::vector<std::string>& words, StopSignal& stop) {
  ChildProcess process = Spawn({.words = words});
  int received = 0;
  std::optional<int> status;
  while (!(status = process.ReapIfEnded())) {
    const int signal = stop.Within(std::chrono::milliseconds(100));
    if (signal == 0) continue;
    received = signal;
    process.Signal(SIGTERM);
  }
  if (*status == kUnknownEnd) throw std::runtime_error(words[0] + " " + EndText(*status));
  if (received != 0) return 128 + received;
  return WIFEXITED(*status) ? WEXITSTATUS(*status) : 128 + WTERMSIG(*status);
}

std::vector<std::string> ScriptWords(const std::string& script) {
  // The system's Python, for which matplotlib is installed; PATH may find another one first. It reads no PYTHON*
  // variables (-E) and no packages of the user's (-s), writes no bytecode (-B), and takes names as they are (utf8).
  return {"/usr/bin/python3", "-E", "-s", "-B", "-X", "utf8", FindShared(script, "scripts")};
}

int RunScript(const std::string& script, const std::vector<std::string>& arguments, StopSignal& stop) {
  std::vector<std::string> words = ScriptWords(script);
  words.insert(words.end(), arguments.begin(), arguments.end());
  return RunProgram(words, stop);
}

}  // namespace mascot
