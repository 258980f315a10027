// Operators over axes: each number of their output is computed from all numbers along some axes of the input.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "agent/network/node_call.h"

namespace mascot {
namespace {

/// Where each number of the input goes in the output of a reduction.
struct Reduction {
  TensorShape shape;
  Indices places;
  std::size_t each = 1;  // numbers of the input for each of the output
};

/// `since`: the opset from which on the axes are an input.
Reduction ReductionOf(const NodeCall& call, std::int64_t since) {
  call.ExpectInputs(1, 2);
  const TensorShape& from = call.Shape(0);
  const auto axes = call.Axes(since).value_or(std::vector<std::int64_t>());
  const bool keeps = call.Get<std::int64_t>("keepdims", 1) != 0;
  const bool all_if_none = call.Get<std::int64_t>("noop_with_empty_axes", 0) == 0;
  std::vector<bool> goes(from.size(), axes.empty() && all_if_none);
  for (const std::size_t axis : AxesOf(axes, from.size())) goes[axis] = true;
  Reduction reduction;
  TensorShape kept = from;
  for (std::size_t k = 0; k < from.size(); ++k) {
    if (goes[k]) reduction.each *= static_cast<std::size_t>(from[k]);
    if (goes[k]) kept[k] = 1;
    if (!goes[k] || keeps) reduction.shape.push_back(kept[k]);
  }
  reduction.places = PlacesIn(kept, from);
  return reduction;
}

template <class Function>
NodePlan PlanReduce(const NodeCall& call, std::int64_t since, double first, bool is_mean, Function function) {
  Reduction reduction = ReductionOf(call, since);
  const std::size_t numbers = NumbersIn(reduction.shape);
  return {.shape = reduction.shape,
          .kernel = [=, places = std::move(reduction.places), each = static_cast<double>(reduction.each)](
                        std::span<const double* const> in, double* out) {
            std::fill_n(out, numbers, first);
            for (std::size_t k = 0; k < places.size(); ++k) out[places[k]] = function(out[places[k]], in[0][k]);
            if (is_mean)
              for (std::size_t k = 0; k < numbers; ++k) out[k] /= each;
          }};
}

NodePlan PlanReduceSum(const NodeCall& call) { return PlanReduce(call, 13, 0, false, std::plus<>()); }
NodePlan PlanReduceMean(const NodeCall& call) { return PlanReduce(call, 18, 0, true, std::plus<>()); }
NodePlan PlanReduceMax(const NodeCall& call) {
  return PlanReduce(call, 18, -std::numeric_limits<double>::infinity(), false,
                    [](double a, double b) { return std::isnan(b) || b > a ? b : a; });
}

NodePlan PlanSoftmax(const NodeCall& call) {
  call.ExpectInputs(1, 1);
  const TensorShape& shape = call.Shape(0);
  const std::size_t axis = AxisOf(call.Get<std::int64_t>("axis", call.opset < 13 ? 1 : -1), shape.size());
  if (call.opset < 13 && axis + 1 != shape.size())
    throw NetworkError(
        fmt::format("expected the last axis with an opset below 13, got axis {} of {}", axis, ShapeText(shape)));
  const auto length = static_cast<std::size_t>(shape[axis]), step = Strides(shape)[axis], numbers = NumbersIn(shape);
  return {.shape = shape, .kernel = [=](std::span<const double* const> in, double* out) {
            for (std::size_t first = 0; first < numbers; ++first) {
              if (first / step % length != 0) continue;
              double largest = -std::numeric_limits<double>::infinity(), sum = 0;
              for (std::size_t k = 0; k < length; ++k) largest = std::max(largest, in[0][first + k * step]);
              for (std::size_t k = 0; k < length; ++k) {
                const double e = std::exp(in[0][first + k * step] - largest);
                out[first + k * step] = e;
                sum += e;
              }
              for (std::size_t k = 0; k < length; ++k) out[first + k * step] /= sum;
            }
          }};
}

}  // namespace

std::vector<Operator> OperatorsOverAxes() {
  const std::vector<std::string_view> attributes = {"axes", "keepdims", "noop_with_empty_axes"};
  return {
      {.name = "ReduceMax", .plan = PlanReduceMax, .attributes = attributes, .tensors = 1},
      {.name = "ReduceMean", .plan = PlanReduceMean, .attributes = attributes, .tensors = 1},
      {.name = "ReduceSum", .plan = PlanReduceSum, .attributes = attributes, .tensors = 1},
      {.name = "Softmax", .plan = PlanSoftmax, .attributes = {"axis"}},
  };
}

}  // namespace mascot
