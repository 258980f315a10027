#include "system/children.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>

extern char** environ;

namespace mascot {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

namespace {

constexpr auto kLongestDeath = 10s;  // of a child that was killed: then it is given up

}  // namespace

std::filesystem::path ProgramFolder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

std::optional<int> Exit::code() const { return WIFEXITED(status) ? std::optional(WEXITSTATUS(status)) : std::nullopt; }

Children::~Children() {
  Stop(0ms);
  for (Child& child : running_) child.process.Release();  // in a call of the kernel that does not end
}

pid_t Children::Spawn(const std::string& process, const std::string& program, const std::vector<std::string>& arguments,
                      const std::filesystem::path& log, const Streams& streams) {
  const int output = logs_.Open(process, log);
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);  // logs of other children, files of the run: not for it
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  if (streams.input >= 0)
    posix_spawn_file_actions_adddup2(&files, streams.input, STDIN_FILENO);
  else
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, streams.output >= 0 ? streams.output : output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, output, STDERR_FILENO);
  for (const int shared : shared_) posix_spawn_file_actions_adddup2(&files, shared, shared);  // not closed by exec
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);

  pid_t pid = 0;
  const int error = posix_spawnp(&pid, program.c_str(), &files, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  close(output);
  if (error != 0) throw std::runtime_error("cannot start " + program + ": " + std::strerror(error));
  running_.push_back({process, ChildProcess(pid)});
  return pid;
}

std::vector<Exit> Children::Reap() {
  std::vector<Exit> exits;
  for (Child& child : running_)
    if (const auto status = child.process.ReapIfEnded()) exits.push_back({child.name, *status});
  std::erase_if(running_, [](const Child& child) { return child.process.number() == 0; });
  return exits;
}

bool Children::WaitAll(std::chrono::milliseconds grace) {
  // SIGCHLD is blocked and goes to the StopSignal of the run, which is not read here: poll instead.
  const auto deadline = WallClock::now() + grace;
  for (; Reap(), !running_.empty() && WallClock::now() < deadline;) poll(nullptr, 0, 2);
  return running_.empty();
}

void Children::Stop(std::chrono::milliseconds grace) {
  if (running_.empty()) return;
  if (grace > 0ms) {
    Signal(SIGTERM);
    if (WaitAll(grace)) return;
  }
  Kill();
}

void Children::Kill() {
  Signal(SIGKILL);
  WaitAll(kLongestDeath);
}

void Children::Signal(int signal) {
  for (const Child& child : running_) child.process.Signal(signal);
}

}  // namespace mascot
