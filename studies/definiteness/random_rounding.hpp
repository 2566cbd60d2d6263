// Significands of p bits whose operations round stochastically with r random bits, or to nearest.
#pragma once

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/catalogue/round_to.hpp>

#include <compare>

namespace rlslab::studies {

/// How the exact result x of an operation becomes one of its two neighbours of p bits. f in [0, 1): the fraction of the
/// way to the outer one. With r random bits the outer one is taken with probability
///   truncate    2^-r floor(2^r f)             the bits of f behind the r-th are surplus, and dropped
///   half        2^-r floor(2^r f + 1/2)       half of the last random bit is added to them first
struct RandomRounding {
    enum class Surplus { truncate, half };
    int digits = 53;      ///< p, 2 to 53
    int random_bits = 0;  ///< r; 0: to nearest, ties to even. At most 53 - p, which drops less than 2^-(53-p) of f
    Surplus surplus = Surplus::truncate;
};

/// Rounds the exact value head + tail by the rule. head: the double nearest to it, tail: of the sign of the exact value
/// less head. draw() returns 64 random bits, of which the first r are used; a number of p bits draws nothing, nor does
/// one whose probability is 0. Exponents are double's. Infinities stay, every NaN becomes one.
template <class Draw>
constexpr double round_at_random(double head, double tail, RandomRounding const& rule, Draw&& draw) {
    using namespace rlslab::detail;
    if (!is_number(head)) return not_a_number(head);
    int const surplus = 53 - rule.digits - rule.random_bits;
    std::uint64_t const ulp = std::uint64_t{1} << (53 - rule.digits), size = bits_of(floor_of(head, tail)),
                        rest = size & (ulp - 1);
    std::uint64_t const half =
        rule.surplus == RandomRounding::Surplus::half && surplus > 0 ? std::uint64_t{1} << (surplus - 1) : 0;
    std::uint64_t const of_all = (rest + half) >> surplus;  // the probability, in units of 2^-r
    bool const up = of_all != 0 && (draw() >> (64 - rule.random_bits)) < of_all;
    return with_sign_of(head, from_bits(size - rest + (up ? ulp : 0)));
}

/// Sets the rule by which RandomlyRounded rounds in this thread until this object is destroyed. Throws
/// std::invalid_argument for a rule whose numbers are out of range.
class [[nodiscard]] RandomRoundingScope {
    static inline constinit thread_local RandomRounding current_{};
    RandomRounding previous_;

public:
    explicit RandomRoundingScope(RandomRounding const& rule) : previous_(current_) {
        if (rule.digits < 2 || rule.digits > 53 || rule.random_bits < 0 || rule.random_bits > 53 - rule.digits)
            throw std::invalid_argument("expected 2 to 53 digits, and at most 53 random bits and digits together");
        current_ = rule;
    }
    ~RandomRoundingScope() { current_ = previous_; }
    RandomRoundingScope(RandomRoundingScope const&) = delete;
    RandomRoundingScope& operator=(RandomRoundingScope const&) = delete;
    static RandomRounding const& rule() { return current_; }
};

/// A number whose operations round by the thread's RandomRoundingScope. Where that is at random they draw from its
/// StochasticStream. Made from a double it is rounded to nearest, as data are.
class RandomlyRounded {
    double value_ = 0;
    struct AlreadyRounded {};
    RandomlyRounded(double x, AlreadyRounded) : value_(x) {}
    static RandomlyRounded rounded(double head, double tail) {
        RandomRounding const& rule = RandomRoundingScope::rule();
        if (rule.random_bits == 0) return {round_to_bits(head, tail, rule.digits), AlreadyRounded{}};
        return {round_at_random(head, tail, rule, [] { return StochasticStream::current().next(); }), AlreadyRounded{}};
    }

public:
    RandomlyRounded() = default;
    explicit RandomlyRounded(double x) : value_(round_to_bits(x, 0, RandomRoundingScope::rule().digits)) {}
    explicit operator double() const { return value_; }

    friend RandomlyRounded operator+(RandomlyRounded a, RandomlyRounded b) {  // Knuth's TwoSum: the tail is exact
        double const x = a.value_, y = b.value_, sum = x + y, of_y = sum - x, of_x = sum - of_y;
        return rounded(sum, (x - of_x) + (y - of_y));
    }
    friend RandomlyRounded operator-(RandomlyRounded a, RandomlyRounded b) { return a + -b; }
    friend RandomlyRounded operator*(RandomlyRounded a, RandomlyRounded b) {
        double const product = a.value_ * b.value_;
        return rounded(product, std::fma(a.value_, b.value_, -product));
    }
    friend RandomlyRounded operator/(RandomlyRounded a, RandomlyRounded b) {  // the remainder is exact
        double const quotient = a.value_ / b.value_;
        return rounded(quotient, quotient == 0 ? 0.0 : std::fma(-quotient, b.value_, a.value_) / b.value_);
    }
    friend RandomlyRounded operator-(RandomlyRounded a) { return {-a.value_, AlreadyRounded{}}; }
    friend RandomlyRounded sqrt(RandomlyRounded a) {
        double const root = std::sqrt(a.value_);
        return rounded(root, std::fma(-root, root, a.value_));
    }
    RandomlyRounded& operator+=(RandomlyRounded b) { return *this = *this + b; }
    RandomlyRounded& operator-=(RandomlyRounded b) { return *this = *this - b; }
    RandomlyRounded& operator*=(RandomlyRounded b) { return *this = *this * b; }
    RandomlyRounded& operator/=(RandomlyRounded b) { return *this = *this / b; }

    friend RandomlyRounded abs(RandomlyRounded a) { return {rlslab::detail::magnitude(a.value_), AlreadyRounded{}}; }
    friend bool isfinite(RandomlyRounded a) { return rlslab::detail::is_number(a.value_); }
    friend bool operator==(RandomlyRounded const&, RandomlyRounded const&) = default;
    friend auto operator<=>(RandomlyRounded const&, RandomlyRounded const&) = default;
};

}  // namespace rlslab::studies

namespace rlslab {

template <>
struct ArithmeticTraits<studies::RandomlyRounded> {
    static constexpr std::string_view name = "random";
    static constexpr int digits = 53, min_exp = -1022, max_exp = 1023;
};
template <>
inline int significand_bits<studies::RandomlyRounded>() {
    return studies::RandomRoundingScope::rule().digits;
}
template <>
struct RoundingSeedScope<studies::RandomlyRounded> : StochasticStream {
    using StochasticStream::StochasticStream;
};
/// The draws of what is no part of the algorithm are taken back.
template <>
struct UncountedScope<studies::RandomlyRounded> : UncountedScope<Chopped<binary16, Rounding::stochastic>> {};
template <>
struct Encoding<studies::RandomlyRounded> : EncodingInDouble<studies::RandomlyRounded, detail::AnyDouble> {};

}  // namespace rlslab

template <>
struct Eigen::NumTraits<rlslab::studies::RandomlyRounded>
    : rlslab::detail::StorageTraits<rlslab::studies::RandomlyRounded> {
    using Number = rlslab::studies::RandomlyRounded;
    static Number highest() { return Number(std::numeric_limits<double>::max()); }
    static Number lowest() { return -highest(); }
    static Number infinity() { return Number(std::numeric_limits<double>::infinity()); }
    static Number quiet_NaN() { return Number(std::numeric_limits<double>::quiet_NaN()); }
};
