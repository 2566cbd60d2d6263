// Short binary formats as data, and three ways to round an exact value to one.
//
// All decisions use the bits of a double and exact operations only, so that no rounding mode, optimisation level or
// instruction set can change a result.
#pragma once

#include <rlslab/core/cpp20.hpp>

#include <bit>
#include <cstdint>
#include <limits>

namespace rlslab {

/// The numbers 1.f x 2^e of p = `digits` bits with min_exp <= e <= max_exp, subnormal numbers below them, infinities,
/// NaN, both zeros.
struct Format {
    int digits, min_exp, max_exp;
    friend constexpr bool operator==(Format const&, Format const&) = default;
};
inline constexpr Format binary16{11, -14, 15}, bfloat16{8, -126, 127}, tf32{11, -126, 127};

enum class Rounding { nearest, toward_zero, stochastic };

namespace detail {

inline constexpr std::uint64_t sign_bit = std::uint64_t{1} << 63;

constexpr std::uint64_t bits_of(double x) { return __builtin_bit_cast(std::uint64_t, x); }
constexpr double from_bits(std::uint64_t bits) { return __builtin_bit_cast(double, bits); }
constexpr double magnitude(double x) { return from_bits(bits_of(x) & ~sign_bit); }
constexpr double with_sign_of(double x, double magnitude) {
    return from_bits(bits_of(magnitude) | (bits_of(x) & sign_bit));
}
constexpr double power_of_two(int e) { return from_bits(std::uint64_t(e + 1023) << 52); }  ///< -1022 <= e <= 1023

/// The exponent of the smallest subnormal number. Every number of the format is an integer multiple of that.
constexpr int lowest_exp(Format f) { return f.min_exp - f.digits + 1; }

}  // namespace detail

constexpr double largest(Format f) {
    return detail::power_of_two(f.max_exp) * (2 - detail::power_of_two(1 - f.digits));
}
constexpr double smallest_normal(Format f) { return detail::power_of_two(f.min_exp); }
constexpr double smallest_subnormal(Format f) { return detail::power_of_two(detail::lowest_exp(f)); }

/// Whether double can emulate the format. With l = lowest_exp and t = max_exp + 1 all positive numbers lie in [2^l,
/// 2^t), and
///   precision   2p + 2 <= 53 makes double rounding innocuous to nearest (see round_to_nearest) and products exact;
///   products    lie in [2^2l, 2^2t): normal doubles if 2l >= -1022 and 2t <= 1023;
///   quotients   lie in (2^(l-t), 2^(t-l)), and the tail of an inexact quotient q is (a - q b) / b, where a - q b
///               is a multiple of ulp(q) ulp(b) > |a| 2^-(53+p): so tails are normal if l - t - 53 - p >= -1022;
///   sums and roots lie between.
constexpr bool fits_in_double(Format f) {
    int const p = f.digits, l = detail::lowest_exp(f), t = f.max_exp + 1;
    return p >= 2 && 2 * p + 2 <= 53 && f.min_exp <= f.max_exp && 2 * l >= -1022 && 2 * t <= 1023 && t - l <= 1023 &&
           l - t - 53 - p >= -1022;
}

namespace detail {

/// One unit in the last place of a normal number, as an increment of a double's bits.
constexpr std::uint64_t one_ulp(Format f) { return std::uint64_t{1} << (53 - f.digits); }

constexpr bool is_number(double x) {
    return (bits_of(x) & ~sign_bit) < bits_of(std::numeric_limits<double>::infinity());
}
/// Infinities unchanged, and one bit pattern for every NaN: which of two NaNs an operation returns depends on the
/// compiler.
constexpr double not_a_number(double x) { return x == x ? x : std::numeric_limits<double>::quiet_NaN(); }

/// The tail of |head + tail|. (It flips bits: a branch on random signs would be slow.)
constexpr double outward(double head, double tail) { return from_bits(bits_of(tail) ^ (bits_of(head) & sign_bit)); }

/// The largest double <= |head + tail|, when head is the double nearest to head + tail.
constexpr double floor_of(double head, double tail) {
    return from_bits((bits_of(head) & ~sign_bit) - (outward(head, tail) < 0));
}

/// x >= 0 truncated to the format's numbers, as if its exponents had no upper bound.
constexpr double truncated(double x, Format f) {
    if (x >= smallest_normal(f)) return from_bits(bits_of(x) & ~(one_ulp(f) - 1));
    return double(std::int64_t(x * power_of_two(-lowest_exp(f)))) * smallest_subnormal(f);
}
/// The next of those numbers after x >= 0.
constexpr double after(double x, Format f) {
    return x >= smallest_normal(f) ? from_bits(bits_of(x) + one_ulp(f)) : x + smallest_subnormal(f);
}

}  // namespace detail

/// x rounded to the nearest number of the format f, which fits_in_double, ties to even; infinity from the largest
/// number plus half an ulp on.
///
/// It needs no tail: if the result of two p-bit operands is rounded to double and then here, the outcome is that of one
/// rounding. The two could differ only if double landed on a midpoint of the format, which has p + 1 bits, and the
/// exact result was elsewhere. But products are exact; sums are exact or within 2^-(51-p) relative of an operand,
/// midpoints no closer than 2^-(p+1); and a quotient (a root) that is no midpoint differs from all of them by 2^-2p
/// (2^-(2p+1)) relative, whereas double moves it by at most 2^-53. The same counts hold among subnormals, where
/// midpoints have fewer bits.
constexpr double round_to_nearest(double x, Format f) {
    using namespace detail;
    std::uint64_t const first = bits_of(smallest_normal(f)), ulp = one_ulp(f);
    std::uint64_t const overflow = bits_of(largest(f)) + ulp / 2;
    std::uint64_t const bits = bits_of(x), size = bits & ~sign_bit;
    if (size - first < overflow - first) [[likely]] {
        // Just under half an ulp, or half of one if the last kept bit is odd; a carry moves on to the next binade.
        std::uint64_t const odd = (bits / ulp) & 1;
        return from_bits((bits + (ulp / 2 - 1) + odd) & ~(ulp - 1));
    }
    if (!is_number(x)) return not_a_number(x);
    if (size >= overflow) return with_sign_of(x, std::numeric_limits<double>::infinity());
    double const quanta = magnitude(x) * power_of_two(-lowest_exp(f));
    std::int64_t const whole = std::int64_t(quanta);
    double const rest = quanta - double(whole);
    bool const up = rest > 0.5 || (rest == 0.5 && whole % 2 != 0);
    return with_sign_of(x, double(whole + up) * smallest_subnormal(f));
}

/// head + tail rounded toward zero. head is the double nearest to the exact value, tail has the sign of the exact value
/// minus head. Finite values beyond the largest number become the largest number.
constexpr double round_toward_zero(double head, double tail, Format f) {
    using namespace detail;
    if (!is_number(head)) return not_a_number(head);
    double const below = truncated(floor_of(head, tail), f);
    return with_sign_of(head, below > largest(f) ? largest(f) : below);
}

/// head + tail rounded to one of its two neighbours: away from zero iff u < phi, where phi is the fraction of the way
/// to the outer one and u = uniform() in [0, 1) has 53 bits. So the probability is phi to 2^-53, and the mean is the
/// exact value. A number of the format stays, and draws nothing. The outer neighbour of the largest number is
/// 2^(max_exp+1); a result of that size or more becomes infinity.
template <class Uniform>
constexpr double round_stochastically(double head, double tail, Format f, Uniform&& uniform) {
    using namespace detail;
    if (!is_number(head)) return not_a_number(head);
    double const size = magnitude(head), below = truncated(floor_of(head, tail), f);
    double chosen = below;
    if (below != size || tail != 0) {
        // u < phi is u gap < (|head| - below) + tail. The left side below is exact: both terms are multiples of gap
        // 2^-53 and at most gap; or |head| < gap / 2 has finer bits, and then the difference is exact or too large for
        // its rounding, or for the tail, to matter.
        double const above = after(below, f), gap = above - below;
        bool const up = uniform() * gap - (size - below) < outward(head, tail);
        // Added, because a branch on a random bit would be slow.
        chosen = from_bits(bits_of(below) + up * (bits_of(above) - bits_of(below)));
    }
    return with_sign_of(head, chosen > largest(f) ? std::numeric_limits<double>::infinity() : chosen);
}

}  // namespace rlslab
