#include "agent/python/python.h"

#include <cstdlib>
#include <mutex>
#include <sstream>
#include <string>
#include <utility>

#include "agent/python/internal.h"
#include "base/after_last.h"
#include "base/utf8.h"

namespace mascot {
namespace {

constexpr std::size_t kLongestException = 20'000;  // of an exception: they go to terminals, logs and summaries

/// What NumPy and linear algebra choose by the processor, chosen here: results then have the same bits on each.
void PinToBaseline() {
  // One thread: results do not depend on the number of cores, and a hundred agents do not each start a thread per core.
  for (const char* variable : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"})
    setenv(variable, "1", /*overwrite=*/0);
  setenv("OPENBLAS_CORETYPE", "Prescott", /*overwrite=*/1);  // x86-64 with SSE3
  setenv("NPY_DISABLE_CPU_FEATURES",
         "SSSE3 SSE41 POPCNT SSE42 AVX F16C FMA3 AVX2 AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL",
         /*overwrite=*/1);
}

/// What PYTHONPATH names comes behind all other folders: a law may need it, and it takes the place of nothing.
void AddPythonPath() {
  const char* folders = std::getenv("PYTHONPATH");
  if (folders == nullptr) return;
  const py::object path = py::module_::import("sys").attr("path");
  std::istringstream text(folders);
  for (std::string folder; std::getline(text, folder, ':');)
    if (!folder.empty()) path.attr("append")(py::module_::import("os").attr("fsdecode")(py::bytes(folder)));
}

void StartInterpreter() {
  if (Py_IsInitialized() != 0)  // its program would be guarded as a law is
    throw std::runtime_error(
        "a law in Python does not fly inside of another program in Python: `orchestrator up` flies its file, or give "
        "the function itself to mascot.fly()");
  PinToBaseline();
  // No PYTHON* variables: a PYTHONHOME of another Python would keep this one from starting. Text is UTF-8, whatever the
  // locale.
  PyPreConfig first;
  PyPreConfig_InitPythonConfig(&first);
  first.use_environment = 0;
  first.utf8_mode = 1;
  Py_PreInitialize(&first);
  PyConfig config;
  PyConfig_InitPythonConfig(&config);
  config.use_environment = 0;
  // NumPy would warn of those features in the list that this processor lacks.
  PyWideStringList_Append(&config.warnoptions, L"ignore:During parsing environment variable:RuntimeWarning");
  PyConfig_SetBytesString(&config, &config.program_name, "/usr/bin/python3");  // Debian's, whatever comes first in PATH
  config.parse_argv = 0;
  config.install_signal_handlers = 0;
  config.write_bytecode = 0;
  config.use_hash_seed = 1;  // the order of sets of strings is the same in every run
  config.hash_seed = 0;
  config.safe_path = 1;
  py::initialize_interpreter(&config, 0, nullptr, /*add_program_dir_to_path=*/false);  // nor the current folder
  AddPythonPath();
  TakePythonOutput();
  GuardProcess();
  UseVirtualEnvironment();
  PyEval_SaveThread();
}

/// Makes this thread's Python state once and keeps it between locks: making it each time takes longer than a law.
void KeepThreadState() {
  thread_local const bool kept = [] {
    PyGILState_Ensure();
    PyEval_SaveThread();
    return true;
  }();
  (void)kept;
}

/// How many calls deep a traceback is looked at as a whole: a recursion without end may have millions.
constexpr int kDeep = 5000;

/// Whether an exception came through more than kDeep calls.
bool IsDeep(py::object trace) {
  int calls = 0;
  while (trace && !trace.is_none() && ++calls <= kDeep) trace = trace.attr("tb_next");
  return calls > kDeep;
}

/// The innermost line of `file` that the exception came through, among its first kDeep calls; 0: none.
int LineOf(const py::error_already_set& error, const std::string& file) {
  int line = 0, calls = 0;
  for (py::object trace = error.trace(); trace && !trace.is_none() && ++calls <= kDeep; trace = trace.attr("tb_next"))
    if (trace.attr("tb_frame").attr("f_code").attr("co_filename").cast<std::string>() == file)
      line = trace.attr("tb_lineno").cast<int>();
  return line;
}

int IntOr0(const py::handle& object, const char* attribute) {
  const py::object value = py::getattr(object, attribute, py::none());
  return py::isinstance<py::int_>(value) ? value.cast<int>() : 0;
}

/// Makes the lines of a text that is in no file known to tracebacks.
void RegisterLines(const std::string& text, const std::string& file) {
  const py::object lines = py::str(text).attr("splitlines")(true);
  py::module_::import("linecache").attr("cache")[py::str(file)] = py::make_tuple(text.size(), py::none(), lines, file);
}

/// The mapping that Python code knows as DATA.
py::object DataOf(const PythonFiles& files) {
  py::dict space;
  py::exec(R"python(
class Data(dict):
    """The files of law.data: the path of each, by its name there."""

    def __missing__(self, name):
        raise KeyError(f"law.data does not name {name!r}, but {', '.join(map(repr, self)) or 'nothing'}")
)python",
           space);
  return space["Data"](files);
}

/// The signature of a function; None if Python cannot tell.
py::object SignatureOf(const py::object& function) try {
  return py::module_::import("inspect").attr("signature")(function);
} catch (py::error_already_set&) {
  return py::none();
}

}  // namespace

PythonLock::PythonLock() {
  static std::once_flag started;
  std::call_once(started, StartInterpreter);
  KeepThreadState();
  state_ = PyGILState_Ensure();
}

bool PythonHasStarted() { return Py_IsInitialized() != 0; }

PythonLock::~PythonLock() { PyGILState_Release(state_); }

std::string TextOf(const py::handle& text) {
  const auto bytes =
      py::reinterpret_steal<py::bytes>(PyUnicode_AsEncodedString(text.ptr(), "utf-8", "backslashreplace"));
  if (!bytes) throw py::error_already_set();
  return bytes;
}

PythonError Explain(py::error_already_set& error, const std::string& file) {
  const py::object traceback = py::module_::import("traceback");
  const bool is_syntax = error.matches(PyExc_SyntaxError) && TextOf(py::str(error.value().attr("filename"))) == file;
  const auto text = [&](const py::object& lines) {
    std::string joined = TextOf(py::str("").attr("join")(lines));
    while (joined.ends_with('\n')) joined.pop_back();
    return Shortened(joined, kLongestException);
  };
  const std::string only = text(traceback.attr("format_exception_only")(error.type(), error.value()));
  const std::string summary(AfterLast(only, '\n'));
  const py::object trace = error.trace() ? error.trace() : py::none();  // a SyntaxError has none
  const py::object limit = IsDeep(trace) ? py::object(py::int_(-20)) : py::object(py::none());  // the last 20 calls
  const std::string full = text(traceback.attr("format_exception")(error.type(), error.value(), trace, limit));
  return PythonError(full, summary, is_syntax ? IntOr0(error.value(), "lineno") : LineOf(error, file),
                     is_syntax ? IntOr0(error.value(), "offset") : 0);
}

py::dict RunPython(const std::string& text, const std::string& file, int line, const PythonModules& modules,
                   const PythonFiles& files) {
  const std::string padded = std::string(static_cast<std::size_t>(line - 1), '\n') + text;
  try {
    RegisterLines(padded, file);
    const py::object code = py::module_::import("builtins").attr("compile")(padded, file, "exec");
    py::dict space;
    space["__name__"] = "law";
    space["__file__"] = file;
    space["DATA"] = DataOf(files);
    space["__builtins__"] = BuiltinsOf(modules, space["DATA"]);
    const auto result = py::reinterpret_steal<py::object>(PyEval_EvalCode(code.ptr(), space.ptr(), space.ptr()));
    if (!result) throw py::error_already_set();
    return space;
  } catch (py::error_already_set& error) {
    throw Explain(error, file);
  }
}

std::string SignatureIfNotCallable(const py::object& function, std::size_t count) {
  const py::object signature = SignatureOf(function);
  if (signature.is_none()) return "";
  try {
    signature.attr("bind")(*py::tuple(py::make_tuple(py::none()) * py::int_(count)));
    return "";
  } catch (py::error_already_set&) {
    return TextOf(py::str(signature));
  }
}

int LineOf(const py::object& function) {
  return IntOr0(py::getattr(function, "__code__", py::none()), "co_firstlineno");
}

py::object ToPython(const Value& value) {
  struct Converter {
    py::object operator()(bool boolean) const { return py::bool_(boolean); }
    py::object operator()(std::int64_t integer) const { return py::int_(integer); }
    py::object operator()(double number) const { return py::float_(number); }
    py::object operator()(const std::string& text) const { return py::str(text); }
    py::object operator()(const Value::List& list) const {
      py::list items;
      for (const Value& item : list) items.append(ToPython(item));
      return items;
    }
    py::object operator()(const Value::Table& table) const {
      py::dict items;
      for (const auto& [key, item] : table) items[py::str(key)] = ToPython(item);
      return items;
    }
  };
  return std::visit(Converter{}, value.data);
}

}  // namespace mascot
