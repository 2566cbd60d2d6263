// Formats chosen at run time: a double holds p bits, and the exact result of every operation is rounded once. Exponents
// are double's, or those of a range that is set with the length; then the rounding is chosen, too.
#pragma once

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/storage_traits.hpp>

#include <cmath>
#include <compare>

namespace rlslab {

/// A format, and how operations round to it. Without a range of its own, exponents are double's and rounding is to
/// nearest.
struct RunTimeFormat {
    Format format{53, -1022, 1023};
    Rounding rounding = Rounding::nearest;

    constexpr bool has_range() const { return format.min_exp != -1022 || format.max_exp != 1023; }
    /// 2 to 53 bits without a range; with one, what double can emulate (fits_in_double).
    constexpr bool valid() const {
        if (has_range()) return fits_in_double(format);
        return format.digits >= 2 && format.digits <= 53 && rounding == Rounding::nearest;
    }
    friend constexpr bool operator==(RunTimeFormat const&, RunTimeFormat const&) = default;
};

/// Sets the format to which VariablePrecision rounds in this thread until this object is destroyed; then the previous
/// one applies again. Without any scope it has 53 bits. Stochastic rounding needs a StochasticStream besides. Throws
/// std::invalid_argument for a format that is not valid().
class [[nodiscard]] PrecisionScope {
    static inline constinit thread_local RunTimeFormat current_{};
    RunTimeFormat previous_;

public:
    explicit PrecisionScope(int bits) : PrecisionScope(RunTimeFormat{{bits, -1022, 1023}}) {}
    explicit PrecisionScope(RunTimeFormat const& format) : previous_(current_) {
        expects(format.valid(), format.has_range() ? "a format that double can emulate (fits_in_double)"
                                                   : "2 to 53 bits of precision, rounded to nearest without a range");
        current_ = format;
    }
    ~PrecisionScope() { current_ = previous_; }
    PrecisionScope(PrecisionScope const&) = delete;
    PrecisionScope& operator=(PrecisionScope const&) = delete;
    static RunTimeFormat const& format() { return current_; }
    static int bits() { return current_.format.digits; }
};

/// head + tail rounded to p bits, ties to even. head is the double nearest to the exact value, tail has the sign of the
/// exact value minus head: it decides when head lies halfway between two p-bit numbers and the exact value does not.
/// Exponents are double's.
inline double round_to_bits(double head, double tail, int p) {
    using namespace detail;
    if (p == 53 || !is_number(head)) return head;
    std::uint64_t const ulp = std::uint64_t{1} << (53 - p), bits = bits_of(head), rest = bits & (ulp - 1),
                        below = bits - rest;
    double const out = outward(head, tail);
    bool const up = rest > ulp / 2 || (rest == ulp / 2 && (out > 0 || (out == 0 && (below & ulp) != 0)));
    return from_bits(below + (up ? ulp : 0));
}

/// x as data in the format: to nearest, whatever its operations do.
inline double nearest_in(RunTimeFormat const& f, double x) {
    return f.has_range() ? round_to_nearest(x, f.format) : round_to_bits(x, 0, f.format.digits);
}

/// A number of the format that the thread's current PrecisionScope sets when it is made.
class VariablePrecision {
    double value_ = 0;
    struct AlreadyRounded {};
    VariablePrecision(double x, AlreadyRounded) : value_(x) {}

    /// `rest` has the sign of the exact result minus head, and rest / by is their difference.
    static VariablePrecision rounded(double head, double rest, double by = 1) {
        RunTimeFormat const& now = PrecisionScope::format();
        if (!now.has_range()) [[likely]]
            return {round_to_bits(head, rest, now.format.digits), AlreadyRounded{}};
        if (now.rounding == Rounding::nearest) return {round_to_nearest(head, now.format), AlreadyRounded{}};
        double const tail = rest == 0 ? 0.0 : rest / by;
        if (now.rounding == Rounding::toward_zero) return {round_toward_zero(head, tail, now.format), AlreadyRounded{}};
        return {round_stochastically(head, tail, now.format, &StochasticStream::uniform), AlreadyRounded{}};
    }

public:
    VariablePrecision() = default;
    explicit VariablePrecision(double x) : VariablePrecision(rounded(x, 0)) {}
    explicit operator double() const { return value_; }

