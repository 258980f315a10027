// Prints a hash of each kind of arithmetic by which agents decide, over many made-up numbers: programs for two kinds of
// processors, of which agents decide alike, print the same lines (docs/arm64.md, tests/arm64_test.py).
#include <Eigen/Dense>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <random>
#include <utility>

#include "agent/controllers/lanes/actuate_in_lanes.h"
#include "base/lane_numbers.h"
#include "base/linear_algebra.h"
#include "base/random.h"
#include "base/sines.h"

namespace mascot {
namespace {

/// FNV-1a of the bits of numbers. All that is not a number is one: its sign differs between processors.
class Hash {
 public:
  void Take(double x) {
    const std::uint64_t bits = std::isnan(x) ? 0x7ff8000000000000u : std::bit_cast<std::uint64_t>(x);
    hash_ = (hash_ ^ bits) * 0x100000001b3u;
  }
  void Take(std::complex<double> z) {
    Take(z.real());
    Take(z.imag());
  }
  template <class Derived>
  void Take(const Eigen::EigenBase<Derived>& numbers) {
    const auto computed = numbers.derived().eval();
    for (Eigen::Index k = 0; k < computed.size(); ++k) Take(computed.reshaped()[k]);
  }
  std::uint64_t Value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

class Numbers {
 public:
  /// In [-1, 1).
  double Next() { return random_.In(-1, 1); }
  template <class Matrix>
  Matrix Next(Eigen::Index rows, Eigen::Index columns) {
    Matrix matrix(rows, columns);
    for (double& x : matrix.reshaped()) x = Next();
    return matrix;
  }

