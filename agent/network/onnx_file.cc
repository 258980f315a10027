#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>
#include <optional>
#include <protozero/pbf_reader.hpp>
#include <span>
#include <utility>

#include "agent/network/graph.h"
#include "base/utf8.h"

namespace mascot {
namespace {

static_assert(std::endian::native == std::endian::little, "raw data of ONNX is little-endian");

using Reader = protozero::pbf_reader;
using Wire = protozero::pbf_wire_type;

// Fields of the messages of onnx.proto: the number of each, and how it is encoded.
constexpr std::uint32_t Bytes(std::uint32_t number) { return tag_and_type(number, Wire::length_delimited); }
constexpr std::uint32_t Integer(std::uint32_t number) { return tag_and_type(number, Wire::varint); }
constexpr std::uint32_t Float(std::uint32_t number) { return tag_and_type(number, Wire::fixed32); }
constexpr std::uint32_t Double(std::uint32_t number) { return tag_and_type(number, Wire::fixed64); }

/// Calls `read(field)` for each field of a message. `read` takes its value from `message`, and returns false for a
/// field that it does not know.
template <class Read>
void ReadFields(Reader& message, Read&& read) {
  while (message.next())
    if (!read(message.tag_and_type())) message.skip();
}

template <class Range>
void Append(std::vector<double>& numbers, const Range& range) {
  for (const auto number : range) numbers.push_back(static_cast<double>(number));
}

constexpr int kFloat = 1, kInt32 = 6, kInt64 = 7, kDouble = 11;  // TensorProto.DataType
constexpr const char* kDataTypes[] = {"UNDEFINED", "FLOAT",  "UINT8",     "INT8",       "UINT16",  "INT16",
                                      "INT32",     "INT64",  "STRING",    "BOOL",       "FLOAT16", "DOUBLE",
                                      "UINT32",    "UINT64", "COMPLEX64", "COMPLEX128", "BFLOAT16"};

/// The name of a value of an enumeration whose names begin at 0.
std::string NameOf(std::span<const char* const> names, int value) {
  return value >= 0 && value < std::ssize(names) ? names[static_cast<std::size_t>(value)]
                                                 : fmt::format("type {}", value);
}

/// The numbers of `raw`, which are of type Number.
template <class Number>
std::vector<double> FromRaw(std::string_view raw) {
  if (raw.size() % sizeof(Number) != 0)
    throw NetworkError(fmt::format("expected numbers of {} bytes, got {} bytes", sizeof(Number), raw.size()));
  std::vector<double> numbers(raw.size() / sizeof(Number));
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    Number number;
    std::memcpy(&number, raw.data() + k * sizeof(Number), sizeof(Number));
    numbers[k] = static_cast<double>(number);
  }
  return numbers;
}

std::string_view ViewOf(Reader& message) {
  const protozero::data_view view = message.get_view();
  return {view.data(), view.size()};
}

/// TensorProto.
struct TensorFields {
  std::string name;
  TensorShape dims;
  int data_type = 0;
  bool is_elsewhere = false;  // its numbers are in another file, or in several parts
  std::optional<std::string_view> raw_data;
  std::vector<double> float_data, int32_data, int64_data, double_data;

  explicit TensorFields(Reader message) {
    ReadFields(message, [&](std::uint32_t field) {
      switch (field) {
        case Integer(1):
          dims.push_back(message.get_int64());
          break;
        case Bytes(1):
          std::ranges::copy(message.get_packed_int64(), std::back_inserter(dims));
          break;
        case Integer(2):
          data_type = message.get_int32();
          break;
        case Bytes(3):
          is_elsewhere = true;
          message.skip();
          break;
        case Float(4):
          float_data.push_back(static_cast<double>(message.get_float()));
          break;
        case Bytes(4):
          Append(float_data, message.get_packed_float());
          break;
        case Integer(5):
          int32_data.push_back(message.get_int32());
          break;
        case Bytes(5):
          Append(int32_data, message.get_packed_int32());
          break;
        case Integer(7):
          int64_data.push_back(static_cast<double>(message.get_int64()));
          break;
        case Bytes(7):
          Append(int64_data, message.get_packed_int64());
          break;
        case Bytes(8):
          name = message.get_string();
          break;
        case Bytes(9):
          raw_data = ViewOf(message);
          break;
        case Double(10):
          double_data.push_back(message.get_double());
          break;
        case Bytes(10):
          Append(double_data, message.get_packed_double());
          break;
        case Integer(14):
          is_elsewhere = is_elsewhere || message.get_int32() != 0;
          break;
        default:
          return false;
      }
      return true;
    });
  }

