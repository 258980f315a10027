#include "agent/network/operators.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "agent/network/node_call.h"

namespace mascot {
namespace {

/// All operators, by name.
const std::vector<Operator>& Operators() {
  static const std::vector<Operator> kOperators = [] {
    std::vector<Operator> all;
    for (const auto& kind : {MovingOperators(), OperatorsOfEachNumber(), ProductOperators(), OperatorsOverAxes()})
      all.insert(all.end(), kind.begin(), kind.end());
    std::ranges::sort(all, {}, &Operator::name);
    return all;
  }();
  return kOperators;
}

void CheckAttributes(const NetworkNode& node, const Operator& of) {
  for (const auto& [name, value] : node.attributes)
    if (std::ranges::find(of.attributes, std::string_view(name)) == of.attributes.end())
      throw NetworkError(fmt::format("expected no attribute {}, got one", name));
}

/// Whether the operator's tensors are integers. Throws if it takes none, or if they differ.
bool AreIntegers(std::span<const Operand> inputs, const Operator& of) {
  bool some = false, all = true;
  for (std::size_t k = 0; k < std::min(inputs.size(), of.tensors); ++k) {
    if (!inputs[k].is_there) continue;
    some = some || inputs[k].is_integer;
    all = all && inputs[k].is_integer;
  }
  if (some && !of.takes_integers) throw NetworkError("expected floating-point numbers, got integers");
  if (some && !all) throw NetworkError("expected tensors of one type, got integers and floating-point numbers");
  return some;
}

}  // namespace

NodePlan PlanNode(const NetworkNode& node, std::int64_t opset, std::span<const Operand> inputs) {
  const auto found = std::ranges::find(Operators(), std::string_view(node.op), &Operator::name);
  if (found == Operators().end())
    throw NetworkError(fmt::format("expected one of {}, got {}", OperatorNames(), node.op));
  CheckAttributes(node, *found);
  const bool are_integers = AreIntegers(inputs, *found);
  NodePlan plan = found->plan({node, opset, inputs});
  NumbersIn(plan.shape);
  plan.is_integer = plan.is_integer || are_integers;
  return plan;
}

std::string OperatorNames() {
  std::string names;
  for (const Operator& each : Operators()) names += fmt::format("{}{}", names.empty() ? "" : ", ", each.name);
  return names;
}

}  // namespace mascot
