// Significands of any length up to 53 bits: a double holds p bits, and the exact result of every operation is rounded
// once to nearest.
#pragma once

#include <rlslab/arithmetic/thread_state.hpp>
#include <rlslab/arithmetic/format.hpp>
#include <rlslab/arithmetic/storage_traits.hpp>
#include <rlslab/core/encoding.hpp>
#include <rlslab/core/misuse.hpp>

#include <cmath>
#include <compare>

namespace rlslab {

/// Sets the length to which VariablePrecision rounds in this thread, 2 to 53 bits, until this object is destroyed; then
/// the previous length applies again. Without any scope it is 53. Throws std::invalid_argument for another number of
/// bits.
class [[nodiscard]] PrecisionScope {
    static inline constinit thread_local int current_ = 53;
    int previous_;

public:
    explicit PrecisionScope(int bits) : previous_(current_) {
        expects(bits >= 2 && bits <= 53, "2 to 53 bits of precision");
        current_ = bits;
    }
    ~PrecisionScope() { current_ = previous_; }
    PrecisionScope(PrecisionScope const&) = delete;
    PrecisionScope& operator=(PrecisionScope const&) = delete;
    static int bits() { return current_; }
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

/// A number of any significand length up to 53 bits. Every operation rounds to the length that the thread's current
/// PrecisionScope sets.
class VariablePrecision {
    double value_ = 0;
    struct AlreadyRounded {};
    VariablePrecision(double x, AlreadyRounded) : value_(x) {}
    static VariablePrecision rounded(double head, double tail) {
        return {round_to_bits(head, tail, PrecisionScope::bits()), AlreadyRounded{}};
    }

public:
    VariablePrecision() = default;
    explicit VariablePrecision(double x) : value_(round_to_bits(x, 0, PrecisionScope::bits())) {}
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
        return rounded(root, std::fma(-root, root, a.value_));
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

template <>
struct ThreadState<VariablePrecision> {
    int bits = PrecisionScope::bits();
    struct Part : PrecisionScope {
        Part(ThreadState const& state, std::uint64_t) : PrecisionScope(state.bits) {}
    };
};

template <>
struct ArithmeticTraits<VariablePrecision> {
    static constexpr std::string_view name = "bits";
    static constexpr int digits = 53, min_exp = -1022, max_exp = 1023;
};
template <>
inline int significand_bits<VariablePrecision>() {
    return PrecisionScope::bits();
}

namespace detail {
struct AnyDouble {
    bool operator()(double) const { return true; }
};
}  // namespace detail
/// A number may be longer than the bits of now: it was made before.
template <>
struct Encoding<VariablePrecision> : EncodingInDouble<VariablePrecision, detail::AnyDouble> {};

}  // namespace rlslab

template <>
struct Eigen::NumTraits<rlslab::VariablePrecision> : rlslab::detail::StorageTraits<rlslab::VariablePrecision> {
    using Number = rlslab::VariablePrecision;
    static Number highest() { return Number(std::numeric_limits<double>::max()); }
    static Number lowest() { return -highest(); }
    static Number infinity() { return Number(std::numeric_limits<double>::infinity()); }
    static Number quiet_NaN() { return Number(std::numeric_limits<double>::quiet_NaN()); }
};
