// Interrupts Python code that takes too long.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <sstream>
#include <thread>
#include <vector>

#include "agent/python_internal.h"

namespace mascot {
namespace {

std::int64_t NowNs() { return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1); }

/// An exception class for code that takes too long: PyThreadState_SetAsyncExc() takes a class. It is no Exception,
/// because loops that try something until it works catch those.
py::object MakeTimeoutError(const TimeLimit& limit) {
  py::dict space;
  std::ostringstream text;
  text << "took longer than " << limit.source << " = " << limit.limit_s << " s";
  space["text"] = text.str();
  py::exec(R"(
class TimeoutError(BaseException):
    __module__ = "builtins"
    def __str__(self):
        return text
)",
           space);
  return space["TimeoutError"];
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
  void Begin(PythonTimeLimit& call) {
    calls_.push_back(&call);
    SetNextDeadline();
  }
  void End(PythonTimeLimit& call) {
    std::erase(calls_, &call);
    SetNextDeadline();
  }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  static constexpr auto kCheckEvery = std::chrono::milliseconds(50);

  PythonWatchdog() {
    std::thread([this] {
      for (;; std::this_thread::sleep_for(kCheckEvery))
        if (NowNs() > next_deadline_ns_) InterruptLate();
    }).detach();
  }

  void SetNextDeadline() {
    std::int64_t next = kNever;
    for (const PythonTimeLimit* call : calls_) next = std::min(next, call->deadline_ns_);
    next_deadline_ns_ = next;
  }

  /// The call that is late, if any.
  PythonTimeLimit* Late() const {
    const auto late = std::ranges::find_if(calls_, [](const auto* call) { return call->IsLate(); });
    return late == calls_.end() ? nullptr : *late;
  }

  void InterruptLate() {
    const PyGILState_STATE state = PyGILState_Ensure();  // code that hangs releases the GIL every few milliseconds
    while (const PythonTimeLimit* seen = Late()) {       // it still runs after we waited
      const py::object error = MakeTimeoutError(seen->limit_);
      if (PythonTimeLimit* late = Late(); late == seen) late->Interrupt(error);  // making the error let others run
    }
    SetNextDeadline();
    PyGILState_Release(state);
  }

  std::atomic<std::int64_t> next_deadline_ns_ = kNever;
  std::vector<PythonTimeLimit*> calls_;  // used with the GIL held
};

PythonTimeLimit::PythonTimeLimit(const TimeLimit& limit) : limit_(limit), thread_(PyThread_get_thread_ident()) {
  SetDeadline();
  PythonWatchdog::Get().Begin(*this);
}

PythonTimeLimit::~PythonTimeLimit() {
  PythonWatchdog::Get().End(*this);
  if (interrupted_) PyThreadState_SetAsyncExc(thread_, nullptr);  // cancels it if it is pending
}

void PythonTimeLimit::SetDeadline() { deadline_ns_ = NowNs() + static_cast<std::int64_t>(limit_.limit_s * 1e9); }

bool PythonTimeLimit::IsLate() const { return NowNs() > deadline_ns_; }

void PythonTimeLimit::Interrupt(const py::object& error) {
  SetDeadline();
  interrupted_ = true;
  PyThreadState_SetAsyncExc(thread_, error.ptr());
}

}  // namespace mascot
