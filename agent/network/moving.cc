// Operators whose output has the numbers of their inputs, elsewhere.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "agent/network/node_call.h"

namespace mascot {
namespace {

using Integers = std::vector<std::int64_t>;

/// The output has the numbers of input 0 at these places.
NodeKernel Gather(Indices places) {
  return [places = std::move(places)](std::span<const double* const> in, double* out) {
    for (std::size_t k = 0; k < places.size(); ++k) out[k] = in[0][places[k]];
  };
}

/// The output has the numbers of input 0, in another shape.
NodePlan Reshaped(const NodeCall& call, TensorShape shape) {
  const std::size_t numbers = NumbersIn(call.Shape(0));
  if (NumbersIn(shape) != numbers)
    throw NetworkError(fmt::format("expected a shape for {} numbers, got {}", numbers, ShapeText(shape)));
  return {.shape = std::move(shape),
          .kernel = [numbers](std::span<const double* const> in, double* out) { std::copy_n(in[0], numbers, out); }};
}

NodePlan PlanIdentity(const NodeCall& call) {
  call.ExpectInputs(1, 1);
  return Reshaped(call, call.Shape(0));
}

/// In the wanted shape, -1 is the length that fits, and 0 the input's own length, or 0 with allowzero.
NodePlan PlanReshape(const NodeCall& call) {
  call.ExpectInputs(2, 2);
  const TensorShape& from = call.Shape(0);
  const bool zero_is_zero = call.Get<std::int64_t>("allowzero", 0) != 0;
  TensorShape shape = call.Integers(1, "shape");
  const auto open = std::ranges::find(shape, -1);
  for (std::size_t k = 0; k < shape.size(); ++k)
    if (shape[k] == 0 && !zero_is_zero) {
      if (k >= from.size())
        throw NetworkError(fmt::format("expected an axis {} to keep, got shape {}", k, ShapeText(from)));
      shape[k] = from[k];
    }
  if (open != shape.end()) {
    *open = 1;
    const auto known = static_cast<std::int64_t>(NumbersIn(shape));
    if (known == 0) throw NetworkError("expected a length other than 0 beside -1, got 0");
    *open = static_cast<std::int64_t>(NumbersIn(from)) / known;
  }
  return Reshaped(call, std::move(shape));
}

NodePlan PlanFlatten(const NodeCall& call) {
  call.ExpectInputs(1, 1);
  const TensorShape& from = call.Shape(0);
  const auto axis = call.Get<std::int64_t>("axis", 1);
  const std::ptrdiff_t split = axis == std::ssize(from) ? axis : static_cast<std::ptrdiff_t>(AxisOf(axis, from.size()));
  const auto product = [](auto first, auto last) {
    return std::accumulate(first, last, std::int64_t{1}, std::multiplies<>());
  };
  return Reshaped(call, {product(from.begin(), from.begin() + split), product(from.begin() + split, from.end())});
}

NodePlan PlanUnsqueeze(const NodeCall& call) {
  call.ExpectInputs(1, 2);
  const auto axes = call.Axes(/*since=*/13);
  if (!axes) throw NetworkError("expected axes, got none");
  TensorShape shape = call.Shape(0);
  NumbersIn(TensorShape(shape.size() + axes->size(), 1));  // so many axes
  Indices places = AxesOf(*axes, shape.size() + axes->size());
  std::ranges::sort(places);
  for (const std::size_t place : places) shape.insert(shape.begin() + static_cast<std::ptrdiff_t>(place), 1);
  return Reshaped(call, std::move(shape));
}

NodePlan PlanSqueeze(const NodeCall& call) {
  call.ExpectInputs(1, 2);
  const TensorShape& from = call.Shape(0);
  std::vector<bool> goes(from.size(), false);
  if (const auto axes = call.Axes(/*since=*/13))
    for (const std::size_t axis : AxesOf(*axes, from.size())) goes[axis] = true;
  else
    for (std::size_t k = 0; k < from.size(); ++k) goes[k] = from[k] == 1;
  TensorShape shape;
  for (std::size_t k = 0; k < from.size(); ++k) {
    if (goes[k] && from[k] != 1)
      throw NetworkError(fmt::format("expected axes of length 1, got axis {} of {}", k, ShapeText(from)));
    if (!goes[k]) shape.push_back(from[k]);
  }
  return Reshaped(call, std::move(shape));
}

NodePlan PlanTranspose(const NodeCall& call) {
  call.ExpectInputs(1, 1);
  const TensorShape& from = call.Shape(0);
  Integers order(from.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = std::ssize(from) - 1 - static_cast<std::int64_t>(k);
  order = call.Get("perm", order);
  if (order.size() != from.size())
    throw NetworkError(
        fmt::format("expected perm to have each axis of {} once, got {}", ShapeText(from), order.size()));
  const Indices strides = Strides(from);
  TensorShape shape;
  Integers steps;
  for (const std::size_t axis : AxesOf(order, from.size())) {
    shape.push_back(from[axis]);
    steps.push_back(static_cast<std::int64_t>(strides[axis]));
  }
  Indices places = PlacesOf(shape, 0, steps);
  return {.shape = std::move(shape), .kernel = Gather(std::move(places))};
}

/// From where to where a Slice goes along an axis.
struct Span {
  std::int64_t begin = 0, step = 1, length = 0;
};

/// `start` and `end` count from the end if they are negative, and are then clamped to the axis.
Span SpanOf(std::int64_t start, std::int64_t end, std::int64_t step, std::int64_t length) {
  if (step == 0) throw NetworkError("expected steps other than 0, got 0");
  if (length == 0) return {};
  const auto clamped = [length](std::int64_t at, std::int64_t least, std::int64_t most) {
    return std::clamp(at < 0 ? at + length : at, least, most);
  };
  step = std::clamp(step, -length, length);  // one that is longer goes to no second number either
  if (step > 0) {
    const std::int64_t from = clamped(start, 0, length), to = clamped(end, 0, length);
    return {from, step, to > from ? (to - from - 1) / step + 1 : 0};
  }
  const std::int64_t from = clamped(start, 0, length - 1), to = clamped(end, -1, length - 1);
  return {from, step, from > to ? (from - to - 1) / -step + 1 : 0};
}

/// What a Slice takes of its input, as attributes or, from opset 10 on, as inputs.
struct SliceParts {
  Integers starts, ends, axes, steps;
};

SliceParts PartsOf(const NodeCall& call) {
  call.ExpectInputs(1, 5);
  const auto part = [&](std::string_view name, std::size_t k) {
    return call.IsInput(name, k, /*since=*/10) ? call.Integers(k, name) : call.Get(name, Integers());
  };
  SliceParts parts{.starts = part("starts", 1), .ends = part("ends", 2), .axes = {}, .steps = {}};
  parts.axes.resize(parts.starts.size());
  std::iota(parts.axes.begin(), parts.axes.end(), 0);
  parts.steps.assign(parts.starts.size(), 1);
  if (call.Has(3) || call.HasAttribute("axes")) parts.axes = part("axes", 3);
  if (call.Has(4)) parts.steps = call.Integers(4, "steps");
  for (const Integers* const each : {&parts.ends, &parts.axes, &parts.steps})
    if (each->size() != parts.starts.size())
      throw NetworkError("expected as many starts as ends, axes and steps, got other numbers of them");
  return parts;
}

NodePlan PlanSlice(const NodeCall& call) {
  const SliceParts parts = PartsOf(call);
  const TensorShape& from = call.Shape(0);
  const Indices strides = Strides(from), axes = AxesOf(parts.axes, from.size());
  TensorShape shape = from;
  Integers steps(strides.begin(), strides.end());
  std::int64_t first = 0;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const std::size_t axis = axes[k];
    const Span span = SpanOf(parts.starts[k], parts.ends[k], parts.steps[k], from[axis]);
    shape[axis] = span.length;
    first += span.begin * steps[axis];
    steps[axis] *= span.step;
  }
  Indices places = PlacesOf(shape, first, steps);
  return {.shape = std::move(shape), .kernel = Gather(std::move(places))};
}

NodePlan PlanConcat(const NodeCall& call) {
  if (!call.HasAttribute("axis")) throw NetworkError("expected an axis, got none");
  TensorShape shape = call.Shape(0);
  const std::size_t axis = AxisOf(call.Get<std::int64_t>("axis", 0), shape.size());
  for (std::size_t k = 1; k < call.inputs.size(); ++k) {
    const TensorShape& other = call.Shape(k);
    TensorShape same = other;
    if (other.size() == shape.size()) same[axis] = shape[axis];
    if (same != shape)
      throw NetworkError(fmt::format("expected shapes that fit, got {} and {}", ShapeText(shape), ShapeText(other)));
    shape[axis] += other[axis];
  }
  std::size_t outer = 1;
  for (std::size_t k = 0; k < axis; ++k) outer *= static_cast<std::size_t>(shape[k]);
  Indices blocks;  // of each input, for one position of the outer axes
  for (const Operand& input : call.inputs) blocks.push_back(outer > 0 ? NumbersIn(input.shape) / outer : 0);
  return {.shape = std::move(shape), .kernel = [outer, blocks](std::span<const double* const> in, double* out) {
            for (std::size_t row = 0; row < outer; ++row)
              for (std::size_t k = 0; k < blocks.size(); ++k)
                out = std::copy_n(in[k] + row * blocks[k], blocks[k], out);
          }};
}

NodePlan PlanConstant(const NodeCall& call) {
  call.ExpectInputs(0, 0);
  if (call.node.attributes.size() != 1)
    throw NetworkError(fmt::format("expected one value, got {}", call.node.attributes.size()));
  Tensor tensor;
  tensor.is_integer = call.HasAttribute("value_int") || call.HasAttribute("value_ints");
  if (call.HasAttribute("value")) {
    tensor = call.Get<Tensor>("value", {});
  } else if (call.HasAttribute("value_float")) {
    tensor.numbers = {call.Get<double>("value_float", 0)};
  } else if (call.HasAttribute("value_int")) {
    tensor.numbers = {static_cast<double>(call.Get<std::int64_t>("value_int", 0))};
  } else if (call.HasAttribute("value_floats")) {
    tensor.numbers = call.Get<std::vector<double>>("value_floats", {});
    tensor.shape = {std::ssize(tensor.numbers)};
  } else {
    const auto integers = call.Get<Integers>("value_ints", {});
    tensor.numbers.assign(integers.begin(), integers.end());
    tensor.shape = {std::ssize(tensor.numbers)};
  }
  return {.shape = tensor.shape,
          .kernel = [numbers = tensor.numbers](std::span<const double* const>,
                                               double* out) { std::ranges::copy(numbers, out); },
          .is_integer = tensor.is_integer};
}

}  // namespace

std::vector<Operator> MovingOperators() {
  return {
      {.name = "Concat", .plan = PlanConcat, .attributes = {"axis"}, .takes_integers = true},
      {.name = "Constant",
       .plan = PlanConstant,
       .attributes = {"value", "value_float", "value_floats", "value_int", "value_ints"}},
      {.name = "Flatten", .plan = PlanFlatten, .attributes = {"axis"}, .takes_integers = true},
      {.name = "Identity", .plan = PlanIdentity, .takes_integers = true},
      {.name = "Reshape", .plan = PlanReshape, .attributes = {"allowzero"}, .tensors = 1, .takes_integers = true},
      {.name = "Slice",
       .plan = PlanSlice,
       .attributes = {"axes", "ends", "starts"},
       .tensors = 1,
       .takes_integers = true},
      {.name = "Squeeze", .plan = PlanSqueeze, .attributes = {"axes"}, .tensors = 1, .takes_integers = true},
      {.name = "Transpose", .plan = PlanTranspose, .attributes = {"perm"}, .takes_integers = true},
      {.name = "Unsqueeze", .plan = PlanUnsqueeze, .attributes = {"axes"}, .tensors = 1, .takes_integers = true},
  };
}

}  // namespace mascot
