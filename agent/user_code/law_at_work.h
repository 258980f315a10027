#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace mascot {

struct Experiment;

/// What the code of a law may take for itself, and the words for messages.
struct LawLimits {
  double limit_s = 0;       ///< wall clock; 0: no limit
  std::string_view source;  ///< the key that says so
  int memory_mb = 0;        ///< memory of the process (control.python_memory_mb); 0: no limit
};

/// While an object of this class lives, its thread runs code of a user's law. Whatever that does to the process, the
/// process says whose law it was:
/// * A signal by which it would end silently (SIGSEGV, from a stack overflow, say, SIGABRT, SIGFPE, SIGILL) is named
///   first: "error: the law of agent 3 crashed: SIGSEGV"; from then on also in other threads, which laws may start.
/// * Code in C that ends the process by exit(), quick_exit() or _exit() is named likewise; the exit code is then not 0.
/// * Long after the limit, 1.5 times and at least 1 s more, the process ends with exit code 1 and says so: the code has
///   not let itself be interrupted, or cannot be. Likewise if it takes 1.5 times the memory, and 256 MB more.
/// * A process that the code forks dies with the thread that forked it, and does not outlive the object.
/// Either way the process leaves its LastWords. Time in which the process was stopped does not count.
class LawAtWork {
 public:
  /// `who`: "the law of agent 3"; must live as long as this object.
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

/// From now on signals that end this process without a word (SIGSEGV, SIGABRT, ...) are named first, whoever crashes;
/// and LastWords are left. Handlers that others have set, such as a sanitizer's, stay.
void ExplainCrashes();
/// The limits of the laws that users wrote, in this experiment.
LawLimits LimitsOfLaws(const Experiment& experiment);
/// Whether this process is one that a law has forked.
bool IsForkedByLaw();
/// Says so of this process, which dies with its parent from now on. For forks in other threads of a law.
void MarkAsForkedByLaw();
/// Memory of this process that is its own alone (MB).
double OwnMemory_mb();

}  // namespace mascot
