// Quad: IEEE binary128, computed by MPFR.
#pragma once

#include <rlslab/arithmetic/mpfr_encoding.hpp>
#include <rlslab/arithmetic/storage_traits.hpp>

#include <mpfr.h>

#include <compare>

namespace rlslab {
class Quad;
}

/// It stands before the class because libc++ reads it where Quads are compared.
template <>
struct std::numeric_limits<rlslab::Quad> {
    using Quad = rlslab::Quad;

    static constexpr bool is_specialized = true, is_signed = true, is_integer = false, is_exact = false,
                          has_infinity = true, has_quiet_NaN = true, has_signaling_NaN = false, is_iec559 = true,
                          is_bounded = true, is_modulo = false, traps = false, tinyness_before = false;
    static constexpr std::float_denorm_style has_denorm = std::denorm_present;
    static constexpr bool has_denorm_loss = false;
    static constexpr std::float_round_style round_style = std::round_to_nearest;
    static constexpr int radix = 2, digits = 113, digits10 = 33, max_digits10 = 36, min_exponent = -16381,
                         max_exponent = 16384, min_exponent10 = -4931, max_exponent10 = 4932;
    static Quad min();
    static Quad max();
    static Quad lowest();
    static Quad epsilon();
    static Quad round_error();
    static Quad denorm_min();
    static Quad infinity();
    static Quad quiet_NaN();
};

namespace rlslab {

/// 113 bits, exponents -16382 ... 16383, subnormals below: +, -, x, / and sqrt round once, to nearest, ties to even.
/// MPFR computes directly on the limbs stored here. Its exponents reach further, so only overflow and subnormal results
/// need a second step. A plain value of 32 bytes.
class Quad {
    static constexpr int bits = 113, limbs = (bits + GMP_NUMB_BITS - 1) / GMP_NUMB_BITS;
    static constexpr mpfr_exp_t last = 16384, first = -16381,
                                least = -16493;  // of 0.1f x 2^e: largest, least normal, least
    mp_limb_t limb_[limbs]{};
    mpfr_exp_t exponent_ = 0;
    int kind_ = MPFR_ZERO_KIND;  // MPFR's: NaN, infinity, zero, or a regular number; negative with the number

    static void into_range(mpfr_ptr x, int ternary) {
        if (!mpfr_regular_p(x)) return;
        if (mpfr_exp_t const e = mpfr_get_exp(x); e > last) mpfr_set_inf(x, mpfr_sgn(x));
        else if (e < first) into_subnormals(x, ternary);
    }
    /// x was rounded to 113 bits, from the side that `ternary` tells. Rounds it to the fewer bits that a subnormal
    /// number has.
    [[gnu::noinline]] static void into_subnormals(mpfr_ptr x, int ternary) {
        mpfr_exp_t const before = mpfr_get_emin();
        mpfr_set_emin(least);
        mpfr_subnormalize(x, mpfr_check_range(x, ternary, MPFR_RNDN), MPFR_RNDN);
        mpfr_set_emin(before);
    }
    /// operation(x) sets x and returns MPFR's ternary value.
    template <class Operation>
    static Quad of(Operation operation) {
        Quad out;
        mpfr_t x;
        mpfr_custom_init_set(x, MPFR_NAN_KIND, 0, bits, out.limb_);
        into_range(x, operation(x));
        out.kind_ = mpfr_custom_get_kind(x);
        if (mpfr_regular_p(x)) out.exponent_ = mpfr_get_exp(x);
        return out;
    }

public:
    /// A view for MPFR's functions to read. The Quad must outlive it.
    class View {
        mpfr_t x_;

    public:
        explicit View(Quad const& q) {
            mpfr_custom_init_set(x_, q.kind_, q.exponent_, bits, const_cast<mp_limb_t*>(q.limb_));
        }
        operator mpfr_srcptr() const { return x_; }
    };
    View mpfr() const { return View(*this); }

    Quad() = default;
    Quad(std::integral auto n) {
        if constexpr (sizeof(n) > sizeof(long))  // 64 bits where long has 32
            *this = Quad(long(n >> 32)) * Quad(4294967296.0) + Quad((unsigned long)(n & 0xffffffff));
        else if constexpr (std::signed_integral<decltype(n)>)
            *this = of([n](mpfr_ptr x) { return mpfr_set_si(x, long(n), MPFR_RNDN); });
        else *this = of([n](mpfr_ptr x) { return mpfr_set_ui(x, (unsigned long)(n), MPFR_RNDN); });
    }
    Quad(std::floating_point auto a) {
        if constexpr (sizeof(a) > sizeof(double)) *this = of([a](mpfr_ptr x) { return mpfr_set_ld(x, a, MPFR_RNDN); });
        else *this = of([a](mpfr_ptr x) { return mpfr_set_d(x, double(a), MPFR_RNDN); });
    }
    /// Rounded once, from any length.
    explicit Quad(mpfr_srcptr a) : Quad(of([a](mpfr_ptr x) { return mpfr_set(x, a, MPFR_RNDN); })) {}
    explicit operator double() const { return mpfr_get_d(mpfr(), MPFR_RNDN); }
    explicit operator float() const { return mpfr_get_flt(mpfr(), MPFR_RNDN); }
    explicit operator long double() const { return mpfr_get_ld(mpfr(), MPFR_RNDN); }

