// What Python code prints.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>

#include "agent/python_internal.h"

namespace mascot {
namespace {

std::atomic<int> suppressed = 0;

/// Python's stdout: what Python code prints goes to stderr, because stdout belongs to the program. It goes there in
/// whole lines, so that those of several threads do not mix; a line that is not over appears when Python flushes it,
/// when it gets long, and at the end of the process.
class PythonOutput {
 public:
  static PythonOutput& Get() {
    static PythonOutput& output = *new PythonOutput;  // lives as long as the process: Python uses it
    return output;
  }

  std::size_t Write(const py::str& text) {
    if (suppressed == 0) Add(TextOf(text));
    return py::len(text);
  }
  void Flush() {
    if (suppressed == 0) PrintAll();
  }
  void PrintAll() {
    const std::lock_guard lock(mutex_);
    Print(line_.size());
  }

 private:
  static constexpr std::size_t kLongestLine = 4096;

  void Add(const std::string& text) {
    const std::lock_guard lock(mutex_);
    line_ += text;
    Print(line_.size() > kLongestLine ? line_.size() : line_.rfind('\n') + 1);  // npos + 1 is 0
  }
  void Print(std::size_t bytes) {
    if (bytes == 0) return;
    std::fwrite(line_.data(), 1, bytes, stderr);
    std::fflush(stderr);
    line_.erase(0, bytes);
  }

  std::mutex mutex_;  // at the end of the process the GIL may be held by a law that hangs
  std::string line_;
};

PYBIND11_EMBEDDED_MODULE(mascot_output, module) {
  py::class_<PythonOutput, std::unique_ptr<PythonOutput, py::nodelete>>(module, "Output")
      .def("write", &PythonOutput::Write)
      .def("flush", &PythonOutput::Flush);
}

}  // namespace

void TakePythonOutput() {
  const py::module_ module = py::module_::import("mascot_output");
  py::module_::import("sys").attr("stdout") = py::cast(&PythonOutput::Get(), py::return_value_policy::reference);
  std::atexit([] { PythonOutput::Get().PrintAll(); });
}

SuppressedPythonOutput::SuppressedPythonOutput() { ++suppressed; }
SuppressedPythonOutput::~SuppressedPythonOutput() { --suppressed; }

}  // namespace mascot
