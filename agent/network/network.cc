#include "agent/network/network.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "agent/network/node_call.h"

namespace mascot {
namespace {

constexpr std::int64_t kOldestOpset = 9, kNewestOpset = 21;
constexpr std::size_t kMaxNodes = 10'000, kMaxProducts = std::size_t{1} << 26, kMaxWork = std::size_t{1} << 22;

/// The length of a row of numbers: [n], or [1, n] where the length of the first axis may be left open.
std::size_t RowLength(const NetworkGraph::Port& port, std::string_view what) {
  const TensorShape& shape = port.shape;
  const bool fits = (shape.size() == 1 || (shape.size() == 2 && (shape[0] == 1 || shape[0] == -1))) && shape.back() > 0;
  if (!fits)
    throw NetworkError(fmt::format("{} {}: expected one row of numbers, [n] or [batch, n], got {}", what, port.name,
                                   ShapeText(shape)));
  return NumbersIn({shape.back()});
}

const NetworkGraph::Port& TheOnly(const std::vector<NetworkGraph::Port>& ports, std::string_view what) {
  if (ports.size() != 1) throw NetworkError(fmt::format("expected one {}, got {}", what, ports.size()));
  return ports.front();
}

}  // namespace

/// Plans the nodes in the order of the file, with constants computed once.
struct Network::Compiler {
  const NetworkGraph& graph;
  Network& network;
  struct Known {
    Operand operand;
    Place place;
  };
  const Known kLeftOut = {{.shape = {}, .is_there = false}, {.is_there = false}};
  std::map<std::string, Known> known = {};       // tensors, by name
  std::map<std::string, Tensor> constants = {};  // those that are computed from constants
  std::size_t products = 0, work = 0;            // of the nodes so far; work: numbers that are read and written

  void Compile() {
    if (graph.opset < kOldestOpset || graph.opset > kNewestOpset)
      throw NetworkError(fmt::format("expected operators of version (opset) {} to {}, got {}", kOldestOpset,
                                     kNewestOpset, graph.opset));
    if (graph.nodes.size() > kMaxNodes)
      throw NetworkError(fmt::format("expected at most {} nodes, got {}", kMaxNodes, graph.nodes.size()));
    for (const auto& [name, tensor] : graph.constants) AddConstant(name, tensor);
    const NetworkGraph::Port& input = TheOnly(graph.inputs, "input");
    network.inputs_ = RowLength(input, "input");
    TensorShape shape = input.shape;
    if (shape.size() == 2) shape[0] = 1;
    known[input.name] = {{.shape = shape}, {.offset = 0}};
    network.scratch_ = network.inputs_;
    for (std::size_t k = 0; k < graph.nodes.size(); ++k) {
      try {
        AddNode(graph.nodes[k]);
      } catch (const NetworkError& error) {
        throw NetworkError(fmt::format("node {} ({}): {}", k + 1, graph.nodes[k].Title(), error.what()));
      }
    }
    const NetworkGraph::Port& output = TheOnly(graph.outputs, "output");
    const Known& answer = Find(output.name);
    network.outputs_ = RowLength({output.name, answer.operand.shape}, "output");
    network.output_ = answer.place;
  }

  const Known& Find(const std::string& name) const {
    const auto found = known.find(name);
    if (found == known.end())
      throw NetworkError(fmt::format("expected a tensor {} from a node before, got none", name));
    return found->second;
  }

  void AddConstant(const std::string& name, const Tensor& tensor) {
    known[name] = {{.shape = tensor.shape, .constant = &tensor, .is_integer = tensor.is_integer},
                   {.is_constant = true, .offset = network.constants_.size()}};
    network.constants_.insert(network.constants_.end(), tensor.numbers.begin(), tensor.numbers.end());
    if (network.constants_.size() > kMaxNumbers)
      throw NetworkError(fmt::format("expected at most {} constant numbers, got more", kMaxNumbers));
  }

  void AddNode(const NetworkNode& node) {
    if (node.outputs.size() != 1) throw NetworkError(fmt::format("expected one output, got {}", node.outputs.size()));
    std::vector<Operand> operands;
    std::vector<Place> places;
    for (const std::string& name : node.inputs) {
      const Known input = name.empty() ? kLeftOut : Find(name);
      operands.push_back(input.operand);
      places.push_back(input.place);
    }
    NodePlan plan = PlanNode(node, graph.opset, operands);
    Charge(operands, plan);
    if (known.contains(node.outputs[0]))
      throw NetworkError(fmt::format("expected a new name for its output, got {}", node.outputs[0]));
    network.most_operands_ = std::max(network.most_operands_, places.size());
    if (std::ranges::all_of(operands, [](const Operand& each) { return !each.is_there || each.constant != nullptr; })) {
      Tensor& tensor = constants[node.outputs[0]];
      tensor = {plan.shape, std::vector<double>(NumbersIn(plan.shape)), plan.is_integer};
      std::vector<const double*> values;
      for (const Operand& each : operands)
        values.push_back(each.constant != nullptr ? each.constant->numbers.data() : nullptr);
      plan.kernel(values, tensor.numbers.data());
      AddConstant(node.outputs[0], tensor);
      return;
    }
    known[node.outputs[0]] = {{.shape = plan.shape, .is_integer = plan.is_integer}, {.offset = network.scratch_}};
    network.steps_.push_back({std::move(plan.kernel), std::move(places), network.scratch_});
    network.scratch_ += NumbersIn(plan.shape);
  }

  /// Adds what a node takes, of which memory and time are a part, to that of the others.
  void Charge(const std::vector<Operand>& operands, const NodePlan& plan) {
    products += plan.products;
    if (products > kMaxProducts)
      throw NetworkError(fmt::format("expected at most {} products of numbers in the network, got more", kMaxProducts));
    work += NumbersIn(plan.shape);
    for (const Operand& each : operands) work += NumbersIn(each.shape);
    if (work > kMaxWork)
      throw NetworkError(fmt::format("expected nodes that read and write at most {} numbers, got more", kMaxWork));
  }
};

Network Network::FromOnnx(std::string_view file) { return Network(ReadOnnx(file)); }

Network::Network(const NetworkGraph& graph) : metadata_(graph.metadata) {
  Compiler{.graph = graph, .network = *this}.Compile();
}

Network::Scratch Network::MakeScratch() const {
  Scratch scratch;
  scratch.numbers.resize(scratch_);
  scratch.operands.resize(most_operands_);
  return scratch;
}

std::span<const double> Network::Answer(std::span<const double> input, Scratch& scratch) const {
  std::ranges::copy(input, scratch.numbers.begin());
  const auto numbers_at = [&](const Place& place) {
    return !place.is_there ? nullptr : (place.is_constant ? constants_.data() : scratch.numbers.data()) + place.offset;
  };
  for (const Step& step : steps_) {
    std::ranges::transform(step.inputs, scratch.operands.begin(), numbers_at);
    step.kernel(std::span(scratch.operands).first(step.inputs.size()), scratch.numbers.data() + step.output);
  }
  return {numbers_at(output_), outputs_};
}

}  // namespace mascot
