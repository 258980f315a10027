#pragma once

// What agent/python/*.cc and agent/laws/custom/*.cc share; no other file includes this, or pybind11.

#include <pybind11/embed.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "agent/python/python.h"
#include "base/value.h"

namespace mascot {

namespace py = pybind11;

/// Holds the global interpreter lock (GIL). The process has one interpreter, which the first lock starts and which
/// lives as long as the process. Every use of a Python object, its destruction too, needs a live lock. Cheap from the
/// second time on in each thread.
class PythonLock {
 public:
  PythonLock();
  ~PythonLock();
  PythonLock(const PythonLock&) = delete;
  PythonLock& operator=(const PythonLock&) = delete;

 private:
  PyGILState_STATE state_;
};

/// Python code that runs longer than its limit while an object of this class lives gets a TimeoutError at the line
/// where it is, and another one each time it catches that (the error is not an Exception: only a bare except, or one of
/// BaseException, catches it). If the process takes too much memory, the code gets a MemoryError of the same kind. A
/// call that does not return to Python is not interrupted; then LawAtWork ends the process, later. Made and destroyed
/// with the GIL held, in one thread; one at a time in each thread.
class LimitedPython {
 public:
  /// `who` is that of LawAtWork.
  LimitedPython(const LawLimits& limits, const std::string& who);
  ~LimitedPython();
  LimitedPython(const LimitedPython&) = delete;
  LimitedPython& operator=(const LimitedPython&) = delete;

 private:
  friend class PythonWatchdog;
  void SetDeadline();
  bool IsLate() const;
  bool TakesTooMuch(double memory_mb) const;
  void Interrupt(const py::object& error);

  // Used with the GIL held, also by the watchdog's thread.
  const LawAtWork at_work_;
  const LawLimits limits_;
  const unsigned long thread_;
  std::int64_t deadline_ns_ = 0;
  bool interrupted_ = false, told_of_memory_ = false;
};

/// Keeps Python code from ending or changing the process that it shares with MASCOT: os._exit, os.kill of this process,
/// signal.signal, ... raise an exception in the process that runs the law. Children that the law forks may use them
/// all, and die with it. Called once, with the GIL held.
void GuardProcess();
/// Makes sys.stdout and sys.stderr print to stderr, as text that is safe for a terminal. Called once, with the GIL
/// held.
void TakePythonOutput();
/// Lets Python code import the packages of FindVirtualEnvironment(). Called once, with the GIL held.
void UseVirtualEnvironment();
/// The text of a str in UTF-8. Half of a surrogate pair, which UTF-8 does not have, is escaped as on Python's stderr:
/// \udc80.
std::string TextOf(const py::handle& text);

/// The __builtins__ of a law: those of Python, with an import statement that knows `modules`, which get `data` as DATA.
/// Each call makes new objects of the modules, so that laws share nothing.
py::object BuiltinsOf(const PythonModules& modules, const py::object& data);
/// Runs `text` in a namespace of its own, which it returns, and in which DATA has the paths of `files`. `file`, `line`:
/// where `text` begins, for messages. Throws PythonError.
py::dict RunPython(const std::string& text, const std::string& file, int line, const PythonModules& modules,
                   const PythonFiles& files);
/// The PythonError for an exception that left the user's code, whose name in messages is `file`.
PythonError Explain(py::error_already_set& error, const std::string& file);
/// A value as dict, list, str, int, float or bool.
py::object ToPython(const Value& value);
/// A new NumPy array that holds `values`.
py::array_t<double> Array(std::span<const double> values);
/// A new NumPy array of the shape (points, 3).
py::array_t<double> Rows(std::span<const Eigen::Vector3d> points);
/// repr() of a returned value, for a message; its type if repr() fails.
std::string Repr(const py::handle& value);
/// The numbers in a returned value; nullopt if it is not a flat sequence of numbers.
std::optional<std::vector<double>> Numbers(const py::object& value);
/// The signature of a function, "(t, me)", if it cannot be called with `count` arguments; else empty.
std::string SignatureIfNotCallable(const py::object& function, std::size_t count);
/// The line at which a function is defined; 0: not known.
int LineOf(const py::object& function);

}  // namespace mascot
