#include "system/spawn.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "system/end_now.h"

extern char** environ;

namespace mascot {
namespace {

/// What a program finds open.
class Files {
 public:
  explicit Files(const Program& program) {
    posix_spawn_file_actions_init(&actions_);
    Put(program.input, STDIN_FILENO, O_RDONLY);
    Put(program.output, STDOUT_FILENO, O_WRONLY);
    Put(program.errors, STDERR_FILENO, O_WRONLY);
    for (const int shared : program.shared) Put(shared, shared, 0);
  }
  ~Files() { posix_spawn_file_actions_destroy(&actions_); }
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;

  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  void Put(int what, int place, int access) {
    if (what >= 0)
      posix_spawn_file_actions_adddup2(&actions_, what, place);  // also if they are one: it is not closed by exec then
    else if (what == Program::kNowhere)
      posix_spawn_file_actions_addopen(&actions_, place, "/dev/null", access, 0);
  }

  posix_spawn_file_actions_t actions_{};
};

/// Its process group, and what it does with signals.
class Attributes {
 public:
  explicit Attributes(const Program& program) {
    using Group = Program::Group;
    using Signals = Program::Signals;
    posix_spawnattr_init(&attributes_);
    int flags = POSIX_SPAWN_SETSIGMASK;
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes_, program.signals == Signals::kBlocked ? &all : &none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    if (program.signals == Signals::kDefault) flags |= POSIX_SPAWN_SETSIGDEF;
    posix_spawnattr_setpgroup(&attributes_, 0);
    if (program.group == Group::kOwn) flags |= POSIX_SPAWN_SETPGROUP;
    if (program.group == Group::kOwnSession) flags |= POSIX_SPAWN_SETSID;
    posix_spawnattr_setflags(&attributes_, static_cast<short>(flags));
  }
  ~Attributes() { posix_spawnattr_destroy(&attributes_); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;

  const posix_spawnattr_t* get() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

}  // namespace

ChildProcess Spawn(const Program& program) {
  std::vector<std::string> words = program.words;
  if (!program.name.empty()) words.front() = program.name;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);  // libraries and laws open files without that
  const Files files(program);
  const Attributes attributes(program);
  const std::string& path = program.words.front();
  pid_t number = 0;
  const int error = posix_spawnp(&number, path.c_str(), files.get(), attributes.get(), argv.data(), environ);
  if (error != 0) throw std::runtime_error("cannot start " + path + ": " + std::strerror(error));
  return ChildProcess(number);
}

ChildProcess Fork(const std::function<void()>& work) {
  const pid_t parent = getpid();
  const pid_t number = fork();
  if (number < 0) throw std::system_error(errno, std::generic_category(), "cannot start a process");
  if (number > 0) return ChildProcess(number);
  setpgid(0, 0);
  if (!DieWith(parent)) EndNow(1);
  work();
  EndNow(0);
}

pid_t SplitProcess() {
  const pid_t number = fork();
  if (number < 0) throw std::system_error(errno, std::generic_category(), "cannot start a process");
  return number;
}

bool DieWith(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  return getppid() == parent;
}

}  // namespace mascot