    friend VariablePrecision operator+(VariablePrecision a, VariablePrecision b) {  // Knuth's TwoSum: the tail is exact
        double const x = a.value_, y = b.value_, sum = x + y, of_y = sum - x, of_x = sum - of_y;
        return rounded(sum, (x - of_x) + (y - of_y));
    }
    friend VariablePrecision operator-(VariablePrecision a, VariablePrecision b) { return a + -b; }
    friend VariablePrecision operator*(VariablePrecision a, VariablePrecision b) {
        double const product = a.value_ * b.value_;
        return rounded(product, std::fma(a.value_, b.value_, -product));
    }
    friend VariablePrecision operator/(VariablePrecision a, VariablePrecision b) {  // the remainder is exact
        double const quotient = a.value_ / b.value_;
        return rounded(quotient, quotient == 0 ? 0.0 : std::fma(-quotient, b.value_, a.value_) / b.value_);
    }
    friend VariablePrecision operator-(VariablePrecision a) { return {-a.value_, AlreadyRounded{}}; }
    friend VariablePrecision sqrt(VariablePrecision a) {
        double const root = std::sqrt(a.value_);
        return rounded(root, std::fma(-root, root, a.value_), 2 * root);  // (sqrt(x) - root) (sqrt(x) + root)
    }
    VariablePrecision& operator+=(VariablePrecision b) { return *this = *this + b; }
    VariablePrecision& operator-=(VariablePrecision b) { return *this = *this - b; }
    VariablePrecision& operator*=(VariablePrecision b) { return *this = *this * b; }
    VariablePrecision& operator/=(VariablePrecision b) { return *this = *this / b; }

    friend VariablePrecision abs(VariablePrecision a) { return {detail::magnitude(a.value_), AlreadyRounded{}}; }
    friend bool isfinite(VariablePrecision a) { return detail::is_number(a.value_); }
    friend bool operator==(VariablePrecision const&, VariablePrecision const&) = default;
    friend auto operator<=>(VariablePrecision const&, VariablePrecision const&) = default;
};

/// The parts have the format; where it rounds at random, each draws as those of a Chopped do.
template <>
struct ThreadState<VariablePrecision> {
    RunTimeFormat format = PrecisionScope::format();
    std::uint64_t drawn = format.rounding == Rounding::stochastic ? StochasticStream::current().next() : 0;
    class Part {
        PrecisionScope precision_;
        Seed seed_;
        StochasticStream stream_;

    public:
        Part(ThreadState const& state, std::uint64_t part)
            : precision_(state.format), seed_{Seed{state.drawn + part}.next()}, stream_(seed_) {}
    };
};
template <>
struct UncountedScope<VariablePrecision> : UncountedScope<HalfStochastic> {};

template <>
struct ArithmeticTraits<VariablePrecision> {
    static constexpr std::string_view name = "bits";
    static constexpr int digits = 53, min_exp = -1022, max_exp = 1023;
};
template <>
inline int significand_bits<VariablePrecision>() {
    return PrecisionScope::bits();
}
template <>
inline int min_exponent<VariablePrecision>() {
    return PrecisionScope::format().format.min_exp;
}
template <>
inline int max_exponent<VariablePrecision>() {
    return PrecisionScope::format().format.max_exp;
}

namespace detail {
struct AnyDouble {
    bool operator()(double) const { return true; }
};
}  // namespace detail
/// A number may be longer than the format of now: it was made before.
template <>
struct Encoding<VariablePrecision> : EncodingInDouble<VariablePrecision, detail::AnyDouble> {};

}  // namespace rlslab

template <>
struct Eigen::NumTraits<rlslab::VariablePrecision> : rlslab::detail::StorageTraits<rlslab::VariablePrecision> {
    using Number = rlslab::VariablePrecision;
    static Number highest() { return Number(rlslab::largest(rlslab::PrecisionScope::format().format)); }
    static Number lowest() { return -highest(); }
    static Number infinity() { return Number(std::numeric_limits<double>::infinity()); }
    static Number quiet_NaN() { return Number(std::numeric_limits<double>::quiet_NaN()); }
};