  std::vector<double> Numbers() const {
    switch (data_type) {
      case kFloat:
        return raw_data ? FromRaw<float>(*raw_data) : float_data;
      case kInt32:
        return raw_data ? FromRaw<std::int32_t>(*raw_data) : int32_data;
      case kInt64:
        return raw_data ? FromRaw<std::int64_t>(*raw_data) : int64_data;
      case kDouble:
        return raw_data ? FromRaw<double>(*raw_data) : double_data;
      default:
        throw NetworkError(fmt::format("expected numbers of type FLOAT, DOUBLE, INT64 or INT32, got {}",
                                       NameOf(kDataTypes, data_type)));
    }
  }
};

/// Adds what is wrong with a part of the file to its name.
template <class Make>
auto Named(const std::string& what, Make&& make) {
  try {
    return make();
  } catch (const NetworkError& error) {
    throw NetworkError(fmt::format("{}: {}", what, error.what()));
  }
}

Tensor ToTensor(const TensorFields& from) {
  return Named("tensor " + from.name, [&] {
    if (from.is_elsewhere) throw NetworkError("expected its numbers in this file, got another file");
    const std::size_t expected = NumbersIn(from.dims);
    Tensor tensor{.shape = from.dims,
                  .numbers = from.Numbers(),
                  .is_integer = from.data_type == kInt32 || from.data_type == kInt64};
    if (tensor.numbers.size() != expected)
      throw NetworkError(fmt::format("expected {} numbers, got {}", expected, tensor.numbers.size()));
    return tensor;
  });
}

constexpr const char* kAttributeTypes[] = {
    "UNDEFINED", "FLOAT",   "INT",    "STRING",        "TENSOR",         "GRAPH",      "FLOATS",     "INTS",
    "STRINGS",   "TENSORS", "GRAPHS", "SPARSE_TENSOR", "SPARSE_TENSORS", "TYPE_PROTO", "TYPE_PROTOS"};

/// AttributeProto: its name, and its value.
std::pair<std::string, Attribute> ToAttribute(Reader message) {
  std::string name;
  int type = 0;
  double number = 0;
  std::int64_t integer = 0;
  std::vector<double> numbers;
  std::vector<std::int64_t> integers;
  Reader tensor;
  ReadFields(message, [&](std::uint32_t field) {
    switch (field) {
      case Bytes(1):
        name = message.get_string();
        break;
      case Float(2):
        number = static_cast<double>(message.get_float());
        break;
      case Integer(3):
        integer = message.get_int64();
        break;
      case Bytes(5):
        tensor = message.get_message();
        break;
      case Float(7):
        numbers.push_back(static_cast<double>(message.get_float()));
        break;
      case Bytes(7):
        Append(numbers, message.get_packed_float());
        break;
      case Integer(8):
        integers.push_back(message.get_int64());
        break;
      case Bytes(8):
        std::ranges::copy(message.get_packed_int64(), std::back_inserter(integers));
        break;
      case Integer(20):
        type = message.get_int32();
        break;
      default:
        return false;
    }
    return true;
  });
  switch (type) {
    case 1:
      return {name, number};
    case 2:
      return {name, integer};
    case 4:
      return {name, ToTensor(TensorFields(tensor))};
    case 6:
      return {name, numbers};
    case 7:
      return {name, integers};
    default:
      throw NetworkError(fmt::format("attribute {}: expected numbers, got {}", name, NameOf(kAttributeTypes, type)));
  }
}

bool IsOfOnnx(const std::string& domain) { return domain.empty() || domain == "ai.onnx"; }

/// NodeProto.
NetworkNode ToNode(Reader message) {
  NetworkNode node;
  std::string domain;
  std::vector<Reader> attributes;
  ReadFields(message, [&](std::uint32_t field) {
    switch (field) {
      case Bytes(1):
        node.inputs.push_back(message.get_string());
        break;
      case Bytes(2):
        node.outputs.push_back(message.get_string());
        break;
      case Bytes(3):
        node.name = message.get_string();
        break;
      case Bytes(4):
        node.op = message.get_string();
        break;
      case Bytes(5):
        attributes.push_back(message.get_message());
        break;
      case Bytes(7):
        domain = message.get_string();
        break;
      default:
        return false;
    }
    return true;
  });
  if (!IsOfOnnx(domain)) throw NetworkError(fmt::format("expected an operator of ONNX, got {} of {}", node.op, domain));
  for (const Reader& attribute : attributes)
    Named(node.Title(), [&] { return node.attributes.insert(ToAttribute(attribute)); });
  return node;
}

/// TensorShapeProto.Dimension: -1 if it has a name instead of a length.
std::int64_t ToLength(Reader message) {
  std::int64_t length = -1;
  while (message.next(1, Wire::varint)) length = message.get_int64();
  return length;
}

/// TypeProto.Tensor: the shape, of numbers.
TensorShape ToShape(Reader message) {
  TensorShape lengths;
  int type = 0;
  ReadFields(message, [&](std::uint32_t field) {
    if (field == Integer(1)) {
      type = message.get_int32();
    } else if (field == Bytes(2)) {
      Reader shape = message.get_message();
      while (shape.next(1, Wire::length_delimited)) lengths.push_back(ToLength(shape.get_message()));
    } else {
      return false;
    }
    return true;
  });
  if (type != kFloat && type != kDouble)
    throw NetworkError(fmt::format("expected numbers of type FLOAT or DOUBLE, got {}", NameOf(kDataTypes, type)));
  return lengths;
}

/// ValueInfoProto.
NetworkGraph::Port ToPort(Reader message) {
  NetworkGraph::Port port;
  std::optional<Reader> tensor;
  ReadFields(message, [&](std::uint32_t field) {
    if (field == Bytes(1)) {
      port.name = message.get_string();
    } else if (field == Bytes(2)) {
      Reader type = message.get_message();
      while (type.next(1, Wire::length_delimited)) tensor = type.get_message();
    } else {
      return false;
    }
    return true;
  });
  if (!tensor) throw NetworkError(fmt::format("{}: expected a tensor", port.name));
  port.shape = Named(port.name, [&] { return ToShape(*tensor); });
  return port;
}

/// GraphProto.
void ReadGraph(Reader message, NetworkGraph& graph) {
  std::vector<Reader> inputs;
  ReadFields(message, [&](std::uint32_t field) {
    switch (field) {
      case Bytes(1):
        graph.nodes.push_back(ToNode(message.get_message()));
        break;
      case Bytes(5): {
        const TensorFields tensor(message.get_message());
        graph.constants[tensor.name] = ToTensor(tensor);
        break;
      }
      case Bytes(11):
        inputs.push_back(message.get_message());
        break;
      case Bytes(12):
        graph.outputs.push_back(ToPort(message.get_message()));
        break;
      case Bytes(15):
        throw NetworkError("expected no sparse tensors, got some");
      default:
        return false;
    }
    return true;
  });
  for (const Reader& input : inputs)
    if (NetworkGraph::Port port = ToPort(input); !graph.constants.contains(port.name)) graph.inputs.push_back(port);
}

/// OperatorSetIdProto, if it is that of ONNX's own operators.
void ReadOpset(Reader message, NetworkGraph& graph) {
  std::string domain;
  std::int64_t version = 0;
  ReadFields(message, [&](std::uint32_t field) {
    if (field == Bytes(1))
      domain = message.get_string();
    else if (field == Integer(2))
      version = message.get_int64();
    else
      return false;
    return true;
  });
  if (IsOfOnnx(domain)) graph.opset = version;
}

/// StringStringEntryProto.
void ReadMetadata(Reader message, NetworkGraph& graph) {
  std::string key, value;
  ReadFields(message, [&](std::uint32_t field) {
    if (field != Bytes(1) && field != Bytes(2)) return false;
    (field == Bytes(1) ? key : value) = message.get_string();
    return true;
  });
  graph.metadata[key] = value;
}

}  // namespace

