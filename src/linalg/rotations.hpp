// Plane rotations.
#pragma once

#include <rlslab/problem.hpp>

namespace rlslab {

/// [c s; -s c] (a, b)' = (r, 0)'.
template <Real T>
struct Rotation {
    T c, s, r;
};

/// A sum of squares this large cannot owe a digit to squares that went subnormal; beyond binary64's exponents: not zero.
template <Real T>
[[gnu::always_inline]] inline T least_sum_of_squares() {
    return T(std::ldexp(1.0, ArithmeticTraits<T>::min_exp + ArithmeticTraits<T>::digits));
}

/// The rotation that carries b into a, the larger of the two divided out first; r has a's sign where |a| >= |b|.
/// Source: Golub & Van Loan, Matrix Computations, Alg. 5.1.3.
template <Real T>
[[gnu::noinline]] Rotation<T> givens_scaled(T const& a, T const& b) {
    if (absolute(a) < absolute(b)) {
        T const t = a / b;
        T const u = square_root(T(1) + t * t);
        T const s = (b < T(0) ? -T(1) : T(1)) / u;
        return {s * t, s, absolute(b) * u};
    }
    T const t = b / a;
    T const u = square_root(T(1) + t * t);
    T const c = T(1) / u;
    return {c, c * t, a * u};
}

/// The rotation that carries b into a >= 0. b = 0 gives exactly the identity. Scaled where a square would overflow or vanish,
/// as it easily does in a format with a short exponent.
template <Real T>
[[gnu::always_inline]] inline Rotation<T> givens(T const& a, T const& b) {
    if (b == T(0)) return {T(1), T(0), a};
    T const sum = a * a + b * b;
    if (!is_finite(sum) || !(least_sum_of_squares<T>() < sum)) return givens_scaled(a, b);
    T const r = square_root(sum);
    return {a / r, b / r, r};
}

}  // namespace rlslab
