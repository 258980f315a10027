// What Python code prints.
#include <cstdlib>

#include "agent/python/internal.h"
#include "agent/user_code/law_output.h"

namespace mascot {
namespace {

/// Python's stdout or stderr.
class PythonOutput {
 public:
  // They live as long as the process: Python uses them. At its end the GIL may be held by a law that hangs.
  static PythonOutput& OfOutput() {
    static PythonOutput& output = *new PythonOutput(LawOutput::Kind::kUsual);
    return output;
  }
  static PythonOutput& OfErrors() {
    static PythonOutput& output = *new PythonOutput(LawOutput::Kind::kErrors);
    return output;
  }

  std::size_t Write(const py::str& text) {
    output_.Add(TextOf(text));
    return py::len(text);
  }
  void Flush() { output_.Flush(); }
  void PrintAll() { output_.PrintAll(); }

 private:
  explicit PythonOutput(LawOutput::Kind kind) : output_(kind) {}

  LawOutput output_;
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

}  // namespace mascot
