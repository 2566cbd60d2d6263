// Compiles the kernels and runs them. Each has one text (kernels/*) for all arithmetics; for float and double it is
// compiled for several instruction sets, and one is chosen at start-up. All give the same bits: the texts fix the order
// of evaluation in blocks of eight rows, nothing is fused, and lanes are combined only in the tree that ends a dot
// product.
#pragma once

#include <rlslab/linalg/kernel_types.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <type_traits>
#ifdef __x86_64__
#include <emmintrin.h>
#endif

// --- registers of 64 bytes: which kernels use them -------------------------------------------------------------------

namespace rlslab::kernels {

inline constexpr Index never = std::numeric_limits<Index>::max();

template <class K, class... Kernels>
inline constexpr bool is_one_of = (std::same_as<K, Kernels> || ...);

/// A kernel for double uses registers of 64 bytes, where there are such, from d = `from` on. `registers` is then as in
/// the sweeps: there are twice as many of them as of smaller ones. The kernels for float, and those that the table
/// leaves out, were not faster with them.
struct Wide {
    Index from = never;
    int registers = 8;
};
/// The table: what was faster on an AMD EPYC of the Zen 4 kind (docs/speed.md), by 3 to 40 %.
template <class K, class T = double>
inline constexpr Wide wide =
    is_one_of<K, ReflectPanel<T>, SubtractProduct<T>, SubtractProduct<float>>                   ? Wide{1}
    : is_one_of<K, OnBlocks<Multiply<T>>, OnBlocks<SubtractRankOne<T>>, OnBlocks<AddSquare<T>>> ? Wide{5}
    : is_one_of<K, RotateInRows<T>>                                                             ? Wide{8}
    : is_one_of<K, ThenMultiply<SubtractRankOne<T>>>                                            ? Wide{16}
    : is_one_of<K, MultiplyTransposed<T, Shape::full>, MultiplyTransposed<T, Shape::upper>>     ? Wide{40}
    : is_one_of<K, SubtractRankOne<T>>                                                          ? Wide{64, 16}
    : is_one_of<K, SubtractRankTwo<T>, SweepUd<T>, SweepRotations<T>, SumOfSquares<T>>          ? Wide{64}
    : is_one_of<K, ThenMultiply<SweepUd<T>>>                                                    ? Wide{96}
    : is_one_of<K, ThenMultiply<SweepRotations<T>>, ThenMultiply<SweepCarlson<T>>>              ? Wide{128}
    : is_one_of<K, Multiply<T>>                                                                 ? Wide{192}
    : is_one_of<K, SweepCarlson<T>>                                                             ? Wide{256}
                                                                                                : Wide{};

/// On smaller registers, and for float, ThenMultiply<Pass> is faster than two passes from this d on.
template <class P>
inline constexpr Index one_pass_from = is_one_of<P, SubtractRankOne<float>, SubtractRankOne<double>> ? 128
                                       : is_one_of<P, SweepUd<float>>                                ? 192
                                       : is_one_of<P, SweepUd<double>>                               ? 320
                                       : is_one_of<P, SweepCarlson<double>>                          ? 384
                                       : is_one_of<P, SweepRotations<double>>                        ? 512
                                       : is_one_of<P, SweepCarlson<float>, SweepRotations<float>>    ? 640
                                                                                                     : never;

/// From this d on a sweep is faster with a few columns side by side (kernels/columns.hpp) than with a few blocks of
/// rows (kernels/sweep.hpp), on registers of 64 bytes or on smaller ones. Measured as the table above was, the kernels
/// alone, A in memory or in the caches as it fits.
struct ByColumns {
    Index from = never, from_on_wide = never;
};
template <class K>
inline constexpr ByColumns by_columns_from =
    is_one_of<K, ThenMultiply<SubtractRankOne<float>>>              ? ByColumns{128}
    : is_one_of<K, Multiply<float>, Multiply<double>>               ? ByColumns{256, 512}
    : is_one_of<K, ThenMultiply<SubtractRankOne<double>>>           ? ByColumns{256, 512}
    : is_one_of<K, SweepUd<double>>                                 ? ByColumns{256, 1600}
    : is_one_of<K, SubtractRankOne<float>, SubtractRankOne<double>> ? ByColumns{384, 384}
    : is_one_of<K, SweepUd<float>>                                  ? ByColumns{640}
    : is_one_of<K, SweepCarlson<float>, SweepCarlson<double>>       ? ByColumns{640, 768}
    : is_one_of<K, SweepRotations<float>, SweepRotations<double>>   ? ByColumns{640, 1600}
    : is_one_of<K, AddSquare<float>, AddSquare<double>>             ? ByColumns{1024, 1024}
                                                                    : ByColumns{};

/// RotateInRows is faster than RotateIn for one row after another from this d on.
inline constexpr Index together_from = 5;

/// Up to this fixed size a kernel that has a text for it (kernels/small.hpp) is inlined, without loops.
inline constexpr int small_up_to = 8;

}  // namespace rlslab::kernels