NetworkError::NetworkError(std::string_view text) : std::runtime_error(Shortened(PlainLine(text), 1000)) {}

std::string NetworkNode::Title() const { return name.empty() || name == op ? op : op + " " + name; }

std::size_t NumbersIn(const TensorShape& shape) {
  if (shape.size() > kMaxAxes)
    throw NetworkError(fmt::format("expected a tensor of at most {} axes, got {}", kMaxAxes, shape.size()));
  std::size_t numbers = 1;
  for (const std::int64_t length : shape) {
    if (length < 0) throw NetworkError(fmt::format("expected lengths of axes from 0 on, got {}", length));
    if (length > static_cast<std::int64_t>(kMaxNumbers) ||
        (numbers *= std::max<std::size_t>(1, static_cast<std::size_t>(length))) > kMaxNumbers)
      throw NetworkError(fmt::format("expected at most {} numbers in a tensor, got more", kMaxNumbers));
  }
  return std::ranges::find(shape, 0) == shape.end() ? numbers : 0;
}

NetworkGraph ReadOnnx(std::string_view bytes) {
  NetworkGraph graph;
  bool is_there = false;
  try {
    Reader model(bytes.data(), bytes.size());
    ReadFields(model, [&](std::uint32_t field) {
      switch (field) {
        case Bytes(7):
          ReadGraph(model.get_message(), graph);
          is_there = true;
          break;
        case Bytes(8):
          ReadOpset(model.get_message(), graph);
          break;
        case Bytes(14):
          ReadMetadata(model.get_message(), graph);
          break;
        default:
          return false;
      }
      return true;
    });
  } catch (const protozero::exception&) {
    is_there = false;
  }
  if (!is_there) throw NetworkError("expected a model in the format ONNX, got something else");
  return graph;
}

}  // namespace mascot
