// Formats chosen at run time: a double holds p bits, and the exact result of every operation is rounded once. Exponents
// are double's, or those of a range that is set with the length; then the rounding is chosen, too.
#pragma once

#include <rlslab/arithmetic/chopped.hpp>

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
class [[nodiscard]] PrecisionScope : detail::ThreadScope<RunTimeFormat> {
    static RunTimeFormat const& checked(RunTimeFormat const& format) {
        expects(format.valid(), format.has_range() ? "a format that double can emulate (fits_in_double)"
                                                   : "2 to 53 bits of precision, rounded to nearest without a range");
        return format;
    }

public:
    explicit PrecisionScope(int bits) : PrecisionScope(RunTimeFormat{{bits, -1022, 1023}}) {}
    explicit PrecisionScope(RunTimeFormat const& format) : ThreadScope(checked(format)) {}
    static RunTimeFormat const& format() { return now(); }
    static int bits() { return now().format.digits; }
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

namespace detail {
struct InFormatOfNow {
    static constexpr std::string_view name = "bits";
    static constexpr Format widest{53, -1022, 1023};
    static Format format() { return PrecisionScope::format().format; }

    template <class Tail>
    static double round(double head, Tail tail) {
        RunTimeFormat const& now = PrecisionScope::format();
        if (!now.has_range()) [[likely]]
            return round_to_bits(head, tail(), now.format.digits);
        if (now.rounding == Rounding::nearest) return round_to_nearest(head, now.format);
        if (now.rounding == Rounding::toward_zero) return round_toward_zero(head, tail(), now.format);
        return round_stochastically(head, tail(), now.format, &StochasticStream::uniform);
    }
    static double of(double x) {
        return round(x, [] { return 0.0; });
    }
    static double nearest(double x) { return nearest_in(PrecisionScope::format(), x); }
    static bool is_number(double) { return true; }  // it may be longer than the format of now: it was made before

    static constexpr bool may_draw = true;
    static bool draws() { return setting().rounding == Rounding::stochastic; }
    using Setting = RunTimeFormat;
    using Scope = PrecisionScope;
    static Setting const& setting() { return PrecisionScope::format(); }
};
}  // namespace detail

/// A number of the format that the thread's current PrecisionScope sets when it is made.
using VariablePrecision = Rounded<detail::InFormatOfNow>;

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

}  // namespace rlslab
