// The short formats and their roundings against tables of all their numbers and exact rational arithmetic.
//
// Every check is a predicate over the thing checked, so that a saboteur shows that it can fail.
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

namespace rlslab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The numbers >= 0 of a format have places 0, 1, 2...; odd ones hold odd significands; the last is the first power of
/// two that the format lacks. Nothing in format.hpp is asked, so that a search among them is an independent rounding.
std::size_t binade(Format f) { return std::size_t{1} << (f.digits - 1); }
std::size_t last_place(Format f) { return binade(f) * std::size_t(f.max_exp - f.min_exp + 2); }
double number(Format f, std::size_t place) {
    std::size_t const m = place % binade(f), row = place / binade(f);  // row 0 has the subnormals
    return std::ldexp(double(row == 0 ? m : binade(f) + m), f.min_exp - f.digits + (row == 0 ? 1 : int(row)));
}
std::vector<double> numbers(Format f, std::size_t from, std::size_t to) {
    std::vector<double> out;
    for (std::size_t place = from; place <= to; ++place) out.push_back(number(f, place));
    return out;
}
std::vector<double> numbers(Format f) { return numbers(f, 0, last_place(f)); }
/// Those close to x only, from an even place on: for formats with too many.
std::vector<double> numbers_around(Format f, double x) {
    x = std::min(x, std::ldexp(1, f.max_exp + 1));
    int const e = x == 0 ? f.min_exp : std::max(std::ilogb(x), f.min_exp);
    std::size_t const place = std::size_t(e - f.min_exp) * binade(f) + std::size_t(std::ldexp(x, f.digits - 1 - e));
    return numbers(f, place < 4 ? 0 : (place - 2) / 2 * 2, std::min(place + 4, last_place(f)));
}

/// The same number, with the same sign of zero; NaN is NaN.
bool same(double a, double b) {
    return (a == b && std::signbit(a) == std::signbit(b)) || (std::isnan(a) && std::isnan(b));
}

/// The three roundings of head + tail behind one signature; u is the stochastic one's draw.
using Rounder = std::function<double(double head, double tail, double u)>;
template <Format F>
Rounder rounder(Rounding rounding) {
    if (rounding == Rounding::nearest) return [](double x, double, double) { return round_to_nearest(x, F); };
    if (rounding == Rounding::toward_zero) return [](double x, double t, double) { return round_toward_zero(x, t, F); };
    return [](double x, double t, double u) { return round_stochastically(x, t, F, [u] { return u; }); };
}
bool symmetric(Rounder const& round, double head, double tail, double u, double expected) {
    return same(round(head, tail, u), expected) && same(round(-head, -tail, u), -expected);
}

bool keeps_every_number(Rounder const& round, std::vector<double> const& all) {
    bool good = symmetric(round, infinity, 0, 0, infinity) && std::isnan(round(nan, 0, 0));
    for (std::size_t i = 0; i + 1 < all.size(); ++i) good = good && symmetric(round, all[i], 0, 0, all[i]);
    return good;
}

bool rounds_to_nearest_even(Rounder const& round, std::vector<double> const& all) {
    bool good = symmetric(round, 1e300, 0, 0, infinity) && symmetric(round, 1e-300, 0, 0, 0);
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        bool const last = i + 2 == all.size();
        double const here = all[i], next = last ? infinity : all[i + 1], middle = (here + all[i + 1]) / 2;
        for (double const x : {std::nextafter(here, infinity), std::nextafter(middle, 0)})
            good = good && symmetric(round, x, 0, 0, here);
        good = good && symmetric(round, middle, 0, 0, i % 2 ? next : here);
        for (double const x : {std::nextafter(middle, infinity), std::nextafter(all[i + 1], 0)})
            good = good && symmetric(round, x, 0, 0, next);
    }
    return good;
}

bool rounds_toward_zero(Rounder const& round, std::vector<double> const& all) {
    double const top = all[all.size() - 2];
    bool good = symmetric(round, 1e-300, 0, 0, 0);
    for (double const x : {all.back(), 1e300}) good = good && symmetric(round, x, 0, 0, top);
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        double const here = all[i], next = all[i + 1], middle = (here + next) / 2, tiny = next * 0x1p-100;
        for (double const x : {std::nextafter(here, infinity), std::nextafter(middle, 0), middle,
                               std::nextafter(middle, infinity), std::nextafter(next, 0)})
            good = good && symmetric(round, x, 0, 0, here);
        good = good && symmetric(round, next, -tiny, 0, here) && (here == 0 || symmetric(round, here, tiny, 0, here));
    }
    return good;
}

