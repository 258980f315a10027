// Networks in the format ONNX: each operator on numbers that are easily checked, and what is refused.
#include "agent/network/network.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/onnx_model.h"

namespace mascot::test {
namespace {

using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::Pointwise;

using Row = std::vector<double>;

Row Answer(const OnnxModel& model, const Row& input) {
  const Network network = Network::FromOnnx(model.Bytes());
  Network::Scratch scratch = network.MakeScratch();
  const auto answer = network.Answer(input, scratch);
  return {answer.begin(), answer.end()};
}

/// The answer of a network of one node, whose other inputs are `constants`, made a row.
Row Through(const std::string& op, const Row& input, int outputs, const OnnxAttributes& attributes = {},
            const std::function<std::vector<std::string>(OnnxModel&)>& constants = {}, int opset = 14) {
  OnnxModel model(static_cast<int>(input.size()), opset);
  std::vector<std::string> inputs{"x"};
  if (constants)
    for (const std::string& name : constants(model)) inputs.push_back(name);
  model.Node(op, inputs, "y", attributes).Integers("row", {1, -1}).Node("Reshape", {"y", "row"}, "answer");
  return Answer(model.Output("answer", outputs), input);
}

// --- operators -------------------------------------------------------------------------------------------

TEST(Network, NumbersBecomeOthersOneByOne) {
  const Row x{-2, -0.5, 0, 3};
  EXPECT_THAT(Through("Relu", x, 4), ElementsAre(0, 0, 0, 3));
  EXPECT_THAT(Through("Neg", x, 4), ElementsAre(2, 0.5, 0, -3));
  EXPECT_THAT(Through("Abs", x, 4), ElementsAre(2, 0.5, 0, 3));
  const auto each = [&](const std::string& op, double (*of)(double)) {
    Row expected;
    for (const double number : x) expected.push_back(of(number));
    EXPECT_THAT(Through(op, x, 4), Pointwise(DoubleEq(), expected)) << op;
  };
  each("Tanh", [](double number) { return std::tanh(number); });
  each("Exp", [](double number) { return std::exp(number); });
  each("Sigmoid", [](double number) { return 1 / (1 + std::exp(-number)); });
  each("Softplus", [](double number) { return std::log(1 + std::exp(number)); });
  each("Elu", [](double number) { return number < 0 ? std::exp(number) - 1 : number; });
  each("LeakyRelu", [](double number) { return number < 0 ? 0.01f * number : number; });
}

TEST(Network, LargeNumbersDoNotOverflow) {
  EXPECT_THAT(Through("Sigmoid", {-1000, 1000}, 2), ElementsAre(0, 1));
  EXPECT_THAT(Through("Softplus", {-1000, 1000}, 2), ElementsAre(0, 1000));
  EXPECT_THAT(Through("Softmax", {1000, 1000}, 2, {{"axis", 1}}), ElementsAre(0.5, 0.5));
}

TEST(Network, ProductsOfMatricesAreThoseOfAlgebra) {
  const auto with = [](std::vector<std::int64_t> shape, std::vector<float> numbers) {
    return [=](OnnxModel& model) {
      model.Numbers("w", shape, numbers).Numbers("c", {2}, {100, 200});
      return std::vector<std::string>{"w", "c"};
    };
  };
  EXPECT_THAT(Through("Gemm", {1, 2, 3}, 2, {}, with({3, 2}, {1, 2, 3, 4, 5, 6})), ElementsAre(122, 228));
  EXPECT_THAT(Through("Gemm", {1, 2, 3}, 2, {{"transB", 1}}, with({2, 3}, {1, 3, 5, 2, 4, 6})), ElementsAre(122, 228));
  const auto matrix = [](OnnxModel& model) {
    model.Numbers("w", {3, 2}, {1, 2, 3, 4, 5, 6});
    return std::vector<std::string>{"w"};
  };
  EXPECT_THAT(Through("MatMul", {1, 2, 3}, 2, {}, matrix), ElementsAre(22, 28));
}

TEST(Network, ShapesAreBroadcastFromTheirEnds) {
  OnnxModel model(6);
  model.Integers("2x3", {2, 3}).Numbers("column", {2, 1}, {10, 20}).Integers("row", {1, -1});
  model.Node("Reshape", {"x", "2x3"}, "m").Node("Add", {"m", "column"}, "sum").Node("Reshape", {"sum", "row"}, "y");
  EXPECT_THAT(Answer(model.Output("y", 6), {1, 2, 3, 4, 5, 6}), ElementsAre(11, 12, 13, 24, 25, 26));
}

TEST(Network, SlicesGoBothWays) {
  const auto slice = [](std::int64_t from, std::int64_t to, std::int64_t step) {
    return [=](OnnxModel& model) {
      model.Integers("from", {from}).Integers("to", {to}).Integers("axis", {1}).Integers("step", {step});
      return std::vector<std::string>{"from", "to", "axis", "step"};
    };
  };
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max(),
                         kLeast = std::numeric_limits<std::int64_t>::min();
  const Row x{0, 1, 2, 3, 4, 5};
  EXPECT_THAT(Through("Slice", x, 3, {}, slice(1, 4, 1)), ElementsAre(1, 2, 3));
  EXPECT_THAT(Through("Slice", x, 2, {}, slice(-2, 100, 1)), ElementsAre(4, 5));
  EXPECT_THAT(Through("Slice", x, 3, {}, slice(0, 6, 2)), ElementsAre(0, 2, 4));
  EXPECT_THAT(Through("Slice", x, 6, {}, slice(-1, -100, -1)), ElementsAre(5, 4, 3, 2, 1, 0));
  EXPECT_THAT(Through("Slice", x, 4, {}, slice(2, kMost, 1)), ElementsAre(2, 3, 4, 5)) << "as PyTorch says: to the end";
  EXPECT_THAT(Through("Slice", x, 3, {}, slice(kMost, kLeast, -2)), ElementsAre(5, 3, 1));
  EXPECT_THAT(Through("Slice", x, 1, {}, slice(1, kMost, kMost)), ElementsAre(1));
  EXPECT_THAT(Through("Slice", x, 1, {}, slice(-1, kLeast, kLeast)), ElementsAre(5));
  EXPECT_THAT(
      Through("Slice", x, 2, {{"starts", std::vector<std::int64_t>{0, 1}}, {"ends", std::vector<std::int64_t>{1, 3}}},
              {}, /*opset=*/9),
      ElementsAre(1, 2));
}

TEST(Network, ShapesChangeAsOnnxSays) {
  // x is [1, 6]; a row of 6 numbers comes out if the last shape has 6 numbers in one row.
  const auto through = [](const std::vector<std::vector<std::int64_t>>& shapes, const OnnxAttributes& attributes) {
    OnnxModel model(6);
    std::string at = "x";
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      const std::string to = "y" + std::to_string(k);
      model.Integers("shape" + std::to_string(k), shapes[k])
          .Node("Reshape", {at, "shape" + std::to_string(k)}, to, attributes);
      at = to;
    }
    return Answer(model.Output(at, 6), {1, 2, 3, 4, 5, 6});
  };
  EXPECT_EQ(through({{2, 3}, {-1, 6}}, {}).size(), 6U);
  EXPECT_EQ(through({{2, 3}, {0, -1}, {1, 6}}, {}).size(), 6U) << "0 keeps an axis";
  EXPECT_EQ(through({{6}}, {}).size(), 6U);
}

TEST(Network, AxesAreSummedAveragedAndSearchedInTheirOrder) {
  for (const auto& [op, expected] : std::map<std::string, Row>{
           {"ReduceSum", {5, 7, 9}}, {"ReduceMean", {2.5, 3.5, 4.5}}, {"ReduceMax", {4, 5, 6}}}) {
    OnnxModel model(6, /*opset=*/18);
    model.Integers("2x3", {2, 3}).Integers("axes", {0}).Integers("row", {1, -1});
    model.Node("Reshape", {"x", "2x3"}, "m").Node(op, {"m", "axes"}, "r", {{"keepdims", 0}});
    EXPECT_THAT(Answer(model.Node("Reshape", {"r", "row"}, "y").Output("y", 3), {1, 2, 3, 4, 5, 6}),
                ElementsAreArray(expected))
        << op;
  }
}

TEST(Network, AReductionWithoutAxesTakesAllOrNone) {
  const auto mean = [](const OnnxAttributes& attributes, int outputs, int opset = 14) {
    return Through("ReduceMean", {1, 2, 3, 6}, outputs, attributes, {}, opset);
  };
  EXPECT_THAT(mean({}, 1), ElementsAre(3));
  EXPECT_THAT(mean({{"keepdims", 0}}, 1), ElementsAre(3));
  EXPECT_THAT(mean({{"axes", std::vector<std::int64_t>{-1}}}, 1), ElementsAre(3)) << "an attribute below opset 18";
  EXPECT_THAT(mean({{"noop_with_empty_axes", 1}}, 4, 18), ElementsAre(1, 2, 3, 6));
}

TEST(Network, GemmTakesItsFactorsAndTransposesBoth) {
  OnnxModel model(4);
  model.Integers("2x2", {2, 2})
      .Integers("row", {1, -1})
      .Numbers("b", {2, 2}, {1, 0, 1, 2})
      .Numbers("c", {2, 1}, {1, 3});
  model.Node("Reshape", {"x", "2x2"}, "a")
      .Node("Gemm", {"a", "b", "c"}, "g", {{"transA", 1}, {"transB", 1}, {"alpha", 2.0F}, {"beta", 10.0F}})
      .Node("Reshape", {"g", "row"}, "y");
  // 2 [1 3; 2 4] [1 1; 0 2] + 10 [1 1; 3 3]
  EXPECT_THAT(Answer(model.Output("y", 4), {1, 2, 3, 4}), ElementsAre(12, 24, 34, 50));
}

TEST(Network, MatricesAreStackedAndVectorsAreMultiplied) {
  OnnxModel model(4);
  model.Integers("stack", {2, 1, 2})
      .Integers("row", {1, -1})
      .Numbers("b", {1, 2, 2}, {1, 0, 1, 2})
      .Numbers("v", {2}, {1, 10});
  model.Node("Reshape", {"x", "stack"}, "a").Node("MatMul", {"a", "b"}, "ab").Node("MatMul", {"ab", "v"}, "abv");
  model.Node("Reshape", {"abv", "row"}, "y");
  EXPECT_THAT(Answer(model.Output("y", 2), {1, 2, 3, 4}), ElementsAre(3 + 40, 7 + 80));
}

TEST(Network, ClipLeavesOutLimitsThatAreNotThere) {
  const auto limits = [](std::vector<std::string> names) {
    return [=](OnnxModel& model) {
      model.Numbers("low", {}, {-1}).Numbers("high", {}, {2});
      return names;
    };
  };
  const Row x{-3, 0.5, 4};
  EXPECT_THAT(Through("Clip", x, 3, {}, limits({"low", "high"})), ElementsAre(-1, 0.5, 2));
  EXPECT_THAT(Through("Clip", x, 3, {}, limits({"low"})), ElementsAre(-1, 0.5, 4));
  EXPECT_THAT(Through("Clip", x, 3, {}, limits({"", "high"})), ElementsAre(-3, 0.5, 2));
  EXPECT_THAT(Through("Clip", x, 3), ElementsAre(-3, 0.5, 4));
  EXPECT_THAT(Through("Clip", x, 3, {{"min", -1.0F}, {"max", 2.0F}}, {}, /*opset=*/10), ElementsAre(-1, 0.5, 2));
}

TEST(Network, AxesComeAndGo) {
  OnnxModel model(6);
  model.Integers("2x3", {2, 3}).Integers("axes", {0, -1}).Integers("first", {0});
  model.Node("Reshape", {"x", "2x3"}, "a").Node("Unsqueeze", {"a", "axes"}, "four");               // [1, 2, 3, 1]
  model.Node("Transpose", {"four"}, "turned", {{"perm", std::vector<std::int64_t>{0, 3, 2, 1}}});  // [1, 1, 3, 2]
  model.Node("Squeeze", {"turned", "first"}, "three").Node("Squeeze", {"three"}, "two");           // [3, 2]
  model.Node("Flatten", {"two"}, "y", {{"axis", 0}});
  EXPECT_THAT(Answer(model.Output("y", 6), {1, 2, 3, 4, 5, 6}), ElementsAre(1, 4, 2, 5, 3, 6));
}

TEST(Network, NumbersOfEveryEncodingAreTheSame) {
  const auto answer = [](const onnx::TensorProto& tensor) {
    OnnxModel model(2);
    return Answer(model.Initializer("w", tensor).Node("Mul", {"x", "w"}, "y").Output("y", 2), {1, 2});
  };
  onnx::TensorProto raw = FloatTensor({2}, {}), doubles = raw, raw_doubles = raw;
  const float floats[] = {0.5F, -3};
  const double wide[] = {0.5, -3};
  raw.set_raw_data(floats, sizeof(floats));
  doubles.set_data_type(onnx::TensorProto::DOUBLE);
  raw_doubles.set_data_type(onnx::TensorProto::DOUBLE);
  raw_doubles.set_raw_data(wide, sizeof(wide));
  for (const double number : wide) doubles.add_double_data(number);
  for (const onnx::TensorProto& tensor : {FloatTensor({2}, {0.5F, -3}), raw, doubles, raw_doubles})
    EXPECT_THAT(answer(tensor), ElementsAre(0.5, -6));
}

TEST(Network, ParametersOfEveryEncodingAreTheSame) {
  const auto answer = [](const onnx::TensorProto& end) {
    OnnxModel model(3);
    model.Integers("1", {1}).Initializer("end", end);
    return Answer(model.Node("Slice", {"x", "1", "end", "1"}, "y").Output("y", 1), {1, 2, 3});
  };
  const std::int64_t raw_end[] = {-1};
  const std::int32_t raw_narrow[] = {-1};
  onnx::TensorProto raw = IntegerTensor({}), narrow = raw, raw_32 = raw;
  for (onnx::TensorProto* each : {&raw, &narrow, &raw_32}) each->set_dims(0, 1);
  raw.set_raw_data(raw_end, sizeof(raw_end));
  narrow.set_data_type(onnx::TensorProto::INT32);
  raw_32.set_data_type(onnx::TensorProto::INT32);
  raw_32.set_raw_data(raw_narrow, sizeof(raw_narrow));
  narrow.add_int32_data(-1);
  for (const onnx::TensorProto& end : {IntegerTensor({-1}), raw, narrow, raw_32})
    EXPECT_THAT(answer(end), ElementsAre(2));
}

TEST(Network, ConstantsStandInNodesAsWell) {
  const auto answer = [](const std::string& name, const OnnxAttribute& value, int numbers) {
    OnnxModel model(2);
    model.Node("Constant", {}, "c", {{name, value}}).Node("Mul", {"x", "c"}, "y");
    return Answer(model.Output("y", numbers), {1, 2});
  };
  EXPECT_THAT(answer("value", FloatTensor({2}, {3, 4}), 2), ElementsAre(3, 8));
  EXPECT_THAT(answer("value_float", 3.0F, 2), ElementsAre(3, 6));
  EXPECT_THAT(answer("value_floats", std::vector<float>{3, 4}, 2), ElementsAre(3, 8));
  OnnxModel integers(2);
  integers.Node("Constant", {}, "one", {{"value_int", 1}})
      .Node("Constant", {}, "zero", {{"value_ints", std::vector<std::int64_t>{0}}});
  integers.Node("Unsqueeze", {"one", "zero"}, "ones").Node("Slice", {"x", "zero", "ones", "ones"}, "y");
  EXPECT_THAT(Answer(integers.Output("y", 1), {1, 2}), ElementsAre(1));
}

TEST(Network, ConstantsAreComputedOnce) {
  OnnxModel model(2);
  model.Numbers("a", {2}, {1, 2}).Numbers("b", {2}, {3, 4});
  model.Node("Add", {"a", "b"}, "c").Node("Tanh", {"c"}, "d").Node("Mul", {"x", "d"}, "y").Output("y", 2);
  EXPECT_THAT(Answer(model, {1, 2}), ElementsAre(DoubleEq(std::tanh(4.0)), DoubleEq(2 * std::tanh(6.0))));
}

TEST(Network, ANetworkIsSharedByThoseWhoHaveTheirOwnScratch) {
  const Network network = Network::FromOnnx(ConsensusNetwork(2, 0.5F, 0.25F).Bytes());
  Network::Scratch one = network.MakeScratch(), other = network.MakeScratch();
  Row x(28, 0.0);
  const auto at_rest = network.Answer(x, one);
  x[3] = 4;  // v.x
  const auto flying = network.Answer(x, other);
  EXPECT_THAT(at_rest, ElementsAre(0, 0, 0));
  EXPECT_THAT(flying, ElementsAre(-1, 0, 0));
}

// --- what is refused -------------------------------------------------------------------------------------

/// What is said of a file.
std::string Refusal(const std::string& bytes) {
  try {
    Network::FromOnnx(bytes);
  } catch (const NetworkError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Network, WhatIsNoNetworkIsRefused) {
  const std::string no_model = "expected a model in the format ONNX, got something else";
  EXPECT_EQ(Refusal(""), no_model);
  EXPECT_EQ(Refusal("a poem"), no_model);
  const std::string good = ConsensusNetwork(1, 1, 1).Bytes();
  EXPECT_EQ(Refusal(good.substr(0, good.size() / 2)), no_model);
}

TEST(Network, AnUnknownOperatorIsNamedWithItsNode) {
  OnnxModel model(2);
  model.Node("Relu", {"x"}, "r").Node("Sin", {"r"}, "y").Output("y", 2);
  model.graph().mutable_node(1)->set_name("/wave/Sin");
  EXPECT_EQ(Refusal(model.Bytes()), "node 2 (Sin /wave/Sin): expected one of " + OperatorNames() + ", got Sin");
}

using Make = std::function<void(OnnxModel&)>;

/// What is said of a network whose input is a row of four numbers.
std::string RefusalOf(const Make& make, int opset = 14) {
  OnnxModel model(4, opset);
  make(model);
  if (model.graph().output_size() == 0) model.Output("y", 4);
  return Refusal(model.Bytes());
}

/// The same, of a network of one node with output y.
std::string RefusalOf(const std::string& op, const std::vector<std::string>& inputs,
                      const OnnxAttributes& attributes = {}, const Make& constants = {}, int opset = 14) {
  return RefusalOf(
      [&](OnnxModel& model) {
        if (constants) constants(model);
        model.Node(op, inputs, "y", attributes);
      },
      opset);
}

TEST(Network, WhatIsInTheFileIsRefusedInWords) {
  EXPECT_EQ(RefusalOf([](OnnxModel& model) {
              model.Node("Relu", {"x"}, "y").graph().mutable_node(0)->set_domain("com.example");
            }),
            "expected an operator of ONNX, got Relu of com.example");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) {
              model.Numbers("w", {2, 2}, {1, 2, 3});
            }),
            "tensor w: expected 4 numbers, got 3");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) { model.Numbers("w", std::vector<std::int64_t>(17, 1), {1}); }),
            "tensor w: expected a tensor of at most 16 axes, got 17");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) { model.Numbers("w", {-2}, {1}); }),
            "tensor w: expected lengths of axes from 0 on, got -2");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) {
              model.Numbers("w", {1 << 20, 2}, {1});
            }),
            "tensor w: expected at most 1048576 numbers in a tensor, got more");
  EXPECT_EQ(
      RefusalOf([](OnnxModel& model) {
        model.Numbers("w", {1}, {1}).graph().mutable_initializer(0)->set_data_location(onnx::TensorProto::EXTERNAL);
      }),
      "tensor w: expected its numbers in this file, got another file");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) {
              model.Numbers("w", {1}, {1}).graph().mutable_initializer(0)->mutable_segment()->set_begin(0);
            }),
            "tensor w: expected its numbers in this file, got another file");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) {
              model.Numbers("w", {1}, {1}).graph().mutable_initializer(0)->set_data_type(onnx::TensorProto::FLOAT16);
            }),
            "tensor w: expected numbers of type FLOAT, DOUBLE, INT64 or INT32, got FLOAT16");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) {
              model.Numbers("w", {1}, {1}).graph().mutable_initializer(0)->set_data_type(99);
            }),
            "tensor w: expected numbers of type FLOAT, DOUBLE, INT64 or INT32, got type 99");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) {
              model.Numbers("w", {1}, {}).graph().mutable_initializer(0)->set_raw_data("12345");
            }),
            "tensor w: expected numbers of 4 bytes, got 5 bytes");
  EXPECT_EQ(RefusalOf("Relu", {"x"}, {{"mode", std::string("slow")}}),
            "Relu: attribute mode: expected numbers, got STRING");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) { model.graph().add_sparse_initializer(); }),
            "expected no sparse tensors, got some");
  EXPECT_EQ(
      RefusalOf([](OnnxModel& model) {
        model.graph().mutable_input(0)->mutable_type()->mutable_tensor_type()->set_elem_type(onnx::TensorProto::INT64);
      }),
      "x: expected numbers of type FLOAT or DOUBLE, got INT64");
  EXPECT_EQ(
      RefusalOf([](OnnxModel& model) { model.graph().mutable_input(0)->mutable_type()->mutable_sequence_type(); }),
      "x: expected a tensor");
}