// --- the texts, compiled for each instruction set --------------------------------------------------------------------

namespace rlslab::kernels::portable {
#include <rlslab/linalg/kernels/all.hpp>

#include <rlslab/linalg/kernels/small.hpp>
}  // namespace rlslab::kernels::portable
#ifndef RLSLAB_COMPILED_KERNELS
#include <rlslab/linalg/kernels/each_isa.hpp>
#endif

namespace rlslab {

/// The instruction sets for which the kernels are compiled, each containing those before it. avx512: AVX-512 F, DQ and
/// VL.
enum class Isa { baseline, avx2, avx512 };

namespace kernels {
/// The last one that both the processor and the operating system (which must keep the registers of each thread) offer.
inline Isa best_isa() {
#ifdef __x86_64__
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
        return Isa::avx512;
    if (__builtin_cpu_supports("avx2")) return Isa::avx2;
#endif
    return Isa::baseline;
}
/// The instruction set that the kernels use: baseline until this variable is initialised. A test may choose an earlier
/// one; the bits stay the same.
inline Isa isa = best_isa();

/// Bytes of a register in the kernels that are inlined. Those of AVX-512 are not used there: at these sizes they are
/// slower.
#ifdef __AVX2__
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif

/// Elementwise kernels of vectors up to so many bytes are inlined: a call would cost as much. Where there are no wider
/// registers to call for, all are.
#if defined(__AVX2__) || !defined(__x86_64__)
inline constexpr Index inlined_bytes = never;
#else
inline constexpr Index inlined_bytes = 256;
#endif

/// What the tables above count: numbers of a vector, or of a column.
template <class Kernel>
[[gnu::always_inline]] inline Index size_of(Kernel const& kernel) {
    if constexpr (OnColumns<Kernel>) return kernel.rows;
    else return kernel.d;
}
/// Whether the kernel uses registers of 64 bytes on this instruction set.
template <class Kernel>
constexpr bool uses_wide_registers(Isa on, Index d) {
    return on >= Isa::avx512 && d >= wide<Kernel>.from;
}
/// Whether ThenMultiply<Pass> is faster than the pass and a product after it on this instruction set.
template <class Pass>
constexpr bool one_pass_is_faster(Isa on, Index d) {
    return uses_wide_registers<ThenMultiply<Pass>>(on, d) || d >= one_pass_from<Pass>;
}

/// Runs the text for the processor at hand. With RLSLAB_COMPILED_KERNELS it stands in the library rlslab::kernels, for
/// every kernel of float and double; otherwise it is compiled here. The bits are the same.
template <class T, class Kernel>
#ifdef RLSLAB_COMPILED_KERNELS
void dispatch(Kernel const& kernel);
#else
[[gnu::always_inline]] inline void dispatch(Kernel const& kernel) {
    if constexpr (!OnColumns<Kernel> && !Together<Kernel> && !Elementwise<Kernel>)
        if (kernel.d <= 4)
            return portable::evaluate<portable::SimdBlock<T, std::min(register_bytes, 4 * int(sizeof(T))), 4>>(kernel);
#ifdef __x86_64__
    if constexpr (wide<Kernel>.from != never)
        if (uses_wide_registers<Kernel>(isa, size_of(kernel)))
            return avx512::run_outlined<avx512::InRegisters<Kernel, T, 64>>(kernel);
    if (register_bytes >= 32 || isa >= Isa::avx2) return avx2::run_outlined<avx2::InRegisters<Kernel, T, 32>>(kernel);
#endif
    portable::run_outlined<portable::InRegisters<Kernel, T, register_bytes>>(kernel);
}
#endif
}  // namespace kernels

/// Runs the kernel. N: its d if that is fixed, or Dynamic. Small kernels are inlined, because a call would take a large
/// part of their time; their text pays where there are no registers, too (docs/embedded.md).
template <class T, int N, class Kernel>
[[gnu::always_inline]] inline void run_kernel(Kernel const& kernel) {
    using namespace kernels;
    constexpr bool native = std::same_as<T, float> || std::same_as<T, double>;
    if constexpr (native && N != Dynamic && N <= small_up_to && requires { portable::evaluate_small<N, T>(kernel); }) {
        portable::evaluate_small<N, T>(kernel);
    } else if constexpr (!Hardware<T>) {
        portable::evaluate<portable::Any<Kernel, T>>(kernel);
    } else if constexpr (N != Dynamic && N <= 4) {
        portable::evaluate<portable::SimdBlock<T, std::min(register_bytes, 4 * int(sizeof(T))), 4>>(kernel);
    } else if constexpr (N != Dynamic && N <= 8) {
        portable::evaluate<portable::SimdBlock<T, register_bytes>>(kernel);
    } else {
        if constexpr (Elementwise<Kernel>)
            if (kernel.d <= inlined_bytes / Index(sizeof(T)))
                return portable::evaluate<portable::SimdBlock<T, register_bytes>>(kernel);
        dispatch<T>(kernel);
    }
}

}  // namespace rlslab
