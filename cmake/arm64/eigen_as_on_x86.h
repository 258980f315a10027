// For aarch64 (the compiler includes this first in each source that uses Eigen): Eigen computes by its code for SSE2,
// of which every x86-64 processor has the bits. Its own code for NEON rounds a * b + c once, where x86-64 rounds twice,
// and takes the terms of products of matrices in another order. The instructions of SSE2 are those of SIMDe
// (libsimde-dev), which g++ makes NEON of.
#pragma once

#ifdef __cplusplus
#define __SSE__ 1
#define __SSE2__ 1
#include <Eigen/Core>
#undef __SSE__
#undef __SSE2__
#ifndef EIGEN_VECTORIZE_SSE2
#error "expected Eigen to take its code for SSE2"
#endif
#endif
