// The short formats and their roundings against tables of all their numbers and exact rational arithmetic.
//
// Every check is a predicate over the thing checked, so that a saboteur shows that it can fail.
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/problem.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <thread>
#include <vector>

namespace rlslab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// All numbers >= 0 of a format in order, then the first power of two that it lacks. Made without asking format.hpp, so
/// that a neighbour search in it is an independent rounding. Odd places hold odd significands.
std::vector<double> numbers(Format f) {
    std::vector<double> out;
    int const half = 1 << (f.digits - 1);
    for (int m = 0; m < half; ++m) out.push_back(std::ldexp(m, f.min_exp - f.digits + 1));
    for (int e = f.min_exp; e <= f.max_exp; ++e)
        for (int m = half; m < 2 * half; ++m) out.push_back(std::ldexp(m, e - f.digits + 1));
    out.push_back(std::ldexp(1, f.max_exp + 1));
    return out;
}

/// The same number, with the same sign of zero; NaN is NaN.
bool same(double a, double b) { return (a == b && std::signbit(a) == std::signbit(b)) || (std::isnan(a) && std::isnan(b)); }

/// The three roundings of head + tail behind one signature; u is the stochastic one's draw.
using Rounder = std::function<double(double head, double tail, double u)>;
template <Format F>
Rounder rounder(Rounding rounding) {
    if (rounding == Rounding::nearest) return [](double x, double, double) { return round_to_nearest<F>(x); };
    if (rounding == Rounding::toward_zero) return [](double x, double t, double) { return round_toward_zero<F>(x, t); };
    return [](double x, double t, double u) { return round_stochastically<F>(x, t, [u] { return u; }); };
}
bool odd(Rounder const& round, double head, double tail, double u, double expected) {    // both signs
    return same(round(head, tail, u), expected) && same(round(-head, -tail, u), -expected);
}

bool keeps_every_number(Rounder const& round, std::vector<double> const& all) {
    bool good = odd(round, infinity, 0, 0, infinity) && std::isnan(round(nan, 0, 0));
    for (std::size_t i = 0; i + 1 < all.size(); ++i) good = good && odd(round, all[i], 0, 0, all[i]);
    return good;
}

bool rounds_to_nearest_even(Rounder const& round, std::vector<double> const& all) {
    bool good = odd(round, 1e300, 0, 0, infinity) && odd(round, 1e-300, 0, 0, 0);
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        bool const last = i + 2 == all.size();
        double const here = all[i], next = last ? infinity : all[i + 1], middle = (here + all[i + 1]) / 2;
        good = good && odd(round, std::nextafter(here, infinity), 0, 0, here) &&
               odd(round, std::nextafter(middle, 0), 0, 0, here) && odd(round, middle, 0, 0, i % 2 ? next : here) &&
               odd(round, std::nextafter(middle, infinity), 0, 0, next) &&
               odd(round, std::nextafter(all[i + 1], 0), 0, 0, next);
    }
    return good;
}

bool rounds_toward_zero(Rounder const& round, std::vector<double> const& all) {
    double const top = all[all.size() - 2];
    bool good = odd(round, 1e300, 0, 0, top) && odd(round, 1e-300, 0, 0, 0) && odd(round, all.back(), 0, 0, top);
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        double const here = all[i], next = all[i + 1], tiny = next * 0x1p-100;
        for (double const x : {std::nextafter(here, infinity), (here + next) / 2, std::nextafter(next, 0)})
            good = good && odd(round, x, 0, 0, here);
        good = good && odd(round, next, -tiny, 0, here) && (here == 0 || odd(round, here, tiny, 0, here));
    }
    return good;
}

