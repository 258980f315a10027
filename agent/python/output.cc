// What Python code prints.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>

#include "agent/python/internal.h"
#include "base/after_last.h"
#include "base/utf8.h"

namespace mascot {
namespace {

std::atomic<int> suppressed = 0;

/// Python's stdout and stderr: what Python code prints goes to stderr, because stdout belongs to the program, and is
/// fit for a terminal. It goes there in whole lines, so that those of several threads do not mix; a line that is not
/// over appears when Python flushes it, when it gets long, and at the end of the process.
class PythonOutput {
 public:
  // They live as long as the process: Python uses them.
  static PythonOutput& OfOutput() {
    static PythonOutput& output = *new PythonOutput(/*is_error=*/false);
    return output;
  }
  static PythonOutput& OfErrors() {
    static PythonOutput& output = *new PythonOutput(/*is_error=*/true);
    return output;
  }

  std::size_t Write(const py::str& text) {
    if (is_error_ || suppressed == 0) Add(TextOf(text));
    return py::len(text);
  }
  void Flush() {
    if (is_error_ || suppressed == 0) PrintAll();
  }
  void PrintAll() {
    const std::lock_guard lock(mutex_);
    Print(line_.size());
  }

 private:
  static constexpr std::size_t kLongestLine = 4096;

  explicit PythonOutput(bool is_error) : is_error_(is_error) {}

  void Add(const std::string& text) {
    const std::lock_guard lock(mutex_);
    line_ += text;
    Print(line_.size() > kLongestLine ? line_.size() : line_.size() - AfterLast(line_, '\n').size());
  }
  void Print(std::size_t bytes) {
    if (bytes == 0) return;
    const std::string text = Plain(std::string_view(line_).substr(0, bytes));
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
    line_.erase(0, bytes);
  }

  const bool is_error_;  // errors are never suppressed
  std::mutex mutex_;     // at the end of the process the GIL may be held by a law that hangs
  std::string line_;
};

}  // namespace

void TakePythonOutput() {
  // A module that is made now: PYBIND11_EMBEDDED_MODULE makes one when the program starts, which Python itself may be.
  const py::object module = py::module_::import("types").attr("ModuleType")("mascot_output");
  py::class_<PythonOutput, std::unique_ptr<PythonOutput, py::nodelete>>(module, "Output")
      .def("write", &PythonOutput::Write)
      .def("flush", &PythonOutput::Flush);
  const py::module_ sys = py::module_::import("sys");
  sys.attr("stdout") = py::cast(&PythonOutput::OfOutput(), py::return_value_policy::reference);
  sys.attr("stderr") = py::cast(&PythonOutput::OfErrors(), py::return_value_policy::reference);
  std::atexit([] {
    PythonOutput::OfOutput().PrintAll();
    PythonOutput::OfErrors().PrintAll();
  });
}

SuppressedPythonOutput::SuppressedPythonOutput() { ++suppressed; }
SuppressedPythonOutput::~SuppressedPythonOutput() { --suppressed; }

}  // namespace mascot
