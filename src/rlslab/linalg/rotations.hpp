// Plane rotations.
#pragma once

#include <rlslab/core/problem.hpp>

namespace rlslab {

/// [c s; -s c] (a, b)' = (r, 0)'.
template <Real T>
struct Rotation {
    T c, s, r;
};

/// a in the lanes where `truth` holds, b in the others.
template <Real T>
Rotation<T> select(Truth<T> const& truth, Rotation<T> const& a, Rotation<T> const& b)
    requires(!std::same_as<Truth<T>, bool>)
{
    return {select(truth, a.c, b.c), select(truth, a.s, b.s), select(truth, a.r, b.r)};
}

/// The smallest sum of squares that is accurate even if some of its terms underflowed: 2^(min_exp + p). A square that is subnormal or zero
/// has an absolute error of at most 2^(min_exp - p), half the smallest subnormal number, which is 2^-2p = u^2 of that sum. For an
/// arithmetic whose exponents reach beyond binary64's the power is 0 in double: then every sum above zero passes.
template <Real T>
[[gnu::always_inline]] inline T least_sum_of_squares() {
    return T(std::ldexp(1.0, ArithmeticTraits<T>::min_exp + ArithmeticTraits<T>::digits));
}

/// The rotation that makes b zero against a, computed from the quotient of the smaller by the larger, so that no square overflows or
/// underflows. r has a's sign if |a| >= |b|, and is positive otherwise. a = b = 0 gives NaN. Source: Golub & Van Loan 2013, Alg. 5.1.3.
template <Real T>
[[gnu::noinline]] Rotation<T> givens_scaled(T const& a, T const& b) {
    Truth<T> const exchanged = absolute(a) < absolute(b);
    T const t = select(exchanged, a, b) / select(exchanged, b, a);
    T const u = square_root(T(1) + t * t);
    T const larger = select(exchanged && b < T(0), T(-1), T(1)) / u, smaller = larger * t;
    return {select(exchanged, smaller, larger), select(exchanged, larger, smaller), select(exchanged, absolute(b), a) * u};
}

/// The rotation that makes b zero against a >= 0. b = 0 gives exactly the identity, with r = a. Where a square would overflow or underflow,
/// as it easily does in a format with few exponent bits, givens_scaled computes it. If a or b is not finite, neither is r, unless b = 0.
template <Real T>
[[gnu::always_inline]] inline Rotation<T> givens(T const& a, T const& b) {
    Truth<T> const nothing = b == T(0);
    if (all(nothing)) return {T(1), T(0), a};
    T const square = b * b, sum = a * a + square;
    Truth<T> const in_range = is_finite(sum) && least_sum_of_squares<T>() < sum;
    if constexpr (std::same_as<Truth<T>, bool>) {
        if (!in_range) return givens_scaled(a, b);
    }
    T const r = square_root(sum);
    Rotation<T> turn{a / r, b / r, r};
    if (!all(in_range)) turn = select(in_range, turn, givens_scaled(a, b));
    return any(nothing) ? select(nothing, Rotation<T>{T(1), T(0), a}, turn) : turn;
}

}  // namespace rlslab
