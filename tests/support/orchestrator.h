#pragma once

// Runs the real `orchestrator` for end-to-end tests.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/folders.h"
#include "tests/support/scratch.h"
#include "tests/support/waits.h"

extern char** environ;

namespace mascot::test {

inline std::string Config(const std::string& name) { return SourceFolder() + "/configs/" + name + ".toml"; }

/// Sends a signal to a process; the test fails if there is none. A number of 0 (no such child) or -1 (not started) is
/// never passed on: kill(2) takes them for our process group, and for every process.
inline void SignalTo(pid_t process, int signal) {
  ASSERT_GT(process, 0) << "there is no such process";
  kill(process, signal);
}

/// Starts a program; the destructor ends it (SIGTERM) if it still runs.
class Running {
 public:
  Running(const std::string& program, std::vector<std::string> arguments, const std::filesystem::path& output)
      : out_(output.string() + ".out"), err_(output.string() + ".err"), command_(program) {
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (std::string& argument : arguments) {
      argv.push_back(argument.data());
      command_ += " " + argument;
    }
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, 1, out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_addopen(&files, 2, err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (posix_spawnp(&pid_, program.c_str(), &files, nullptr, argv.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&files);
  }
  ~Running() {
    if (pid_ <= 0) return;
    Signal(SIGTERM);  // in order: who is killed leaves its shared memory
    Signal(SIGCONT);  // a test may have stopped it
    Wait();
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  pid_t pid() const { return pid_; }
  void Signal(int signal) const { SignalTo(pid_, signal); }
  /// Waits for the end. Returns the exit code, or -signal if a signal ended the program. The test fails if the program
  /// goes on for longer than `patience`, and kills it.
  int Wait(std::chrono::milliseconds patience = kPatienceForRuns) {
    if (pid_ <= 0) return kNotStarted;
    const int status = AwaitEndOf(std::exchange(pid_, -1), "the end of: " + command_, patience);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  /// Whether the program has ended; Wait() then returns at once.
  bool IsOver() const {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == pid_;
  }
  std::string out() const { return ReadFile(out_); }
  std::string err() const { return ReadFile(err_); }
  bool Said(const std::string& text) const { return err().find(text) != std::string::npos; }

 private:
  static constexpr int kNotStarted = 127;  // what a shell says of a program that it has not found

  std::string out_, err_, command_;
  pid_t pid_ = -1;
};

/// Waits until a program has printed a whole line with `words` to stderr. Returns what follows them in it; nothing if
/// there is no such line, and the test fails.
inline std::string RestOfLine(const Running& program, const std::string& words) {
  std::string err;
  std::size_t at = 0, end = 0;
  Until([&] {
    const bool was_over = program.IsOver();
    err = program.err();
    at = err.find(words);
    end = err.find('\n', at);
    return end != std::string::npos || was_over;
  });
  if (end != std::string::npos) return err.substr(at + words.size(), end - at - words.size());
  ADD_FAILURE() << "no line with '" << words << "' in: " << err;
  return "";
}

/// Starts `orchestrator up` for one configuration, with results in folder/name, without plots.
class Up : public Running {
 public:
  Up(const ScratchFolder& folder, const std::string& name, const std::string& config,
     std::vector<std::string> more = {})
      : Running(BuildFolder() + "/orchestrator", Words(folder, name, config, std::move(more)), folder.File(name)),
        path_(folder.File(name)) {}

  const std::filesystem::path& path() const { return path_; }
  std::string File(const std::string& name) const { return ReadFile(path_ / name); }
  nlohmann::json Summary() const { return nlohmann::json::parse(File("summary.json")); }
  /// What `orchestrator info` prints of the recording.
  std::string Info() const {
    return Shell("'" + BuildFolder() + "/orchestrator' info '" + path_.string() + "'").output;
  }
  /// Process id of a child; 0 before it has been spawned.
  pid_t Child(const std::string& process) const;

 private:
  static std::vector<std::string> Words(const ScratchFolder& folder, const std::string& name, const std::string& config,
                                        std::vector<std::string> more) {
    std::vector<std::string> words{"up", config, "--out", folder.File(name), "--set", "output.save_plot=false"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  std::filesystem::path path_;
};

/// Process id of the child of `parent` whose command line contains `words`, or 0.
inline pid_t ChildOf(pid_t parent, const std::string& words) {
  const std::string pid = std::to_string(parent);
  std::ifstream children("/proc/" + pid + "/task/" + pid + "/children");
  for (pid_t child; children >> child;) {
    std::string command;
    std::getline(std::ifstream("/proc/" + std::to_string(child) + "/cmdline"), command);  // nothing, if it has ended
    for (char& c : command)
      if (c == '\0') c = ' ';
    if (command.find(words) != std::string::npos) return child;
  }
  return 0;
}

inline pid_t Up::Child(const std::string& process) const {
  if (process == "physics_server") return ChildOf(pid(), "/physics_server ");
  return ChildOf(pid(), "--id " + process.substr(std::string("agent_").size()) + " ");
}

/// Waits until the ticks of a run have begun: then `up` prints its first progress line.
inline bool Flies(const Running& up) {
  return Until([&] { return up.Said("x real time"); });
}

/// How often `words` stand in `text`.
inline std::size_t CountOf(const std::string& words, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; ++at) ++count;
  return count;
}

}  // namespace mascot::test
