// What clang needs before the library when it compiles for a GPU without a CUDA toolkit: the standard headers, outside
// of the region in which all functions are compiled for both sides, and the little of libm that the variants call.
#pragma once

#ifdef __CUDA__  // for any other compiler the standard headers alone
// as clang's own wrappers of the standard headers spell them
#define __host__ __attribute__((host))
#define __device__ __attribute__((device))

// Before <cmath>'s `using ::sqrt`, so that std has both sides' functions.
extern "C" {
__device__ inline double sqrt(double x) noexcept { return __nvvm_sqrt_rn_d(x); }
__device__ inline float sqrtf(float x) noexcept { return __nvvm_sqrt_rn_f(x); }
/// 2^n x by exponents: exact but for an overflow or underflow, which the library's calls do not reach (x = 1, |n| <=
/// 1000).
__device__ inline double ldexp(double x, int n) noexcept {
    return x * __nvvm_bitcast_ll2d(((long long)n + 1023) << 52);
}
}
#endif

#include <bits/stdc++.h>  // all of them
#ifdef __x86_64__
#include <emmintrin.h>
#endif