    friend Quad operator+(Quad const& a, Quad const& b) {
        return of([&](mpfr_ptr x) { return mpfr_add(x, a.mpfr(), b.mpfr(), MPFR_RNDN); });
    }
    friend Quad operator-(Quad const& a, Quad const& b) {
        return of([&](mpfr_ptr x) { return mpfr_sub(x, a.mpfr(), b.mpfr(), MPFR_RNDN); });
    }
    friend Quad operator*(Quad const& a, Quad const& b) {
        return of([&](mpfr_ptr x) { return mpfr_mul(x, a.mpfr(), b.mpfr(), MPFR_RNDN); });
    }
    friend Quad operator/(Quad const& a, Quad const& b) {
        return of([&](mpfr_ptr x) { return mpfr_div(x, a.mpfr(), b.mpfr(), MPFR_RNDN); });
    }
    friend Quad sqrt(Quad const& a) {
        return of([&](mpfr_ptr x) { return mpfr_sqrt(x, a.mpfr(), MPFR_RNDN); });
    }
    friend Quad operator-(Quad a) {
        a.kind_ = -a.kind_;
        return a;
    }
    Quad& operator+=(Quad const& b) { return *this = *this + b; }
    Quad& operator-=(Quad const& b) { return *this = *this - b; }
    Quad& operator*=(Quad const& b) { return *this = *this * b; }
    Quad& operator/=(Quad const& b) { return *this = *this / b; }

    friend Quad abs(Quad const& a) { return a.kind_ < 0 ? -a : a; }
    friend Quad ldexp(Quad const& a, int e) {
        return of([&](mpfr_ptr x) { return mpfr_mul_2si(x, a.mpfr(), e, MPFR_RNDN); });
    }
    /// f and e of a = f 2^e with 1/2 <= |f| < 1. Zero, an infinity or a NaN is returned unchanged, with e = 0.
    friend Quad frexp(Quad a, int* e) {
        *e = int(a.exponent_);
        a.exponent_ = 0;
        return a;
    }
    friend bool isfinite(Quad const& a) { return a.kind_ >= MPFR_ZERO_KIND || a.kind_ <= -MPFR_ZERO_KIND; }
    friend bool isnan(Quad const& a) { return a.kind_ == MPFR_NAN_KIND; }
    friend bool isinf(Quad const& a) { return !isnan(a) && !isfinite(a); }
    friend bool signbit(Quad const& a) { return a.kind_ < 0; }
    friend bool operator==(Quad const& a, Quad const& b) { return mpfr_equal_p(a.mpfr(), b.mpfr()) != 0; }
    friend std::partial_ordering operator<=>(Quad const& a, Quad const& b) {
        if (isnan(a) || isnan(b)) return std::partial_ordering::unordered;
        return mpfr_cmp(a.mpfr(), b.mpfr()) <=> 0;
    }
};

template <>
struct ArithmeticTraits<Quad> {
    static constexpr std::string_view name = "quad";
    static constexpr int digits = 113, min_exp = -16382, max_exp = 16383;
};

template <>
struct Encoding<Quad> {
    using Bytes = detail::MpfrEncoding<113>;
    static constexpr std::size_t size = Bytes::size;
    static void write(Quad const& x, std::byte* to) {
        Quad::View const exact = x.mpfr();
        Bytes::write(exact, to);
    }
    static bool read(std::byte const* from, Quad& x) {
        mpfr_t exact;
        mpfr_init2(exact, 113);
        bool const read = Bytes::read(from, exact);
        x = Quad(mpfr_srcptr(exact));
        mpfr_clear(exact);
        Quad::View const kept = x.mpfr();  // other bits where it is beyond the range
        return read && Bytes::written_as(kept, from);
    }
};

}  // namespace rlslab

inline rlslab::Quad std::numeric_limits<rlslab::Quad>::min() { return ldexp(Quad(1), -16382); }
inline rlslab::Quad std::numeric_limits<rlslab::Quad>::max() { return ldexp(Quad(1) - ldexp(Quad(1), -113), 16384); }
inline rlslab::Quad std::numeric_limits<rlslab::Quad>::lowest() { return -max(); }
inline rlslab::Quad std::numeric_limits<rlslab::Quad>::epsilon() { return ldexp(Quad(1), -112); }
inline rlslab::Quad std::numeric_limits<rlslab::Quad>::round_error() { return Quad(0.5); }
inline rlslab::Quad std::numeric_limits<rlslab::Quad>::denorm_min() { return ldexp(Quad(1), -16494); }
inline rlslab::Quad std::numeric_limits<rlslab::Quad>::infinity() {
    return Quad(std::numeric_limits<double>::infinity());
}
inline rlslab::Quad std::numeric_limits<rlslab::Quad>::quiet_NaN() {
    return Quad(std::numeric_limits<double>::quiet_NaN());
}

template <>
struct Eigen::NumTraits<rlslab::Quad> : rlslab::detail::StorageTraits<rlslab::Quad> {};
