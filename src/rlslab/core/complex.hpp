// Complex numbers over any ordered field: a scalar of the variants in which every operation has one defined rounding.
#pragma once

#include <rlslab/core/encoding.hpp>
#include <rlslab/core/scalar.hpp>

#include <Eigen/Core>
#include <array>
#include <complex>

namespace rlslab {

namespace detail {
/// x, behind which no compiler looks. GCC's vectorizer (at least 12, x86 with FMA) takes a difference beside a sum of
/// products, as in a complex product, for one fused instruction, whatever -ffp-contract says.
template <class F>
[[gnu::always_inline]] inline F rounded(F x) {
#if defined(__GNUC__) && !defined(__clang__)
    if constexpr (std::same_as<F, float> || std::same_as<F, double>) {
#if defined(__FMA__)
        asm("" : "+x"(x));
#elif defined(__aarch64__)
        asm("" : "+w"(x));
#elif defined(__riscv_flen)
        asm("" : "+f"(x));
#endif
    }
#endif
    return x;
}
}  // namespace detail

/// re + i im. Each operation of F is rounded once, in the order written:
///
///   (a + ib)(c + id) = (ac - bd) + i(ad + bc)        r(a + ib) = ra + i rb        (a + ib) / r = a/r + i b/r        r
///   real
///
/// Not std::complex: its product is a call (__mulsc3) that repairs NaN, may fuse, and is not defined for other F than
/// the hardware's. Both convert into each other without a word, with the same bits; an array of std::complex is viewed
/// as it stands (Regressor). A quotient of two complex numbers, an order among them, and a conversion from or to a real
/// number without a word are not there: none of the variants' formulas has one, so that they do not compile by mistake.
///
/// may_alias: a view of std::complex's numbers reads them through this type.
template <Field F>
class [[gnu::may_alias]] Complex {
    static_assert(std::same_as<Accumulator<F>, F>,
                  "sums of fixed-point words are wider than the words: not complex yet");

public:
    F re, im;

    Complex() = default;
    Complex(F const& real, F const& imaginary) : re(real), im(imaginary) {}
    explicit Complex(F const& real) : re(real), im(F(0)) {}
    explicit Complex(int real)
        requires(!std::same_as<F, int>)
        : re(F(real)), im(F(0)) {}
    explicit Complex(double real)
        requires(!std::same_as<F, double>)
        : re(F(real)), im(F(0)) {}
    Complex(std::complex<F> const& x)
        requires std::floating_point<F>
        : re(x.real()), im(x.imag()) {}
    operator std::complex<F>() const
        requires std::floating_point<F>
    {
        return {re, im};
    }

    friend Complex operator+(Complex const& x, Complex const& y) { return {F(x.re + y.re), F(x.im + y.im)}; }
    friend Complex operator-(Complex const& x, Complex const& y) { return {F(x.re - y.re), F(x.im - y.im)}; }
    friend Complex operator-(Complex const& x) { return {F(-x.re), F(-x.im)}; }
    friend Complex operator*(Complex const& x, Complex const& y) {
        using detail::rounded;
        F const ac = rounded(F(x.re * y.re)), bd = rounded(F(x.im * y.im));
        F const ad = rounded(F(x.re * y.im)), bc = rounded(F(x.im * y.re));
        return {F(ac - bd), F(ad + bc)};
    }
    friend Complex operator*(F const& r, Complex const& x) { return {F(r * x.re), F(r * x.im)}; }
    friend Complex operator*(Complex const& x, F const& r) { return {F(x.re * r), F(x.im * r)}; }
    friend Complex operator/(Complex const& x, F const& r) { return {F(x.re / r), F(x.im / r)}; }
    Complex& operator+=(Complex const& y) { return *this = *this + y; }
    Complex& operator-=(Complex const& y) { return *this = *this - y; }
    Complex& operator*=(Complex const& y) { return *this = *this * y; }
    Complex& operator*=(F const& r) { return *this = *this * r; }
    Complex& operator/=(F const& r) { return *this = *this / r; }
    friend Truth<F> operator==(Complex const& x, Complex const& y) { return x.re == y.re && x.im == y.im; }

