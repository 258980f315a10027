#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "agent/network/graph.h"
#include "agent/network/operators.h"

namespace mascot {

/// A feed-forward network that takes one row of numbers and answers with one, as read from a file of the format ONNX.
/// Numbers are computed as double, whatever the file's are, in the order of the file, to the same bits on every
/// processor. A network does not change: threads may share it.
class Network {
 public:
  /// Reads `file`, the contents of a file. Throws NetworkError with the node, if it is one of a node.
  static Network FromOnnx(std::string_view file);
  explicit Network(const NetworkGraph& graph);

  std::size_t inputs() const { return inputs_; }
  std::size_t outputs() const { return outputs_; }
  /// Additional words in the file, by key (ONNX: metadata_props).
  const std::map<std::string, std::string>& metadata() const { return metadata_; }

  /// Memory for the numbers between the nodes. Each thread needs one of its own.
  class Scratch {
   private:
    friend class Network;
    std::vector<double> numbers;
    std::vector<const double*> operands;
  };
  Scratch MakeScratch() const;
  /// The network's answer to `input`, which has inputs() numbers: outputs() numbers, valid until the next call with
  /// this scratch. Does not allocate.
  std::span<const double> Answer(std::span<const double> input, Scratch& scratch) const;

 private:
  /// Where the numbers of a tensor are: among the constants, or in the scratch.
  struct Place {
    bool is_constant = false;
    bool is_there = true;  // false: an input that is left out
    std::size_t offset = 0;
  };
  struct Step {
    NodeKernel kernel;
    std::vector<Place> inputs;
    std::size_t output = 0;  // offset in the scratch
  };
  struct Compiler;

  std::size_t inputs_ = 0, outputs_ = 0;
  std::map<std::string, std::string> metadata_;
  std::vector<double> constants_;
  std::vector<Step> steps_;
  Place output_;
  std::size_t scratch_ = 0;  // numbers in it; the input comes first
  std::size_t most_operands_ = 0;
};

}  // namespace mascot
