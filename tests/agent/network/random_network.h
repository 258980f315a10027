// Random networks of all operators that we know, which are also valid for ONNX Runtime.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tests/support/onnx_model.h"

namespace mascot::test {

/// Draws a network, node by node. Another program that computes with float has rounding errors, of which each tensor
/// has a bound: a node is drawn only if the bound of its output stays within kMaxError. All numbers in the file are
/// float.
class RandomNetwork {
 public:
  explicit RandomNetwork(unsigned seed) : random_(seed), wide_(Int(1, 12)), opset_(Int(9, 18)), model_(wide_, opset_) {
    tensors_.push_back({"x", {1, wide_}, 4, 0});
    for (int k = Int(5, 40); k > 0; --k) Grow();
    Finish();
  }
  const OnnxModel& model() const { return model_; }
  /// The input: numbers that a float has, in [-4, 4].
  std::vector<double> MakeInput() {
    std::vector<double> row;
    for (int k = 0; k < wide_; ++k) row.push_back(static_cast<double>(Float(-4, 4)));
    return row;
  }

  static constexpr double kMaxError = 5e-7;

 private:
  using Shape = std::vector<std::int64_t>;
  struct Of {
    std::string name;
    Shape shape;
    double most;   // no number is larger
    double error;  // no number is further off, if it was computed with float
  };
  static constexpr double kUnit = 0x1p-24;  // what float rounds to, relatively

  int Int(int least, int most) { return std::uniform_int_distribution(least, most)(random_); }
  float Float(float least, float most) { return std::uniform_real_distribution(least, most)(random_); }
  bool Chance(double probability) { return std::bernoulli_distribution(probability)(random_); }
  template <class Item>
  const Item& Pick(const std::vector<Item>& items) {
    return items[static_cast<std::size_t>(Int(0, static_cast<int>(items.size()) - 1))];
  }
  static std::int64_t Count(const Shape& shape) {
    std::int64_t count = 1;
    for (const std::int64_t length : shape) count *= length;
    return count;
  }
  std::string NewName() { return "t" + std::to_string(++names_); }
  int AxisFromEitherEnd(int axis, const Shape& shape) {
    return Chance(0.5) ? axis : axis - static_cast<int>(shape.size());
  }

  /// A constant, as an initializer or as a node.
  std::string Constant(const onnx::TensorProto& tensor) {
    const std::string name = NewName();
    if (Chance(0.3))
      model_.Node("Constant", {}, name, {{"value", tensor}});
    else
      model_.Initializer(name, tensor);
    return name;
  }
  std::string Integers(const Shape& integers) { return Constant(IntegerTensor(integers)); }
  std::vector<float> Numbers(std::int64_t count, float least, float most) {
    std::vector<float> numbers;
    for (std::int64_t k = 0; k < count; ++k) numbers.push_back(Float(least, most));
    return numbers;
  }

  void Add(const std::string& op, const std::vector<std::string>& inputs, const Shape& shape, double most, double error,
           const OnnxAttributes& attributes = {}) {
    error += kUnit * most;
    if (error > kMaxError || most > 64 || Count(shape) > 200) return;
    const std::string name = NewName();
    model_.Node(op, inputs, name, attributes);
    tensors_.push_back({name, shape, most, error});
  }
  /// A node that only moves numbers.
  void Move(const std::string& op, const std::vector<std::string>& inputs, const Shape& shape, const Of& from,
            const OnnxAttributes& attributes = {}) {
    Add(op, inputs, shape, from.most, from.error - kUnit * from.most, attributes);
  }
  /// A parameter that is an attribute below opset `since`, and an input from then on.
  void Parameter(const std::string& name, const Shape& value, int since, std::vector<std::string>& inputs,
                 OnnxAttributes& attributes) {
    if (opset_ < since)
      attributes[name] = value;
    else
      inputs.push_back(Integers(value));
  }

  void Grow() {
    const Of x = Pick(tensors_);  // a copy: nodes are added
    using Kind = void (RandomNetwork::*)(const Of&);
    static const std::vector<Kind> kKinds = {
        &RandomNetwork::Gemm,    &RandomNetwork::MatMul,    &RandomNetwork::OfTwo,   &RandomNetwork::WithConstant,
        &RandomNetwork::OfEach,  &RandomNetwork::OfEach,    &RandomNetwork::Clip,    &RandomNetwork::Concat,
        &RandomNetwork::Slice,   &RandomNetwork::Reshape,   &RandomNetwork::Flatten, &RandomNetwork::Unsqueeze,
        &RandomNetwork::Squeeze, &RandomNetwork::Transpose, &RandomNetwork::Reduce,  &RandomNetwork::Softmax,
        &RandomNetwork::Roots};
    (this->*Pick(kKinds))(x);
  }