/// Away from zero iff the draw is below the fraction; tails far below the draw's last bit still tip the balance.
bool rounds_up_iff_the_draw_is_below_the_fraction(Rounder const& round, std::vector<double> const& all) {
    constexpr double draw = 0x1p-53, last_draw = 1 - draw;
    bool good = odd(round, 1e300, 0, 0, infinity) && odd(round, all.back(), 0, 0, infinity);
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        double const here = all[i], gap = all[i + 1] - here, next = i + 2 == all.size() ? infinity : all[i + 1];
        for (double const x : {here == 0 ? gap * 0x1p-200 : std::nextafter(here, infinity), here + gap / 4, here + gap / 2,
                               here + gap / 2 + gap / 8, std::nextafter(all[i + 1], 0)}) {
            double const fraction = (x - here) / gap, tiny = std::min(x, gap) * 0x1p-80;
            double const highest_up = draw * (std::ceil(fraction / draw) - 1);
            good = good && odd(round, x, 0, 0, next) && odd(round, x, 0, highest_up, next) &&
                   odd(round, x, 0, highest_up + draw, here) && odd(round, x, 0, last_draw, here);
            if (fraction >= draw)    // a multiple of the draw: the tail decides
                good = good && odd(round, x, tiny, fraction, next) && odd(round, x, tiny, fraction + draw, here) &&
                       odd(round, x, -tiny, fraction, here) && odd(round, x, -tiny, highest_up, next);
        }
        double const tiny = gap * 0x1p-80;
        good = good && odd(round, all[i + 1], -tiny, last_draw, next) &&
               (here == 0 || (odd(round, here, tiny, 0, next) && odd(round, here, tiny, draw, here)));
    }
    return good;
}

template <Format F>
void round_everything() {
    auto const all = numbers(F);
    EXPECT_EQ(largest(F), all[all.size() - 2]);
    EXPECT_EQ(smallest_subnormal(F), all[1]);
    for (Rounding r : {Rounding::nearest, Rounding::toward_zero, Rounding::stochastic})
        EXPECT_TRUE(keeps_every_number(rounder<F>(r), all));
    EXPECT_TRUE(rounds_to_nearest_even(rounder<F>(Rounding::nearest), all));
    EXPECT_TRUE(rounds_toward_zero(rounder<F>(Rounding::toward_zero), all));
    EXPECT_TRUE(rounds_up_iff_the_draw_is_below_the_fraction(rounder<F>(Rounding::stochastic), all));
}
constexpr Format small{4, -3, 4}, smallest{2, -1, 1}, widest{25, -400, 400};

TEST(Format, BoundsAreThoseOfDouble) {
    EXPECT_TRUE(fits_in_double(binary16) && fits_in_double(bfloat16) && fits_in_double(tf32) && fits_in_double(widest));
    EXPECT_FALSE(fits_in_double({26, -100, 100}));
    EXPECT_FALSE(fits_in_double({1, -100, 100}));
    EXPECT_FALSE(fits_in_double({11, -14, 511}));
    EXPECT_FALSE(fits_in_double({11, -502, 15}));
    EXPECT_FALSE(fits_in_double({25, -460, 460}));
}
TEST(Format, RoundsEveryNumberMidpointAndNeighbour) {
    EXPECT_EQ(numbers(binary16).size(), 31745u);    // 0x7c00 and the power of two after them
    round_everything<binary16>();
    round_everything<bfloat16>();
    round_everything<tf32>();
    round_everything<small>();
    round_everything<smallest>();
}
TEST(Format, ExactNumbersDrawNothing) {
    auto const refuse = []() -> double { throw std::logic_error("drawn"); };
    for (double const x : numbers(binary16)) EXPECT_NO_THROW(round_stochastically<binary16>(-x, 0, refuse));
    EXPECT_THROW(round_stochastically<binary16>(1, 0x1p-90, refuse), std::logic_error);
}
TEST(Format, ChecksOfRoundingCanFail) {
    auto const all = numbers(binary16);
    Rounder const nearest = rounder<binary16>(Rounding::nearest), cut = rounder<binary16>(Rounding::toward_zero),
                  toss = rounder<binary16>(Rounding::stochastic);
    EXPECT_FALSE(keeps_every_number([&](double x, double, double) { return nearest(x, 0, 0) + 0.0; }, all));    // drops -0
    EXPECT_FALSE(keeps_every_number([&](double x, double, double) { return std::abs(x) < 0x1p-14 ? 0 * x : x; }, all));
    EXPECT_FALSE(rounds_to_nearest_even(cut, all));
    EXPECT_FALSE(rounds_to_nearest_even(    // ties away from zero
        [&](double x, double, double) { return nearest(x * (1 + 0x1p-52), 0, 0); }, all));
    EXPECT_FALSE(rounds_to_nearest_even(    // saturates
        [&](double x, double, double) { return std::clamp(nearest(x, 0, 0), -65504.0, 65504.0); }, all));
    EXPECT_FALSE(rounds_toward_zero(nearest, all));
    EXPECT_FALSE(rounds_toward_zero([&](double x, double, double) { return cut(x, 0, 0); }, all));    // rounds twice
    EXPECT_FALSE(rounds_up_iff_the_draw_is_below_the_fraction([&](double x, double, double u) { return toss(x, 0, u); }, all));
    EXPECT_FALSE(rounds_up_iff_the_draw_is_below_the_fraction(    // <= for <
        [&](double x, double t, double u) { return toss(x, t, u - 0x1p-53); }, all));
}

