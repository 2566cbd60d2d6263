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
T least_sum_of_squares() {
    return T(std::ldexp(1.0, ArithmeticTraits<T>::min_exp + ArithmeticTraits<T>::digits));
}

/// The rotation that carries b into a. b = 0 gives exactly the identity. Where a square would overflow or vanish, as it
/// easily does in a format with a short exponent, the larger of the two is divided out first; r then has a's sign where
/// |a| >= |b|, and is positive otherwise. Source: Golub & Van Loan, Matrix Computations, Alg. 5.1.3.
template <Real T>
Rotation<T> givens(T const& a, T const& b) {
    using std::sqrt;
    if (b == T(0)) return {T(1), T(0), a};
    T const sum = a * a + b * b;
    if (is_finite(sum) && least_sum_of_squares<T>() < sum) {
        T const r = square_root(sum);
        return {a / r, b / r, r};
    }
    if (absolute(a) < absolute(b)) {
        T const t = a / b;
        T const u = sqrt(T(1) + t * t);
        T const s = (b < T(0) ? -T(1) : T(1)) / u;
        return {s * t, s, absolute(b) * u};
    }
    T const t = b / a;
    T const u = sqrt(T(1) + t * t);
    T const c = T(1) / u;
    return {c, c * t, a * u};
}

/// Rotates the n pairs (x_i, y_i).
template <Real T>
void rotate(Rotation<T> const& g, T* x, T* y, Index n) {
    for (Index i = 0; i < n; ++i) {
        T const t = x[i];
        x[i] = g.c * t + g.s * y[i];
        y[i] = g.c * y[i] - g.s * t;
    }
}

}  // namespace rlslab
