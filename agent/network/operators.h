#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "agent/network/graph.h"

namespace mascot {

/// Computes a node: reads the numbers of its inputs (null: left out), and writes those of its output.
using NodeKernel = std::function<void(std::span<const double* const> inputs, double* output)>;

/// What is known of an input of a node before numbers come in.
struct Operand {
  TensorShape shape;
  const Tensor* constant = nullptr;  ///< its numbers, if they are always the same; null: they are not
  bool is_integer = false;
  bool is_there = true;  ///< false: it is left out
};

/// How a node is computed.
struct NodePlan {
  TensorShape shape;  ///< of its output
  NodeKernel kernel;
  std::size_t products = 0;  ///< multiplications of numbers in it, to know what it costs
  bool is_integer = false;   ///< whether its output has integers
};

/// Plans a node, by the rules of its operator in ONNX, for inputs of these shapes. A kernel computes in a fixed order,
/// by functions whose bits are the same on every processor (base/libm.cc), and allocates nothing. Throws NetworkError
/// if the operator is not known here, or the node breaks its rules.
NodePlan PlanNode(const NetworkNode& node, std::int64_t opset, std::span<const Operand> inputs);

/// The names of the operators that PlanNode() knows: "Add, Clip, ...".
std::string OperatorNames();

}  // namespace mascot
