// Interrupts Python code that takes too long, or too much memory.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "agent/python/internal.h"

namespace mascot {
namespace {

std::int64_t NowNs() { return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1); }

/// An exception class of this name and text: PyThreadState_SetAsyncExc() takes a class. It is no Exception, because
/// loops that try something until it works catch those.
py::object MakeError(const char* name, const std::string& text) {
  py::dict space;
  space["text"] = text;
  space["name"] = name;
  py::exec(R"(
error = type(name, (BaseException,), {"__module__": "builtins", "__str__": lambda self: text})
)",
           space);
  return space["error"];
}

py::object MakeTimeoutError(const LawLimits& limits) {
  std::ostringstream text;
  text << "took longer than " << limits.source << " = " << limits.limit_s << " s";
  return MakeError("TimeoutError", text.str());
}

py::object MakeMemoryError(const LawLimits& limits) {
  return MakeError("MemoryError", "needs more than control.python_memory_mb = " + std::to_string(limits.memory_mb));
}

}  // namespace

/// Knows every piece of Python code that runs with a time limit: agents that share a process run their laws in several
/// threads, which take turns. A thread of its own looks now and then; the code itself pays for two atomic stores.
class PythonWatchdog {
 public:
  static PythonWatchdog& Get() {
    static PythonWatchdog& watchdog = *new PythonWatchdog;  // its thread lives as long as the process
    return watchdog;
  }
  void Begin(LimitedPython& call) {
    calls_.push_back(&call);
    SetNextDeadline();
  }
  void End(LimitedPython& call) {
    std::erase(calls_, &call);
    SetNextDeadline();
  }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  static constexpr auto kCheckEvery = std::chrono::milliseconds(50);

  PythonWatchdog() {
    std::thread([this] {
      for (;; std::this_thread::sleep_for(kCheckEvery))
        if (NowNs() > next_deadline_ns_ || IsMemoryDue()) InterruptDue();
    }).detach();
  }

  void SetNextDeadline() {
    std::int64_t next = kNever;
    double memory_mb = std::numeric_limits<double>::infinity();
    for (const LimitedPython* call : calls_) {
      next = std::min(next, call->deadline_ns_);
      if (call->limits_.memory_mb > 0 && !call->told_of_memory_)
        memory_mb = std::min<double>(memory_mb, call->limits_.memory_mb);
    }
    next_deadline_ns_ = next;
    min_memory_mb_ = memory_mb;
  }

  bool IsMemoryDue() const {
    const double min_mb = min_memory_mb_;
    return min_mb < std::numeric_limits<double>::infinity() && OwnMemory_mb() > min_mb;
  }

  /// A call that is to be interrupted now, if any.
  LimitedPython* Due() const {
    const double memory_mb = OwnMemory_mb();
    const auto due =
        std::ranges::find_if(calls_, [=](const auto* call) { return call->IsLate() || call->TakesTooMuch(memory_mb); });
    return due == calls_.end() ? nullptr : *due;
  }

  void InterruptDue() {
    const PyGILState_STATE state = PyGILState_Ensure();  // code that hangs releases the GIL every few milliseconds
    while (const LimitedPython* seen = Due()) {          // it still runs after we waited
      const bool is_late = seen->IsLate();
      const py::object error = is_late ? MakeTimeoutError(seen->limits_) : MakeMemoryError(seen->limits_);
      LimitedPython* due = Due();
      if (due != seen) continue;  // making the error let others run
      due->told_of_memory_ = due->told_of_memory_ || !is_late;
      due->Interrupt(error);
    }
    SetNextDeadline();
    PyGILState_Release(state);
  }

  std::atomic<std::int64_t> next_deadline_ns_ = kNever;
  std::atomic<double> min_memory_mb_ = std::numeric_limits<double>::infinity();
  std::vector<LimitedPython*> calls_;  // used with the GIL held
};

LimitedPython::LimitedPython(const LawLimits& limits, const std::string& who)
    : at_work_(who, limits), limits_(limits), thread_(PyThread_get_thread_ident()) {
  SetDeadline();
  PythonWatchdog::Get().Begin(*this);
}

LimitedPython::~LimitedPython() {
  PythonWatchdog::Get().End(*this);
  if (interrupted_) PyThreadState_SetAsyncExc(thread_, nullptr);  // cancels it if it is pending
}

void LimitedPython::SetDeadline() { deadline_ns_ = NowNs() + static_cast<std::int64_t>(limits_.limit_s * 1e9); }

bool LimitedPython::IsLate() const { return NowNs() > deadline_ns_; }

bool LimitedPython::TakesTooMuch(double memory_mb) const {
  return !told_of_memory_ && limits_.memory_mb > 0 && memory_mb > limits_.memory_mb;
}

void LimitedPython::Interrupt(const py::object& error) {
  SetDeadline();
  interrupted_ = true;
  PyThreadState_SetAsyncExc(thread_, error.ptr());
}

}  // namespace mascot
