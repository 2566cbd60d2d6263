// Plane rotations.
#pragma once

#include <rlslab/core/problem.hpp>

namespace rlslab {

/// [c s'; -s c] applied to (a, b) gives (r, 0); c and r are real. On (R_i, psi'), rows of R = L', s is conjugated:
/// of_rows.
template <RootedScalar T>
struct Rotation {
    RealOf<T> c;
    T s;
    RealOf<T> r;
};
template <RootedScalar T>
[[gnu::always_inline]] inline Rotation<T> of_rows(Rotation<T> const& turn) {
    return {turn.c, conjugate(turn.s), turn.r};
}

/// a in the lanes where `truth` holds, b in the others.
template <RootedScalar T>
Rotation<T> select(Truth<T> const& truth, Rotation<T> const& a, Rotation<T> const& b)
    requires(!std::same_as<Truth<T>, bool>)
{
    return {select(truth, a.c, b.c), select(truth, a.s, b.s), select(truth, a.r, b.r)};
}

/// The smallest sum of squares that is accurate even if some of its terms underflowed: 2^(min_exp + p). A square that
/// is subnormal or zero has an absolute error of at most 2^(min_exp - p), half the smallest subnormal number, which is
/// 2^-2p = u^2 of that sum. For an arithmetic whose exponents reach beyond binary64's the power is 0 in double: then
/// every sum above zero passes.
template <Real T>
[[gnu::always_inline]] inline T least_sum_of_squares() {
    return T(std::ldexp(1.0, min_exponent<T>() + significand_bits<T>()));
}

/// The rotation that makes b zero against a, computed from the quotient of the smaller by the larger, so that no square
/// overflows or underflows. r has a's sign if |a| >= |b|, and is positive otherwise. a = b = 0 gives NaN. Source: Golub
/// & Van Loan 2013, Alg. 5.1.3.
template <Real T>
[[gnu::noinline]] Rotation<T> givens_scaled(T const& a, T const& b) {
    Truth<T> const exchanged = absolute(a) < absolute(b);
    T const t = select(exchanged, a, b) / select(exchanged, b, a);
    T const u = square_root(T(1) + t * t);
    T const larger = select(exchanged && b < T(0), T(-1), T(1)) / u, smaller = larger * t;
    return {select(exchanged, smaller, larger), select(exchanged, larger, smaller),
            select(exchanged, absolute(b), a) * u};
}

/// The rotation that makes b zero against a >= 0. b = 0 gives exactly the identity, with r = a. Where a square would
/// overflow or underflow, as it easily does in a format with few exponent bits, givens_scaled computes it. If a or b is
/// not finite, neither is r, unless b = 0.
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

/// The rotation that makes a complex b zero against a real a >= 0: c = a / r, s = b / r, r = |(a, b)|. Its bits are
/// those of the real rotation where b is real. Where a square would overflow or underflow, it is the real rotation of
/// (a, |b|), s turned to b's direction.
template <RootedScalar T>
    requires ComplexScalar<T>
Rotation<T> givens(RealOf<T> const& a, T const& b) {
    using R = RealOf<T>;
    Truth<T> const nothing = b == T(0);
    if (all(nothing)) return {R(1), T(0), a};
    R const square = absolute_square(b), sum = a * a + square;
    Truth<T> const in_range = is_finite(sum) && least_sum_of_squares<R>() < sum;
    R const r = square_root(sum);
    Rotation<T> turn{a / r, b / r, r};
    if (!all(in_range)) {
        R const re = absolute(b.re), im = absolute(b.im);
        R const most = select(re < im, im, re), least = select(re < im, re, im);
        R const by = select(most == R(0), R(1), most), small = least / by;
        R const length = by * square_root(R(R(1) + small * small));
        // b / |b| of b / by: |b| itself may be below the normal numbers.
        T const towards = (b / by) / square_root(R(R(1) + small * small));
        Rotation<R> const scaled = givens_scaled(a, length);
        turn = select(in_range, turn, Rotation<T>{scaled.c, scaled.s * towards, scaled.r});
    }
    return any(nothing) ? select(nothing, Rotation<T>{R(1), T(0), a}, turn) : turn;
}

}  // namespace rlslab
