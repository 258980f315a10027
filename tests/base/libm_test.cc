// The functions of libm as the programs have them.
#include <dlfcn.h>
#include <gmock/gmock.h>

#include <Eigen/Core>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "base/complex_division.h"
#include "base/sines.h"

namespace mascot {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Function {
  std::string name;
  std::function<double(double)> ours;
  std::function<long double(long double)> exact;  ///< to 64 bits
  double from, to;
  double ulps = 1.0;  ///< error bound
};

const Function kFunctions[] = {
    {"sin", [](double x) { return std::sin(x); }, [](long double x) { return std::sin(x); }, -100, 100},
    {"cos", [](double x) { return std::cos(x); }, [](long double x) { return std::cos(x); }, -100, 100},
    {"tan", [](double x) { return std::tan(x); }, [](long double x) { return std::tan(x); }, -100, 100},
    {"asin", [](double x) { return std::asin(x); }, [](long double x) { return std::asin(x); }, -1, 1},
    {"acos", [](double x) { return std::acos(x); }, [](long double x) { return std::acos(x); }, -1, 1},
    {"atan", [](double x) { return std::atan(x); }, [](long double x) { return std::atan(x); }, -10, 10},
    {"sinh", [](double x) { return std::sinh(x); }, [](long double x) { return std::sinh(x); }, -20, 20},
    {"cosh", [](double x) { return std::cosh(x); }, [](long double x) { return std::cosh(x); }, -20, 20},
    {"tanh", [](double x) { return std::tanh(x); }, [](long double x) { return std::tanh(x); }, -5, 5},
    {"asinh", [](double x) { return std::asinh(x); }, [](long double x) { return std::asinh(x); }, -100, 100},
    {"acosh", [](double x) { return std::acosh(x); }, [](long double x) { return std::acosh(x); }, 1, 100},
    {"atanh", [](double x) { return std::atanh(x); }, [](long double x) { return std::atanh(x); }, -1, 1},
    {"exp", [](double x) { return std::exp(x); }, [](long double x) { return std::exp(x); }, -700, 700},
    {"exp2", [](double x) { return std::exp2(x); }, [](long double x) { return std::exp2(x); }, -1000, 1000},
    {"expm1", [](double x) { return std::expm1(x); }, [](long double x) { return std::expm1(x); }, -10, 10},
    {"log", [](double x) { return std::log(x); }, [](long double x) { return std::log(x); }, 0, 1000},
    {"log2", [](double x) { return std::log2(x); }, [](long double x) { return std::log2(x); }, 0, 1000},
    {"log10", [](double x) { return std::log10(x); }, [](long double x) { return std::log10(x); }, 0, 1000},
    {"log1p", [](double x) { return std::log1p(x); }, [](long double x) { return std::log1p(x); }, -1, 10},
    {"cbrt", [](double x) { return std::cbrt(x); }, [](long double x) { return std::cbrt(x); }, -1000, 1000},
    {"erf", [](double x) { return std::erf(x); }, [](long double x) { return std::erf(x); }, -5, 5},
    {"erfc", [](double x) { return std::erfc(x); }, [](long double x) { return std::erfc(x); }, -5, 25, 1.5},
    {"tgamma", [](double x) { return std::tgamma(x); }, [](long double x) { return std::tgamma(x); }, 0.1, 100},
    {"atan2", [](double x) { return std::atan2(x, 0.75); }, [](long double x) { return std::atan2(x, 0.75L); }, -9, 9},
    {"pow", [](double x) { return std::pow(x, -1.75); }, [](long double x) { return std::pow(x, -1.75L); }, 0, 1000},
    {"hypot", [](double x) { return std::hypot(x, 0.75); }, [](long double x) { return std::hypot(x, 0.75L); }, -9, 9},
};

class Libm : public testing::TestWithParam<Function> {};

TEST_P(Libm, IsExactToItsUnitsInTheLastPlace) {
  const Function& f = GetParam();
  std::mt19937_64 random(1);
  for (int k = 0; k < 20'000; ++k) {
    const double x = f.from + (f.to - f.from) * (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53;
    const long double exact = f.exact(x);
    const double magnitude = std::abs(static_cast<double>(exact));
    const double ulp = std::nextafter(magnitude, kInfinity) - magnitude;
    ASSERT_LE(std::abs(static_cast<double>((f.ours(x) - exact) / ulp)), f.ulps) << x;
  }
}

INSTANTIATE_TEST_SUITE_P(Functions, Libm, testing::ValuesIn(kFunctions),
                         [](const auto& param_info) { return param_info.param.name; });

/// Bits of all functions at many places, as one number (FNV-1a).
std::uint64_t Bits() {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const Function& f : kFunctions) {
    std::mt19937_64 random(2);
    for (int k = 0; k < 1000; ++k) {
      const double x = f.from + (f.to - f.from) * (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53;
      const unsigned __int128 product = hash ^ std::bit_cast<std::uint64_t>(f.ours(x));
      hash = static_cast<std::uint64_t>(product * 0x100000001b3);
    }
  }
  return hash;
}

TEST(LibmOf, EveryProcessorGivesTheseBits) { EXPECT_EQ(Bits(), 11286657497132857937u); }

TEST(LibmOf, TwoAnglesHasTheBitsOfEach) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> small(-2, 2), any(-1e6, 1e6);
  for (int k = 0; k < 100'000; ++k) {
    const Eigen::Vector2d angles(small(random), k % 2 == 0 ? small(random) : any(random));
    const SinesAndCosines of = SinesAndCosinesOf(angles);
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(of.sin[i], std::sin(angles[i])) << angles[i];
      ASSERT_EQ(of.cos[i], std::cos(angles[i])) << angles[i];
    }
  }
}

