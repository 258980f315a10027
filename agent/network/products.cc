// Products of matrices.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "agent/network/node_call.h"

namespace mascot {
namespace {

/// A matrix in numbers that another object has.
struct Matrix {
  std::size_t rows = 0, columns = 0;
  std::size_t row_step = 0, column_step = 1;  ///< from one number to the next
};

/// y (in row-major order) = a b: each number is summed in the order of the columns of `a`.
void Multiply(const double* a, const Matrix& of_a, const double* b, const Matrix& of_b, double* y) {
  for (std::size_t i = 0; i < of_a.rows; ++i) {
    double* const row = y + i * of_b.columns;
    std::fill_n(row, of_b.columns, 0.0);
    for (std::size_t k = 0; k < of_a.columns; ++k) {
      const double factor = a[i * of_a.row_step + k * of_a.column_step];
      const double* const row_of_b = b + k * of_b.row_step;
      if (of_b.column_step == 1)
        for (std::size_t j = 0; j < of_b.columns; ++j) row[j] += factor * row_of_b[j];
      else
        for (std::size_t j = 0; j < of_b.columns; ++j) row[j] += factor * row_of_b[j * of_b.column_step];
    }
  }
}

void ExpectFit(const Matrix& a, const Matrix& b) {
  if (a.columns != b.rows)
    throw NetworkError(
        fmt::format("expected matrices that fit, got {} x {} and {} x {}", a.rows, a.columns, b.rows, b.columns));
}

/// An input of Gemm.
struct Factor {
  Matrix matrix;
  std::vector<double> transposed;  // its numbers, if they are constant and to be transposed: rows then stand together

  Factor(const Operand& operand, bool is_transposed) {
    if (operand.shape.size() != 2)
      throw NetworkError(fmt::format("expected matrices, got shape {}", ShapeText(operand.shape)));
    const auto rows = static_cast<std::size_t>(operand.shape[0]), columns = static_cast<std::size_t>(operand.shape[1]);
    matrix = {rows, columns, columns, 1};
    if (!is_transposed) return;
    matrix = {columns, rows, 1, columns};
    if (operand.constant == nullptr) return;
    matrix = {columns, rows, rows, 1};
    transposed.resize(rows * columns);
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < columns; ++j) transposed[j * rows + i] = operand.constant->numbers[i * columns + j];
  }
  const double* Of(const double* numbers) const { return transposed.empty() ? numbers : transposed.data(); }
};

NodePlan PlanGemm(const NodeCall& call) {
  call.ExpectInputs(2, 3);
  const Factor a(call.Input(0), call.Get<std::int64_t>("transA", 0) != 0),
      b(call.Input(1), call.Get<std::int64_t>("transB", 0) != 0);
  ExpectFit(a.matrix, b.matrix);
  const TensorShape shape{static_cast<std::int64_t>(a.matrix.rows), static_cast<std::int64_t>(b.matrix.columns)};
  Indices in_c;
  if (call.Has(2)) {
    const TensorShape& c = call.Shape(2);
    if (Broadcast(c, shape) != shape)
      throw NetworkError(fmt::format("expected shapes that fit, got {} and {}", ShapeText(shape), ShapeText(c)));
    in_c = PlacesIn(c, shape);
  }
  const double alpha = call.Get<double>("alpha", 1), beta = call.Get<double>("beta", 1);
  return {.shape = shape,
          .kernel =
              [=](std::span<const double* const> in, double* out) {
                Multiply(a.Of(in[0]), a.matrix, b.Of(in[1]), b.matrix, out);
                const std::size_t numbers = a.matrix.rows * b.matrix.columns;
                if (alpha != 1)
                  for (std::size_t k = 0; k < numbers; ++k) out[k] *= alpha;
                for (std::size_t k = 0; k < in_c.size(); ++k) out[k] += beta * in[2][in_c[k]];
              },
          .products = a.matrix.rows * a.matrix.columns * b.matrix.columns};
}

NodePlan PlanMatMul(const NodeCall& call) {
  call.ExpectInputs(2, 2);
  TensorShape a = call.Shape(0), b = call.Shape(1);
  if (a.empty() || b.empty()) throw NetworkError("expected vectors and matrices, got a single number");
  const bool row = a.size() == 1, column = b.size() == 1;
  if (row) a.insert(a.begin(), 1);
  if (column) b.push_back(1);
  const auto last_two = [](const TensorShape& shape) {
    const auto columns = static_cast<std::size_t>(shape.back());
    return Matrix{static_cast<std::size_t>(shape[shape.size() - 2]), columns, columns, 1};
  };
  const Matrix of_a = last_two(a), of_b = last_two(b);
  ExpectFit(of_a, of_b);
  const TensorShape stack_a(a.begin(), a.end() - 2), stack_b(b.begin(), b.end() - 2),
      stack = Broadcast(stack_a, stack_b);
  TensorShape shape = stack;
  if (!row) shape.push_back(static_cast<std::int64_t>(of_a.rows));
  if (!column) shape.push_back(static_cast<std::int64_t>(of_b.columns));
  NumbersIn(shape);
  return {.shape = std::move(shape),
          .kernel =
              [=, in_a = PlacesIn(stack_a, stack), in_b = PlacesIn(stack_b, stack)](std::span<const double* const> in,
                                                                                    double* out) {
                for (std::size_t k = 0; k < in_a.size(); ++k)
                  Multiply(in[0] + in_a[k] * of_a.rows * of_a.columns, of_a, in[1] + in_b[k] * of_b.rows * of_b.columns,
                           of_b, out + k * of_a.rows * of_b.columns);
              },
          .products = NumbersIn(stack) * of_a.rows * of_a.columns * of_b.columns};
}

}  // namespace

std::vector<Operator> ProductOperators() {
  return {
      {.name = "Gemm", .plan = PlanGemm, .attributes = {"alpha", "beta", "transA", "transB"}},
      {.name = "MatMul", .plan = PlanMatMul},
  };
}

}  // namespace mascot
