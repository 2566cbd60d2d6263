// Where stochastic rounding's draws come from: replay, streams that nest and do not interact; and the bits of the short
// arithmetics, the same in every build.
#include <rlslab/arithmetic/chopped.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

namespace rlslab {
namespace {

/// A long run of mixed operations, hashed; NaNs count as one, whatever their bits.
template <class C>
std::uint64_t long_run(Seed data, int steps) {
    std::uint64_t hash = 0;
    C x[8];
    for (C& each : x) each = C(data.bell());
    for (int k = 0; k < steps; ++k) {
        std::uint64_t const pick = data.next();
        C &a = x[pick % 8], b = x[pick / 8 % 8];
        switch (pick / 64 % 8) {
            case 0: a += b; break;
            case 1: a -= b; break;
            case 2: a *= b; break;
            case 3: a /= b; break;
            case 4: a = sqrt(abs(a)); break;
            case 5: a = C(data.bell()) * b; break;
            default: a = C(data.bell()); break;
        }
        double const value = double(a);
        hash = Seed{hash ^ (std::isnan(value) ? 1 : std::bit_cast<std::uint64_t>(value))}.next();
    }
    return hash;
}
template <class C>
std::uint64_t seeded_run(Seed seed, int steps = 4000) {
    StochasticStream const stream(seed);
    return long_run<C>(Seed{1}, steps);
}

TEST(Stochastic, IsReplayedBySeedAndThreadsDoNotInteract) {
    std::uint64_t const alone = seeded_run<BFloat16Stochastic>(Seed{5}),
                        other = seeded_run<BFloat16Stochastic>(Seed{6});
    EXPECT_EQ(alone, seeded_run<BFloat16Stochastic>(Seed{5}));
    EXPECT_NE(alone, other);
    std::uint64_t there = 0;
    std::thread thread([&] { there = seeded_run<BFloat16Stochastic>(Seed{6}); });
    std::uint64_t const here = seeded_run<BFloat16Stochastic>(Seed{5});
    thread.join();
    EXPECT_EQ(here, alone);
    EXPECT_EQ(there, other);
}
TEST(Stochastic, StreamsNestAndTheOwnersSeedAdvances) {
    BFloat16Stochastic const one(1), divisor(0.328125);
    Seed outer{1}, inner{2}, drawn_from_1{1}, drawn_from_2{2};
    {
        StochasticStream const stream(outer);
        try {
            StochasticStream const nested(inner);
            EXPECT_NE(double(one / divisor), 0);
            throw 0;
        } catch (int) {}
        EXPECT_EQ(outer, Seed{1});
        EXPECT_NE(double(one / divisor), 0);
    }
    drawn_from_1.next();
    drawn_from_2.next();
    EXPECT_EQ(outer, drawn_from_1);
    EXPECT_EQ(inner, drawn_from_2);
}
TEST(Stochastic, WithoutAStreamOnlyExactResultsAreComputed) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    BFloat16Stochastic const one(1), zero(0), endless(infinity);
    EXPECT_THROW(one / BFloat16Stochastic(3), std::logic_error);
    EXPECT_THROW(one - BFloat16Stochastic(0x1p-100), std::logic_error);
    EXPECT_THROW(sqrt(BFloat16Stochastic(2)), std::logic_error);
    EXPECT_THROW(BFloat16Stochastic(0.1), std::logic_error);
    EXPECT_NO_THROW(one + one * BFloat16Stochastic(0.5) - endless);
    EXPECT_NO_THROW(sqrt(BFloat16Stochastic(2.25)) / BFloat16Stochastic(1.5));
    EXPECT_NO_THROW(one / endless + zero / one + one / zero + zero / zero + sqrt(zero) + sqrt(-one) + sqrt(endless));
}

/// Recorded from g++ 12 at -O2; -O0, -O3 and -march=native with FMA instructions must give the same.
TEST(Chopped, SameBitsInEveryBuild) {
    constexpr int steps = 200000;
    EXPECT_EQ(seeded_run<Half>(Seed{1}, steps), 8626577044937698187u);
    EXPECT_EQ(seeded_run<HalfZero>(Seed{1}, steps), 4214837405022159798u);
    EXPECT_EQ(seeded_run<HalfStochastic>(Seed{1}, steps), 16145621835945972688u);
    EXPECT_EQ(seeded_run<BFloat16Zero>(Seed{1}, steps), 897796715624102084u);
    EXPECT_EQ(seeded_run<Tf32Stochastic>(Seed{1}, steps), 10578779623462078578u);
    EXPECT_EQ((seeded_run<Chopped<Format{25, -400, 400}, Rounding::stochastic>>(Seed{1}, steps)), 3738872335928380218u);
}

TEST(Seed, IsSplitMix64AndItsBellIsNormalised) {
    Seed seed{1234567};  // the published sequence
    for (auto expected : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u, 4593380528125082431u})
        EXPECT_EQ(seed.next(), expected);
    constexpr int n = 100000;
    double sum = 0, squares = 0;
    for (int k = 0; k < n; ++k) {
        double const x = seed.bell();
        sum += x;
        squares += x * x;
        ASSERT_TRUE(-6 <= x && x < 6);
    }
    // Var x = 1 and var x^2 = 1.9, so that false alarms have probability 1e-10 over seeds.
    EXPECT_LT(std::abs(sum), 6.5 * std::sqrt(n));
    EXPECT_LT(std::abs(squares - n), 6.5 * std::sqrt(1.9 * n));
}

}  // namespace
}  // namespace rlslab