/// Where |exact| lies among the numbers: against(g) is the sign of |exact| - g.
using Against = std::function<int(Rational const&)>;
double search(std::vector<double> const& all, Against const& against, Rounding rounding, double u) {
    auto const after = std::partition_point(all.begin(), all.end(), [&](double g) { return against(Rational(g)) >= 0; });
    std::size_t const last = all.size() - 1, i = std::size_t(after - all.begin()) - 1;
    auto const number = [&](std::size_t k) { return k == last ? infinity : all[k]; };
    if (rounding == Rounding::toward_zero) return all[std::min(i, last - 1)];
    if (i == last || against(Rational(all[i])) == 0) return number(i);
    Rational const gap = Rational(all[i + 1]) - Rational(all[i]);
    if (rounding == Rounding::stochastic) return number(i + (against(Rational(all[i]) + Rational(u) * gap) > 0));
    int const side = against(Rational(all[i]) + gap / 2);
    return number(i + (side > 0 || (side == 0 && i % 2 == 1)));
}
int sign(Rational const& x) { return x.sign(); }

/// a op b rounded once, independently; u is the draw. Specials, and signs of exact zeros, are double's.
double oracle(std::vector<double> const& all, Rounding rounding, char op, double a, double b, double u) {
    double const head = op == '+' ? a + b : op == '-' ? a - b : op == '*' ? a * b : op == '/' ? a / b : std::sqrt(a);
    if (!std::isfinite(head) || head == 0) return head;
    Rational const x(std::abs(a)), y(std::isfinite(b) ? std::abs(b) : 0);
    if (!std::isfinite(b)) return head;
    Against against;
    if (op == 'r') {
        against = [&](Rational const& g) { return sign(x - g * g); };
    } else if (op == '/') {
        against = [&](Rational const& g) { return sign(x - g * y); };
    } else {
        Rational const s = op == '*' ? Rational(x * y) : abs(op == '+' ? Rational(a) + Rational(b) : Rational(a) - Rational(b));
        against = [s](Rational const& g) { return sign(s - g); };
    }
    return std::copysign(search(all, against, rounding, u), head);
}

using Operation = std::function<double(char op, double a, double b)>;
template <class C>
double operate(char op, double x, double y) {
    C a(x);
    C const b(y);
    switch (op) {
        case '+': return double(a += b);
        case '-': return double(a -= b);
        case '*': return double(a *= b);
        case '/': return double(a /= b);
        default: return double(sqrt(a));
    }
}

/// One operation under a stream of its own: the value, and that one draw is taken at most.
bool rounds_once(Operation const& f, std::vector<double> const& all, Rounding rounding, char op, double a, double b, Seed seed) {
    Seed copy = seed, used = seed;
    double const u = copy.uniform();
    StochasticStream const stream(used);
    double const result = f(op, a, b);
    return same(result, oracle(all, rounding, op, a, b, u)) && (used == seed || used == copy);
}

/// Every number and both signs, infinities and NaN.
std::vector<double> with_signs_and_specials(std::vector<double> numbers_alone) {
    std::vector<double> out{infinity, -infinity, nan};
    for (double x : numbers_alone) out.insert(out.end(), {x, -x});
    return out;
}
bool all_pairs(Operation const& f, std::vector<double> const& all, Rounding r, std::vector<double> const& some) {
    Seed seed{2};
    bool good = true;
    for (double const a : some) {
        for (double const b : some)
            for (char const op : {'+', '-', '*', '/'}) good = good && rounds_once(f, all, r, op, a, b, Seed{seed.next()});
        good = good && rounds_once(f, all, r, 'r', a, 0, Seed{seed.next()});
    }
    return good;
}
/// Pairs drawn from all numbers, every second one of neighbouring places: cancellation, quotients close to 1.
bool random_pairs(Operation const& f, std::vector<double> const& all, Rounding r, int count, Seed seed) {
    bool good = true;
    std::size_t const n = all.size() - 1;
    for (int k = 0; k < count && good; ++k) {
        std::size_t const i = seed.next() % n, j = k % 2 ? seed.next() % n : std::min(n - 1, i + seed.next() % 4096);
        double const a = seed.next() % 2 ? all[i] : -all[i], b = seed.next() % 2 ? all[j] : -all[j];
        for (char const op : {'+', '-', '*', '/'}) good = good && rounds_once(f, all, r, op, a, b, Seed{seed.next()});
    }
    return good;
}

