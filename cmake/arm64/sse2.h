// What Eigen takes of <mmintrin.h>, <xmmintrin.h> and <emmintrin.h>, and of g++ itself, for processors that are not
// x86.
#pragma once

#define SIMDE_NO_NATIVE  // by g++'s vectors: NEON's own types are not those that Eigen's wrappers expect
#define SIMDE_ENABLE_NATIVE_ALIASES
#include <simde/x86/sse2.h>

#define __builtin_ia32_sqrtsd(x) _mm_sqrt_pd(x)
#define __builtin_ia32_sqrtss(x) _mm_sqrt_ps(x)