    // By the names that Eigen looks for.
    friend Complex conj(Complex const& x) { return {x.re, F(-x.im)}; }
    friend F const& real(Complex const& x) { return x.re; }
    friend F const& imag(Complex const& x) { return x.im; }
};

template <Field F>
[[gnu::always_inline]] inline Complex<F> conjugate(Complex<F> const& x) {
    return {x.re, F(-x.im)};
}
template <Field F>
[[gnu::always_inline]] inline F const& real_part(Complex<F> const& x) {
    return x.re;
}
template <Field F>
[[gnu::always_inline]] inline F absolute_square(Complex<F> const& x) {
    F const aa = x.re * x.re, bb = x.im * x.im;
    return F(aa + bb);
}
template <Field F>
Truth<F> is_finite(Complex<F> const& x) {
    return is_finite(x.re) && is_finite(x.im);
}
/// a in the lanes where `truth` holds, b in the others.
template <Field F>
Complex<F> select(Truth<F> const& truth, Complex<F> const& a, Complex<F> const& b)
    requires(!std::same_as<Truth<F>, bool>)
{
    return {select(truth, a.re, b.re), select(truth, a.im, b.im)};
}

namespace detail {
template <std::floating_point F>
Complex<F> const* viewed(std::complex<F> const* x) {
    static_assert(sizeof(Complex<F>) == sizeof(std::complex<F>) && alignof(Complex<F>) <= alignof(std::complex<F>));
    return reinterpret_cast<Complex<F> const*>(x);  // may_alias
}
template <Field F>
inline constexpr auto complex_name = [] {
    std::array<char, 8 + ArithmeticTraits<F>::name.size()> out{'c', 'o', 'm', 'p', 'l', 'e', 'x', ' '};
    for (std::size_t i = 0; i < ArithmeticTraits<F>::name.size(); ++i) out[8 + i] = ArithmeticTraits<F>::name[i];
    return out;
}();
}  // namespace detail

template <Field F, class X>
struct PerLaneOf<Complex<F>, X> : PerLaneOf<F, X> {};
template <Field F>
struct UncountedScope<Complex<F>> : UncountedScope<F> {};
template <Field F>
struct ArithmeticTraits<Complex<F>> : ArithmeticTraits<F> {
    static constexpr std::string_view name{detail::complex_name<F>.data(), detail::complex_name<F>.size()};
};

/// The real part, then the imaginary one.
template <Field F>
struct Encoding<Complex<F>> {
    static constexpr std::size_t size = 2 * Encoding<F>::size;
    static void write(Complex<F> const& x, std::byte* to) {
        Encoding<F>::write(x.re, to);
        Encoding<F>::write(x.im, to + Encoding<F>::size);
    }
    static bool read(std::byte const* from, Complex<F>& x) {
        return Encoding<F>::read(from, x.re) && Encoding<F>::read(from + Encoding<F>::size, x.im);
    }
};

}  // namespace rlslab

template <class F>
struct Eigen::NumTraits<rlslab::Complex<F>> : Eigen::GenericNumTraits<rlslab::Complex<F>> {
    using Real = F;
    using NonInteger = rlslab::Complex<F>;
    using Nested = rlslab::Complex<F>;
    using Literal = typename NumTraits<F>::Literal;
    enum {
        IsComplex = 1,
        IsInteger = 0,
        IsSigned = 1,
        RequireInitialization = NumTraits<F>::RequireInitialization,
        ReadCost = 2 * int(NumTraits<F>::ReadCost),
        AddCost = 2 * int(NumTraits<F>::AddCost),
        MulCost = 4 * int(NumTraits<F>::MulCost)
    };
    static F epsilon() { return NumTraits<F>::epsilon(); }
    static F dummy_precision() { return NumTraits<F>::dummy_precision(); }
    static F highest() { return NumTraits<F>::highest(); }
    static F lowest() { return NumTraits<F>::lowest(); }
    static int digits10() { return NumTraits<F>::digits10(); }
};