template <Format F, Rounding R>
void operate_on_specials_and_samples() {
    auto const all = numbers(F);
    std::size_t const one = std::size_t(std::find(all.begin(), all.end(), 1) - all.begin()), n = all.size() - 1;
    std::size_t const normal = std::size_t{1} << (F.digits - 1);
    std::vector<double> some;
    for (std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{3}, normal - 1, normal, normal + 1,
                          one / 2, one - 1, one, one + 1, one + normal / 2, one + normal, one + 3 * normal / 2, n - 2, n - 1})
        some.push_back(all[i]);
    EXPECT_TRUE(all_pairs(&operate<Chopped<F, R>>, all, R, with_signs_and_specials(some)));
    EXPECT_TRUE(random_pairs(&operate<Chopped<F, R>>, all, R, 4000, Seed{7}));
}
template <Rounding R>
void operate_on_everything() {
    operate_on_specials_and_samples<binary16, R>();
    operate_on_specials_and_samples<bfloat16, R>();
    operate_on_specials_and_samples<tf32, R>();
    for (auto all = numbers(small); auto f : {Operation(&operate<Chopped<small, R>>)})
        EXPECT_TRUE(all_pairs(f, all, R, with_signs_and_specials({all.begin(), all.end() - 1})));
    for (auto all = numbers(smallest); auto f : {Operation(&operate<Chopped<smallest, R>>)})
        EXPECT_TRUE(all_pairs(f, all, R, with_signs_and_specials({all.begin(), all.end() - 1})));
}
TEST(Chopped, NearestRoundsOnce) { operate_on_everything<Rounding::nearest>(); }
TEST(Chopped, TowardZeroRoundsOnce) { operate_on_everything<Rounding::toward_zero>(); }
TEST(Chopped, StochasticRoundsOnce) { operate_on_everything<Rounding::stochastic>(); }

template <Rounding R>
bool all_roots(Operation const& f) {
    auto const all = numbers(binary16);
    bool good = true;
    for (std::size_t i = 0; i + 1 < all.size() && good; ++i) good = rounds_once(f, all, R, 'r', all[i], 0, Seed{i});
    return good;
}
TEST(Chopped, RootsOfEveryHalf) {
    EXPECT_TRUE(all_roots<Rounding::nearest>(&operate<Half>));
    EXPECT_TRUE(all_roots<Rounding::toward_zero>(&operate<HalfZero>));
    EXPECT_TRUE(all_roots<Rounding::stochastic>(&operate<HalfStochastic>));
    EXPECT_FALSE(all_roots<Rounding::nearest>(&operate<HalfZero>));
    EXPECT_FALSE(all_roots<Rounding::stochastic>([](char op, double a, double b) { return operate<Half>(op, a, b); }));
}
TEST(Chopped, TailsAreSeenAcrossTheWholeRange) {
    EXPECT_EQ(double(BrainZero(1) - BrainZero(0x1p-100)), 1 - 0x1p-8);
    EXPECT_EQ(double(BrainZero(0x1p-133) - BrainZero(largest(bfloat16))), -largest(bfloat16) + 0x1p120);
    EXPECT_EQ(double(BrainZero(1) + BrainZero(0x1p-100)), 1);
    EXPECT_EQ(double(BrainZero(largest(bfloat16)) * BrainZero(2)), largest(bfloat16));
    EXPECT_EQ(double(Brain(largest(bfloat16)) * Brain(2)), infinity);
}
/// Double rounding: the operation in double, rounded as C rounds. Innocuous to nearest, not otherwise.
template <class C>
double twice(char op, double a, double b) {
    return double(C(operate<double>(op, a, b)));
}
TEST(Chopped, ChecksOfOperationsCanFail) {
    auto const half = numbers(binary16), few = numbers(small), all = with_signs_and_specials({few.begin(), few.end() - 1});
    using Nearest = Chopped<small>;
    using Zero = Chopped<small, Rounding::toward_zero>;
    using Stochastic = Chopped<small, Rounding::stochastic>;
    EXPECT_TRUE(all_pairs(&twice<Nearest>, few, Rounding::nearest, all));
    EXPECT_FALSE(all_pairs(&operate<Zero>, few, Rounding::nearest, all));
    EXPECT_FALSE(all_pairs(&operate<Nearest>, few, Rounding::toward_zero, all));
    EXPECT_FALSE(all_pairs(&operate<Nearest>, few, Rounding::stochastic, all));
    EXPECT_FALSE(all_pairs(&twice<Zero>, few, Rounding::toward_zero, all));
    EXPECT_FALSE(random_pairs(&twice<BrainZero>, numbers(bfloat16), Rounding::toward_zero, 4000, Seed{7}));
    auto const drawing_twice = [](char op, double a, double b) {
        double const result = operate<Stochastic>(op, a, b);
        return result == operate<Stochastic>(op, a, b) ? result : result;
    };
    EXPECT_FALSE(all_pairs(drawing_twice, few, Rounding::stochastic, all));
}

