#include "agent/python/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "agent/python/internal.h"

namespace mascot {
namespace {

std::string At(const std::string& file, int line) { return file + ":" + std::to_string(std::max(line, 1)) + ": "; }

/// An array that Python may read but not change: the next metric gets the same one.
template <class Number>
py::array ReadOnly(const RunArray& array) {
  py::array_t<Number> made(std::vector<py::ssize_t>(array.shape.begin(), array.shape.end()));
  std::transform(array.values.begin(), array.values.end(), made.mutable_data(),
                 [](double value) { return static_cast<Number>(value); });
  made.attr("setflags")(py::arg("write") = false);
  return made;
}

/// What METRICS names, with units; throws std::runtime_error if it is anything else.
std::vector<PythonMetric> Declared(const py::object& metrics, const std::string& file) {
  const auto refuse = [&] {
    throw std::runtime_error(At(file, 1) + "expected METRICS to be a dict of names and units or a list of names, got " +
                             Repr(metrics));
  };
  std::vector<PythonMetric> list;
  if (py::isinstance<py::dict>(metrics)) {
    for (const auto& [name, unit] : metrics.cast<py::dict>()) {
      if (!py::isinstance<py::str>(name) || !py::isinstance<py::str>(unit)) refuse();
      list.push_back({TextOf(name), TextOf(unit)});
    }
  } else if (py::isinstance<py::list>(metrics) || py::isinstance<py::tuple>(metrics)) {
    for (const py::handle& name : metrics) {
      if (!py::isinstance<py::str>(name)) refuse();
      list.push_back({TextOf(name), ""});
    }
  } else {
    refuse();
  }
  return list;
}

/// The functions that the file itself defines, without those of modules that it imports.
std::vector<PythonMetric> Defined(const py::dict& space) {
  std::vector<PythonMetric> list;
  for (const auto& [name, value] : space) {
    const std::string text = TextOf(py::str(name));
    if (PyFunction_Check(value.ptr()) && !text.starts_with('_') &&
        py::getattr(value, "__module__", py::none()).equal(space["__name__"]))
      list.push_back({text, ""});
  }
  return list;
}

}  // namespace

struct PythonMetrics::Functions {
  std::vector<py::object> calls;  // by PythonMetrics::list_
};

PythonMetrics::PythonMetrics(const MetricFile& file)
    : PythonMetrics(file.text, std::filesystem::path(file.path).filename(),
                    std::filesystem::path(file.path).parent_path(), LawLimits{60, "the limit of a metric"}) {}

PythonMetrics::PythonMetrics(const std::string& text, const std::string& file, const std::string& folder,
                             const LawLimits& limits)
    : file_(file), limits_(limits), functions_(std::make_unique<Functions>()) {
  const PythonModules modules = ModulesBeside(text, folder);
  const PythonLock lock;
  try {
    const LimitedPython limited(limits_, file_);
    const py::dict space = RunPython(text, file, 1, modules, {});
    list_ = space.contains("METRICS") ? Declared(space["METRICS"], file) : Defined(space);
    for (const PythonMetric& metric : list_) {
      const py::object function = space.contains(metric.name) ? py::object(space[py::str(metric.name)]) : py::none();
      if (PyCallable_Check(function.ptr()) == 0)
        throw std::runtime_error(At(file, 1) + "METRICS: expected names of functions, got '" + metric.name + "'");
      if (const std::string signature = SignatureIfNotCallable(function, 1); !signature.empty())
        throw std::runtime_error(At(file, LineOf(function)) +
                                 "expected a metric of one argument, the arrays of a run, got " + metric.name +
                                 signature + " (METRICS can say which functions are metrics)");
      functions_->calls.push_back(function);
    }
  } catch (const PythonError& error) {
    throw std::runtime_error(At(file, error.line()) + error.summary());
  }
  if (list_.empty()) throw std::runtime_error(At(file, 1) + "expected functions of the arrays of a run, got none");
}

PythonMetrics::~PythonMetrics() {
  const PythonLock lock;
  functions_.reset();
}

std::vector<std::optional<double>> PythonMetrics::Of(std::span<const RunArray> arrays) const {
  const PythonLock lock;
  std::vector<std::pair<py::str, py::array>> made;
  for (const RunArray& array : arrays)
    made.emplace_back(array.name, array.of_integers ? ReadOnly<std::int64_t>(array) : ReadOnly<double>(array));
  std::vector<std::optional<double>> numbers;
  for (std::size_t k = 0; k < list_.size(); ++k) {
    const std::string metric = "metric " + list_[k].name + ": ";
    try {
      const LimitedPython limited(limits_, file_);
      py::dict run;
      for (const auto& [name, array] : made) run[name] = array;
      const py::object value = functions_->calls[k](run);
      if (value.is_none()) {
        numbers.push_back(std::nullopt);
        continue;
      }
      const double number = py::isinstance<py::str>(value) ? -1 : PyFloat_AsDouble(value.ptr());
      const bool failed = py::isinstance<py::str>(value) || PyErr_Occurred() != nullptr;
      PyErr_Clear();
      if (failed || std::isinf(number))
        throw std::runtime_error(At(file_, LineOf(functions_->calls[k])) + metric +
                                 "expected a finite number, or None for no value, got " + Repr(value));
      numbers.push_back(std::isnan(number) ? std::nullopt : std::optional(number));
    } catch (py::error_already_set& error) {
      const PythonError explained = Explain(error, file_);
      throw std::runtime_error(At(file_, explained.line()) + metric + explained.summary());
    }
  }
  return numbers;
}

}  // namespace mascot