/// Away from zero iff the draw is below the fraction; tails far below the draw's last bit still tip the balance.
bool rounds_up_iff_the_draw_is_below_the_fraction(Rounder const& round, std::vector<double> const& all) {
    constexpr double draw = 0x1p-53, last_draw = 1 - draw;
    bool good = symmetric(round, 1e300, 0, 0, infinity) && symmetric(round, all.back(), 0, 0, infinity);
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        double const here = all[i], gap = all[i + 1] - here, next = i + 2 == all.size() ? infinity : all[i + 1];
        double const just_above = here == 0 ? gap * 0x1p-200 : std::nextafter(here, infinity);
        double const middle = here + gap / 2;
        for (double const x : {just_above, here + gap / 4, std::nextafter(middle, 0), middle,
                               std::nextafter(middle, infinity), middle + gap / 8, std::nextafter(all[i + 1], 0)}) {
            double const fraction = (x - here) / gap, tiny = std::min(x, gap) * 0x1p-80;
            double const highest_up = draw * (std::ceil(fraction / draw) - 1);
            good = good && symmetric(round, x, 0, 0, next) && symmetric(round, x, 0, highest_up, next) &&
                   symmetric(round, x, 0, highest_up + draw, here) && symmetric(round, x, 0, last_draw, here);
            if (std::fmod(fraction, draw) == 0)  // the tail decides
                good = good && symmetric(round, x, tiny, fraction, next) &&
                       symmetric(round, x, tiny, fraction + draw, here) && symmetric(round, x, -tiny, fraction, here) &&
                       symmetric(round, x, -tiny, highest_up, next);
        }
        double const tiny = gap * 0x1p-80;
        good = good && symmetric(round, all[i + 1], -tiny, last_draw, next) &&
               (here == 0 || (symmetric(round, here, tiny, 0, next) && symmetric(round, here, tiny, draw, here)));
    }
    return good;
}

template <Format F>
void round_everything() {
    auto const all = numbers(F);
    EXPECT_TRUE(largest(F) == all[all.size() - 2] && smallest_subnormal(F) == all[1]);
    for (Rounding r : {Rounding::nearest, Rounding::toward_zero, Rounding::stochastic})
        EXPECT_TRUE(keeps_every_number(rounder<F>(r), all));
    EXPECT_TRUE(rounds_to_nearest_even(rounder<F>(Rounding::nearest), all));
    EXPECT_TRUE(rounds_toward_zero(rounder<F>(Rounding::toward_zero), all));
    EXPECT_TRUE(rounds_up_iff_the_draw_is_below_the_fraction(rounder<F>(Rounding::stochastic), all));
}
constexpr Format small{4, -3, 4}, smallest{2, -1, 1}, widest{25, -400, 400};

TEST(Format, BoundsAreThoseOfDouble) {
    EXPECT_TRUE(fits_in_double(binary16) && fits_in_double(bfloat16) && fits_in_double(tf32) && fits_in_double(widest));
    for (Format const f : {Format{26, -100, 100}, {1, -100, 100}, {11, -14, 511}, {11, -502, 15}, {25, -460, 460}})
        EXPECT_FALSE(fits_in_double(f));
}
TEST(Format, RoundsEveryNumberMidpointAndNeighbour) {
    EXPECT_EQ(numbers(binary16).size(), 31745u);  // 0x7c00 and the power of two after them
    round_everything<binary16>();
    round_everything<bfloat16>();
    round_everything<tf32>();
    round_everything<small>();
    round_everything<smallest>();
}
TEST(Format, ExactNumbersDrawNothing) {
    auto const refuse = []() -> double { throw std::logic_error("drawn"); };
    for (double const x : numbers(binary16)) EXPECT_NO_THROW(round_stochastically(-x, 0, binary16, refuse));
    EXPECT_THROW(round_stochastically(1, 0x1p-90, binary16, refuse), std::logic_error);
}
TEST(Format, ChecksOfRoundingCanFail) {
    auto const all = numbers(binary16);
    Rounder const nearest = rounder<binary16>(Rounding::nearest), cut = rounder<binary16>(Rounding::toward_zero),
                  toss = rounder<binary16>(Rounding::stochastic);
    auto const refuted = [&](auto const& check, Rounder const& saboteur) { return !check(saboteur, all); };
    using D = double;
    EXPECT_TRUE(refuted(keeps_every_number, [&](D x, D, D) { return nearest(x, 0, 0) + 0.0; }));  // drops -0
    EXPECT_TRUE(refuted(keeps_every_number, [&](D x, D, D) { return std::abs(x) < 0x1p-14 ? 0 * x : x; }));
    EXPECT_TRUE(refuted(rounds_to_nearest_even, cut));
    EXPECT_TRUE(refuted(rounds_to_nearest_even, [&](D x, D, D) { return nearest(x * (1 + 0x1p-52), 0, 0); }));
    EXPECT_TRUE(refuted(rounds_to_nearest_even,  // never to infinity
                        [&](D x, D, D) { return std::clamp(nearest(x, 0, 0), -65504., 65504.); }));
    EXPECT_TRUE(refuted(rounds_toward_zero, nearest));
    EXPECT_TRUE(refuted(rounds_toward_zero, [&](D x, D, D) { return cut(x, 0, 0); }));  // rounds twice
    EXPECT_TRUE(refuted(rounds_up_iff_the_draw_is_below_the_fraction, [&](D x, D, D u) { return toss(x, 0, u); }));
    EXPECT_TRUE(refuted(rounds_up_iff_the_draw_is_below_the_fraction,  // <= for <
                        [&](D x, D t, D u) { return toss(x, t, u - 0x1p-53); }));
}