TEST(Chopped, TwentyFourBitsAreFloat) {
    using Float = Chopped<Format{24, -126, 127}>;
    Seed seed{3};
    for (int k = 0; k < 100000; ++k) {
        float const a = std::bit_cast<float>(std::uint32_t(seed.next() >> 32)), near = a * float(seed.bell());
        float const b = k % 2 ? std::bit_cast<float>(std::uint32_t(seed.next() >> 32)) : near;
        ASSERT_TRUE(same(double(Float(a) + Float(b)), a + b) && same(double(Float(a) - Float(b)), a - b));
        ASSERT_TRUE(same(double(Float(a) * Float(b)), a * b) && same(double(Float(a) / Float(b)), a / b));
        ASSERT_TRUE(same(double(sqrt(Float(a))), std::sqrt(a)));
        ASSERT_EQ(Float(a) < Float(b), a < b);
    }
}

/// Ups among n additions of a quarter ulp, n/4 expected: within 6.5 standard deviations, so a false alarm has probability
/// 1e-10 over seeds.
bool a_quarter_goes_up_a_quarter_of_the_time(std::function<double(double, Seed&)> const& quarter_ulp_above_one) {
    constexpr int n = 1 << 18;
    Seed seed{11};
    int ups = 0;
    for (int k = 0; k < n; ++k) ups += quarter_ulp_above_one(1 + 0x1p-12, seed) > 1;
    return std::abs(ups - n / 4) < 6.5 * std::sqrt(n * 3 / 16.0);
}
TEST(Stochastic, MeansAreExact) {
    auto const add = [](double x, Seed& seed) {
        StochasticStream const stream(seed);
        return double(HalfStochastic(1) + HalfStochastic(x - 1));
    };
    EXPECT_TRUE(a_quarter_goes_up_a_quarter_of_the_time(add));
    EXPECT_FALSE(a_quarter_goes_up_a_quarter_of_the_time([](double x, Seed& seed) {    // the draw is not uniform
        return round_stochastically<binary16>(x, 0, [&] { return 0.99 * seed.uniform(); });
    }));
}

