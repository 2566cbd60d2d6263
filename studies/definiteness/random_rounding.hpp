// Significands of p bits whose operations round stochastically with r random bits, or to nearest.
#pragma once

#include <rlslab/arithmetic/variable_precision.hpp>

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
class [[nodiscard]] RandomRoundingScope : rlslab::detail::ThreadScope<RandomRounding> {
public:
    explicit RandomRoundingScope(RandomRounding const& rule) : ThreadScope(rule) {
        if (rule.digits < 2 || rule.digits > 53 || rule.random_bits < 0 || rule.random_bits > 53 - rule.digits)
            throw std::invalid_argument("expected 2 to 53 digits, and at most 53 random bits and digits together");
    }
    static RandomRounding const& rule() { return now(); }
};

struct AtRandom {
    static constexpr std::string_view name = "random";
    static constexpr Format widest{53, -1022, 1023};
    static Format format() { return {setting().digits, -1022, 1023}; }

    template <class Tail>
    static double round(double head, Tail tail) {
        RandomRounding const& rule = setting();
        if (rule.random_bits == 0) return round_to_bits(head, tail(), rule.digits);
        return round_at_random(head, tail(), rule, [] { return StochasticStream::current().next(); });
    }
    static double of(double x) { return nearest(x); }
    static double nearest(double x) { return round_to_bits(x, 0, setting().digits); }
    static bool is_number(double) { return true; }

    static constexpr bool may_draw = true;
    static bool draws() { return setting().random_bits != 0; }
    using Setting = RandomRounding;
    using Scope = RandomRoundingScope;
    static Setting const& setting() { return RandomRoundingScope::rule(); }
};

/// A number whose operations round by the thread's RandomRoundingScope. Where that is at random they draw from its
/// StochasticStream. Made from a double it is rounded to nearest, as data are.
using RandomlyRounded = Rounded<AtRandom>;

}  // namespace rlslab::studies

template <>
inline int rlslab::significand_bits<rlslab::studies::RandomlyRounded>() {
    return studies::RandomRoundingScope::rule().digits;
}