/// A number of any magnitude, at times one of those that need care.
double AnyNumber(std::mt19937_64& random) {
  constexpr double kSpecial[] = {
      0, -0.0, kInfinity, -kInfinity, 1, 0x1p-1074, 0x1p-1022, 0x1p1023, 0x1.fffffffffffffp1023};
  if (random() % 8 == 0) return kSpecial[random() % std::size(kSpecial)];
  const double fraction = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
  const int any = static_cast<int>(random() % 2040) - 1030, usual = static_cast<int>(random() % 20) - 10;
  return std::ldexp(fraction, random() % 2 == 0 ? any : usual);
}

TEST(Quotient, HasTheBitsOfTheDivisionOfTheCompilerOnX86) {
#ifndef __x86_64__
  GTEST_SKIP() << "the compiler's division of complex numbers is ours on this processor";
#endif
  std::mt19937_64 random(4);
  for (int k = 0; k < 1'000'000; ++k) {
    const double a = AnyNumber(random), b = AnyNumber(random), c = AnyNumber(random), d = AnyNumber(random);
    const std::complex<double> theirs = std::complex(a, b) / std::complex(c, d), ours = Quotient({a, b}, {c, d});
    const auto same = [](double x, double y) {
      return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y) || (std::isnan(x) && std::isnan(y));
    };
    ASSERT_TRUE(same(ours.real(), theirs.real()) && same(ours.imag(), theirs.imag()))
        << "(" << a << ", " << b << ") / (" << c << ", " << d << "): " << ours << ", expected " << theirs;
  }
}

TEST(ProductsOfMatrices, AreComputedInTheSameBlocksOnEveryProcessor) {
  EXPECT_EQ(Eigen::l1CacheSize(), 32 << 10);
  EXPECT_EQ(Eigen::l2CacheSize(), 256 << 10);
  EXPECT_EQ(Eigen::l3CacheSize(), 2 << 20);
}

TEST(LibmOf, ThisProgramIsThatOfItsSharedLibrariesToo) {
  Dl_info program, info;
  ASSERT_NE(dladdr(reinterpret_cast<void*>(&Bits), &program), 0);
  for (const std::string name : {"sin",   "cos",   "tan",   "sincos", "asin",  "acos", "atan",  "atan2", "sinh", "cosh",
                                 "tanh",  "asinh", "acosh", "atanh",  "exp",   "exp2", "exp10", "expm1", "log",  "log2",
                                 "log10", "log1p", "pow",   "cbrt",   "hypot", "erf",  "erfc",  "tgamma"})
    for (const std::string& function : {name, name + "f"}) {
      void* found = dlsym(RTLD_DEFAULT, function.c_str());
      ASSERT_NE(dladdr(found, &info), 0) << function;
      EXPECT_EQ(info.dli_fbase, program.dli_fbase) << function << " is that of " << info.dli_fname;
    }
}

TEST(LibmOf, SpecialValuesAreThoseOfTheCStandard) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const volatile double zero = 0, minus_zero = -0.0, infinite = kInfinity;
  EXPECT_TRUE(std::signbit(std::sin(minus_zero)));
  EXPECT_TRUE(std::isnan(std::sin(infinite)));
  EXPECT_EQ(std::cos(zero), 1);
  EXPECT_EQ(std::atan2(minus_zero, -1.0), -M_PI);
  EXPECT_EQ(std::atan2(zero, -1.0), M_PI);
  EXPECT_EQ(std::atan2(infinite, infinite), M_PI / 4);
  EXPECT_EQ(std::exp(infinite), infinite);
  EXPECT_EQ(std::exp(-infinite), 0);
  EXPECT_EQ(std::log(zero), -infinite);
  EXPECT_TRUE(std::isnan(std::log(zero - 1)));
  EXPECT_TRUE(std::isnan(std::asin(zero + 2)));
  EXPECT_EQ(std::pow(nan, zero), 1);
  EXPECT_EQ(std::pow(zero - 8, zero + 3), -512);
  EXPECT_TRUE(std::isnan(std::pow(zero - 8, zero + 0.5)));
  EXPECT_EQ(std::hypot(infinite, nan), infinite);
  double sine = 0, cosine = 0;
  sincos(zero + 0.5, &sine, &cosine);
  EXPECT_EQ(sine, std::sin(zero + 0.5));
  EXPECT_EQ(cosine, std::cos(zero + 0.5));
}

}  // namespace
}  // namespace mascot