/// A long run of mixed operations; its last value and a hash of all.
template <class C>
std::uint64_t long_run(Seed data, int steps) {
    std::uint64_t hash = 0xcbf29ce484222325;
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
        hash = (hash ^ (std::isnan(value) ? 0 : std::bit_cast<std::uint64_t>(value))) * 0x100000001b3;
    }
    return hash;
}
template <class C>
std::uint64_t seeded_run(Seed seed, int steps = 4000) {
    StochasticStream const stream(seed);
    return long_run<C>(Seed{1}, steps);
}
TEST(Stochastic, IsReplayedBySeedAndStreamsDoNotInteract) {
    std::uint64_t const alone = seeded_run<BrainStochastic>(Seed{5}), other = seeded_run<BrainStochastic>(Seed{6});
    EXPECT_EQ(alone, seeded_run<BrainStochastic>(Seed{5}));
    EXPECT_NE(alone, other);
    std::uint64_t there = 0;
    std::thread thread([&] { there = seeded_run<BrainStochastic>(Seed{6}); });
    std::uint64_t const here = seeded_run<BrainStochastic>(Seed{5});
    thread.join();
    EXPECT_EQ(here, alone);
    EXPECT_EQ(there, other);
}
TEST(Stochastic, StreamsNestAndTheOwnersSeedAdvances) {
    BrainStochastic const one(1), third(0.328125);
    Seed outer{1}, inner{2};
    {
        StochasticStream const stream(outer);
        { StochasticStream const nested(inner); EXPECT_NE(double(one / third), 0); }
        EXPECT_EQ(outer, Seed{1});
        EXPECT_NE(inner, Seed{2});
        EXPECT_NE(double(one / third), 0);
    }
    EXPECT_EQ(outer.state, Seed{1}.state + (inner.state - Seed{2}.state));    // one draw each
    EXPECT_THROW(one / third, std::logic_error);
    EXPECT_THROW(BrainStochastic(0.1), std::logic_error);
    EXPECT_NO_THROW(one + one * BrainStochastic(0.5) - BrainStochastic(infinity));    // exact: nothing to draw
}

TEST(Chopped, SameBitsInEveryBuild) {
    constexpr int steps = 200000;
    EXPECT_EQ(seeded_run<Half>(Seed{1}, steps), 0u);
    EXPECT_EQ(seeded_run<BrainZero>(Seed{1}, steps), 0u);
    EXPECT_EQ(seeded_run<TensorStochastic>(Seed{1}, steps), 0u);
    EXPECT_EQ((seeded_run<Chopped<widest, Rounding::stochastic>>(Seed{1}, steps)), 0u);
}

template <class C>
bool has_traits(std::string_view name, Format f) {
    using Traits = ArithmeticTraits<C>;
    using Storage = Eigen::NumTraits<C>;
    return Traits::name == name && Format{Traits::digits, Traits::min_exp, Traits::max_exp} == f &&
           double(Storage::highest()) == largest(f) && double(Storage::lowest()) == -largest(f) &&
           double(Storage::epsilon()) == std::ldexp(1, 1 - f.digits) && Storage::dummy_precision() > C(0);
}
TEST(Chopped, Traits) {
    static_assert(Real<Half> && Real<BrainZero> && Real<TensorStochastic>);
    EXPECT_TRUE(has_traits<Half>("binary16", binary16) && has_traits<Brain>("bfloat16", bfloat16));
    EXPECT_TRUE(has_traits<HalfZero>("binary16-zero", binary16) && has_traits<TensorZero>("tf32-zero", tf32));
    EXPECT_TRUE(has_traits<BrainStochastic>("bfloat16-stochastic", bfloat16));
    EXPECT_FALSE(has_traits<Brain>("bfloat16", binary16));
    for (double const x : numbers(bfloat16)) ASSERT_EQ(widen(Brain(-x)), Reference(-x));
    EXPECT_TRUE(isnan(widen(Half(nan))) && isinf(widen(Half(-infinity))) && widen(Half(-infinity)) < 0);
    EXPECT_TRUE(is_finite(Half(65504)) && !is_finite(Half(65520)) && !is_finite(Half(nan)));
    EXPECT_EQ((Matrix<Half>::Identity(3, 3) * Half(2)).trace(), Half(6));
}

TEST(Seed, IsSplitMix64AndItsBellIsNormalised) {
    Seed seed{1234567};    // the published sequence
    for (std::uint64_t expected : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u, 4593380528125082431u})
        EXPECT_EQ(seed.next(), expected);
    constexpr int n = 100000;
    double sum = 0, squares = 0;
    for (int k = 0; k < n; ++k) {
        double const x = seed.bell();
        sum += x;
        squares += x * x;
        ASSERT_TRUE(-6 <= x && x < 6);
    }
    EXPECT_LT(std::abs(sum), 6.5 * std::sqrt(n));                // false alarm: 1e-10
    EXPECT_LT(std::abs(squares - n), 6.5 * std::sqrt(2.0 * n));    // var x^2 = 1.9
}

}  // namespace
}  // namespace rlslab
