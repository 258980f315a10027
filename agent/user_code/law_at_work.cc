#include "agent/user_code/law_at_work.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <span>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "agent/user_code/last_words.h"
#include "experiment/experiment.h"
#include "system/end_now.h"
#include "system/left_file.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;

thread_local const char* whose_law = nullptr;  // whose law runs in this thread
std::atomic<bool> forked_by_law = false;
std::atomic<pid_t> this_process = 0;  // as long as no law has run: 0

// --- signals ------------------------------------------------------------------------------------------

struct Fatal {
  int signal;
  const char* name;
};
constexpr Fatal kFatal[] = {{SIGSEGV, "SIGSEGV"}, {SIGABRT, "SIGABRT"}, {SIGFPE, "SIGFPE"}, {SIGILL, "SIGILL"},
                            {SIGTRAP, "SIGTRAP"}, {SIGSYS, "SIGSYS"},   {SIGBUS, "SIGBUS"}};

void Say(std::string_view text) {
  if (!WriteAll(STDERR_FILENO, text)) return;
}

/// `reason`: pieces of a text. Calls only what a signal handler may call.
void SayError(std::span<const char* const> reason) {
  Say("error: ");
  for (const char* piece : reason) Say(piece);
  Say("\n");
}

struct sigaction before_bus_error {};  // whose SIGBUS is explained elsewhere if no law is at work

/// A signal handler, called once: then the signal ends the process. In a thread that a law has started, and no one
/// knows of, it is not known whose law it is.
void ExplainCrash(int signal) {
  if (signal == SIGBUS && whose_law == nullptr && before_bus_error.sa_handler != SIG_DFL)
    before_bus_error.sa_handler(signal);
  const auto* row =
      std::find_if(std::begin(kFatal), std::end(kFatal), [=](const Fatal& f) { return f.signal == signal; });
  const char* const reason[] = {whose_law != nullptr ? whose_law : "this process", " crashed: ", row->name};
  SayError(reason);
  if (!IsForkedByLaw()) LastWords::Leave(reason, std::size(reason), 128 + signal);
  raise(signal);
}

/// A stack for signal handlers of this thread: its own may be what has overflown.
class SignalStack {
 public:
  SignalStack() : memory_(std::make_unique<char[]>(kSize)) {
    stack_t stack{};
    stack.ss_sp = memory_.get();
    stack.ss_size = kSize;
    sigaltstack(&stack, nullptr);
  }
  ~SignalStack() {
    stack_t none{};
    none.ss_flags = SS_DISABLE;
    sigaltstack(&none, nullptr);
  }
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  static constexpr std::size_t kSize = std::size_t{64} * 1024;
  std::unique_ptr<char[]> memory_;
};

// --- ends without a signal ----------------------------------------------------------------------------

constexpr const char* kSomeLaw = "a law, or what it has called,";

/// To be called by the thread that ends this process, through `call`. If that is `who`, the process says so and ends
/// with an exit code that is not 0; null: it is no law. A process that a law has started may end as it likes.
void ExplainEnd(int code, const char* call, const char* who) {
  if (who == nullptr || getpid() != this_process || IsForkedByLaw()) return;
  const char* const reason[] = {who, " has ended the process by ", call};
  SayError(reason);
  const int failure = code != 0 ? code : 1;
  LastWords::Leave(reason, std::size(reason), failure);
  EndNow(failure);
}

/// The law that runs in this thread; a thread that a law has started does not know whose it is.
const char* WhoseLaw() { return whose_law != nullptr ? whose_law : kSomeLaw; }

/// A handler of exit(). Our own code calls that in the main thread alone, and not while there are words to leave.
void OnExit(int code, void* /*nothing*/) {
  const bool is_ours = whose_law == nullptr && syscall(SYS_gettid) == getpid() && !LastWords::Await();
  ExplainEnd(code, "exit()", is_ours ? nullptr : WhoseLaw());
}

/// In a process that was just forked. A law's dies with the thread that forked it.
void OnFork() {
  if (whose_law != nullptr)
    MarkAsForkedByLaw();
  else
    this_process = getpid();
}

void PrepareProcess() {
  static const bool prepared = [] {
    ExplainCrashes();
    this_process = getpid();
    on_exit(OnExit, nullptr);
    at_quick_exit([] { ExplainEnd(1, "quick_exit()", WhoseLaw()); });
    pthread_atfork(nullptr, nullptr, OnFork);
    return true;
  }();
  (void)prepared;
  thread_local const SignalStack stack;
}

}  // namespace

void ExplainCrashes() {
  static const bool explained = [] {
    for (const Fatal& fatal : kFatal) {
      struct sigaction before {};
      if (sigaction(fatal.signal, nullptr, &before) != 0 || (before.sa_flags & SA_SIGINFO) != 0) continue;
      if (fatal.signal == SIGBUS)
        before_bus_error = before;
      else if (before.sa_handler != SIG_DFL)
        continue;
      struct sigaction action {};
      action.sa_handler = ExplainCrash;
      action.sa_flags = static_cast<int>(SA_RESETHAND | SA_ONSTACK | SA_NODEFER);
      sigaction(fatal.signal, &action, nullptr);
    }
    return true;
  }();
  (void)explained;
}