  /// Weights by which sums of `terms` products are at most as large as the largest factor.
  onnx::TensorProto Weights(const Shape& shape, std::int64_t terms) {
    const float most = 1.0F / static_cast<float>(terms);
    return FloatTensor(shape, Numbers(Count(shape), -most, most));
  }

  void Gemm(const Of& x) {
    if (x.shape.size() != 2) return;
    const bool a_turned = Chance(0.2), b_turned = Chance(0.6);
    const std::int64_t rows = x.shape[a_turned ? 1 : 0], terms = x.shape[a_turned ? 0 : 1], columns = Int(1, 9);
    std::vector<std::string> inputs = {
        x.name, Constant(Weights(b_turned ? Shape{columns, terms} : Shape{terms, columns}, terms))};
    const bool with_c = opset_ < 11 || Chance(0.8);  // ONNX Runtime wants one below opset 11
    if (with_c) {
      const Shape of_c = Pick(std::vector<Shape>{{columns}, {1, columns}, {rows, columns}, {1}, {}});
      inputs.push_back(Constant(FloatTensor(of_c, Numbers(Count(of_c), -1, 1))));
    }
    OnnxAttributes attributes = {{"transA", std::int64_t{a_turned}}, {"transB", std::int64_t{b_turned}}};
    float alpha = 1, beta = 1;
    if (Chance(0.3)) {
      attributes["alpha"] = alpha = Float(0.5, 2);
      attributes["beta"] = beta = Float(0.5, 2);
    }
    const double most = static_cast<double>(alpha) * x.most + (with_c ? static_cast<double>(beta) : 0);
    Add("Gemm", inputs, {rows, columns}, most,
        static_cast<double>(alpha) * x.error + kUnit * most * static_cast<double>(terms + 2), attributes);
  }

  void MatMul(const Of& x) {
    if (x.shape.empty()) return;
    const std::int64_t terms = x.shape.back(), columns = Int(1, 6);
    Shape of_b = {terms, columns}, to = x.shape;
    to.back() = columns;
    if (Chance(0.2)) {
      of_b = {terms};
      to.pop_back();
    } else if (x.shape.size() >= 3 && Chance(0.5)) {
      of_b = x.shape;
      of_b[of_b.size() - 2] = terms;
      of_b.back() = columns;
    }
    Add("MatMul", {x.name, Constant(Weights(of_b, terms))}, to, x.most,
        x.error + kUnit * x.most * static_cast<double>(terms));
  }

  /// Whether the second shape can be broadcast to the first.
  static bool Fits(const Shape& shape, const Shape& other) {
    if (other.size() > shape.size()) return false;
    for (std::size_t k = 1; k <= other.size(); ++k)
      if (other[other.size() - k] != 1 && other[other.size() - k] != shape[shape.size() - k]) return false;
    return true;
  }

  void OfTwo(const Of& x) {
    std::vector<Of> fitting;
    std::ranges::copy_if(tensors_, std::back_inserter(fitting), [&](const Of& y) { return Fits(x.shape, y.shape); });
    const Of y = Pick(fitting);
    std::vector<std::string> inputs = {x.name, y.name};
    if (Chance(0.5)) std::ranges::reverse(inputs);
    const std::string op = Pick(std::vector<std::string>{"Add", "Sub", "Mul"});
    if (op == "Mul")
      Add(op, inputs, x.shape, x.most * y.most, x.most * y.error + y.most * x.error + x.error * y.error);
    else
      Add(op, inputs, x.shape, x.most + y.most, x.error + y.error);
  }

  void WithConstant(const Of& x) {
    Shape other(x.shape.begin() + Int(0, static_cast<int>(x.shape.size())), x.shape.end());
    for (std::int64_t& length : other)
      if (Chance(0.5)) length = 1;
    std::vector<std::string> inputs = {x.name, Constant(FloatTensor(other, Numbers(Count(other), 0.5, 1)))};
    const std::string op = Pick(std::vector<std::string>{"Add", "Sub", "Mul", "Div"});
    if (op != "Div" && Chance(0.5)) std::ranges::reverse(inputs);
    const double factor = op == "Div" ? 2 : 1, more = op == "Add" || op == "Sub" ? 1 : 0;
    Add(op, inputs, x.shape, factor * x.most + more, factor * x.error);
  }

