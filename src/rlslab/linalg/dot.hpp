// The dot product: eight running lanes, then the tree ((0+4)+(2+6)) + ((1+5)+(3+7)), absent lanes left out.
#pragma once

#include <rlslab/core/problem.hpp>

#include <concepts>

namespace rlslab {

namespace detail {
/// The part of the tree that ends in the sum of the lanes first, first + stride, ... below eight. With stride = 8 it is
/// one lane: the running sum of the products first, first + 8, ...
template <int first, int stride, class X, class T>
[[gnu::always_inline]] inline T lanes_summed(X const& x, T const* y, Index n) {
    if constexpr (stride == 8) {
        T sum = conjugate(x[first]) * y[first];
        for (Index k = first + 8; k < n; k += 8) sum += conjugate(x[k]) * y[k];
        return sum;
    } else {
        T sum = lanes_summed<first, 2 * stride>(x, y, n);
        if (first + stride < n) sum += lanes_summed<first + stride, 2 * stride>(x, y, n);
        return sum;
    }
}
}  // namespace detail

/// x'y of n numbers each, in the order above, x conjugated where it is complex; 0 for n <= 0. x and y may be the same.
/// Where T has a wider accumulator the sum is of that type: whoever stores the result rounds it.
template <Scalar T>
Accumulator<T> dot(T const* x, T const* y, Index n) {
    if (n <= 0) [[unlikely]]
        return Accumulator<T>(0);
    if constexpr (!std::same_as<Truth<T>,
                                bool>)  // a Pack: the running sum of one lane after another fits into registers
        return detail::lanes_summed<0, 1>(x, y, n);
    Accumulator<T> lane[8];
    if (n < 8) {
        for (Index i = 0; i < n; ++i) lane[i] = conjugate(x[i]) * y[i];
        for (Index half = 4; half >= 1; half /= 2)
            for (Index i = 0; i < half && i + half < n; ++i) lane[i] += lane[i + half];
        return lane[0];
    }
#pragma GCC unroll 8  // constant counts: -O2 keeps the lanes in registers
    for (Index i = 0; i < 8; ++i) lane[i] = conjugate(x[i]) * y[i];
    Index k = 8;
    for (; k + 8 <= n; k += 8)
#pragma GCC unroll 8
        for (Index i = 0; i < 8; ++i) lane[i] += conjugate(x[k + i]) * y[k + i];
    for (Index i = 0; k + i < n; ++i) lane[i] += conjugate(x[k + i]) * y[k + i];
#pragma GCC unroll 4
    for (Index i = 0; i < 4; ++i) lane[i] += lane[i + 4];
    lane[0] += lane[2];
    lane[1] += lane[3];
    lane[0] += lane[1];
    return lane[0];
}

/// The same for n = N, or Dynamic; up to eight numbers without loops.
template <int N, Scalar T>
Accumulator<T> dot(T const* x, T const* y, Index n) {
    if constexpr (N != Dynamic && N <= 8 && std::floating_point<T>) return detail::lanes_summed<0, 1>(x, y, N);
    else return dot(x, y, n);
}

}  // namespace rlslab
