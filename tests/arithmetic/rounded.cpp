// The three roundings, and every operation of numbers that round: against all numbers of a format and exact rationals.
// Then the draws of stochastic rounding, and the bits of the short arithmetics, the same in every build.
//
// Every check is a predicate over the thing checked, so that a saboteur shows that it can fail.
#include "tests/common/rounding.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <thread>
#include <vector>

namespace rlslab {
namespace {

using namespace rounding;

constexpr Format small{4, -3, 4}, smallest{2, -1, 1}, widest{25, -400, 400};
constexpr Format formats[] = {binary16, bfloat16, tf32, small, smallest, widest};
constexpr Rounding roundings[] = {Rounding::nearest, Rounding::toward_zero, Rounding::stochastic};

/// The three roundings of head + tail behind one signature; u is the stochastic one's draw.
using Rounder = std::function<double(double head, double tail, double u)>;
Rounder rounder(Format f, Rounding rounding) {
    if (rounding == Rounding::nearest) return [f](double x, double, double) { return round_to_nearest(x, f); };
    if (rounding == Rounding::toward_zero)
        return [f](double x, double t, double) { return round_toward_zero(x, t, f); };
    return [f](double x, double t, double u) { return round_stochastically(x, t, f, [u] { return u; }); };
}

/// Every number, midpoint and neighbour of them, with tails far below the last bit of a draw that tip the balance (to
/// nearest there are none), and draws on both sides of the fraction.
bool rounds_everything(Rounder const& round, Format f, Rounding rounding) {
    constexpr double draw = 0x1p-53, last_draw = 1 - draw;
    auto const right = [&](Place i, double head, double tail, double u) {
        double const expected = rounded(
            f, rounding, i,
            [=](double g, double more) {
                double const d = head - g - more;  // of the right sign: only the last difference may be rounded
                return d != 0 ? (d > 0) - (d < 0) : (tail > 0) - (tail < 0);
            },
            u);
        return same(round(head, tail, u), expected) && same(round(-head, -tail, u), -expected);
    };
    auto const at = [&](Place i, double head, double tail, double fraction = 0) {
        if (rounding != Rounding::stochastic) return right(i, head, tail, 0);
        double const highest_up = draw * (std::ceil(fraction / draw) - 1);
        bool good = right(i, head, tail, 0) && right(i, head, tail, last_draw);
        for (double const u : {highest_up, highest_up + draw, highest_up + 2 * draw})
            good = good && (u < 0 || u > last_draw || right(i, head, tail, u));
        return good;
    };
    Place const last = last_place(f);
    bool good = same(round(infinity, 0, 0), infinity) && same(round(-infinity, 0, 0), -infinity) &&
                std::isnan(round(nan, 0, 0)) && at(0, 1e-300, 0) && at(last, 1e300, 0) && at(last, number(f, last), 0);
    for (Place i = 0; i < last && good; ++i) {
        double const here = number(f, i), next = number(f, i + 1), gap = next - here, middle = here + gap / 2;
        for (double const x : {here, here == 0 ? gap * 0x1p-200 : std::nextafter(here, infinity), here + gap / 4,
                               std::nextafter(middle, 0), middle, std::nextafter(middle, infinity), middle + gap / 8,
                               std::nextafter(next, 0)}) {
            double const fraction = (x - here) / gap, tiny = std::min(x, gap) * 0x1p-80;
            good = good && at(i, x, 0, fraction);
            if (rounding != Rounding::nearest && x != 0 && std::fmod(fraction, draw) == 0)
                good = good && at(i, x, tiny, fraction) && (x == here || at(i, x, -tiny, fraction));
        }
        if (rounding != Rounding::nearest) good = good && at(i, next, -gap * 0x1p-80, 1);
    }
    return good;
}

TEST(Format, BoundsAreThoseOfDouble) {
    for (Format const f : formats) EXPECT_TRUE(fits_in_double(f));
    for (Format const f : {Format{26, -100, 100}, {1, -100, 100}, {11, -14, 511}, {11, -502, 15}, {25, -460, 460}})
        EXPECT_FALSE(fits_in_double(f));
}
TEST(Format, RoundsEveryNumberMidpointAndNeighbour) {
    EXPECT_EQ(last_place(binary16), 31744u);  // 0x7c00
    for (Format const f : {binary16, bfloat16, tf32, small, smallest}) {
        EXPECT_TRUE(largest(f) == number(f, last_place(f) - 1) && smallest_subnormal(f) == number(f, 1));
        for (Rounding const r : roundings) EXPECT_TRUE(rounds_everything(rounder(f, r), f, r)) << f.digits << int(r);
    }
}
TEST(Format, ExactNumbersDrawNothing) {
    auto const refuse = []() -> double { throw std::logic_error("drawn"); };
    for (Place i = 0; i < last_place(binary16); ++i)
        EXPECT_NO_THROW(round_stochastically(-number(binary16, i), 0, binary16, refuse));
    EXPECT_THROW(round_stochastically(1, 0x1p-90, binary16, refuse), std::logic_error);
}
TEST(Format, ChecksOfRoundingCanFail) {
    Rounder const nearest = rounder(binary16, Rounding::nearest), cut = rounder(binary16, Rounding::toward_zero),
                  toss = rounder(binary16, Rounding::stochastic);
    using D = double;
    std::pair<Rounding, Rounder> const saboteurs[] = {
        {Rounding::nearest, [&](D x, D, D) { return nearest(x, 0, 0) + 0.0; }},  // drops -0
        {Rounding::nearest, [&](D x, D, D) { return std::abs(x) < 0x1p-14 ? 0 * x : nearest(x, 0, 0); }},
        {Rounding::nearest, cut},
        {Rounding::nearest, [&](D x, D, D) { return nearest(x * (1 + 0x1p-52), 0, 0); }},
        {Rounding::nearest, [&](D x, D, D) { return std::clamp(nearest(x, 0, 0), -65504., 65504.); }},
        {Rounding::toward_zero, nearest},
        {Rounding::toward_zero, [&](D x, D, D) { return cut(x, 0, 0); }},  // rounds twice
        {Rounding::stochastic, [&](D x, D, D u) { return toss(x, 0, u); }},
        {Rounding::stochastic, [&](D x, D t, D u) { return toss(x, t, u - 0x1p-53); }}};  // <= for <
    for (auto const& [rounding, saboteur] : saboteurs)
        EXPECT_FALSE(rounds_everything(saboteur, binary16, rounding)) << int(rounding);
}

/// A seed whose next draw is k 2^-53: SplitMix64 backwards.
Seed seed_drawing(std::uint64_t k) {
    std::uint64_t z = k << 11;
    z = (z ^ (z >> 31) ^ (z >> 62)) * 0x319642b2d24d8ec3;
    z = (z ^ (z >> 27) ^ (z >> 54)) * 0x96de1b173f119089;
    return Seed{(z ^ (z >> 30) ^ (z >> 60)) - 0x9e3779b97f4a7c15};
}
/// Up at the last draw below the exact fraction, down at the next: it takes the right tail to the last bit of a draw.
bool turns_at_the_fraction(Operation const& f, Format format, char op, double a, double b) {
    auto const expected = [&](std::uint64_t k) {
        return oracle(format, Rounding::stochastic, op, a, b, double(k) * 0x1p-53);
    };
    std::uint64_t up = 0, down = std::uint64_t{1} << 53;
    double const highest = expected(up);
    if (same(highest, expected(down))) return true;  // exact
    while (down - up > 1) {
        std::uint64_t const k = (up + down) / 2;
        (same(expected(k), highest) ? up : down) = k;
    }
    return rounds_once(f, format, Rounding::stochastic, op, a, b, seed_drawing(up)) &&
           (down >> 53 || rounds_once(f, format, Rounding::stochastic, op, a, b, seed_drawing(down)));
}
bool random_turns(Operation const& f, Format format, int count) {
    return random_pairs(format, count,
                        [&](char op, double a, double b, Seed) { return turns_at_the_fraction(f, format, op, a, b); });
}
bool random_roundings(Operation const& f, Format format, Rounding r, int count) {
    return random_pairs(format, count,
                        [&](char op, double a, double b, Seed s) { return rounds_once(f, format, r, op, a, b, s); });
}
/// Pairs of infinities, NaN and the numbers in these places, of both signs.
bool all_pairs(Operation const& f, Format format, Rounding r, std::vector<Place> const& places) {
    std::vector<double> some{infinity, -infinity, nan};
    for (Place const i : places) some.insert(some.end(), {number(format, i), -number(format, i)});
    Seed seed{2};
    for (double const a : some)
        for (double const b : some)
            for (char const op : operations)
                if (!rounds_once(f, format, r, op, a, op == 'r' ? 0 : b, Seed{seed.next()})) return false;
    return true;
}
/// All of a short format; of others the ends, and what lies about 1.
std::vector<Place> places_of(Format f) {
    Place const all = last_place(f), normal = binade(f), one = normal * Place(1 - f.min_exp);
    if (all > 100)
        return {0,   1,       normal - 1,       normal,       normal + 1,           one / 2, one - 1,
                one, one + 1, one + normal / 2, one + normal, one + 3 * normal / 2, all - 2, all - 1};
    std::vector<Place> out(all);
    for (Place i = 0; i < all; ++i) out[i] = i;
    return out;
}

/// A format and rounding, as it is compiled in and as the thread sets it.
struct Row {
    Format format;
    Rounding rounding;
    Operation ways[2];
};
template <Format... F>
std::vector<Row> table() {
    std::vector<Row> out;
    auto const add = [&]<Format f, Rounding r>() {
        out.push_back({f, r, {&operate<Chopped<f, r>>, [](char op, double a, double b) {
                                  PrecisionScope const precision(RunTimeFormat{f, r});
                                  return operate<VariablePrecision>(op, a, b);
                              }}});
    };
    (..., (add.template operator()<F, Rounding::nearest>(), add.template operator()<F, Rounding::toward_zero>(),
           add.template operator()<F, Rounding::stochastic>()));
    return out;
}
std::vector<Row> const rows = table<binary16, bfloat16, tf32, small, smallest, widest>();

TEST(Rounded, EveryOperationIsTheExactResultRoundedOnce) {
    for (auto const& [format, rounding, ways] : rows)
        for (Operation const& way : ways) {
            EXPECT_TRUE(all_pairs(way, format, rounding, places_of(format))) << format.digits << ' ' << int(rounding);
            EXPECT_TRUE(random_roundings(way, format, rounding, 2500)) << format.digits << ' ' << int(rounding);
        }
}
TEST(Rounded, WithoutARangeEveryLengthRoundsOnce) {
    for (int p = 2; p <= 53; ++p) {
        PrecisionScope const precision(p);
        EXPECT_TRUE(random_pairs({p, -60, 60}, 1000, [&](char op, double a, double b, Seed seed) {
            return rounds_once(&operate<VariablePrecision>, {p, -900, 900}, Rounding::nearest, op, a, b, seed);
        })) << p;
    }
}
TEST(Rounded, StochasticRoundingTurnsAtTheFraction) {
    EXPECT_EQ(seed_drawing(12345).uniform(), 12345 * 0x1p-53);
    for (auto const& [format, rounding, ways] : rows)
        if (rounding == Rounding::stochastic) {
            for (Operation const& way : ways) EXPECT_TRUE(random_turns(way, format, 100)) << format.digits;
        }
}
TEST(Rounded, RootsOfEveryHalf) {
    for (auto const& [format, rounding, ways] : rows)
        for (Place i = 0; format == binary16 && i < last_place(binary16); ++i)
            ASSERT_TRUE(rounds_once(ways[0], format, rounding, 'r', number(format, i), 0, Seed{i})) << i;
}
TEST(Rounded, TwentyFourBitsAreFloat) {
    using Float = Chopped<Format{24, -126, 127}>;
    Seed seed{3};
    for (int k = 0; k < 100000; ++k) {
        float const a = std::bit_cast<float>(std::uint32_t(seed.next() >> 32)), near = a * float(seed.bell());
        float const b = k % 2 ? std::bit_cast<float>(std::uint32_t(seed.next() >> 32)) : near;
        for (char const op : operations) ASSERT_TRUE(same(operate<Float>(op, a, b), operate<float>(op, a, b)));
        ASSERT_EQ(Float(a) < Float(b), a < b);
    }
}

/// Double rounding: the operation in double, rounded as C rounds. Innocuous to nearest, not otherwise.
template <class C>
double twice(char op, double a, double b) {
    return double(C(operate<double>(op, a, b)));
}
/// Up for half as many draws as is due.
double biased(char op, double a, double b) {
    auto const draw = [] { return std::min(2 * StochasticStream::uniform(), 1 - 0x1p-53); };
    return round_stochastically(operate<double>(op, a, b), 0, small, draw);
}
double drawing_twice(char op, double a, double b) {
    operate<Chopped<small, Rounding::stochastic>>(op, a, b);
    return operate<Chopped<small, Rounding::stochastic>>(op, a, b);
}
TEST(Rounded, ChecksOfOperationsCanFail) {
    auto const passes = [](Operation const& f, Rounding r) { return all_pairs(f, small, r, places_of(small)); };
    using Nearest = Chopped<small>;
    using Zero = Chopped<small, Rounding::toward_zero>;
    EXPECT_TRUE(passes(&twice<Nearest>, Rounding::nearest));
    EXPECT_FALSE(passes(&operate<Zero>, Rounding::nearest));
    EXPECT_FALSE(passes(&operate<Nearest>, Rounding::toward_zero));
    EXPECT_FALSE(passes(&operate<Nearest>, Rounding::stochastic));
    EXPECT_FALSE(passes(&biased, Rounding::stochastic));
    EXPECT_FALSE(passes(&drawing_twice, Rounding::stochastic));
    // Without the tail.
    EXPECT_FALSE(random_roundings(&twice<BFloat16Zero>, bfloat16, Rounding::toward_zero, 4000));
    EXPECT_FALSE(random_roundings(&twice<BFloat16Stochastic>, bfloat16, Rounding::stochastic, 4000));
    EXPECT_FALSE(random_turns(&twice<BFloat16Stochastic>, bfloat16, 1000));
    PrecisionScope const precision(50);
    EXPECT_FALSE(random_pairs({50, -60, 60}, 1000, [](char op, double a, double b, Seed) {
        return same(twice<VariablePrecision>(op, a, b), oracle({50, -900, 900}, Rounding::nearest, op, a, b));
    }));
}

// --- where draws come from: replay, streams that nest and do not interact; and the bits ------------------------------

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

TEST(Seed, IsSplitMix64) {
    Seed seed{1234567};  // the published sequence
    for (auto expected : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u, 4593380528125082431u})
        EXPECT_EQ(seed.next(), expected);
}

}  // namespace
}  // namespace rlslab
