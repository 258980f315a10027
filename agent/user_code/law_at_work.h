#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace mascot {

struct Experiment;

/// How much time and memory the code of a law may take, and the words for messages.
struct LawLimits {
  double limit_s = 0;       ///< wall clock; 0: no limit
  std::string_view source;  ///< the key that sets the limit of time
  int memory_mb = 0;        ///< memory of the process (control.python_memory_mb); 0: no limit
};

/// While an object of this class lives, its thread runs code of a user's law. Whatever the code does to the process,
/// the process names the law first:
/// * A signal by which the process would end silently (SIGSEGV, for example from a stack overflow, SIGABRT, SIGFPE,
/// SIGILL) is named: "error: the law of agent 3 crashed: SIGSEGV"; from then on also in other threads, which laws may
/// start.
/// * Code in C that ends the process by exit(), quick_exit() or _exit() is named; the exit code is then not 0.
/// * Long after the limit, 1.5 times and at least 1 s more, the process ends with exit code 1 and says so: the code has
/// not let itself be interrupted, or cannot be. So it does if the code takes 1.5 times the memory, and 256 MB more.
/// * A process that the code forks dies with the thread that forked it, and does not outlive the object. In each case
/// the process leaves its LastWords. Time in which the process was stopped does not count.
class LawAtWork {
 public:
  /// `who` names the law in messages, such as "the law of agent 3"; it must live as long as this object.
  LawAtWork(const std::string& who, const LawLimits& limits);
  ~LawAtWork();
  LawAtWork(const LawAtWork&) = delete;
  LawAtWork& operator=(const LawAtWork&) = delete;

 private:
  friend class LastResort;
  const std::string& who_;
  const LawLimits limits_;
  const char* const before_;            // who was at work in this thread before
  std::int64_t until_ns_ = 0;           // in time that LastResort has seen
  mutable bool took_too_much_ = false;  // memory; then its time is up because it does not let go of it
};

/// From now on, signals that end this process silently (SIGSEGV, SIGABRT, ...) are named first, whichever code crashes,
/// and the process leaves its LastWords. Handlers that other code has set, such as a sanitizer's, stay.
void ExplainCrashes();
/// The limits of the laws that users wrote, in this experiment.
LawLimits LimitsOfLaws(const Experiment& experiment);
/// The same without one of memory, which is for laws in Python and Octave.
LawLimits LimitsOfCompiledLaws(const Experiment& experiment);
/// Whether this process is one that a law has forked.
bool IsForkedByLaw();
/// Marks this process as one that a law has forked: from now on it dies with its parent. For forks in other threads of
/// a law.
void MarkAsForkedByLaw();
/// Memory that belongs to this process, or another one, alone (MB); 0 if it has ended.
double OwnMemory_mb();
double MemoryOf_mb(pid_t process);

}  // namespace mascot