// --- the last resort ----------------------------------------------------------------------------------

/// Ends the process if a law goes far beyond its limits. A thread of its own looks now and then: it needs nothing that
/// a law may hold, such as Python's interpreter.
class LastResort {
 public:
  static LastResort& Get() {
    static LastResort& last_resort = *new LastResort;  // its thread lives as long as the process
    return last_resort;
  }
  void Begin(LawAtWork& law) {
    const std::lock_guard lock(mutex_);
    const double grace_s = std::max(1.0, kGrace * law.limits_.limit_s);
    law.until_ns_ = seen_ns_ + static_cast<std::int64_t>((law.limits_.limit_s + grace_s) * 1e9);
    laws_.push_back(&law);
  }
  void End(LawAtWork& law) {
    const std::lock_guard lock(mutex_);
    std::erase(laws_, &law);
  }

 private:
  static constexpr double kGrace = 0.5, kMoreMemory_mb = 256;
  static constexpr auto kLookEvery = 20ms, kLongestGap = 200ms;

  LastResort() {
    std::thread([this] { Watch(); }).detach();
  }

  [[noreturn]] void Watch() {
    auto last = std::chrono::steady_clock::now();
    for (;;) {
      std::this_thread::sleep_for(kLookEvery);
      const auto now = std::chrono::steady_clock::now();
      const auto gap = std::min<std::chrono::nanoseconds>(now - std::exchange(last, now), kLongestGap);
      const std::lock_guard lock(mutex_);
      seen_ns_ += gap.count();
      const bool has_limit = std::ranges::any_of(laws_, [](const auto* law) { return law->limits_.memory_mb > 0; });
      const double memory_mb = has_limit ? OwnMemory_mb() : 0;
      for (const LawAtWork* law : laws_) Look(*law, memory_mb);
    }
  }

  void Look(const LawAtWork& law, double memory_mb) const {
    const LawLimits& limits = law.limits_;
    const bool is_late = limits.limit_s > 0 && seen_ns_ > law.until_ns_;
    if (limits.memory_mb > 0 && memory_mb > limits.memory_mb) law.took_too_much_ = true;
    if ((is_late && law.took_too_much_) ||
        (limits.memory_mb > 0 && memory_mb > (1 + kGrace) * limits.memory_mb + kMoreMemory_mb))
      EndProcess(fmt::format("{} needs more than control.python_memory_mb = {} and cannot be interrupted", law.who_,
                             limits.memory_mb));
    if (is_late)
      EndProcess(fmt::format("{} took longer than {} = {:g} s and cannot be interrupted", law.who_, limits.source,
                             limits.limit_s));
  }

  [[noreturn]] static void EndProcess(const std::string& words) {
    Say("error: " + words + ": the process ends\n");
    const char* const reason = words.c_str();
    LastWords::Leave(&reason, 1, 1);
    EndNow(1);
  }

  std::mutex mutex_;
  std::int64_t seen_ns_ = 0;  // how long this thread has been looking
  std::vector<const LawAtWork*> laws_;
};

LawAtWork::LawAtWork(const std::string& who, const LawLimits& limits) : who_(who), limits_(limits), before_(whose_law) {
  PrepareProcess();
  LastResort::Get().Begin(*this);
  whose_law = who_.c_str();
}

LawAtWork::~LawAtWork() {
  if (IsForkedByLaw()) EndNow(0);  // it was forked by the law, and is none of ours
  LastResort::Get().End(*this);
  whose_law = before_;
}

LawLimits LimitsOfLaws(const Experiment& experiment) {
  // Less than run.agent_timeout_s, so that the law is interrupted first and the message says where it hangs.
  constexpr double kTimeShare = 0.8;
  return {kTimeShare * experiment.run.agent_timeout_s, "0.8 run.agent_timeout_s", experiment.control.python_memory_mb};
}

LawLimits LimitsOfCompiledLaws(const Experiment& experiment) {
  LawLimits limits = LimitsOfLaws(experiment);
  limits.memory_mb = 0;
  return limits;
}

void MarkAsForkedByLaw() {
  forked_by_law = true;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
}

bool IsForkedByLaw() { return forked_by_law; }

double OwnMemory_mb() { return MemoryOf_mb(getpid()); }

double MemoryOf_mb(pid_t process) {
  std::uint64_t size = 0, resident = 0, shared = 0;
  std::ifstream("/proc/" + std::to_string(process) + "/statm") >> size >> resident >> shared;
  static const auto page = static_cast<double>(sysconf(_SC_PAGESIZE));
  return resident > shared ? static_cast<double>(resident - shared) * page / 1e6 : 0;
}

}  // namespace mascot

// In place of libc's, for all libraries: code in C that a law calls, or a thread that it has started, may end the
// process by them. Our own code calls EndNow(). NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp):
// libc's names
extern "C" [[gnu::visibility("default")]] void _exit(int code) {
  mascot::ExplainEnd(code, "_exit()", mascot::WhoseLaw());
  mascot::EndNow(code);
}
extern "C" [[gnu::visibility("default")]] void _Exit(int code) { _exit(code); }
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)
