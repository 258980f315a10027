#include "orchestrator/engines/dds/machine/janitor.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include "bus/process_main.h"
#include "bus/shared_memory.h"
#include "system/children.h"
#include "system/new_file.h"

extern char** environ;

namespace mascot {
namespace {

/// Starts `program` as a janitor of `domain`, with these files: stdin, null output, the lock. Signals for the run, and
/// a terminal that hangs up, do not reach it. Returns 0 or an error number.
int SpawnJanitor(pid_t* pid, std::string program, std::string domain, int input, std::span<const int> lock) {
  std::string name = "janitor", option = kSweepAfterRun;
  char* const argv[] = {name.data(), option.data(), domain.data(), nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  for (const int descriptor : lock) posix_spawn_file_actions_adddup2(&files, descriptor, descriptor);  // stays open
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t all;
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSID);
  const int error = posix_spawn(pid, program.c_str(), &files, &attributes, argv, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return error;
}

}  // namespace

Janitor::Janitor(const DomainLock& lock) { Start(lock.domain(), lock.descriptors()); }

Janitor::Janitor() { Start(kNoDomain, {}); }

void Janitor::Start(int domain, std::span<const int> lock) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("cannot make a pipe: ") + std::strerror(errno));
  lifeline_ = ends[1];
  const std::string program = ProgramFolder() / "physics_server";
  pid_t pid = 0;
  const int error = SpawnJanitor(&pid, program, std::to_string(domain), ends[0], lock);
  close(ends[0]);
  if (error == 0) {
    process_ = ChildProcess(pid);
    return;
  }
  close(lifeline_);
  throw std::runtime_error("cannot start " + program + ": " + std::strerror(error));
}

Janitor::~Janitor() {
  process_.Release();
  close(lifeline_);
}

void Janitor::LeaveWords(const std::string& path, const std::string& text) const {
  // If it has ended, nobody sweeps either, and that is all.
  static_cast<void>(WriteAll(lifeline_, path + '\0' + text));
}

void Janitor::Dismiss() {
  process_.Signal(SIGKILL);
  process_.Reap();
}

}  // namespace mascot
