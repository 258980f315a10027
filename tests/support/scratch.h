#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

extern char** environ;

namespace mascot {

/// A temporary folder for a test; the destructor removes it with its contents.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "mascot-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create " + name);
    path_ = name;
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string File(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline std::string ReadFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void WriteFile(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

struct Ran {
  int exit_code = -1;
  std::string output;  ///< stdout and stderr
};

/// Runs a command in a shell whose standard input is /dev/null. If the shell goes on for longer than `patience`, or a
/// process that it has started still has its output open by then, kills the process group and throws
/// std::runtime_error. Throws it also if the shell cannot be started.
inline Ran Shell(const std::string& command, std::chrono::milliseconds patience = std::chrono::seconds(200)) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("cannot make a pipe for " + command);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, ends[1], 1);
  posix_spawn_file_actions_adddup2(&files, ends[1], 2);
  posix_spawnattr_t group;  // of its own: to be killed as a whole
  posix_spawnattr_init(&group);
  posix_spawnattr_setflags(&group, POSIX_SPAWN_SETPGROUP);
  std::string words[] = {"sh", "-c", command};
  char* const argv[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
  pid_t shell = -1;
  const int failure = ::posix_spawn(&shell, "/bin/sh", &files, &group, argv, environ);
  posix_spawnattr_destroy(&group);
  posix_spawn_file_actions_destroy(&files);
  ::close(ends[1]);
  if (failure != 0) throw std::runtime_error("cannot run " + command);

  const int handle = static_cast<int>(::syscall(SYS_pidfd_open, shell, 0));  // readable when the shell has ended
  const auto is_late = [&](int descriptor) {
    for (;;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      pollfd input{descriptor, POLLIN, 0};
      if (left.count() <= 0) return true;
      if (::poll(&input, 1, static_cast<int>(left.count())) == 1) return false;
    }
  };
  Ran ran;
  bool late = false;
  for (ssize_t got = 1; got > 0 && !late;) {
    char piece[4096];
    late = is_late(ends[0]);
    got = late ? 0 : ::read(ends[0], piece, sizeof piece);
    if (got > 0) ran.output.append(piece, static_cast<std::size_t>(got));
  }
  ::close(ends[0]);
  late = late || is_late(handle);
  ::close(handle);
  if (late) ::kill(-shell, SIGKILL);
  int status = 0;
  ::waitpid(shell, &status, 0);
  if (late)
    throw std::runtime_error("waited " + std::to_string(patience.count()) + " ms in vain for the end of: " + command +
                             "\nuntil then it has printed:\n" + ran.output);
  ran.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return ran;
}

}  // namespace mascot