  void OfEach(const Of& x) {
    struct Function {
      std::string op;
      double slope, most;  // the largest, of arguments in [-1, 1] times x.most
    };
    const Function function = Pick(std::vector<Function>{{"Abs", 1, x.most},
                                                         {"Elu", 1.5, x.most + 1.5},
                                                         {"Identity", 1, x.most},
                                                         {"LeakyRelu", 1.5, 1.5 * x.most},
                                                         {"Neg", 1, x.most},
                                                         {"Relu", 1, x.most},
                                                         {"Sigmoid", 0.25, 1},
                                                         {"Softplus", 1, x.most + 0.7},
                                                         {"Tanh", 1, 1}});
    OnnxAttributes attributes;
    if ((function.op == "LeakyRelu" || function.op == "Elu") && Chance(0.5)) attributes["alpha"] = Float(0.1F, 1.5F);
    Add(function.op, {x.name}, x.shape, function.most, function.slope * x.error + kUnit * function.most, attributes);
  }

  /// The root of exp(-|x|). A relative error stays one through both.
  void Roots(const Of& x) {
    const std::size_t before = tensors_.size();
    Add("Abs", {x.name}, x.shape, x.most, x.error);
    if (tensors_.size() == before + 1) Add("Neg", {tensors_.back().name}, x.shape, x.most, x.error);
    if (tensors_.size() == before + 2) Add("Exp", {tensors_.back().name}, x.shape, 1, x.error + kUnit);
    if (tensors_.size() == before + 3) Add("Sqrt", {tensors_.back().name}, x.shape, 1, x.error + 2 * kUnit);
  }

  void Clip(const Of& x) {
    const float least = Float(-2, 0), most = Float(0, 2);
    if (opset_ < 11) {
      Add("Clip", {x.name}, x.shape, 2, x.error, {{"min", least}, {"max", most}});
      return;
    }
    std::vector<std::string> inputs = {x.name, Chance(0.8) ? Constant(FloatTensor({}, {least})) : ""};
    if (inputs.back().empty() || Chance(0.7)) inputs.push_back(Constant(FloatTensor({}, {most})));
    Move("Clip", inputs, x.shape, {"", {}, std::max(2.0, x.most), x.error});
  }

  void Concat(const Of& x) {
    if (x.shape.empty()) return;
    const int axis = Int(0, static_cast<int>(x.shape.size()) - 1);
    const auto at = static_cast<std::size_t>(axis);
    std::vector<std::string> inputs;
    Of all{"", x.shape, 0, 0};
    all.shape[at] = 0;
    for (int k = Int(1, 4); k > 0; --k) {
      std::vector<Of> fitting;
      std::ranges::copy_if(tensors_, std::back_inserter(fitting), [&](const Of& y) {
        Shape same = y.shape;
        if (same.size() == x.shape.size()) same[at] = x.shape[at];
        return same == x.shape;
      });
      const Of& y = Pick(fitting);
      inputs.push_back(y.name);
      all.shape[at] += y.shape[at];
      all.most = std::max(all.most, y.most);
      all.error = std::max(all.error, y.error);
    }
    Move("Concat", inputs, all.shape, all, {{"axis", std::int64_t{AxisFromEitherEnd(axis, x.shape)}}});
  }