TEST(Network, NamesOutOfTheFileAreFitForALine) {
  const std::string name("a\0\x1B[31m\n", 8);
  EXPECT_EQ(RefusalOf("Relu", {name}),
            "node 1 (Relu): expected a tensor a\\u0000\\u001b[31m\\n from a node before, got none");
  const std::string long_one = RefusalOf("Relu", {std::string(100'000, 'n')});
  EXPECT_EQ(long_one.size(), 1003U);
  EXPECT_THAT(long_one, ::testing::EndsWith("nnn..."));
}

TEST(Network, WhatIsNoNetworkFromARowToARowIsRefusedInWords) {
  const auto axis_of_input = [](OnnxModel & model, int axis) -> auto& {
    return *model.graph().mutable_input(0)->mutable_type()->mutable_tensor_type()->mutable_shape()->mutable_dim(axis);
  };
  EXPECT_EQ(RefusalOf("Relu", {"x"}, {}, {}, /*opset=*/8), "expected operators of version (opset) 9 to 21, got 8");
  EXPECT_EQ(RefusalOf("Relu", {"x"}, {}, {}, /*opset=*/22), "expected operators of version (opset) 9 to 21, got 22");
  EXPECT_EQ(RefusalOf("Relu", {"z"}), "node 1 (Relu): expected a tensor z from a node before, got none");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) { model.Node("Relu", {"r"}, "y").Node("Relu", {"y"}, "r"); }),
            "node 1 (Relu): expected a tensor r from a node before, got none")
      << "a cycle";
  EXPECT_EQ(RefusalOf([](OnnxModel& model) { model.Node("Relu", {"x"}, "x"); }),
            "node 1 (Relu): expected a new name for its output, got x");
  EXPECT_EQ(
      RefusalOf([](OnnxModel& model) { model.Node("Relu", {"x"}, "y").graph().mutable_node(0)->add_output("z"); }),
      "node 1 (Relu): expected one output, got 2");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) { model.Node("Relu", {"x"}, "y").Output("y", 4).Output("x", 4); }),
            "expected one output, got 2");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) { model.graph().clear_input(); }), "expected one input, got 0");
  EXPECT_EQ(RefusalOf([&](OnnxModel& model) { axis_of_input(model, 0).set_dim_value(2); }),
            "input x: expected one row of numbers, [n] or [batch, n], got [2, 4]");
  EXPECT_EQ(RefusalOf([&](OnnxModel& model) { axis_of_input(model, 1).set_dim_param("n"); }),
            "input x: expected one row of numbers, [n] or [batch, n], got [1, ?]");
  EXPECT_EQ(RefusalOf([](OnnxModel& model) {
              model.Integers("s", {2, 2}).Node("Reshape", {"x", "s"}, "y");
            }),
            "output y: expected one row of numbers, [n] or [batch, n], got [2, 2]");
}

