#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace mascot {

/// What is wrong with a network, in words; without the name of its file. Names out of the file are made fit for a line
/// (PlainLine), and a long text is shortened.
class NetworkError : public std::runtime_error {
 public:
  explicit NetworkError(std::string_view text);
};

/// Lengths of the axes of a tensor, the outermost first. None: one number.
using TensorShape = std::vector<std::int64_t>;

/// How many numbers a tensor of this shape has. Throws NetworkError if it has more axes than kMaxAxes, or if its
/// lengths other than 0 make more numbers than kMaxNumbers.
std::size_t NumbersIn(const TensorShape& shape);
inline constexpr std::size_t kMaxAxes = 16, kMaxNumbers = std::size_t{1} << 20;

/// Numbers in row-major order.
struct Tensor {
  TensorShape shape;
  std::vector<double> numbers;
  bool is_integer = false;
};

/// The value of an attribute of a node: of a kind that networks of numbers use.
using Attribute = std::variant<double, std::int64_t, std::vector<double>, std::vector<std::int64_t>, Tensor>;

/// An operation of a network (ONNX: NodeProto).
struct NetworkNode {
  std::string name;                 ///< for messages; may be empty
  std::string op;                   ///< "Gemm"
  std::vector<std::string> inputs;  ///< names of tensors; empty: this input is left out
  std::vector<std::string> outputs;
  std::map<std::string, Attribute, std::less<>> attributes;

  /// What messages call it: "Gemm", with its name if it has one.
  std::string Title() const;
};

/// A network as a file has it, in the terms of ONNX: nothing is checked but that it is of this form.
struct NetworkGraph {
  std::int64_t opset = 0;  ///< version of the operators (ONNX: opset_import of the default domain)
  std::vector<NetworkNode> nodes;
  std::map<std::string, Tensor> constants;  ///< tensors with given numbers (ONNX: initializer), by name
  struct Port {
    std::string name;
    TensorShape shape;  ///< -1: the length of this axis is not given
  };
  std::vector<Port> inputs;  ///< without constants
  std::vector<Port> outputs;
  std::map<std::string, std::string> metadata;
};

/// Reads a file of the format ONNX. Throws NetworkError if it is none, or needs more than this program knows: other
/// domains of operators, subgraphs, sparse or quantised numbers, numbers in other files.
NetworkGraph ReadOnnx(std::string_view bytes);

}  // namespace mascot