  void Slice(const Of& x) {
    Shape axes, starts, ends, steps, to = x.shape;
    for (std::size_t axis = 0; axis < x.shape.size(); ++axis) {
      if (Chance(0.4)) continue;
      const int length = static_cast<int>(x.shape[axis]),
                step = opset_ < 10 ? 1 : Pick(std::vector<int>{1, 1, 2, -1, -2});
      // from `first` on, so many numbers; the end may stand beyond the axis
      const int first = Int(0, length - 1),
                count = Int(1, step > 0 ? (length - 1 - first) / step + 1 : first / -step + 1);
      int end = first + step * count;
      if (end < 0) end = -length - 1;
      const bool to_the_end = first + step * count < 0 || first + step * count >= length;
      axes.push_back(static_cast<int>(axis));
      starts.push_back(Chance(0.5) ? first : first - length);
      ends.push_back(to_the_end && Chance(0.5) ? (step > 0 ? std::numeric_limits<std::int64_t>::max() : -10'000) : end);
      steps.push_back(step);
      to[axis] = count;
    }
    if (axes.empty()) return;
    std::vector<std::string> inputs = {x.name};
    OnnxAttributes attributes;
    Parameter("starts", starts, 10, inputs, attributes);
    Parameter("ends", ends, 10, inputs, attributes);
    Parameter("axes", axes, 10, inputs, attributes);
    if (opset_ >= 10) inputs.push_back(Integers(steps));
    Move("Slice", inputs, to, x, attributes);
  }

  void Reshape(const Of& x) {
    const std::int64_t count = Count(x.shape);
    std::vector<std::int64_t> divisors;
    for (std::int64_t k = 1; k <= count; ++k)
      if (count % k == 0) divisors.push_back(k);
    const std::int64_t rows = Pick(divisors);
    struct Way {
      Shape to, told;
    };
    std::vector<Way> ways = {{{count}, {-1}},
                             {{rows, count / rows}, {rows, -1}},
                             {{rows, count / rows}, {-1, count / rows}},
                             {{1, rows, count / rows}, {1, rows, count / rows}}};
    if (x.shape.size() == 2) ways.push_back({x.shape, {0, -1}});
    const Way way = Pick(ways);
    Move("Reshape", {x.name, Integers(way.told)}, way.to, x);
  }

  void Flatten(const Of& x) {
    const int axis = Int(0, static_cast<int>(x.shape.size()));
    const Shape outer(x.shape.begin(), x.shape.begin() + axis), inner(x.shape.begin() + axis, x.shape.end());
    Move("Flatten", {x.name}, {Count(outer), Count(inner)}, x, {{"axis", std::int64_t{axis}}});
  }

  void Unsqueeze(const Of& x) {
    if (x.shape.size() > 3) return;
    const int axis = Int(0, static_cast<int>(x.shape.size()));
    Shape to = x.shape;
    to.insert(to.begin() + axis, 1);
    std::vector<std::string> inputs = {x.name};
    OnnxAttributes attributes;
    Parameter("axes", {axis}, 13, inputs, attributes);
    Move("Unsqueeze", inputs, to, x, attributes);
  }

  void Squeeze(const Of& x) {
    const auto one = std::ranges::find(x.shape, 1);
    if (one == x.shape.end()) return;
    const auto axis = static_cast<int>(one - x.shape.begin());
    Shape to = x.shape;
    to.erase(to.begin() + axis);
    std::vector<std::string> inputs = {x.name};
    OnnxAttributes attributes;
    Parameter("axes", {axis}, 13, inputs, attributes);
    Move("Squeeze", inputs, to, x, attributes);
  }

  void Transpose(const Of& x) {
    Shape order, to;
    for (std::size_t k = 0; k < x.shape.size(); ++k) order.push_back(static_cast<std::int64_t>(k));
    std::ranges::shuffle(order, random_);
    for (const std::int64_t axis : order) to.push_back(x.shape[static_cast<std::size_t>(axis)]);
    if (!order.empty()) Move("Transpose", {x.name}, to, x, {{"perm", order}});
  }

  void Reduce(const Of& x) {
    if (x.shape.empty()) return;
    const std::string op = Pick(std::vector<std::string>{"ReduceSum", "ReduceMean", "ReduceMax"});
    const bool all = Chance(0.15), keeps = Chance(0.5);
    Shape axes, to;
    std::int64_t terms = 1;
    for (std::size_t k = 0; k < x.shape.size(); ++k) {
      const bool goes = all || Chance(0.5);
      if (goes) axes.push_back(AxisFromEitherEnd(static_cast<int>(k), x.shape));
      if (goes) terms *= x.shape[k];
      if (!goes || keeps) to.push_back(goes ? 1 : x.shape[k]);
    }
    if (axes.empty()) return;
    std::vector<std::string> inputs = {x.name};
    OnnxAttributes attributes = {{"keepdims", std::int64_t{keeps}}};
    if (!all) Parameter("axes", axes, op == "ReduceSum" ? 13 : 18, inputs, attributes);
    const auto n = static_cast<double>(terms);
    const double factor = op == "ReduceSum" ? n : 1, rounding = op == "ReduceMax" ? 0 : kUnit * n * factor * x.most;
    Add(op, inputs, to, factor * x.most, factor * x.error + rounding, attributes);
  }

  void Softmax(const Of& x) {
    if (x.shape.empty()) return;
    const int last = static_cast<int>(x.shape.size()) - 1, axis = opset_ < 13 ? last : Int(0, last);
    Add("Softmax", {x.name}, x.shape, 1,
        2 * x.error + kUnit * static_cast<double>(x.shape[static_cast<std::size_t>(axis)] + 4),
        {{"axis", std::int64_t{axis}}});
  }

  /// The newest tensors side by side, as the answer.
  void Finish() {
    std::vector<std::string> rows;
    std::int64_t count = 0;
    for (std::size_t k = tensors_.size() - std::min<std::size_t>(8, tensors_.size()); k < tensors_.size(); ++k) {
      const std::int64_t numbers = Count(tensors_[k].shape);
      const std::string row = NewName();
      model_.Node("Reshape", {tensors_[k].name, Integers({1, numbers})}, row);
      rows.push_back(row);
      count += numbers;
    }
    model_.Node("Concat", rows, "y", {{"axis", 1}}).Output("y", static_cast<int>(count));
  }

  std::mt19937 random_;
  int wide_, opset_, names_ = 0;
  OnnxModel model_;
  std::vector<Of> tensors_;
};

}  // namespace mascot::test