TEST(Network, ANodeThatBreaksItsRulesIsRefusedInWords) {
  const auto shapes = [](OnnxModel& model) {
    model.Integers("i", {1}).Integers("two", {1, 1}).Integers("0", {0}).Integers("3", {3}).Integers("0,-1", {0, -1});
    model.Integers("2x2", {2, 2})
        .Integers("keep", {1, 4, 0})
        .Integers("far", {7})
        .Integers("many", std::vector<std::int64_t>(15, 0));
    model.Numbers("w", {3}, {1, 2, 3})
        .Numbers("column", {3, 1}, {1, 2, 3})
        .Numbers("one", {}, {1})
        .Numbers("none", {0}, {});
  };
  const auto refusal = [&](const std::string& op, const std::vector<std::string>& inputs,
                           const OnnxAttributes& attributes = {}, int opset = 14) {
    const std::string text = RefusalOf(op, inputs, attributes, shapes, opset), node = "node 1 (" + op + "): ";
    EXPECT_EQ(text.substr(0, node.size()), node);
    return text.substr(std::min(text.size(), node.size()));
  };
  using Axes = std::vector<std::int64_t>;
  // inputs and attributes
  EXPECT_EQ(refusal("Relu", {"x", "x"}), "expected 1 input, got 2");
  EXPECT_EQ(refusal("Relu", {""}), "expected an input 1, got none");
  EXPECT_EQ(refusal("Gemm", {"x"}), "expected 2 to 3 inputs, got 1");
  EXPECT_EQ(refusal("Relu", {"x"}, {{"alpha", 1.0F}}), "expected no attribute alpha, got one");
  EXPECT_EQ(refusal("Elu", {"x"}, {{"alpha", 1}}), "attribute alpha: expected another type");
  EXPECT_EQ(refusal("Relu", {"i"}), "expected floating-point numbers, got integers");
  EXPECT_EQ(refusal("Concat", {"x", "i"}, {{"axis", 0}}),
            "expected tensors of one type, got integers and floating-point numbers");
  EXPECT_EQ(refusal("Reshape", {"x", "x"}), "expected constant shape, got some that depend on the network's input");
  EXPECT_EQ(refusal("Reshape", {"x", "w"}), "expected shape as integers, got other numbers");
  EXPECT_EQ(refusal("Squeeze", {"x"}, {{"axes", Axes{0}}}),
            "expected axes as an input with opset 14, got an attribute");
  EXPECT_EQ(refusal("Squeeze", {"x", "0"}, {}, 12), "expected axes as an attribute with opset 12, got an input");
  EXPECT_EQ(refusal("ReduceMax", {"x", "0"}, {}, 17), "expected axes as an attribute with opset 17, got an input");
  EXPECT_EQ(refusal("Clip", {"x"}, {{"min", 0.0F}}), "expected min as an input with opset 14, got an attribute");
  EXPECT_EQ(refusal("Clip", {"x", "w"}), "expected one number as min, got 3");
  EXPECT_EQ(refusal("Slice", {"x"}, {{"starts", Axes{0}}, {"ends", Axes{1}}}),
            "expected starts as an input with opset 14, got an attribute");
  // shapes and axes
  EXPECT_EQ(refusal("Add", {"x", "w"}), "expected shapes that fit, got [1, 4] and [3]");
  EXPECT_EQ(refusal("Concat", {"x", "w"}, {{"axis", 0}}), "expected shapes that fit, got [1, 4] and [3]");
  EXPECT_EQ(refusal("Concat", {"x"}), "expected an axis, got none");
  EXPECT_EQ(refusal("Concat", {"x"}, {{"axis", 2}}), "expected one of 2 axes, got axis 2");
  EXPECT_EQ(refusal("Flatten", {"x"}, {{"axis", -3}}), "expected one of 2 axes, got axis -3");
  EXPECT_EQ(refusal("ReduceSum", {"x", "two"}), "expected each axis once, got axis 1 twice");
  EXPECT_EQ(refusal("Reshape", {"x", "3"}), "expected a shape for 4 numbers, got [3]");
  EXPECT_EQ(refusal("Reshape", {"x", "keep"}), "expected an axis 2 to keep, got shape [1, 4]");
  EXPECT_EQ(refusal("Reshape", {"none", "0,-1"}), "expected a length other than 0 beside -1, got 0");
  EXPECT_EQ(refusal("Unsqueeze", {"x"}), "expected axes, got none");
  EXPECT_EQ(refusal("Unsqueeze", {"x", "many"}), "expected a tensor of at most 16 axes, got 17");
  EXPECT_EQ(refusal("Squeeze", {"x", "i"}), "expected axes of length 1, got axis 1 of [1, 4]");
  EXPECT_EQ(refusal("Transpose", {"x"}, {{"perm", Axes{0}}}), "expected perm to have each axis of [1, 4] once, got 1");
  EXPECT_EQ(refusal("Slice", {"x", "0", "i", "0", "0"}), "expected steps other than 0, got 0");
  EXPECT_EQ(refusal("Slice", {"x", "0", "two"}),
            "expected as many starts as ends, axes and steps, got other numbers of them");
  EXPECT_EQ(refusal("Constant", {}), "expected one value, got 0");
  // products, and what is over axes
  EXPECT_EQ(refusal("MatMul", {"x", "column"}), "expected matrices that fit, got 1 x 4 and 3 x 1");
  EXPECT_EQ(refusal("MatMul", {"x", "one"}), "expected vectors and matrices, got a single number");
  EXPECT_EQ(refusal("Gemm", {"x", "w"}), "expected matrices, got shape [3]");
  EXPECT_EQ(refusal("Softmax", {"x"}, {{"axis", 0}}, 12),
            "expected the last axis with an opset below 13, got axis 0 of [1, 4]");
}