 private:
  Random random_{7, Random::Stream::kPositions};
};

void Functions(Numbers& numbers, Hash& hash) {
  for (int k = 0; k < 20'000; ++k) {
    const double x = numbers.Next(), y = numbers.Next(), wide = 100 * x;
    for (const double result : {std::sin(wide),
                                std::cos(wide),
                                std::tan(wide),
                                std::asin(x),
                                std::acos(x),
                                std::atan(wide),
                                std::sinh(wide),
                                std::cosh(wide),
                                std::tanh(x),
                                std::asinh(wide),
                                std::acosh(1 + std::abs(wide)),
                                std::atanh(x),
                                std::exp(wide),
                                std::exp2(wide),
                                std::expm1(x),
                                std::log(std::abs(wide)),
                                std::log2(std::abs(wide)),
                                std::log10(std::abs(wide)),
                                std::log1p(x),
                                std::pow(std::abs(wide), y),
                                std::cbrt(wide),
                                std::hypot(wide, y),
                                std::erf(x),
                                std::erfc(wide),
                                std::tgamma(10 * std::abs(x)),
                                std::atan2(wide, y),
                                std::fmod(wide, y),
                                std::remainder(wide, y),
                                std::sqrt(std::abs(wide)),
                                std::round(wide),
                                std::ldexp(x, k % 50)})
      hash.Take(result);
    const SinesAndCosines two = SinesAndCosinesOf({wide, y});
    hash.Take(two.sin);
    hash.Take(two.cos);
  }
}

void ComplexNumbers(Numbers& numbers, Hash& hash) {
  for (int k = 0; k < 20'000; ++k) {
    const std::complex<double> z{numbers.Next(), numbers.Next()}, w{numbers.Next(), 1e-3 * numbers.Next()};
    hash.Take(z * w);
    hash.Take(z / w);
    hash.Take(std::norm(z));
    hash.Take(std::polar(1.0, w.real()));
  }
}

void Dices(Numbers&, Hash& hash) {
  const Dice dice(3, Dice::Stream::kLink, 1, 2);
  for (int k = 0; k < 20'000; ++k) hash.Take(dice.Normal(k, 5));
}

/// What laws and controllers compute of few numbers.
void SmallMatrices(Numbers& numbers, Hash& hash) {
  for (int k = 0; k < 5'000; ++k) {
    const auto a = numbers.Next<Eigen::Matrix3d>(3, 3), b = numbers.Next<Eigen::Matrix3d>(3, 3);
    const auto v = numbers.Next<Eigen::Vector3d>(3, 1);
    const auto four = numbers.Next<Eigen::Matrix4d>(4, 4);
    const Eigen::Quaterniond q(numbers.Next<Eigen::Vector4d>(4, 1).normalized());
    hash.Take(a * b);
    hash.Take(a * v);
    hash.Take(a.transpose() * v);
    hash.Take(a.inverse());
    hash.Take(v.cross(a.col(0)));
    hash.Take(v.normalized() * v.dot(a.col(1)));
    hash.Take(a.determinant() + v.head<2>().norm() + four.determinant());
    hash.Take(four.inverse() * four.col(0));
    hash.Take(four.topLeftCorner<2, 2>() * v.head<2>());
    hash.Take(q.toRotationMatrix());
    hash.Take(q * v);
    hash.Take((q * Eigen::Quaterniond(q.toRotationMatrix())).coeffs());
  }
}

// What laws compute at their start, of matrices of a whole team:

constexpr Eigen::Index kLargest = 40;

void Products(Numbers& numbers, Hash& hash) {
  for (Eigen::Index n = 1; n < kLargest; ++n) {
    const auto a = numbers.Next<Eigen::MatrixXd>(n, n), b = numbers.Next<Eigen::MatrixXd>(n, n / 2 + 1);
    const auto v = numbers.Next<Eigen::VectorXd>(n, 1), w = numbers.Next<Eigen::VectorXd>(n, 1);
    hash.Take(v.dot(w) + v.sum() + v.norm() + v.segment(n / 3, n / 2).squaredNorm());
    hash.Take(a * v);
    hash.Take(a.transpose() * v);
    hash.Take(a * b);
    hash.Take(b.transpose() * a);
  }
}

void BlocksOfProducts(Numbers& numbers, Hash& hash) {
  const auto large = numbers.Next<Eigen::MatrixXd>(300, 520), other = numbers.Next<Eigen::MatrixXd>(520, 7);
  hash.Take(large * other);
}

void Solutions(Numbers& numbers, Hash& hash) {
  for (Eigen::Index n = 1; n < kLargest; ++n) {
    const auto a = numbers.Next<Eigen::MatrixXd>(n, n), b = numbers.Next<Eigen::MatrixXd>(n, n / 2 + 1);
    hash.Take(Solve(a, b.col(0)));
    hash.Take(SolveColumns(a, b));
    hash.Take(LeastSquares(a, b.col(0)));
  }
}

void Eigensystems(Numbers& numbers, Hash& hash) {
  for (Eigen::Index n = 1; n < kLargest; ++n) {
    const auto a = numbers.Next<Eigen::MatrixXd>(n, n);
    hash.Take(SymmetricEigensystemOf(a + a.transpose()).vectors);
    hash.Take(EigensystemOf(a).vectors);
  }
}

/// The low-level stacks of quadrotors, as many at once as this processor's registers hold.
void Controllers(Numbers& numbers, Hash& hash) {
  constexpr std::size_t kQuadrotors = 64;
  LaneNumbers stacks(kQuadrotors, StackField::kCount, kLanes);
  for (std::size_t i = 0; i < kQuadrotors; ++i) {
    for (int field = 0; field < StackField::kCount; ++field) stacks.At(i, field) = 1 + 0.5 * numbers.Next();
    for (int field = 0; field < StackField::kRotors; ++field) stacks.At(i, field) = numbers.Next();
    for (int field = StackField::kMixer; field < StackField::kCount; ++field)
      stacks.At(i, field) = 1e3 * numbers.Next();
    stacks.At(i, StackField::kPeriod) = 0.01;
    stacks.At(i, StackField::kMaxSquared) = 1e4;
    stacks.At(i, StackField::kIsExact) = i % 3 == 0 ? 1 : 0;
    stacks.At(i, StackField::kHoldsAltitude) = i % 5 == 0 ? 1 : 0;
  }
  for (int tick = 0; tick < 1'000; ++tick) {
    for (std::size_t i = 0; i < kQuadrotors; ++i)
      for (int field = 0; field < StackField::kPRef; ++field) stacks.At(i, field) += 0.1 * numbers.Next();
    ActuateBlocks(stacks.Block(0), stacks.blocks());
    for (std::size_t i = 0; i < kQuadrotors; ++i)
      for (int field = StackField::kPRef; field < StackField::kHoldsAltitude; ++field) hash.Take(stacks.At(i, field));
  }
}

}  // namespace
}  // namespace mascot

int main() {
  using Part = void(mascot::Numbers&, mascot::Hash&);
  const std::pair<const char*, Part*> parts[] = {
      {"functions", mascot::Functions},     {"complex numbers", mascot::ComplexNumbers},
      {"random numbers", mascot::Dices},    {"small matrices", mascot::SmallMatrices},
      {"products", mascot::Products},       {"blocks of products", mascot::BlocksOfProducts},
      {"solutions", mascot::Solutions},     {"eigensystems", mascot::Eigensystems},
      {"controllers", mascot::Controllers},
  };
  for (const auto& [name, part] : parts) {
    mascot::Numbers numbers;
    mascot::Hash hash;
    part(numbers, hash);
    std::printf("%-18s %016llx\n", name, static_cast<unsigned long long>(hash.Value()));
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}
