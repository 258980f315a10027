// What Python code may not do to the process that it shares with the rest of a run.
#include "agent/python/internal.h"
#include "agent/user_code/law_at_work.h"

namespace mascot {
namespace {

// Runs in a namespace of its own, with `is_forked` and `mark_as_forked`. Laws and what they import find the guarded
// functions in os and signal, as everybody does. Those of signal raise what they do in any thread but the main one: a
// law runs in that in some engines, and not in others. subprocess uses fork(2): then children die with the law.
constexpr const char* kGuard = R"python(
import functools, os, posix, resource, signal, subprocess


def guard(names, modules, error, is_refused=lambda *arguments, **options: True):
    """Lets the functions of these names raise `error` when they are called with refused arguments."""
    for name in names:
        original = getattr(modules[0], name, None)
        if original is None:
            continue

        def guarded(*arguments, original=original, name=name, **options):
            if not is_forked() and is_refused(*arguments, **options):
                raise error(f"{modules[0].__name__}.{name}: refused, because the process is not the law's alone")
            return original(*arguments, **options)

        for module in modules:
            setattr(module, name, functools.wraps(original)(guarded))


def descends_from_us(pid):
    """Whether the law has started this process; one that is not there may be signalled: that says so."""
    us = os.getpid()
    while pid > 1 and pid != us:
        try:
            with open(f"/proc/{pid}/stat", "rb") as stat:
                pid = int(stat.read().rpartition(b")")[2].split()[1])
        except OSError:
            return True
    return pid == us


def is_not_a_child(pid, number):
    return number != 0 and (pid <= 1 or pid == os.getpid() or not descends_from_us(pid))


def is_not_a_group(group, number):
    return number != 0 and (group <= 1 or group == os.getpgrp())


SYSTEM = os, posix
guard(["_exit", "abort", "execv", "execve", "setsid", "setpgrp", "closerange"], SYSTEM, RuntimeError)
guard(["chdir", "fchdir", "chroot", "setuid", "seteuid", "setreuid", "setresuid", "setgid", "setegid", "setregid", "setresgid",
       "setgroups", "initgroups", "umask"], SYSTEM, RuntimeError)
guard(["setrlimit"], (resource,), RuntimeError)
guard(["prlimit"], (resource,), RuntimeError, lambda pid, which, limits=None: limits is not None)
guard(["kill"], SYSTEM, RuntimeError, is_not_a_child)
guard(["killpg"], SYSTEM, RuntimeError, is_not_a_group)
guard(["setpgid"], SYSTEM, RuntimeError, lambda pid, group: pid in (0, os.getpid()))
guard(["close"], SYSTEM, RuntimeError, lambda fd: isinstance(fd, int) and fd <= 2)
guard(["dup2"], SYSTEM, RuntimeError, lambda fd, fd2, inheritable=True: isinstance(fd2, int) and fd2 <= 2)
guard(["signal", "raise_signal", "alarm", "setitimer", "siginterrupt", "set_wakeup_fd", "pthread_sigmask", "pthread_kill"],
      (signal,), ValueError)
os.register_at_fork(after_in_child=mark_as_forked)
subprocess._USE_VFORK = subprocess._USE_POSIX_SPAWN = False
)python";

}  // namespace

void GuardProcess() {
  py::dict space;
  space["mark_as_forked"] = py::cpp_function(&MarkAsForkedByLaw);
  space["is_forked"] = py::cpp_function([] { return IsForkedByLaw(); });
  space["__builtins__"] = py::module_::import("builtins");
  py::exec(kGuard, space, space);
}

}  // namespace mascot