/// Where |exact| lies among the numbers: against(g) is the sign of |exact| - g.
using Against = std::function<int(Rational const&)>;
double search(std::vector<double> const& all, Against const& against, Rounding rounding, double u) {
    auto const not_above = [&](double g) { return against(Rational(g)) >= 0; };
    auto const above = std::partition_point(all.begin(), all.end(), not_above);
    std::size_t const last = all.size() - 1, i = std::size_t(above - all.begin()) - 1;
    auto const number = [&](std::size_t k) { return k == last ? infinity : all[k]; };
    if (rounding == Rounding::toward_zero) return all[std::min(i, last - 1)];
    if (i == last || against(Rational(all[i])) == 0) return number(i);
    Rational const gap = Rational(all[i + 1]) - Rational(all[i]);
    if (rounding == Rounding::stochastic) return number(i + (against(Rational(all[i]) + Rational(u) * gap) > 0));
    int const side = against(Rational(all[i]) + gap / 2);
    return number(i + (side > 0 || (side == 0 && i % 2 == 1)));
}

/// a op b rounded once, independently; u is the draw. Specials, and signs of exact zeros, are double's.
double oracle(std::vector<double> const& all, Rounding rounding, char op, double a, double b, double u) {
    double const head = op == '+' ? a + b : op == '-' ? a - b : op == '*' ? a * b : op == '/' ? a / b : std::sqrt(a);
    if (!std::isfinite(head) || head == 0 || !std::isfinite(b)) return head;
    Rational const x(std::abs(a)), y(std::abs(b));
    Against against;
    if (op == 'r') {
        against = [&](Rational const& g) { return Rational(x - g * g).sign(); };
    } else if (op == '/') {
        against = [&](Rational const& g) { return Rational(x - g * y).sign(); };
    } else {
        Rational const s = op == '*' ? Rational(x * y) : abs(Rational(a) + Rational(op == '+' ? b : -b));
        against = [s](Rational const& g) { return Rational(s - g).sign(); };
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

/// One operation under a stream of its own: the value, and that a draw is taken if and only if the result is inexact.
/// (What overflows may draw or not: no draw can change it.)
bool rounds_once(Operation const& f, std::vector<double> const& all, Rounding rounding, char op, double a, double b,
                 Seed seed) {
    Seed copy = seed, used = seed;
    double const u = copy.uniform();
    StochasticStream const stream(used);
    double const result = f(op, a, b);
    if (!same(result, oracle(all, rounding, op, a, b, u))) return false;
    if (rounding != Rounding::stochastic) return used == seed;
    double const high = oracle(all, rounding, op, a, b, 0), low = oracle(all, rounding, op, a, b, 1);
    return used == (same(low, high) ? seed : copy) || (used == copy && std::isinf(low));
}

/// A seed whose next draw is k 2^-53: SplitMix64 backwards.
Seed seed_drawing(std::uint64_t k) {
    std::uint64_t z = k << 11;
    z = (z ^ (z >> 31) ^ (z >> 62)) * 0x319642b2d24d8ec3;
    z = (z ^ (z >> 27) ^ (z >> 54)) * 0x96de1b173f119089;
    return Seed{(z ^ (z >> 30) ^ (z >> 60)) - 0x9e3779b97f4a7c15};
}
/// Up at the last draw below the exact fraction, down at the next: it takes the right tail to the last bit of a draw.
bool turns_at_the_fraction(Operation const& f, std::vector<double> const& all, char op, double a, double b) {
    auto const expected = [&](std::uint64_t k) {
        return oracle(all, Rounding::stochastic, op, a, b, double(k) * 0x1p-53);
    };
    std::uint64_t up = 0, down = std::uint64_t{1} << 53;
    if (same(expected(up), expected(down))) return true;  // exact
    while (down - up > 1) {
        std::uint64_t const k = (up + down) / 2;
        (same(expected(k), expected(0)) ? up : down) = k;
    }
    return rounds_once(f, all, Rounding::stochastic, op, a, b, seed_drawing(up)) &&
           (down >> 53 || rounds_once(f, all, Rounding::stochastic, op, a, b, seed_drawing(down)));
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
    for (double const a : some)
        for (double const b : some)
            for (char const op : {'+', '-', '*', '/', 'r'})
                good = good && rounds_once(f, all, r, op, a, op == 'r' ? 0 : b, Seed{seed.next()});
    return good;
}
/// Pairs drawn from all numbers, every second one of neighbouring places: cancellation, quotients close to 1.
using Check = std::function<bool(std::vector<double> const& around, char op, double a, double b, Seed)>;
bool random_pairs(Format f, int count, Check const& check) {
    bool good = true;
    Seed seed{7};
    std::size_t const n = last_place(f);
    for (int k = 0; k < count && good; ++k) {
        std::size_t const i = seed.next() % n, j = k % 2 ? seed.next() % n : std::min(n - 1, i + seed.next() % 4096);
        double const a = (seed.next() % 2 ? 1 : -1) * number(f, i), b = (seed.next() % 2 ? 1 : -1) * number(f, j);
        for (char const op : {'+', '-', '*', '/', 'r'}) {
            double const head = std::abs(operate<double>(op, a, b));
            good = good && check(numbers_around(f, std::isfinite(head) ? head : 0), op, a, b, Seed{seed.next()});
        }
    }
    return good;
}
Check rounding_once(Operation const& f, Rounding r) {
    return [=](auto const& all, char op, double a, double b, Seed s) { return rounds_once(f, all, r, op, a, b, s); };
}
Check turning_at_the_fraction(Operation const& f) {
    return [=](auto const& all, char op, double a, double b, Seed) { return turns_at_the_fraction(f, all, op, a, b); };
}

template <Format F, Rounding R>
void operate_on_samples() {
    EXPECT_TRUE(random_pairs(F, 5000, rounding_once(&operate<Chopped<F, R>>, R)));
}
template <Format F, Rounding R>
void operate_on_specials_and_samples() {
    std::size_t const all = last_place(F), normal = binade(F), one = normal * std::size_t(1 - F.min_exp);
    std::vector<double> some;
    for (std::size_t const place :
         {std::size_t{0}, std::size_t{1}, normal - 1, normal, normal + 1, one / 2, one - 1, one, one + 1,
          one + normal / 2, one + normal, one + 3 * normal / 2, all - 2, all - 1})
        some.push_back(number(F, place));
    EXPECT_TRUE(all_pairs(&operate<Chopped<F, R>>, numbers(F), R, with_signs_and_specials(some)));
    operate_on_samples<F, R>();
}
template <Format F, Rounding R>
void operate_on_all_pairs() {
    auto const all = numbers(F);
    EXPECT_TRUE(all_pairs(&operate<Chopped<F, R>>, all, R, with_signs_and_specials({all.begin(), all.end() - 1})));
}
template <Rounding R>
void operate_on_everything() {
    operate_on_specials_and_samples<binary16, R>();
    operate_on_specials_and_samples<bfloat16, R>();
    operate_on_specials_and_samples<tf32, R>();
    operate_on_samples<widest, R>();
    operate_on_all_pairs<small, R>();
    operate_on_all_pairs<smallest, R>();
}
TEST(Chopped, NearestRoundsOnce) { operate_on_everything<Rounding::nearest>(); }
TEST(Chopped, TowardZeroRoundsOnce) { operate_on_everything<Rounding::toward_zero>(); }
TEST(Chopped, StochasticRoundsOnce) { operate_on_everything<Rounding::stochastic>(); }
template <Format F>
void steer() {
    EXPECT_TRUE(random_pairs(F, 200, turning_at_the_fraction(&operate<Chopped<F, Rounding::stochastic>>)));
}
TEST(Chopped, StochasticTurnsAtTheFraction) {
    EXPECT_EQ(seed_drawing(12345).uniform(), 12345 * 0x1p-53);
    steer<binary16>();
    steer<bfloat16>();
    steer<tf32>();
    steer<widest>();
}

bool all_roots(Operation const& f, Rounding r) {
    bool good = true;
    for (std::size_t i = 0; i < last_place(binary16) && good; ++i) {
        double const x = number(binary16, i);
        good = rounds_once(f, numbers_around(binary16, std::sqrt(x)), r, 'r', x, 0, Seed{i});
    }
    return good;
}
TEST(Chopped, RootsOfEveryHalf) {
    EXPECT_TRUE(all_roots(&operate<Half>, Rounding::nearest));
    EXPECT_TRUE(all_roots(&operate<HalfZero>, Rounding::toward_zero));
    EXPECT_TRUE(all_roots(&operate<HalfStochastic>, Rounding::stochastic));
    EXPECT_FALSE(all_roots(&operate<HalfZero>, Rounding::nearest));
    EXPECT_FALSE(all_roots(&operate<Half>, Rounding::stochastic));
}
TEST(Chopped, TailsAreSeenAcrossTheWholeRange) {
    EXPECT_EQ(double(BFloat16Zero(1) - BFloat16Zero(0x1p-100)), 1 - 0x1p-8);
    EXPECT_EQ(double(BFloat16Zero(0x1p-133) - BFloat16Zero(largest(bfloat16))), -largest(bfloat16) + 0x1p120);
    EXPECT_EQ(double(BFloat16Zero(1) + BFloat16Zero(0x1p-100)), 1);
    EXPECT_EQ(double(BFloat16Zero(largest(bfloat16)) * BFloat16Zero(2)), largest(bfloat16));
    EXPECT_EQ(double(BFloat16(largest(bfloat16)) * BFloat16(2)), infinity);
}
/// Double rounding: the operation in double, rounded as C rounds. Innocuous to nearest, not otherwise.
template <class C>
double twice(char op, double a, double b) {
    return double(C(operate<double>(op, a, b)));
}
/// Up for half as many draws as is due.
template <Format F>
double biased(char op, double a, double b) {
    auto const draw = [] { return std::min(2 * StochasticStream::uniform(), 1 - 0x1p-53); };
    return round_stochastically(operate<double>(op, a, b), 0, F, draw);
}
TEST(Chopped, ChecksOfOperationsCanFail) {
    auto const few = numbers(small), all = with_signs_and_specials({few.begin(), few.end() - 1});
    using Nearest = Chopped<small>;
    using Zero = Chopped<small, Rounding::toward_zero>;
    using Stochastic = Chopped<small, Rounding::stochastic>;
    EXPECT_TRUE(all_pairs(&twice<Nearest>, few, Rounding::nearest, all));
    EXPECT_FALSE(all_pairs(&operate<Zero>, few, Rounding::nearest, all));
    EXPECT_FALSE(all_pairs(&operate<Nearest>, few, Rounding::toward_zero, all));
    EXPECT_FALSE(all_pairs(&operate<Nearest>, few, Rounding::stochastic, all));
    // The same without its tail, and with half of every fraction.
    EXPECT_FALSE(random_pairs(bfloat16, 4000, rounding_once(&twice<BFloat16Zero>, Rounding::toward_zero)));
    EXPECT_FALSE(random_pairs(bfloat16, 4000, rounding_once(&twice<BFloat16Stochastic>, Rounding::stochastic)));
    EXPECT_FALSE(random_pairs(bfloat16, 1000, turning_at_the_fraction(&twice<BFloat16Stochastic>)));
    EXPECT_FALSE(all_pairs(&biased<small>, few, Rounding::stochastic, all));
    EXPECT_TRUE(all_pairs(&operate<Stochastic>, few, Rounding::stochastic, all));
    auto const drawing_twice = [](char op, double a, double b) {
        operate<Stochastic>(op, a, b);
        return operate<Stochastic>(op, a, b);
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

}  // namespace
}  // namespace rlslab
