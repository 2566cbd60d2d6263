// The dense kernels by name, each with one text for every arithmetic, compiled for several instruction sets where the
// arithmetic is the hardware's, and the choice among them at start-up. Whatever is chosen, the bits are the same: the texts
// (isa/*.hpp) fix the order of evaluation in blocks of eight rows, nothing is fused, and no lane meets another but in the
// tree that ends a dot product.
#pragma once

#include <rlslab/linalg/dot.hpp>
#include <rlslab/linalg/reflector.hpp>
#include <rlslab/linalg/storage.hpp>

#include <algorithm>
#include <cstdint>
#include <type_traits>
#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace rlslab::kernels {

/// The rows [first, last) of a block.
struct RowRange {
    Index first, last;
};

// --- elementwise: out = x ... over d numbers --------------------------------------------------------------------------

template <class T>
struct OverColumn {
    Index d;
    T const* x;
    T* out;
};
template <class T>
struct DivideByOne : OverColumn<T> {
    T s;
};
template <class T>
struct Divide : OverColumn<T> {
    T const* y;
};
template <class T>
struct Scale : OverColumn<T> {
    T const* y;
};
template <class T>
struct TakeRoots : OverColumn<T> {};
template <class T>
struct AddScaled : OverColumn<T> {
    T a;
    T const* y;
};
template <class T>
struct ScaleByOne : OverColumn<T> {
    T a;
};
template <class T>
struct Add : OverColumn<T> {
    T const* y;
};
template <class T>
struct AddProduct : OverColumn<T> {
    T const *y, *z;
};
/// before_j = s, s += x_j, out_j = s.
template <class T>
struct PrefixSums : OverColumn<T> {
    T* before;
    T* s;
};
template <class T>
struct AllFinite : OverColumn<T> {
    Truth<T>* finite;
};
template <class K>
concept Elementwise = requires(K k) { []<class T>(OverColumn<T> const&) {}(k); };

// --- products -----------------------------------------------------------------------------------------------------------

enum class Shape { full, upper };

template <class T, Shape>
struct MultiplyTransposed {
    Index d, ld;
    T const *A, *x;
    T* out;
};
template <class T>
struct MultiplySquares {
    static constexpr int registers = 8;
    Index d, ld;
    T const *A, *B;
    Index row, column;  // strides of B
    T* out;
};

// --- sweeps over columns: what step j reads, what the running block starts from ------------------------------------------

enum class Start { zero, column, first_product };

template <class T>
struct Multiply {
    static constexpr int registers = 8;
    static constexpr bool upper = false, writes = false;
    static constexpr Start starts = Start::first_product;
    Index d, ld;
    T const* A;
    T* w;
    T const* x;
    T const& at(Index j) const { return x[j]; }
};
template <class T>
struct SubtractRankOne {
    static constexpr int registers = 8;
    static constexpr bool upper = false, writes = true;
    static constexpr Start starts = Start::column;
    Index d, ld;
    T* A;
    T const *w, *f;
    T correction;
    T at(Index j) const { return f[j]; }
};
template <class T>
struct SubtractMirrored {
    static constexpr int registers = 4;
    Index d, ld;
    T* A;
    T const *w, *f;
    T correction;
};
template <class T>
struct SubtractRankTwo {
    static constexpr int registers = 4;
    Index d, ld;
    T* A;
    T const *x, *g;
    T correction;
};
/// Of an upper triangle A, with w running along its rows from zero.
template <class T>
struct OverTriangle {
    static constexpr int registers = 4;
    static constexpr bool upper = true, writes = true;  // below the diagonal the zeros that it computed
    static constexpr Start starts = Start::zero;
    Index d, ld;
    T *A, *w;
};
template <class T>
struct SweepUd : OverTriangle<T> {
    struct At {
        T g, mu;
    };
    T const *g, *mu;
    At at(Index j) const { return {g[j], mu[j]}; }
};
template <class T>
struct SweepCarlson : OverTriangle<T> {
    struct At {
        T f, keep, mix;
    };
    T const *f, *keep, *mix;
    T correction;
    At at(Index j) const { return {f[j], keep[j], mix[j]}; }
};
template <class T>
struct SweepRotations : OverTriangle<T> {
    struct At {
        T c, s;
    };
    T const *c, *s;
    T correction;
    At at(Index j) const { return {c[j], s[j]}; }
};
template <class K>
concept ByRows = requires { K::registers; };
template <class K>
concept Sweep = ByRows<K> && requires { K::starts; };

