// The operations that a variant needs of its scalar, and the properties of a scalar that the rest of the library needs.
#pragma once

#include <rlslab/core/cpp20.hpp>

// Every operation is rounded once, in the order written. These options allow a compiler to fuse, reorder or drop
// operations.
#if (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(__FAST_MATH__)
#error "rlslab: -ffast-math or -ffinite-math-only (-Ofast) hides infinities and NaN: a breakdown would look sound"
#elif defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || defined(__NO_SIGNED_ZEROS__)
#error "rlslab: -funsafe-math-optimizations (or a part of it) changes the order and number of roundings"
#endif

#include <cmath>
#include <complex>
#include <concepts>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

namespace rlslab {

/// An ordered field, except for rounding: +, -, x, / and comparisons; constructible from int and from double.
/// Unchecked: that the operations round as the arithmetic's name says (tests/arithmetic*.cpp test that).
// clang-format would take b * b for a pointer.
// clang-format off
template <class T>
concept Field = std::copyable<T> && std::constructible_from<T, int> && std::constructible_from<T, double> &&
                requires(T a, T const b) {
                    { b + b } -> std::convertible_to<T>;
                    { b - b } -> std::convertible_to<T>;
                    { b * b } -> std::convertible_to<T>;
                    { b / b } -> std::convertible_to<T>;
                    { -b } -> std::convertible_to<T>;
                    a += b;
                    a -= b;
                    a *= b;
                    a /= b;
                    !(b < b) && (b == b);
                };
// clang-format on

template <Field F>
class Complex;

/// The type of the numbers that are real by theory, whatever the data are: lambda, s, gamma, D, the diagonal of R,
/// c of a rotation. T itself, or F for Complex<F>: no rounding error can put an imaginary part into them.
template <class T>
struct RealOfScalar {
    using type = T;
};
template <Field F>
struct RealOfScalar<Complex<F>> {
    using type = F;
};
template <class T>
using RealOf = typename RealOfScalar<T>::type;

template <class T>
concept ComplexScalar = !std::same_as<RealOf<T>, T>;
/// The scalar of a variant: an ordered field, or the complex numbers over one. What is written for Field refuses
/// complex numbers when it is compiled.
template <class T>
concept Scalar = Field<T> || ComplexScalar<T>;

/// The complex conjugate, the real part, and |x|^2 = conj(x) x. Of a real x: x, x and x^2, with the bits and the
/// cost of these.
template <class T>
inline constexpr bool is_std_complex = false;
template <class F>
inline constexpr bool is_std_complex<std::complex<F>> = true;
template <class T>
concept NotStdComplex = !is_std_complex<T>;  // of which these would not be true
template <NotStdComplex T>
[[gnu::always_inline]] inline T const& conjugate(T const& x) {
    return x;
}
template <NotStdComplex T>
[[gnu::always_inline]] inline T const& real_part(T const& x) {
    return x;
}
template <NotStdComplex T>
[[gnu::always_inline]] inline auto absolute_square(T const& x) {
    return x * x;
}

/// The type of a comparison of two real numbers: bool, or one truth for each lane where T is a Pack of numbers.
template <class T>
using Truth = std::remove_cvref_t<decltype(std::declval<RealOf<T> const&>() < std::declval<RealOf<T> const&>())>;

/// A branch in the text of a variant is written with all, any and select, so that each lane of a Pack takes its own
/// side. For a scalar these are the plain branch. select: a where `truth` holds, else b.
inline bool all(bool truth) { return truth; }
inline bool any(bool truth) { return truth; }
template <class X>
X select(bool truth, X const& a, X const& b) {
    return truth ? a : b;
}
/// X, or one X for each of T's lanes.
template <class T, class X>
struct PerLaneOf {
    using type = X;
};
template <class T, class X>
using PerLane = typename PerLaneOf<T, X>::type;

/// A Field with a square root, which the square-root forms need and the rational numbers lack.
/// `sqrt` is found by argument-dependent lookup after `using std::sqrt`.
template <class T>
concept Real = Field<T> && (std::floating_point<T> || requires(T const a) {
                   { sqrt(a) } -> std::convertible_to<T>;
               });

/// A Scalar whose real numbers have a square root.
template <class T>
concept RootedScalar = Real<T> || (ComplexScalar<T> && Real<RealOf<T>>);

/// False for infinities and NaN; true for every value of a scalar that has neither.
template <Field T>
[[gnu::always_inline]] inline Truth<T> is_finite(T const& x) {
    using std::isfinite;
    if constexpr (requires { isfinite(x); }) return Truth<T>(isfinite(x));
    else return true;
}

template <Field T>
T absolute(T const& x) {
    return select(x < T(0), T(-x), x);
}

template <Real T>
[[gnu::always_inline]] inline T square_root(T const& x) {  // a call in the middle of a kernel would spill its registers
    using std::sqrt;
    return sqrt(x);
}

/// The properties of an arithmetic. Each scalar specialises this beside its definition.
///   name      as on the command line          digits  bits p of the significand, so that u = 2^-p
///   min_exp, max_exp   exponents e of the smallest and largest normal 1.f x 2^e
template <class T>
struct ArithmeticTraits;

template <>
struct ArithmeticTraits<float> {
    static constexpr std::string_view name = "float";
    static constexpr int digits = 24, min_exp = -126, max_exp = 127;
};
template <>
struct ArithmeticTraits<double> {
    static constexpr std::string_view name = "double";
    static constexpr int digits = 53, min_exp = -1022, max_exp = 1023;
};
/// x87's 64 bits are "extended"; elsewhere long double is double again, binary128, or a pair of doubles.
template <>
struct ArithmeticTraits<long double> {
    using Limits = std::numeric_limits<long double>;
    static constexpr std::string_view name = Limits::digits == 64 ? "extended" : "long double";
    static constexpr int digits = Limits::digits, min_exp = Limits::min_exponent - 1,
                         max_exp = Limits::max_exponent - 1;
};

/// What a sum of products of T is kept in until it is stored as a T: T itself, but for scalars that specialise it.
template <class T>
struct AccumulatorOf {
    using type = T;
};
template <class T>
using Accumulator = typename AccumulatorOf<T>::type;

/// The number of bits p of the significand; for VariablePrecision the one that holds in the calling thread now.
template <class T>
constexpr int significand_bits() {
    return ArithmeticTraits<T>::digits;
}
/// The exponents of the smallest and the largest normal number; for VariablePrecision those of now.
template <class T>
constexpr int min_exponent() {
    return ArithmeticTraits<T>::min_exp;
}
template <class T>
constexpr int max_exponent() {
    return ArithmeticTraits<T>::max_exp;
}

/// While an UncountedScope exists, the thread's computations are no part of the algorithm: afterwards the random
/// stream and the tally of operations are what they were before. A scalar that has such a stream or tally
/// specialises this.
template <class T>
struct UncountedScope {
    UncountedScope() {}
};

/// The distance from 1 to the next larger number, 2^(1-p) = 2u. Error budgets are stated in it.
template <class T>
double epsilon() {
    return std::ldexp(1.0, 1 - ArithmeticTraits<T>::digits);
}

}  // namespace rlslab
