// Plane rotations.
#pragma once

#include <rlslab/core/problem.hpp>

namespace rlslab {

/// [c s; -s c] (a, b)' = (r, 0)'.
template <Real T>
struct Rotation {
    T c, s, r;
};

/// Lane by lane.
template <Real T>
Rotation<T> select(Truth<T> const& truth, Rotation<T> const& a, Rotation<T> const& b)
    requires(!std::same_as<Truth<T>, bool>)
{
    return {select(truth, a.c, b.c), select(truth, a.s, b.s), select(truth, a.r, b.r)};
}

/// A sum of squares this large cannot owe a digit to squares that went subnormal; beyond binary64's exponents: not zero.
template <Real T>
[[gnu::always_inline]] inline T least_sum_of_squares() {
    return T(std::ldexp(1.0, ArithmeticTraits<T>::min_exp + ArithmeticTraits<T>::digits));
}

/// The rotation that carries b into a, the larger of the two divided out first; r has a's sign where |a| >= |b|.
/// Source: Golub & Van Loan 2013, Alg. 5.1.3.
template <Real T>
[[gnu::noinline]] Rotation<T> givens_scaled(T const& a, T const& b) {
    Truth<T> const exchanged = absolute(a) < absolute(b);
    T const t = select(exchanged, a, b) / select(exchanged, b, a);
    T const u = square_root(T(1) + t * t);
    T const larger = select(exchanged && b < T(0), T(-1), T(1)) / u, smaller = larger * t;
    return {select(exchanged, smaller, larger), select(exchanged, larger, smaller), select(exchanged, absolute(b), a) * u};
}

/// The rotation that carries b into a >= 0. b = 0 gives exactly the identity. Scaled where a square would overflow or vanish,
/// as it easily does in a format with a short exponent.
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
