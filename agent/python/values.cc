// Values on their way between Python and C++.
#include <algorithm>

#include "agent/python/internal.h"
#include "base/utf8.h"

namespace mascot {

py::array_t<double> Array(std::span<const double> values) {
  py::array_t<double> array(static_cast<py::ssize_t>(values.size()));  // filled below: half the time of a copy
  std::ranges::copy(values, array.mutable_data());
  return array;
}

py::array_t<double> Rows(std::span<const Eigen::Vector3d> points) {
  py::array_t<double> rows({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}});
  double* next = rows.mutable_data();
  for (const Eigen::Vector3d& point : points) next = std::copy_n(point.data(), 3, next);
  return rows;
}

std::string Repr(const py::handle& value) try {
  constexpr std::size_t kLongest = 200;
  return Shortened(TextOf(py::repr(value)), kLongest);
} catch (py::error_already_set&) {
  return "an object of type " + TextOf(py::type::of(value).attr("__name__"));
}

std::optional<std::vector<double>> Numbers(const py::object& value) {
  std::vector<double> numbers;
  if (PyTuple_Check(value.ptr()) || PyList_Check(value.ptr())) {  // the usual case, and the fastest
    for (const py::handle& item : py::reinterpret_borrow<py::sequence>(value)) {
      const double number = PyFloat_AsDouble(item.ptr());
      if (number == -1 && PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        return std::nullopt;
      }
      numbers.push_back(number);
    }
    return numbers;
  }
  constexpr std::string_view kReal = "biufO";  // NumPy would also make numbers of text, dates and complex numbers
  if (!py::isinstance<py::array>(value) ||
      kReal.find(value.attr("dtype").attr("kind").cast<std::string>()) == std::string_view::npos)
    return std::nullopt;
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!array) {
    PyErr_Clear();
    return std::nullopt;
  }
  if (array.ndim() != 1) return std::nullopt;
  numbers.assign(array.data(), array.data() + array.size());
  return numbers;
}

}  // namespace mascot
