// The kernels' texts for AVX2 and AVX-512. GCC splits vectors that are wider than its target's registers before it
// inlines. A target attribute on the caller comes too late, so the whole text is compiled under each target. What a
// translation unit is compiled for needs no text of its own. Included after dispatch.hpp's tables and portable text.
#pragma once

#ifdef __x86_64__
#ifdef __AVX2__
namespace rlslab::kernels {
namespace avx2 = portable;
}
#else
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
namespace rlslab::kernels::avx2 {
#include <rlslab/linalg/kernels/all.hpp>
}
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
namespace rlslab::kernels {
namespace avx512 = portable;
}
#else
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512vl")
#pragma GCC optimize("fp-contract=off")
#endif
namespace rlslab::kernels::avx512 {
#include <rlslab/linalg/kernels/all.hpp>
}
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
#endif
