// The texts of the kernels, in the order in which they build on one another. Included by dispatch.hpp once for each
// instruction set, each time in a namespace of its own: no #pragma once.
#include <rlslab/core/instructions.hpp>

#include <rlslab/linalg/kernels/block.hpp>

#include <rlslab/linalg/kernels/dense.hpp>

#include <rlslab/linalg/kernels/sweep.hpp>

#include <rlslab/linalg/kernels/columns.hpp>

#include <rlslab/linalg/kernels/blocks.hpp>

#include <rlslab/linalg/kernels/lower.hpp>

#include <rlslab/linalg/kernels/rows.hpp>

#include <rlslab/linalg/kernels/reflect.hpp>

#include <rlslab/linalg/kernels/panel.hpp>

#include <rlslab/linalg/kernels/product.hpp>

/// The type of a block of rows in a kernel's text: Any for every arithmetic, InRegisters for registers of `bytes`
/// bytes.
template <class K, class T>
using Any = std::conditional_t<OnColumns<K>, Lane<T>, ScalarRow<T>>;
template <class K, class T, int bytes>
using InRegisters = std::conditional_t<OnColumns<K>, Packed<T, bytes>, SimdBlock<T, bytes>>;

template <class B, class K>
[[gnu::noinline, gnu::aligned(64)]] void run_outlined(
    K const& kernel) {      // on a cache line, whatever is linked beside it
    K const copy = kernel;  // whose address nobody has: its fields stay in registers
    evaluate<B>(copy);
}
