// Rounding with few random bits: its probabilities, counted over all draws, and its agreement with the
// other roundings.
#include "studies/definiteness/random_rounding.hpp"

#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rlslab {
using namespace studies;
namespace {

using Surplus = RandomRounding::Surplus;
constexpr auto no_draw = []() -> std::uint64_t {
    ADD_FAILURE() << "a draw";
    return 0;
};

/// How many of the 2^r draws round x up, by round(x, draw).
template <class Round>
long ups(double x, int r, Round round) {
    long out = 0;
    for (std::uint64_t n = 0; n < std::uint64_t{1} << r; ++n) out += round(x, (n << (64 - r)) | 0x5a5a5a) > std::abs(x);
    return out;
}
/// 2^r f, and the same as the rule has it: x = (2^(p-1) + n + f) 2^(e-p+1), all in integers.
long of_all(double x, RandomRounding const& rule) {
    int e;
    double const scaled = std::ldexp(std::frexp(std::abs(x), &e), rule.digits), f = scaled - std::floor(scaled);
    double const chance = std::ldexp(f, rule.random_bits);
    return long(std::floor(rule.surplus == Surplus::half ? chance + 0.5 : chance));
}

TEST(RandomRounding, TheOuterNeighbourIsTakenAsOftenAsTheRuleSays) {
    Seed seed{20261122};
    for (int n = 0; n < 400; ++n)
        for (Surplus const surplus : {Surplus::truncate, Surplus::half}) {
            RandomRounding const rule{2 + int(seed.next() % 23), 1 + int(seed.next() % 8), surplus};
            double const x = std::ldexp(seed.bell(), int(seed.next() % 600) - 300);
            auto const round = [&](double v, std::uint64_t draw) {
                return std::abs(round_at_random(v, 0, rule, [=] { return draw; }));
            };
            EXPECT_EQ(ups(x, rule.random_bits, round), of_all(x, rule))
                << x << ' ' << rule.digits << ' ' << rule.random_bits;
        }
}
TEST(RandomRounding, ASaboteurIsSeen) {  // surplus bits that are rounded up
    RandomRounding const rule{8, 3, Surplus::truncate};
    double const x = 1 + 0x1p-10 + 0x1p-14;
    EXPECT_EQ(
        ups(x, 3, [&](double v, std::uint64_t draw) { return round_at_random(v, 0, rule, [=] { return draw; }); }), 1);
    EXPECT_NE(
        ups(x, 3,
            [&](double v, std::uint64_t draw) { return round_at_random(v + 0x1p-10, 0, rule, [=] { return draw; }); }),
        1);
}
TEST(RandomRounding, WithAllBitsItIsStochasticRounding) {
    Seed seed{7};
    RandomRounding const rule{.digits = 8, .random_bits = 45};
    for (int n = 0; n < 20000; ++n) {
        double const x = std::ldexp(seed.bell(), int(seed.next() % 200) - 100);
        std::uint64_t const draw = seed.next();
        double const few = round_at_random(x, 0, rule, [=] { return draw; });
        EXPECT_EQ(few, round_stochastically(x, 0, bfloat16, [=] { return double(draw >> 11) * 0x1p-53; }));
    }
}
TEST(RandomRounding, ANumberOfTheFormatStaysAndDrawsNothing) {
    RandomRounding const rule{5, 4, Surplus::half};
    double const infinity = std::numeric_limits<double>::infinity();
    for (double const x : {0.0, -0.0, 1.0, -1.9375, 0x1.fp1000, 0x1p-1000, infinity, -infinity})
        EXPECT_EQ(detail::bits_of(round_at_random(x, 0, rule, no_draw)), detail::bits_of(x)) << x;
    EXPECT_TRUE(std::isnan(round_at_random(std::nan(""), 0, rule, no_draw)));
    // A tail towards zero: just below 1, of which the fraction is nearly one.
    EXPECT_EQ(round_at_random(1, -0x1p-60, {5, 4, Surplus::truncate}, [] { return std::uint64_t{15} << 60; }),
              1 - 0x1p-5);
    EXPECT_EQ(round_at_random(1, -0x1p-60, {5, 4, Surplus::truncate}, [] { return std::uint64_t{14} << 60; }), 1);
    EXPECT_EQ(round_at_random(1, -0x1p-60, rule, [] { return ~std::uint64_t{0}; }), 1);
}
TEST(RandomRounding, RulesOutOfRangeAreRefused) {
    for (RandomRounding const& rule :
         {RandomRounding{1, 4}, RandomRounding{54, 0}, RandomRounding{8, 46}, RandomRounding{8, -1}})
        EXPECT_THROW(RandomRoundingScope{rule}, std::invalid_argument);
    EXPECT_EQ(RandomRoundingScope::rule().digits, 53);
}

template <class F>
F run(int rows, Seed seed) {
    using T = typename F::scalar;
    F filter({.size = 3, .forgetting = T(0.97), .prior = Prior<T>{.variance = T(1)}});
    for (int k = 0; k < rows; ++k) {
        Vector<T> psi(3);
        for (T& x : psi) x = T(seed.bell());
        filter.update(psi, T(seed.bell()));
    }
    return filter;
}

TEST(RandomRounding, WithoutRandomBitsAFilterIsThatOfTheSameLength) {
    for (int const p : {6, 8, 24}) {
        PrecisionScope const bits(p);
        RandomRoundingScope const rule({.digits = p});
        auto const nearest = run<Symmetric<RandomlyRounded>>(200, Seed{5});
        auto const reference = run<Symmetric<VariablePrecision>>(200, Seed{5});
        for (Index i = 0; i < 9; ++i)
            EXPECT_EQ(double(nearest.stored().F.reshaped()[i]), double(reference.stored().F.reshaped()[i]));
    }
}
TEST(RandomRounding, AFilterIsReplayedByItsSeed) {
    RandomRoundingScope const rule({.digits = 8, .random_bits = 4});
    auto const with = [](std::uint64_t n) {
        Seed seed{n};
        StochasticStream const stream(seed);
        return double(run<Ud<RandomlyRounded>>(200, Seed{5}).theta()[0]);
    };
    EXPECT_EQ(with(1), with(1));
    EXPECT_NE(with(1), with(2));
    EXPECT_THROW(run<Ud<RandomlyRounded>>(200, Seed{5}), std::logic_error);
}

}  // namespace
}  // namespace rlslab
