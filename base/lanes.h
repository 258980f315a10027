#pragma once

// Several numbers at once, in the vector registers of the processor. This header is for sources that are compiled for
// one kind of them: it has what the compiler's options allow, four lanes with AVX, two with SSE2 or on aarch64, and
// else one.
//
// Each operation rounds in each lane as that of a double does, and the functions of libm are SLEEF's deterministic
// ones, which base/libm.cc takes, too. So a program may take as many lanes as its processor has: the results have the
// same bits.
//
// All of it is internal and inlined. A source for AVX must have no inline function of its own or of others that the
// linker could share with the rest of the program, which runs on processors without AVX.
#include <sleef.h>

#include <cstddef>
#include <cstring>

#if defined(__SSE2__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

#define MASCOT_IN_LANES [[gnu::always_inline]] inline

namespace mascot {
namespace {  // NOLINT(google-build-namespaces): on purpose, see above

#if defined(__AVX__)
constexpr std::ptrdiff_t kLanes = 4;
#elif defined(__SSE2__) || defined(__aarch64__)
constexpr std::ptrdiff_t kLanes = 2;
#else
constexpr std::ptrdiff_t kLanes = 1;
#endif

/// A number in each lane. + - * / and comparisons work lane by lane; a double beside it stands for itself in each lane.
using Real = double __attribute__((vector_size(sizeof(double) * kLanes)));
/// What comparisons give, for `mask ? a : b` lane by lane.
using Mask = decltype(Real{} < Real{});

MASCOT_IN_LANES Real Load(const double* numbers) {
  Real all;
  std::memcpy(&all, numbers, sizeof all);
  return all;
}
MASCOT_IN_LANES void Store(Real all, double* numbers) { std::memcpy(numbers, &all, sizeof all); }
MASCOT_IN_LANES Real InEach(double number) { return number - Real{}; }  // -0 stays -0

/// The fields of one block of LaneNumbers (base/lane_numbers.h): those of `kLanes` things.
class Block {
 public:
  explicit Block(double* numbers) : numbers_(numbers) {}
  Real Get(int field) const { return Load(numbers_ + field * kLanes); }
  void Set(int field, Real value) const { Store(value, numbers_ + field * kLanes); }

 private:
  double* numbers_;
};

MASCOT_IN_LANES bool AllOf(Mask mask) {
  for (std::ptrdiff_t lane = 0; lane < kLanes; ++lane)
    if (mask[lane] == 0) return false;
  return true;
}

MASCOT_IN_LANES bool AnyOf(Mask mask) {
  for (std::ptrdiff_t lane = 0; lane < kLanes; ++lane)
    if (mask[lane] != 0) return true;
  return false;
}

/// As std::max and std::min take them: `a` where they are equal or one is NaN.
MASCOT_IN_LANES Real Max(Real a, Real b) { return a < b ? b : a; }
MASCOT_IN_LANES Real Min(Real a, Real b) { return b < a ? b : a; }
/// As std::clamp.
MASCOT_IN_LANES Real Clamp(Real x, Real low, Real high) { return x < low ? low : high < x ? high : x; }
MASCOT_IN_LANES Real Abs(Real x) { return reinterpret_cast<Real>(reinterpret_cast<Mask>(x) & 0x7FFFFFFFFFFFFFFF); }

#if defined(__AVX__)
MASCOT_IN_LANES Real Sqrt(Real x) { return _mm256_sqrt_pd(x); }
MASCOT_IN_LANES Real Sin(Real x) { return Sleef_cinz_sind4_u10avx(x); }
MASCOT_IN_LANES Real Cos(Real x) { return Sleef_cinz_cosd4_u10avx(x); }
MASCOT_IN_LANES Real Asin(Real x) { return Sleef_cinz_asind4_u10avx(x); }
MASCOT_IN_LANES Real Atan2(Real y, Real x) { return Sleef_cinz_atan2d4_u10avx(y, x); }
MASCOT_IN_LANES Real Hypot(Real x, Real y) { return Sleef_cinz_hypotd4_u05avx(x, y); }
#elif defined(__SSE2__)
MASCOT_IN_LANES Real Sqrt(Real x) { return _mm_sqrt_pd(x); }
MASCOT_IN_LANES Real Sin(Real x) { return Sleef_cinz_sind2_u10sse2(x); }
MASCOT_IN_LANES Real Cos(Real x) { return Sleef_cinz_cosd2_u10sse2(x); }
MASCOT_IN_LANES Real Asin(Real x) { return Sleef_cinz_asind2_u10sse2(x); }
MASCOT_IN_LANES Real Atan2(Real y, Real x) { return Sleef_cinz_atan2d2_u10sse2(y, x); }
MASCOT_IN_LANES Real Hypot(Real x, Real y) { return Sleef_cinz_hypotd2_u05sse2(x, y); }
#elif defined(__aarch64__)
MASCOT_IN_LANES Real Sqrt(Real x) { return vsqrtq_f64(x); }
MASCOT_IN_LANES Real Sin(Real x) { return Sleef_cinz_sind2_u10advsimdnofma(x); }
MASCOT_IN_LANES Real Cos(Real x) { return Sleef_cinz_cosd2_u10advsimdnofma(x); }
MASCOT_IN_LANES Real Asin(Real x) { return Sleef_cinz_asind2_u10advsimdnofma(x); }
MASCOT_IN_LANES Real Atan2(Real y, Real x) { return Sleef_cinz_atan2d2_u10advsimdnofma(y, x); }
MASCOT_IN_LANES Real Hypot(Real x, Real y) { return Sleef_cinz_hypotd2_u05advsimdnofma(x, y); }
#else
MASCOT_IN_LANES Real Sqrt(Real x) { return InEach(__builtin_sqrt(x[0])); }
MASCOT_IN_LANES Real Sin(Real x) { return InEach(Sleef_cinz_sind1_u10purec(x[0])); }
MASCOT_IN_LANES Real Cos(Real x) { return InEach(Sleef_cinz_cosd1_u10purec(x[0])); }
MASCOT_IN_LANES Real Asin(Real x) { return InEach(Sleef_cinz_asind1_u10purec(x[0])); }
MASCOT_IN_LANES Real Atan2(Real y, Real x) { return InEach(Sleef_cinz_atan2d1_u10purec(y[0], x[0])); }
MASCOT_IN_LANES Real Hypot(Real x, Real y) { return InEach(Sleef_cinz_hypotd1_u05purec(x[0], y[0])); }
#endif

}  // namespace
}  // namespace mascot
