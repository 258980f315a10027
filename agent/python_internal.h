#pragma once

// What python.cc and the laws written in Python share; nobody else includes this, or pybind11.

#include <pybind11/embed.h>
#include <pybind11/numpy.h>

#include <string>

#include "agent/python.h"
#include "experiment/toml/value.h"

namespace mascot {

namespace py = pybind11;

/// Holds the process's one interpreter, which is started by the first and lives as long as the process. Every use of a
/// Python object, its destruction too, happens with one of these alive. Cheap from the second time on in each thread.
class PythonLock {
 public:
  PythonLock();
  ~PythonLock();
  PythonLock(const PythonLock&) = delete;
  PythonLock& operator=(const PythonLock&) = delete;

 private:
  PyGILState_STATE state_;
};

/// Python code that runs longer than `limit` while one lives is ended by a TimeoutError, at the line where it is; one
/// that catches it (it is no Exception, so only a bare except does) gets another. (Not a call that does not come back
/// to Python.) Made with the interpreter locked; one at a time in a process.
class PythonTimeLimit {
 public:
  explicit PythonTimeLimit(const TimeLimit& limit);
  ~PythonTimeLimit();
  PythonTimeLimit(const PythonTimeLimit&) = delete;
  PythonTimeLimit& operator=(const PythonTimeLimit&) = delete;
};

/// Runs `text`, which goes by `file` and begins at `line` of it in messages, in a namespace of its own. Throws
/// PythonError.
py::dict RunPython(const std::string& text, const std::string& file, int line);
/// What Python says of an exception that left the user's code, which goes by `file`.
PythonError Explain(py::error_already_set& error, const std::string& file);
py::object ToPython(const Value& value);
/// How a function wants to be called, "(t, me)", if that is with another number of arguments than `count`; else
/// nothing.
std::string OtherSignature(const py::object& function, std::size_t count);
/// The line at which a function is defined; 0: not known.
int LineOf(const py::object& function);

}  // namespace mascot
