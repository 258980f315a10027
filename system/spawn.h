#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

#include "system/child_process.h"

namespace mascot {

/// Another program, and how it is started. It gets our environment.
struct Program {
  enum class Group {
    kOurs,        ///< Ctrl-C reaches it as it reaches us
    kOwn,         ///< Ctrl-C does not reach it
    kOwnSession,  ///< nor does the end of our terminal
  };
  enum class Signals {
    kUnblocked,  ///< none is blocked; it ignores those that we ignore
    kDefault,    ///< none is blocked or ignored
    kBlocked,    ///< all are blocked, but for SIGKILL and SIGSTOP
  };
  static constexpr int kOursToo = -1, kNowhere = -2;

  std::vector<std::string> words;  ///< the program, a path or a name in PATH, and its arguments
  std::string name = {};           ///< what it is called in its first argument; empty: as in `words`
  Group group = Group::kOurs;
  Signals signals = Signals::kUnblocked;
  int input = kOursToo, output = kOursToo, errors = kOursToo;  ///< a descriptor, kOursToo, or kNowhere: /dev/null
  std::vector<int> shared = {};  ///< further descriptors that it gets, under the same numbers; it gets no others
};

/// Starts a program. Throws std::runtime_error if it cannot be started: "cannot start PROGRAM: No such file or
/// directory".
ChildProcess Spawn(const Program& program);

/// Starts a copy of this process, in a process group of its own, which runs `work` and ends with exit code 0, or is
/// killed when the thread that called this has ended. To be called before there are other threads: fork() does not copy
/// them. Throws std::system_error.
ChildProcess Fork(const std::function<void()>& work);

/// Starts a copy of this process, which goes on here with the return value 0; in this process it is the copy's id. For
/// processes without other threads, whose copies nobody need own (system/nursery.h). Throws std::system_error.
pid_t SplitProcess();

/// From now on the kernel kills this process when the thread that started it ends. Returns whether `parent` still is
/// its parent; if not, `parent` had ended before.
[[nodiscard]] bool DieWith(pid_t parent);

}  // namespace mascot