// --- panels of a lower triangle ------------------------------------------------------------------------------------------

template <class T>
struct Eliminate {
    static constexpr bool writes = false, corners = true;
    Index d, ld;
    T const* L;
    T* x;
};
template <class T>
struct SweepGentleman {
    static constexpr bool writes = true;
    Index d, ld;
    T *L, *x;
    T const *c, *s, *e;
};
template <class T>
struct RotateIn {
    static constexpr bool writes = true, corners = true;
    Index d, ld;
    T *L, *x, *z, *eta, *c, *s;
    T root_lambda;
};
template <class T>
struct ReflectIn {
    static constexpr bool writes = true, corners = true;
    Index d, ld;
    T *L, *x, *z, *eta, *tau, *ratio;
    T weight;
};
template <class K>
concept ByPanels = requires { K::corners; };

// --- reflections: over columns of `rows` numbers, one after another ---------------------------------------------------------

template <class T>
struct SumOfSquares {
    Index rows;
    T const* v;
    T* sum;
};
template <class T>
struct Division {
    Index rows;
    T* v;
    T pivot;
};
template <class T>
struct Reflection {
    Index rows, columns;  // of A, what is right of v
    T const* v;
    T tau;
    T *A, *above, *last;  // above A: its columns' entries in R, the last one's apart
};
template <class K>
concept OnColumns = requires(K k) { k.rows; };

}  // namespace rlslab::kernels

// GCC lowers vectors wider than its target's registers before it inlines, so that a target attribute on the caller comes
// too late: the whole text is compiled under each target.
namespace rlslab::kernels::portable {
#include <rlslab/linalg/isa/all.hpp>
}
#if defined(__x86_64__) && !defined(__AVX2__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
namespace rlslab::kernels::avx2 {
#include <rlslab/linalg/isa/all.hpp>
}
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif

namespace rlslab {

enum class Isa { baseline, avx2 };

namespace kernels {
#ifdef __x86_64__
inline bool has_avx2() {
    __builtin_cpu_init();
    return __builtin_cpu_supports("avx2");
}
#else
constexpr bool has_avx2() { return false; }
#endif
/// What the kernels run on. Baseline until start-up is through; a test may change it: the bits do not depend on it.
inline Isa isa = has_avx2() ? Isa::avx2 : Isa::baseline;

/// Bytes of the registers that this translation unit is compiled for anyway.
#ifdef __AVX2__
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif
}  // namespace kernels

/// Runs the kernel on a square or columns of size N: inline for the smallest fixed sizes, where a call would be felt.
template <class T, int N, class Kernel>
[[gnu::always_inline]] inline void run_kernel(Kernel const& kernel) {
    using namespace kernels;
    if constexpr (!Hardware<T>) {
        portable::evaluate<portable::Any<Kernel, T>>(kernel);
    } else if constexpr (N != Dynamic && N <= 4) {
        portable::evaluate<portable::SimdBlock<T, std::min(register_bytes, 4 * int(sizeof(T))), 4>>(kernel);
    } else if constexpr (N != Dynamic && N <= 8) {
        portable::evaluate<portable::SimdBlock<T, register_bytes>>(kernel);
    } else {
        if constexpr (!OnColumns<Kernel>)
            if (kernel.d <= 4) return portable::evaluate<portable::SimdBlock<T, std::min(register_bytes, 4 * int(sizeof(T))), 4>>(kernel);
        if constexpr (Elementwise<Kernel>)
            if (kernel.d <= 16) return portable::evaluate<portable::SimdBlock<T, register_bytes>>(kernel);
#if defined(__x86_64__) && !defined(__AVX2__)
        if (isa == Isa::avx2) return avx2::run_outlined<avx2::InRegisters<Kernel, T, 32>>(kernel);
#endif
        portable::run_outlined<portable::InRegisters<Kernel, T, register_bytes>>(kernel);
    }
}

}  // namespace rlslab
