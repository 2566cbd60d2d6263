// Incomplete beta and gamma functions in balls; a quantile by bisection among the doubles themselves.
#include <rlslab/reference/distributions.hpp>

#include <rlslab/arithmetic/format.hpp>
#include <rlslab/reference/balls.hpp>

#if __has_include(<flint/arb_hypgeom.h>)
#include <flint/arb_hypgeom.h>
#else
#include <arb_hypgeom.h>
#endif

#include <limits>

namespace rlslab::correctly {

namespace {

using balls::Ball, balls::Float;
constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
constexpr long least = 96, most = 1 << 14;  // bits

/// value(ball, bits) at rising precision until its ball rounds to one double.
template <class Value>
double nearest(Value value) {
    double out = nan;
    for (long bits = least; bits <= most; bits *= 2) {
        Ball ball;
        value(ball, bits);
        Float low, high;
        arb_get_lbound_arf(low, ball, bits);
        arb_get_ubound_arf(high, ball, bits);
        out = arf_get_d(arb_midref(static_cast<arb_srcptr>(ball)), ARF_RND_NEAR);
        if (arf_get_d(low, ARF_RND_NEAR) == arf_get_d(high, ARF_RND_NEAR)) return out;
    }
    return out;  // half-way between two doubles to 2^14 bits: either
}

/// The sign of value(ball, bits), 0 where no precision tells it apart from zero.
template <class Value>
int sign(Value value) {
    for (long bits = least; bits <= most; bits *= 2) {
        Ball ball;
        value(ball, bits);
        if (arb_is_positive(ball)) return 1;
        if (arb_is_negative(ball)) return -1;
        if (arb_is_zero(ball)) return 0;
    }
    return 0;
}

/// I_z(a, b) with z = x / (x + y).
void beta(arb_ptr out, arb_srcptr a, arb_srcptr b, arb_srcptr x, arb_srcptr y, long bits) {
    Ball z;
    arb_add(z, x, y, bits);
    arb_div(z, x, z, bits);
    arb_hypgeom_beta_lower(out, a, b, z, 1, bits);
}

}  // namespace

double chi_squared_tail(double freedom, double x) {
    if (!(freedom > 0) || x != x) return nan;
    if (x <= 0) return 1;
    if (x == infinity) return 0;
    return nearest([=](arb_ptr out, long bits) {  // Gamma(nu/2, x/2) / Gamma(nu/2)
        Ball const half_freedom(freedom / 2), half_x(x / 2);
        arb_hypgeom_gamma_upper(out, half_freedom, half_x, 1, bits);
    });
}

double fisher_tail(double numerator, double denominator, double x) {
    if (!(numerator > 0) || !(denominator > 0) || x != x) return nan;
    if (x <= 0) return 1;
    if (x == infinity) return 0;
    return nearest([=](arb_ptr out, long bits) {  // I_z(n/2, m/2),  z = n / (n + m x)
        Ball const n(denominator), half_n(denominator / 2), half_m(numerator / 2);
        Ball mx(numerator);
        Ball const exact_x(x);
        arb_mul(mx, mx, exact_x, bits);
        beta(out, half_n, half_m, n, mx, bits);
    });
}

double student_quantile(double freedom, double p) {
    if (!(freedom > 0) || !(0 < p && p < 1)) return nan;
    if (p == 0.5) return 0;
    // P(T > t) = I_z(nu/2, 1/2) / 2,  z = nu / (nu + t^2): falls in t > 0.
    auto const above = [=](arb_srcptr t) {
        return sign([=](arb_ptr out, long bits) {
                   Ball const nu(freedom), half_nu(freedom / 2), half(0.5);
                   Ball square, tail;
                   arb_mul(square, t, t, bits);
                   beta(out, half_nu, half, nu, square, bits);
                   arb_mul_2exp_si(out, out, -1);
                   arb_set_d(tail, p < 0.5 ? p : 1 - p);  // exact: 1 - p is, from 1/2 on
                   arb_sub(out, out, tail, bits);
               }) > 0;
    };
    std::uint64_t low = 0, high = detail::bits_of(std::numeric_limits<double>::max());
    while (high - low > 1) {
        std::uint64_t const middle = low + (high - low) / 2;
        Ball const t(detail::from_bits(middle));
        (above(t) ? low : high) = middle;
    }
    Ball between(detail::from_bits(low)), other(detail::from_bits(high));
    arb_add(between, between, other, most);
    arb_mul_2exp_si(between, between, -1);
    double const t = detail::from_bits(above(between) ? high : low);
    return p < 0.5 ? -t : t;
}

}  // namespace rlslab::correctly
