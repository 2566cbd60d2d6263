// The coefficients of one Householder reflection, and the norm from which they are computed.
#pragma once

#include <rlslab/linalg/rotations.hpp>

namespace rlslab {

/// |(a, x)|, x of n numbers, for the case that the plain sum of squares overflows or loses terms to underflow: all
/// numbers are divided by the largest first. 0 for x = 0. If a number is not finite, neither is the result. Lanes that
/// are `in_range` get sqrt(plain) instead.
template <Real T>
[[gnu::noinline]] T norm_scaled(T const& a, T const* x, Index n, Truth<T> const& in_range, T const& plain) {
    T largest = T(0);
    for (Index k = 0; k < n; ++k) {
        Truth<T> const stays = absolute(x[k]) <= largest || !(largest == largest);  // a NaN stays
        largest = select(stays, largest, absolute(x[k]));
    }
    Truth<T> const as_it_is = largest == T(0) || !is_finite(largest);
    if constexpr (std::same_as<Truth<T>, bool>) {
        if (as_it_is) return largest;
    }
    T const most = select(largest < absolute(a), absolute(a), largest);
    auto const square = [&most](T const& number) {
        T const right = number / most, left = number / most;
        return T(left * right);
    };
    T scaled = square(a);
    for (Index k = 0; k < n; ++k) scaled += square(x[k]);
    T const size = most * square_root(scaled);
    if constexpr (std::same_as<Truth<T>, bool>) return size;
    else return select(in_range, square_root(plain), select(as_it_is, largest, size));
}

/// |(a, x)|, x of n numbers, `squares` = x'x. For x = 0 the result is 0, not |a|: Reflector takes that as "no
/// reflection".
template <Real T>
[[gnu::always_inline]] inline T norm(T const& a, T const& squares, T const* x, Index n) {
    T const sum = a * a + squares;
    Truth<T> const in_range = T(0) < squares && is_finite(sum) && least_sum_of_squares<T>() < sum;
    if (all(in_range)) return square_root(sum);
    return norm_scaled(a, x, n, in_range, sum);
}

/// The same for a complex x, |x|^2 = `squares`; its bits are those above where x is real.
template <RootedScalar T>
    requires ComplexScalar<T>
RealOf<T> norm(RealOf<T> const& a, RealOf<T> const& squares, T const* x, Index n) {
    using R = RealOf<T>;
    R const sum = a * a + squares;
    Truth<T> const in_range = R(0) < squares && is_finite(sum) && least_sum_of_squares<R>() < sum;
    if (all(in_range)) return square_root(sum);
    R largest = R(0);
    for (Index k = 0; k < 2 * n; ++k) {
        R const size = absolute(k % 2 == 0 ? x[k / 2].re : x[k / 2].im);
        largest = select(size <= largest || !(largest == largest), largest, size);  // a NaN stays
    }
    Truth<T> const as_it_is = largest == R(0) || !is_finite(largest);
    R const most = select(as_it_is, R(1), select(largest < absolute(a), absolute(a), largest));
    auto const square = [&most](R const& number) {
        R const scaled = number / most;
        return R(scaled * scaled);
    };
    R scaled = square(a);
    for (Index k = 0; k < n; ++k) scaled += R(square(x[k].re) + square(x[k].im));
    return select(in_range, square_root(sum), select(as_it_is, largest, R(most * square_root(scaled))));
}

/// The reflection I - tau v v', v = (1, x / pivot), that takes (a, x) to (r, 0):
///   r = -+ size, of the sign opposite to a's      tau = (r - a) / r      pivot = a - r
/// size: |(a, x)| from `norm`. For size = 0 there is no reflection: r = a, tau = 0, pivot = 1.
template <Real T>
struct Reflector {
    T r, tau, pivot;

    [[gnu::always_inline]] Reflector(T const& a, T const& size) {
        Truth<T> const nothing = size == T(0);
        r = select(nothing, a, select(a < T(0), size, T(-size)));
        tau = select(nothing, T(0), T((r - a) / r));
        pivot = select(nothing, T(1), T(a - r));
    }
    /// |a / r|, the cosine of the angle by which (a, x) is turned; 1 without a reflection.
    [[gnu::always_inline]] T cosine(T const& a) const { return select(tau == T(0), T(1), absolute(T(a / r))); }
};

/// The same reflection as I - beta v v', v = (pivot, x), x not divided, from `squares` = x'x: for numbers whose squares
/// and products are in range. Where there are no squares, or so few beside a^2 that they are not known to any digit,
/// there is no reflection: r = a, beta = pivot = 0.
template <Real T>
struct UndividedReflector {
    T r, pivot, beta;

    [[gnu::always_inline]] UndividedReflector(T const& a, T const& squares) {
        T const sum = a * a + squares;
        Truth<T> const turns = T(0) < squares && least_sum_of_squares<T>() < sum;
        T const size = square_root(sum);
        r = select(turns, select(a < T(0), size, T(-size)), a);
        pivot = select(turns, T(a - r), T(0));
        beta = select(turns, T(T(-1) / T(r * pivot)), T(0));
    }
};

}  // namespace rlslab
