// Operators that compute each number of their output from one number of each input.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "agent/network/node_call.h"

namespace mascot {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Function>
NodePlan EachNumber(const NodeCall& call, Function function) {
  const std::size_t numbers = NumbersIn(call.Shape(0));
  return {.shape = call.Shape(0), .kernel = [numbers, function](std::span<const double* const> in, double* out) {
            for (std::size_t k = 0; k < numbers; ++k) out[k] = function(in[0][k]);
          }};
}

/// An operator of one input, without attributes.
template <double (*function)(double)>
NodePlan PlanEach(const NodeCall& call) {
  call.ExpectInputs(1, 1);
  return EachNumber(call, [](double x) { return function(x); });
}

double Abs(double x) { return std::abs(x); }
double Exp(double x) { return std::exp(x); }
double Negative(double x) { return -x; }
double Relu(double x) { return x > 0 || std::isnan(x) ? x : 0.0; }
double Sqrt(double x) { return std::sqrt(x); }
double Tanh(double x) { return std::tanh(x); }
double Sigmoid(double x) {
  if (x >= 0) return 1 / (1 + std::exp(-x));
  const double e = std::exp(x);
  return e / (1 + e);
}
double Softplus(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }

NodePlan PlanLeakyRelu(const NodeCall& call) {
  call.ExpectInputs(1, 1);
  return EachNumber(call, [alpha = call.Get<double>("alpha", 0.01f)](double x) { return x < 0 ? alpha * x : x; });
}

NodePlan PlanElu(const NodeCall& call) {
  call.ExpectInputs(1, 1);
  return EachNumber(call,
                    [alpha = call.Get<double>("alpha", 1)](double x) { return x < 0 ? alpha * std::expm1(x) : x; });
}

NodePlan PlanClip(const NodeCall& call) {
  call.ExpectInputs(1, 3);
  const auto limit = [&](std::size_t k, std::string_view name, double otherwise) {
    if (!call.IsInput(name, k, /*since=*/11)) return call.Get<double>(name, otherwise);
    if (!call.Has(k)) return otherwise;
    const Tensor& tensor = call.Constant(k, name);
    if (tensor.numbers.size() != 1)
      throw NetworkError(fmt::format("expected one number as {}, got {}", name, tensor.numbers.size()));
    return tensor.numbers[0];
  };
  const double least = limit(1, "min", -kInfinity), most = limit(2, "max", kInfinity);
  return EachNumber(call, [=](double x) { return std::isnan(x) ? x : std::min(std::max(x, least), most); });
}

template <class Function>
NodePlan PlanBinary(const NodeCall& call) {
  call.ExpectInputs(2, 2);
  const TensorShape &a = call.Shape(0), &b = call.Shape(1);
  const TensorShape shape = Broadcast(a, b);
  if (a == b)
    return {.shape = shape, .kernel = [numbers = NumbersIn(shape)](std::span<const double* const> in, double* out) {
              for (std::size_t k = 0; k < numbers; ++k) out[k] = Function()(in[0][k], in[1][k]);
            }};
  return {
      .shape = shape,
      .kernel = [in_a = PlacesIn(a, shape), in_b = PlacesIn(b, shape)](std::span<const double* const> in, double* out) {
        for (std::size_t k = 0; k < in_a.size(); ++k) out[k] = Function()(in[0][in_a[k]], in[1][in_b[k]]);
      }};
}

}  // namespace

std::vector<Operator> OperatorsOfEachNumber() {
  return {
      {.name = "Abs", .plan = PlanEach<Abs>},
      {.name = "Add", .plan = PlanBinary<std::plus<>>},
      {.name = "Clip", .plan = PlanClip, .attributes = {"max", "min"}},
      {.name = "Div", .plan = PlanBinary<std::divides<>>},
      {.name = "Elu", .plan = PlanElu, .attributes = {"alpha"}},
      {.name = "Exp", .plan = PlanEach<Exp>},
      {.name = "LeakyRelu", .plan = PlanLeakyRelu, .attributes = {"alpha"}},
      {.name = "Mul", .plan = PlanBinary<std::multiplies<>>},
      {.name = "Neg", .plan = PlanEach<Negative>},
      {.name = "Relu", .plan = PlanEach<Relu>},
      {.name = "Sigmoid", .plan = PlanEach<Sigmoid>},
      {.name = "Softplus", .plan = PlanEach<Softplus>},
      {.name = "Sqrt", .plan = PlanEach<Sqrt>},
      {.name = "Sub", .plan = PlanBinary<std::minus<>>},
      {.name = "Tanh", .plan = PlanEach<Tanh>},
  };
}

}  // namespace mascot
