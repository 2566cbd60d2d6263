// Rounding with few random bits: its probabilities, counted over all draws, and its agreement with the
// other roundings.
#include "studies/definiteness/random_rounding.hpp"
#include "tests/common/rounding.hpp"

#include <rlslab/studies/study.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
namespace studies {
extern Study const stochastic_definiteness;
}
using namespace studies;
namespace {

using Surplus = RandomRounding::Surplus;
using Rounder = std::function<double(double x, RandomRounding const& rule, std::uint64_t draw)>;
double at_random(double x, RandomRounding const& rule, std::uint64_t draw) {
    return round_at_random(x, 0, rule, [=] { return draw; });
}

/// Of the 2^r draws as many round x up as the rule says: 2^r f, whole or to nearest, by a search among the numbers.
bool goes_up_as_often(Rounder const& round, double x, RandomRounding const& rule) {
    Format const f{rule.digits, -900, 900};
    auto const against = rounding::exactly('*', x, 1);
    rounding::Place const place = rounding::place_of(f, x, against);
    double const below = rounding::number(f, place), gap = rounding::number(f, place + 1) - below;
    for (std::uint64_t n = 0; n < std::uint64_t{1} << rule.random_bits; ++n) {
        double const least = std::ldexp(double(n) + (rule.surplus == Surplus::half ? 0.5 : 1), -rule.random_bits);
        double const expected = against(below, least * gap) >= 0 ? below + gap : below;
        if (std::abs(round(x, rule, (n << (64 - rule.random_bits)) | 0x5a5a5a)) != expected) return false;
    }
    return true;
}
TEST(RandomRounding, TheOuterNeighbourIsTakenAsOftenAsTheRuleSays) {
    Seed seed{20261122};
    for (int n = 0; n < 400; ++n)
        for (Surplus const surplus : {Surplus::truncate, Surplus::half}) {
            RandomRounding const rule{2 + int(seed.next() % 23), 1 + int(seed.next() % 8), surplus};
            double const x = std::ldexp(seed.bell(), int(seed.next() % 600) - 300);
            EXPECT_TRUE(goes_up_as_often(&at_random, x, rule)) << x << ' ' << rule.digits << ' ' << rule.random_bits;
        }
    Rounder const saboteur = [](double x, RandomRounding const& rule, std::uint64_t draw) {  // surplus bits rounded up
        return at_random(x + 0x1p-10, rule, draw);
    };
    EXPECT_TRUE(goes_up_as_often(&at_random, 1 + 0x1p-10 + 0x1p-14, {8, 3, Surplus::truncate}));
    EXPECT_FALSE(goes_up_as_often(saboteur, 1 + 0x1p-10 + 0x1p-14, {8, 3, Surplus::truncate}));
}
TEST(RandomRounding, WithAllBitsItIsStochasticRounding) {
    Seed seed{7};
    RandomRounding const rule{.digits = 8, .random_bits = 45};
    for (int n = 0; n < 20000; ++n) {
        double const x = std::ldexp(seed.bell(), int(seed.next() % 200) - 100);
        std::uint64_t const draw = seed.next();
        EXPECT_EQ(at_random(x, rule, draw),
                  round_stochastically(x, 0, bfloat16, [=] { return double(draw >> 11) * 0x1p-53; }));
    }
}
TEST(RandomRounding, ANumberOfTheFormatStaysAndDrawsNothing) {
    RandomRounding const rule{5, 4, Surplus::half};
    auto const no_draw = []() -> std::uint64_t { throw std::logic_error("a draw"); };
    for (double const x :
         {0.0, -0.0, 1.0, -1.9375, 0x1.fp1000, 0x1p-1000, rounding::infinity, -rounding::infinity, rounding::nan})
        EXPECT_TRUE(rounding::same(round_at_random(x, 0, rule, no_draw), x)) << x;
    // A tail towards zero: just below 1, of which the fraction is nearly one.
    EXPECT_EQ(round_at_random(1, -0x1p-60, {5, 4, Surplus::truncate}, [] { return std::uint64_t{15} << 60; }),
              1 - 0x1p-5);
    EXPECT_EQ(round_at_random(1, -0x1p-60, {5, 4, Surplus::truncate}, [] { return std::uint64_t{14} << 60; }), 1);
    EXPECT_EQ(round_at_random(1, -0x1p-60, rule, [] { return ~std::uint64_t{0}; }), 1);
}
TEST(RandomRounding, RulesOutOfRangeAreRefused) {
    for (RandomRounding const& rule :
         {RandomRounding{1, 4}, RandomRounding{54, 0}, RandomRounding{8, 46}, RandomRounding{8, -1}})
        EXPECT_THROW(RandomRoundingScope const scope(rule), std::invalid_argument);
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

// The words of the claims about hazards: on made-up losses each holds, fails and is undecided where it should.

/// The verdict of the claim that begins so.
Verdict verdict(std::string const& begins, Table const& t) {
    for (Claim const& claim : stochastic_definiteness.claims)
        if (claim.text.starts_with(begins)) return claim.judge(t).verdict;
    ADD_FAILURE() << "no claim begins with " << begins;
    return Verdict::fails;
}
Table empty() {
    std::vector<std::string> columns;
    for (Factor const& factor : stochastic_definiteness.factors(Budget::quick)) columns.push_back(factor.name);
    columns.insert(columns.end(), stochastic_definiteness.measures.begin(), stochastic_definiteness.measures.end());
    return Table(columns);
}
/// Twenty runs of `steps` steps with `lost` losses each, one more in every other run, where the law expects `predicted`
/// a step.
void add_runs(Table& t, std::string const& variant, std::string const& rounding, double digits, double lost,
              double predicted, double steps = 1000) {
    for (double n = 1; n <= 20; ++n) {
        double const own = lost + (lost > 0 && std::fmod(n, 2) == 0);
        t.add({variant, 0.9, 0.97, digits, rounding, n, steps, own, 0.0, own / steps, predicted, 1.0});
    }
}
Table symmetric(std::string const& rounding, double lost, double predicted, double steps = 1000) {
    Table t = empty();
    add_runs(t, "symmetric", rounding, 7, lost, predicted, steps);
    return t;
}

TEST(HazardClaims, TheLawHoldsFailsOrIsUndecided) {
    EXPECT_EQ(verdict("S4: to nearest", symmetric("nearest", 20, 0.02)), Verdict::holds);
    EXPECT_EQ(verdict("S4: to nearest", symmetric("nearest", 20, 0.002)), Verdict::fails) << "ten times the law";
    EXPECT_EQ(verdict("S4: to nearest", symmetric("nearest", 20, 0.2)), Verdict::fails) << "a tenth of it";
    EXPECT_EQ(verdict("S4: to nearest", symmetric("nearest", 1, 0.0007)), Verdict::undecided)
        << "thirty losses at 2.1 times the law";
    EXPECT_EQ(verdict("S4: to nearest", symmetric("nearest", 0, 0.0001)), Verdict::fails)
        << "two expected: nothing was measured";
    EXPECT_EQ(verdict("S4: stochastic", symmetric("stochastic", 20, 0.02)), Verdict::holds);
    EXPECT_EQ(verdict("S4: stochastic", symmetric("nearest", 20, 0.02)), Verdict::fails) << "no stochastic runs";
}
TEST(HazardClaims, LossesInBurstsCountLess) {
    Table t = empty();  // as many losses, all of them in two of the runs
    for (double n = 1; n <= 20; ++n) {
        double const own = n <= 2 ? 200 : 0;
        t.add({std::string("symmetric"), 0.9, 0.97, 7.0, std::string("nearest"), n, 1000.0, own, 0.0, own / 1000, 0.02,
               1.0});
    }
    EXPECT_EQ(verdict("S4: to nearest", t), Verdict::undecided);
}
TEST(HazardClaims, HalfABit) {
    auto const with = [](double stochastic) {
        Table t = empty();
        add_runs(t, "symmetric", "nearest", 6, 100, 0.1);
        add_runs(t, "symmetric", "nearest", 7, 25, 0.02);
        add_runs(t, "symmetric", "stochastic", 7, stochastic, 0.04);
        return t;
    };
    EXPECT_EQ(verdict("S5", with(50)), Verdict::holds);
    EXPECT_EQ(verdict("S5", with(400)), Verdict::fails) << "costs two bits";
    EXPECT_EQ(verdict("S5", with(100)), Verdict::fails) << "costs a bit";
    EXPECT_EQ(verdict("S5", with(25)), Verdict::fails) << "costs nothing";
    EXPECT_EQ(verdict("S5", with(10)), Verdict::fails) << "costs less than none";
    EXPECT_EQ(verdict("S5", with(70)), Verdict::undecided) << "three quarters";
}
TEST(HazardClaims, OneLossOfAFactorFormIsSeen) {
    Table t = empty();
    for (char const* variant : {"ud", "carlson", "inverse_qr", "qr"}) add_runs(t, variant, "stochastic", 6, 0, 0.1);
    EXPECT_EQ(verdict("S6", t), Verdict::holds);
    t.add({std::string("ud"), 0.9, 0.97, 6.0, std::string("stochastic"), 21.0, 1000.0, 1.0, 0.0, 0.001, 0.1, 1.0});
    EXPECT_EQ(verdict("S6", t), Verdict::fails);
}
TEST(HazardClaims, FewBitsAreComparedWithAll) {
    auto const with = [](double few) {
        Table t = empty();
        add_runs(t, "symmetric", "stochastic", 8, 50, 0.05);
        add_runs(t, "symmetric", "4 bits", 8, few, 0.05);
        add_runs(t, "symmetric", "4 bits and half", 8, 50, 0.05);
        return t;
    };
    EXPECT_EQ(verdict("4 random bits", with(50)), Verdict::holds);
    EXPECT_EQ(verdict("4 random bits", with(150)), Verdict::fails);
    EXPECT_EQ(verdict("4 random bits", with(72)), Verdict::undecided);
}

}  // namespace
}  // namespace rlslab
