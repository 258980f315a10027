// Networks as files in the format ONNX, node by node.
#pragma once

#include <onnx/onnx_pb.h>

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace mascot::test {

using OnnxAttribute =
    std::variant<std::int64_t, float, std::vector<std::int64_t>, std::vector<float>, std::string, onnx::TensorProto>;
using OnnxAttributes = std::map<std::string, OnnxAttribute>;

inline onnx::TensorProto FloatTensor(const std::vector<std::int64_t>& shape, const std::vector<float>& numbers) {
  onnx::TensorProto tensor;
  tensor.set_data_type(onnx::TensorProto::FLOAT);
  for (const std::int64_t length : shape) tensor.add_dims(length);
  for (const float number : numbers) tensor.add_float_data(number);
  return tensor;
}

inline onnx::TensorProto IntegerTensor(const std::vector<std::int64_t>& integers) {
  onnx::TensorProto tensor;
  tensor.set_data_type(onnx::TensorProto::INT64);
  tensor.add_dims(static_cast<std::int64_t>(integers.size()));
  for (const std::int64_t integer : integers) tensor.add_int64_data(integer);
  return tensor;
}

class OnnxModel {
 public:
  /// A network whose input `x` is a row of this many numbers.
  explicit OnnxModel(int inputs, int opset = 14) {
    model_.set_ir_version(7);
    model_.add_opset_import()->set_version(opset);
    Port(*graph().add_input(), "x", {1, inputs});
  }
  onnx::ModelProto& model() { return model_; }
  onnx::GraphProto& graph() { return *model_.mutable_graph(); }

  OnnxModel& Initializer(const std::string& name, onnx::TensorProto tensor) {
    tensor.set_name(name);
    *graph().add_initializer() = std::move(tensor);
    return *this;
  }
  OnnxModel& Numbers(const std::string& name, const std::vector<std::int64_t>& shape,
                     const std::vector<float>& numbers) {
    return Initializer(name, FloatTensor(shape, numbers));
  }
  /// A list of integers.
  OnnxModel& Integers(const std::string& name, const std::vector<std::int64_t>& integers) {
    return Initializer(name, IntegerTensor(integers));
  }
  OnnxModel& Node(const std::string& op, const std::vector<std::string>& inputs, const std::string& output,
                  const OnnxAttributes& attributes = {}) {
    onnx::NodeProto& node = *graph().add_node();
    node.set_op_type(op);
    for (const std::string& input : inputs) node.add_input(input);
    node.add_output(output);
    for (const auto& [name, value] : attributes) {
      onnx::AttributeProto& attribute = *node.add_attribute();
      attribute.set_name(name);
      std::visit([&](const auto& each) { Set(attribute, each); }, value);
    }
    return *this;
  }
  OnnxModel& Output(const std::string& name, int numbers) {
    Port(*graph().add_output(), name, {1, numbers});
    return *this;
  }
  OnnxModel& Metadata(const std::string& key, const std::string& value) {
    onnx::StringStringEntryProto& entry = *model_.add_metadata_props();
    entry.set_key(key);
    entry.set_value(value);
    return *this;
  }
  std::string Bytes() const { return model_.SerializeAsString(); }

 private:
  static void Set(onnx::AttributeProto& attribute, std::int64_t integer) {
    attribute.set_type(onnx::AttributeProto::INT);
    attribute.set_i(integer);
  }
  static void Set(onnx::AttributeProto& attribute, float number) {
    attribute.set_type(onnx::AttributeProto::FLOAT);
    attribute.set_f(number);
  }
  static void Set(onnx::AttributeProto& attribute, const std::vector<std::int64_t>& integers) {
    attribute.set_type(onnx::AttributeProto::INTS);
    for (const std::int64_t integer : integers) attribute.add_ints(integer);
  }
  static void Set(onnx::AttributeProto& attribute, const std::vector<float>& numbers) {
    attribute.set_type(onnx::AttributeProto::FLOATS);
    for (const float number : numbers) attribute.add_floats(number);
  }
  static void Set(onnx::AttributeProto& attribute, const std::string& text) {
    attribute.set_type(onnx::AttributeProto::STRING);
    attribute.set_s(text);
  }
  static void Set(onnx::AttributeProto& attribute, const onnx::TensorProto& tensor) {
    attribute.set_type(onnx::AttributeProto::TENSOR);
    *attribute.mutable_t() = tensor;
  }
  static void Port(onnx::ValueInfoProto& port, const std::string& name, const std::vector<int>& shape) {
    port.set_name(name);
    onnx::TypeProto::Tensor& tensor = *port.mutable_type()->mutable_tensor_type();
    tensor.set_elem_type(onnx::TensorProto::FLOAT);
    for (const int length : shape) tensor.mutable_shape()->add_dim()->set_dim_value(length);
  }
  onnx::ModelProto model_;
};

/// The consensus law as a network, for a team whose agents have so many places (agent/laws/parts/observation.h) without
/// messages: a = p_gain sum_j a_ij (p_j - p_i) - beta v.
inline OnnxModel ConsensusNetwork(int places, float p_gain, float beta) {
  OnnxModel model(10 + 9 * places);
  model.Integers("3", {3}).Integers("6", {6}).Integers("7", {7}).Integers("10", {10}).Integers("end", {1 << 20});
  model.Integers("0", {0}).Integers("1", {1}).Integers("shape", {places, 9});
  model.Numbers("p_gain", {1}, {p_gain}).Numbers("beta", {1}, {beta});
  model.Node("Slice", {"x", "3", "6", "1"}, "v")
      .Node("Slice", {"x", "10", "end", "1"}, "heard")
      .Node("Reshape", {"heard", "shape"}, "neighbours")
      .Node("Slice", {"neighbours", "0", "3", "1"}, "away")
      .Node("Slice", {"neighbours", "6", "7", "1"}, "weights")
      .Node("Mul", {"away", "weights"}, "pulls")
      .Node("ReduceSum", {"pulls", "0"}, "pull", {{"keepdims", 1}})
      .Node("Mul", {"pull", "p_gain"}, "towards")
      .Node("Mul", {"v", "beta"}, "damping")
      .Node("Sub", {"towards", "damping"}, "a");
  return model.Output("a", 3);
}

}  // namespace mascot::test