TEST(Network, WhatWouldTakeTooMuchMemoryOrTimeIsRefused) {
  EXPECT_EQ(RefusalOf([](OnnxModel& model) {
              for (int k = 0; k < 10'001; ++k) model.Node("Relu", {"x"}, "y" + std::to_string(k));
            }),
            "expected at most 10000 nodes, got 10001");
  const auto large = [](OnnxModel& model) {
    model.Numbers("column", {1 << 18, 1}, std::vector<float>(1 << 18, 1.0F)).Numbers("one", {1, 1}, {1});
  };
  EXPECT_EQ(RefusalOf([&](OnnxModel& model) {
              large(model);
              model.Node("Mul", {"x", "column"}, "a").Node("Concat", {"a", "a"}, "y", {{"axis", 0}});
            }),
            "node 2 (Concat): expected at most 1048576 numbers in a tensor, got more");
  EXPECT_EQ(RefusalOf([&](OnnxModel& model) {
              large(model);
              model.Node("Mul", {"x", "column"}, "a");
              for (int k = 0; k < 3; ++k) model.Node("ReduceSum", {"a"}, "y" + std::to_string(k));
            }),
            "node 4 (ReduceSum): expected nodes that read and write at most 4194304 numbers, got more");
  EXPECT_EQ(RefusalOf([&](OnnxModel& model) {
              for (int k = 0; k < 5; ++k)
                model.Numbers("w" + std::to_string(k), {1 << 18}, std::vector<float>(1 << 18, 1.0F));
            }),
            "expected at most 1048576 constant numbers, got more");
  EXPECT_EQ(RefusalOf([&](OnnxModel& model) {
              model.Numbers("a", {1 << 10, 1 << 9}, std::vector<float>(1 << 19, 1.0F));
              model.Node("Transpose", {"a"}, "b").Node("MatMul", {"a", "b"}, "y");
            }),
            "node 2 (MatMul): expected at most 67108864 products of numbers in the network, got more");
}

}  // namespace
}  // namespace mascot::test
