#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "agent/network/operators.h"

namespace mascot {

using Indices = std::vector<std::size_t>;

/// A node and what is known of its inputs, with readers that check.
struct NodeCall {
  const NetworkNode& node;
  std::int64_t opset;
  std::span<const Operand> inputs;

  bool Has(std::size_t k) const { return k < inputs.size() && inputs[k].is_there; }
  const Operand& Input(std::size_t k) const;
  const TensorShape& Shape(std::size_t k) const { return Input(k).shape; }
  /// Throws unless there are so many inputs, of which the first `least` are not left out.
  void ExpectInputs(std::size_t least, std::size_t most) const;
  /// An attribute of this kind, or `otherwise` if the node has none of this name.
  template <class Kind>
  Kind Get(std::string_view name, Kind otherwise) const {
    const auto found = node.attributes.find(name);
    if (found == node.attributes.end()) return otherwise;
    const Kind* const value = std::get_if<Kind>(&found->second);
    if (value == nullptr) throw NetworkError(WrongType(name));
    return *value;
  }
  bool HasAttribute(std::string_view name) const { return node.attributes.contains(name); }
  /// The numbers of input `k`, which must be constant. `what` they are, in messages.
  const Tensor& Constant(std::size_t k, std::string_view what) const;
  /// The same, of integers.
  std::vector<std::int64_t> Integers(std::size_t k, std::string_view what) const;
  /// Whether this parameter is input `k`, as from opset `since` on, or an attribute, as before. Throws if the node has
  /// it in the other way.
  bool IsInput(std::string_view what, std::size_t k, std::int64_t since) const;
  /// `axes`: input 1 from opset `since` on; nothing: the node has none.
  std::optional<std::vector<std::int64_t>> Axes(std::int64_t since) const;

 private:
  static std::string WrongType(std::string_view name);
};

std::string ShapeText(const TensorShape& shape);

/// The axis of this number, which counts from the last one if it is negative.
std::size_t AxisOf(std::int64_t axis, std::size_t rank);
/// The axes of these numbers, in the same order. Throws if one comes twice.
Indices AxesOf(const std::vector<std::int64_t>& axes, std::size_t rank);

/// Steps between the numbers of each axis.
Indices Strides(const TensorShape& shape);

/// The shape to which two shapes are broadcast.
TensorShape Broadcast(const TensorShape& a, const TensorShape& b);

/// Where each number of a tensor of this shape stands in another one: `first`, and `steps[k]` further for each position
/// of axis k.
Indices PlacesOf(const TensorShape& shape, std::int64_t first, const std::vector<std::int64_t>& steps);
/// Where in a tensor of shape `from` each number of `shape`, to which it is broadcast, stands.
Indices PlacesIn(const TensorShape& from, const TensorShape& shape);

/// An operator of networks.
struct Operator {
  std::string_view name;
  NodePlan (*plan)(const NodeCall& call);
  std::vector<std::string_view> attributes = {};  ///< those that it knows
  std::size_t tensors =
      std::numeric_limits<std::size_t>::max();  ///< how many of its inputs are no parameters: the first ones
  bool takes_integers = false;                  ///< whether these may be integers, as its output then is
};

// The operators, by kind: each list is a file of its own.
std::vector<Operator> MovingOperators();
std::vector<Operator> OperatorsOfEachNumber();
std::vector<Operator> ProductOperators();
std::vector<Operator> OperatorsOverAxes();

}  // namespace mascot
