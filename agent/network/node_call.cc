#include "agent/network/node_call.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mascot {
namespace {

/// Integers beyond those that a double has, such as the end of a Slice to the end, become the nearest ones.
std::int64_t NearestInteger(double number) {
  constexpr auto kLargest = std::numeric_limits<std::int64_t>::max();
  return number >= 0x1p63 ? kLargest : number <= -0x1p63 ? -kLargest : static_cast<std::int64_t>(number);
}

}  // namespace

const Operand& NodeCall::Input(std::size_t k) const {
  if (!Has(k)) throw NetworkError(fmt::format("expected an input {}, got none", k + 1));
  return inputs[k];
}

void NodeCall::ExpectInputs(std::size_t least, std::size_t most) const {
  if (inputs.size() < least || inputs.size() > most)
    throw NetworkError(fmt::format("expected {} input{}, got {}",
                                   least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most),
                                   most == 1 ? "" : "s", inputs.size()));
  for (std::size_t k = 0; k < least; ++k) Input(k);
}

std::string NodeCall::WrongType(std::string_view name) {
  return fmt::format("attribute {}: expected another type", name);
}

const Tensor& NodeCall::Constant(std::size_t k, std::string_view what) const {
  const Operand& input = Input(k);
  if (input.constant == nullptr)
    throw NetworkError(fmt::format("expected constant {}, got some that depend on the network's input", what));
  return *input.constant;
}

std::vector<std::int64_t> NodeCall::Integers(std::size_t k, std::string_view what) const {
  const Tensor& tensor = Constant(k, what);
  if (!tensor.is_integer) throw NetworkError(fmt::format("expected {} as integers, got other numbers", what));
  std::vector<std::int64_t> integers(tensor.numbers.size());
  std::ranges::transform(tensor.numbers, integers.begin(), NearestInteger);
  return integers;
}

bool NodeCall::IsInput(std::string_view what, std::size_t k, std::int64_t since) const {
  const bool is_input = opset >= since;
  if (is_input ? HasAttribute(what) : Has(k))
    throw NetworkError(fmt::format("expected {} as an {} with opset {}, got an {}", what,
                                   is_input ? "input" : "attribute", opset, is_input ? "attribute" : "input"));
  return is_input;
}

std::optional<std::vector<std::int64_t>> NodeCall::Axes(std::int64_t since) const {
  if (!IsInput("axes", 1, since)) {
    if (HasAttribute("axes")) return Get<std::vector<std::int64_t>>("axes", {});
  } else if (Has(1)) {
    return Integers(1, "axes");
  }
  return std::nullopt;
}

std::string ShapeText(const TensorShape& shape) {
  std::vector<std::string> lengths;
  for (const std::int64_t length : shape) lengths.push_back(length < 0 ? "?" : std::to_string(length));
  return fmt::format("[{}]", fmt::join(lengths, ", "));
}

std::size_t AxisOf(std::int64_t axis, std::size_t rank) {
  const auto axes = static_cast<std::int64_t>(rank);
  if (axis < -axes || axis >= axes) throw NetworkError(fmt::format("expected one of {} axes, got axis {}", rank, axis));
  return static_cast<std::size_t>(axis < 0 ? axis + axes : axis);
}

Indices AxesOf(const std::vector<std::int64_t>& axes, std::size_t rank) {
  std::vector<bool> is_there(rank, false);
  Indices all;
  for (const std::int64_t axis : axes) {
    all.push_back(AxisOf(axis, rank));
    if (is_there[all.back()]) throw NetworkError(fmt::format("expected each axis once, got axis {} twice", axis));
    is_there[all.back()] = true;
  }
  return all;
}

Indices Strides(const TensorShape& shape) {
  Indices strides(shape.size(), 1);
  for (std::size_t k = shape.size(); k > 1; --k)
    strides[k - 2] = strides[k - 1] * static_cast<std::size_t>(shape[k - 1]);
  return strides;
}

TensorShape Broadcast(const TensorShape& a, const TensorShape& b) {
  TensorShape shape(std::max(a.size(), b.size()), 1);
  for (std::size_t k = 1; k <= shape.size(); ++k) {
    const std::int64_t in_a = k <= a.size() ? a[a.size() - k] : 1, in_b = k <= b.size() ? b[b.size() - k] : 1;
    if (in_a != in_b && in_a != 1 && in_b != 1)
      throw NetworkError(fmt::format("expected shapes that fit, got {} and {}", ShapeText(a), ShapeText(b)));
    shape[shape.size() - k] = in_a == 1 ? in_b : in_a;
  }
  return shape;
}

Indices PlacesOf(const TensorShape& shape, std::int64_t first, const std::vector<std::int64_t>& steps) {
  Indices places(NumbersIn(shape));
  TensorShape position(shape.size(), 0);
  std::int64_t place = first;
  for (std::size_t& each : places) {
    each = static_cast<std::size_t>(place);
    for (std::size_t behind = shape.size(); behind > 0; --behind) {
      const std::size_t k = behind - 1;
      place += steps[k];
      if (++position[k] < shape[k]) break;
      place -= steps[k] * shape[k];
      position[k] = 0;
    }
  }
  return places;
}

Indices PlacesIn(const TensorShape& from, const TensorShape& shape) {
  const Indices strides = Strides(from);
  const std::size_t first = shape.size() - from.size();  // axis of `shape` that is axis 0 of `from`
  std::vector<std::int64_t> steps(shape.size(), 0);
  for (std::size_t k = 0; k < from.size(); ++k)
    if (from[k] != 1) steps[first + k] = static_cast<std::int64_t>(strides[k]);
  return PlacesOf(shape, 0, steps);
}

}  // namespace mascot
