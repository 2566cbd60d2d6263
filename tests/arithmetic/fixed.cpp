// Fixed point against exact rationals: all pairs of 8-bit words, samples of longer ones; sums, marks, counts. Then the
// dense variants in it: digits, overflow as a breakdown, formats and counts over threads.
//
// Every check is a predicate over the thing checked, so that a saboteur shows that it can fail.
#include <rlslab/arithmetic/fixed.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/many/fold_all.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace rlslab {
namespace {

using V = VariableFixed;
constexpr FixedRounding roundings[] = {FixedRounding::nearest, FixedRounding::down};
constexpr Overflow policies[] = {Overflow::saturate, Overflow::wrap};

Rational power_of_two(int e) {
    Rational const two = 2;
    Rational out = 1;
    for (int i = 0; i < std::abs(e); ++i) out *= two;
    return e < 0 ? Rational(1 / out) : out;
}

/// What a word of the format holds, from a rational number alone: nothing of fixed.hpp is asked.
struct Held {
    std::int64_t word;
    bool marked;
    friend bool operator==(Held const&, Held const&) = default;
};
Held held(Rational const& x, FixedFormat f) {
    Rational const scaled = x * power_of_two(f.fraction);
    auto const n = numerator(scaled), d = denominator(scaled);
    auto below = n / d;  // toward zero
    if (below * d > n) --below;
    if (f.rounding == FixedRounding::nearest) {
        auto const twice = 2 * (n - below * d);
        if (twice > d || (twice == d && below % 2 != 0)) ++below;
    }
    std::int64_t const limit = std::int64_t{1} << (f.bits - 1);
    if (below >= -limit && below < limit) return {below.convert_to<std::int64_t>(), false};
    if (f.overflow == Overflow::saturate) return {below < 0 ? -limit : limit - 1, true};
    auto rest = (below + limit) % (2 * limit);
    if (rest < 0) rest += 2 * limit;
    return {rest.convert_to<std::int64_t>() - limit, true};
}
Rational exactly(V const& x) { return Rational(x.word()) * power_of_two(-V::format().fraction); }
V word(std::int64_t n) { return V(std::ldexp(double(n), -V::format().fraction)); }

/// An operation on two words: as it is computed, and as rationals have it; none where the divisor is 0.
struct Operation {
    std::function<V(V const&, V const&)> computed;
    std::function<std::optional<Rational>(Rational const&, Rational const&)> exact;
};
std::vector<Operation> operations() {
    using R = Rational const&;
    return {{[](V const& a, V const& b) -> V { return a + b; }, [](R a, R b) { return Rational(a + b); }},
            {[](V const& a, V const& b) -> V { return a - b; }, [](R a, R b) { return Rational(a - b); }},
            {[](V const& a, V const& b) -> V { return a * b; }, [](R a, R b) { return Rational(a * b); }},
            {[](V const& a, V const& b) -> V { return a / b; },
             [](R a, R b) { return b == 0 ? std::nullopt : std::optional<Rational>(Rational(a / b)); }}};
}
bool is_exact_rounded_once(Operation const& operation, V const& a, V const& b) {
    std::optional<Rational> const exact = operation.exact(exactly(a), exactly(b));
    if (!exact) return true;
    V const x = operation.computed(a, b);
    return Held{x.word(), x.marked()} == held(*exact, V::format());
}
bool for_all_pairs(Operation const& operation, std::int64_t limit) {
    for (std::int64_t a = -limit; a < limit; ++a)
        for (std::int64_t b = -limit; b < limit; ++b)
            if (!is_exact_rounded_once(operation, word(a), word(b))) return false;
    return true;
}
/// Any size of number is as likely as another, and the ends of the words occur.
V some_word(Seed& seed) {
    FixedFormat const f = V::format();
    std::int64_t const limit = std::int64_t{1} << (f.bits - 1);
    std::uint64_t const kind = seed.next() % 16;
    if (kind == 0) return word(-limit);
    if (kind == 1) return word(limit - 1);
    std::int64_t const n =
        std::int64_t(seed.next() & std::uint64_t(limit - 1)) >> (seed.next() % std::uint64_t(f.bits - 1));
    return word(seed.next() % 2 ? n : -n);
}
bool for_samples(Operation const& operation, int samples, Seed seed) {
    for (int i = 0; i < samples; ++i) {
        V const a = some_word(seed), b = some_word(seed);
        if (!is_exact_rounded_once(operation, a, b)) return false;
    }
    return true;
}

TEST(Fixed, EveryPairOf8BitWordsIsTheExactResultRoundedOnce) {
    for (FixedRounding const rounding : roundings)
        for (Overflow const overflow : policies) {
            FixedScope const scope({8, 5, rounding, overflow});
            for (Operation const& operation : operations()) EXPECT_TRUE(for_all_pairs(operation, 128));
        }
    for (int const fraction : {0, 7}) {
        FixedScope const scope({8, fraction});
        for (Operation const& operation : operations()) EXPECT_TRUE(for_all_pairs(operation, 128));
    }
}
TEST(Fixed, SamplesOfLongerWordsLikewise) {
    for (FixedRounding const rounding : roundings)
        for (Overflow const overflow : policies)
            for (auto const& [bits, fraction] : {std::pair{16, 10}, {16, 15}, {32, 20}, {48, 31}}) {
                FixedScope const scope({bits, fraction, rounding, overflow});
                for (Operation const& operation : operations())
                    EXPECT_TRUE(for_samples(operation, 3000, Seed{std::uint64_t(bits)}));
            }
}
TEST(Fixed, TheChecksOfRoundingCanFail) {
    FixedScope const scope({8, 5});
    std::vector<Operation> const good = operations();
    auto const refuted = [&](size_t which, std::function<V(V const&, V const&)> saboteur) {
        return !for_all_pairs({std::move(saboteur), good[which].exact}, 128);
    };
    EXPECT_TRUE(refuted(0, [](V const& a, V const& b) {  // wraps where it should saturate
        FixedScope const other({8, 5, FixedRounding::nearest, Overflow::wrap});
        return V(a + b);
    }));
    EXPECT_TRUE(refuted(2, [](V const& a, V const& b) {  // truncates
        FixedScope const other({8, 5, FixedRounding::down});
        return V(a * b);
    }));
    EXPECT_TRUE(refuted(2, [](V const& a, V const& b) {  // ties away from zero
        double const x = a.value() * b.value() * 32;
        return word(std::clamp(std::int64_t(x < 0 ? x - 0.5 : x + 0.5), std::int64_t{-128}, std::int64_t{127}));
    }));
    EXPECT_TRUE(
        refuted(3, [](V const& a, V const& b) { return b.word() == 0 ? b : V(a.value() / b.value() + 0x1p-20); }));
    EXPECT_TRUE(refuted(1, [](V const& a, V const& b) {
        return word(std::clamp<std::int64_t>(a.word() - b.word(), -128, 127));
    }));  // no mark
}

bool is_the_root(FixedFormat f, V const& a, V const& root) {
    Rational const square = exactly(a), r = exactly(root), q = power_of_two(-f.fraction), half = q / 2;
    if (f.rounding == FixedRounding::down) return r * r <= square && square < (r + q) * (r + q);
    return (r == 0 || (r - half) * (r - half) < square) && square < (r + half) * (r + half);
}
TEST(Fixed, RootsAreRoundedOnce) {
    for (FixedRounding const rounding : roundings) {
        for (int const fraction : {1, 5, 6}) {
            FixedScope const scope({8, fraction, rounding});
            for (std::int64_t n = 0; n < 128; ++n)
                EXPECT_TRUE(is_the_root(V::format(), word(n), sqrt(word(n)))) << n << ' ' << fraction;
        }
        for (auto const& [bits, fraction] : {std::pair{16, 10}, {32, 20}, {48, 40}}) {
            FixedScope const scope({bits, fraction, rounding});
            Seed seed{7};
            for (int i = 0; i < 3000; ++i) {
                V const a = abs(some_word(seed));
                EXPECT_TRUE(is_the_root(V::format(), a, sqrt(a))) << a.word();
            }
        }
    }
    FixedScope const scope({16, 10});
    EXPECT_FALSE(is_the_root(V::format(), word(3000), word(sqrt(word(3000)).word() + 1)));
    EXPECT_FALSE(is_the_root(V::format(), word(3000), word(sqrt(word(3000)).word() - 1)));
}

/// The product of a matrix and a column, by columns and by dot products: each number exact until it is stored.
template <class T>
bool products_are_rounded_once(Index d, Seed seed) {
    StateMatrix<T> A(d);
    StateVector<T> x(d), by_columns(d), by_rows(d);
    auto const draw = [&] { return T(seed.bell() / 8); };
    for (Index j = 0; j < d; ++j) {
        x[j] = draw();
        for (Index i = 0; i < d; ++i) A(i, j) = draw();
    }
    multiply(A, x.data(), by_columns);
    multiply_transposed(A, x.data(), by_rows);
    auto const exact = [](T const& a) { return Rational(a.word()) * power_of_two(-T::format().fraction); };
    bool good = true;
    for (Index i = 0; i < d; ++i) {
        Rational across = 0, down = 0;
        for (Index j = 0; j < d; ++j) {
            across += exact(A(i, j)) * exact(x[j]);
            down += exact(A(j, i)) * exact(x[j]);
        }
        good = good && held(across, T::format()).word == by_columns[i].word() &&
               held(down, T::format()).word == by_rows[i].word();
    }
    return good;
}
TEST(Fixed, SumsAreExactUntilTheyAreStored) {
    FixedScope const scope({16, 12});
    for (Index d = 1; d <= 20; ++d) EXPECT_TRUE(products_are_rounded_once<V>(d, Seed{std::uint64_t(d)})) << d;
    EXPECT_FALSE(products_are_rounded_once<VariableFixedRounded>(20, Seed{20}));
    Seed seed{3};
    for (int i = 0; i < 3000; ++i) {
        V const a = some_word(seed), b = some_word(seed), c = some_word(seed), e = some_word(seed);
        V const x = a * b - c * e + a;
        EXPECT_EQ((Held{x.word(), x.marked()}),
                  held(exactly(a) * exactly(b) - exactly(c) * exactly(e) + exactly(a), V::format()));
        EXPECT_EQ(a * b < c * e, exactly(a) * exactly(b) < exactly(c) * exactly(e));
        EXPECT_EQ(a * b == c, exactly(a) * exactly(b) == exactly(c));
    }
    V const top = word(32767);
    EXPECT_EQ(V(top + top - top).word(), 32767);  // no overflow on the way
    EXPECT_FALSE(V(top + top - top).marked());
    EXPECT_TRUE(VariableFixedRounded(VariableFixedRounded(7.9) + VariableFixedRounded(7.9) - VariableFixedRounded(7.9))
                    .marked());
}

TEST(Fixed, TheFormatMayBeAConstant) {
    using C = Fixed<FixedFormat{16, 12}>;
    static_assert(Real<C> && Real<V> && Real<VariableFixedRounded> && sizeof(C) == 16);
    FixedScope const scope({16, 12});
    Seed seed{5};
    for (int i = 0; i < 3000; ++i) {
        V const a = some_word(seed), b = some_word(seed);
        C const c(a.value()), e(b.value());
        EXPECT_EQ(V(a * b + a / b).word(), C(c * e + c / e).word());
        EXPECT_EQ(sqrt(abs(a)).word(), sqrt(abs(c)).word());
    }
    EXPECT_TRUE(least_sum_of_squares<V>() == V(1) && least_sum_of_squares<C>() == C(1));
    EXPECT_EQ(significand_bits<V>(), 13);
    EXPECT_EQ(widen(C(-0.5)), Reference(-0.5));
    EXPECT_FALSE(is_finite(widen(C(9.0))));
    for (FixedFormat const f : {FixedFormat{1, 0}, {49, 0}, {16, 16}, {16, -1}})
        EXPECT_THROW(FixedScope const refused(f), std::invalid_argument);
    EXPECT_EQ(FixedScope::format(), (FixedFormat{16, 12}));
}
TEST(Fixed, DataAreRoundedToNearestAndSaturated) {
    for (FixedRounding const rounding : roundings) {
        FixedScope const scope({8, 5, rounding, Overflow::wrap});
        for (int quarters = -4 * 140; quarters <= 4 * 140; ++quarters) {
            V const x(quarters / 128.0);
            EXPECT_EQ((Held{x.word(), x.marked()}), held(Rational(quarters) / 128, {8, 5})) << quarters;
        }
        for (double const x : {1e300, std::numeric_limits<double>::infinity()}) {
            EXPECT_EQ(V(x).word(), 127);
            EXPECT_EQ(V(-x).word(), -128);
            EXPECT_TRUE(V(x).marked() && V(-x).marked());
        }
        V const none(std::numeric_limits<double>::quiet_NaN());
        EXPECT_TRUE(none.word() == 0 && none.marked() && std::isnan(static_cast<double>(none)) && !is_finite(none));
        EXPECT_EQ(V(5e-324).word(), 0);
        EXPECT_EQ(V(-0.0).word(), 0);
    }
}
TEST(Fixed, WhatWentWrongIsMarkedAndCounted) {
    FixedScope const scope({16, 12});
    V const seven(7), least = word(-32768), none(0);
    EXPECT_EQ(fixed_events([&] { EXPECT_TRUE(is_finite(V(seven + none))); }).overflows, 0);
    FixedEvents const events = fixed_events([&] {
        V const over = seven * seven;
        EXPECT_TRUE(over.marked() && !is_finite(over) && !is_finite(V(over - over)) && !is_finite(V(none * over)));
        EXPECT_TRUE((-least).marked());
        EXPECT_EQ((seven / none).word(), 32767);
        EXPECT_EQ((-seven / none).word(), -32768);
        EXPECT_TRUE((none / none).word() == 0 && (none / none).marked());
        EXPECT_TRUE(sqrt(least).word() == 0 && sqrt(least).marked());
        EXPECT_EQ(V(word(1) * word(1)).word(), 0);
        UncountedScope<V> const aside;
        EXPECT_TRUE(V(seven * seven).marked());
    });
    EXPECT_EQ(events, (FixedEvents{2, 4, 2, 1, 49 * 4096}));  // -(-8) is the second overflow
    EXPECT_TRUE(events.broken());
    EXPECT_EQ(fixed_events([&] { fixed_events([&] { EXPECT_TRUE(V(seven * seven).marked()); }); }).overflows, 1);
}

TEST(Fixed, AWordIsSavedAndLoadedWithItsMark) {
    using Word = Fixed<FixedFormat{.bits = 8, .fraction = 4}>;
    std::array<std::byte, Encoding<Word>::size> bytes;
    for (int n = -128; n < 128; ++n)
        for (bool const marked : {false, true}) {
            Word const x = marked ? Word(1e9 * (n < 0 ? -1 : 1)) : Word(n / 16.0);
            Word y(3);
            Encoding<Word>::write(x, bytes.data());
            ASSERT_TRUE(Encoding<Word>::read(bytes.data(), y));
            EXPECT_EQ(y.word(), x.word());
            EXPECT_EQ(y.marked(), marked);
        }
    Word y(3);
    bytes.fill(std::byte(0x7f));  // a word of no such format, and no mark
    EXPECT_FALSE(Encoding<Word>::read(bytes.data(), y));
}

// --- the dense variants ----------------------------------------------------------------------------------------------

/// Rows in [-1, 1): y = psi'theta, theta = 1/4.
template <class Update>
void run_rows(Index d, int rows, Seed seed, Update update) {
    for (int k = 0; k < rows; ++k) {
        Vector<double> psi(d);
        double y = 0;
        for (double& x : psi) y += (x = seed.bell() / 8) / 4;
        update(psi, y);
    }
}
template <class F>
Problem<typename F::scalar> problem_of(Index d, double lambda, double P0) {
    using T = typename F::scalar;
    return {.size = d, .forgetting = T(lambda), .prior = Prior<T>{.variance = T(P0)}};
}
/// The largest error of the stored numbers against the same variant in double.
template <class F, class InDouble>
double error(int fraction, int bits) {
    FixedScope const scope({bits, fraction});
    F filter(problem_of<F>(3, 0.9375, 16));
    InDouble exact(problem_of<InDouble>(3, 0.9375, 16));
    bool sound = true;
    run_rows(3, 60, Seed{11}, [&](Vector<double> const& psi, double y) {
        Vector<V> const row = psi.unaryExpr([](double x) { return V(x); });
        sound = sound && filter.update(row, V(y)).health == Health::sound;
        exact.update(Vector<double>(row.unaryExpr([](V const& x) { return x.value(); })), V(y).value());
    });
    double out = sound ? 0 : INFINITY;
    Matrix<V> const F_ = filter.stored().F;
    Matrix<double> const E = exact.stored().F;
    for (Index i = 0; i < 9; ++i) out = std::max(out, std::abs(double(F_(i)) - E(i)));
    return out;
}
// A rounding of q = 2^-F is amplified by numbers up to 20, over a memory of 16 rows and through a dozen operations;
// errors of conventional and kalman grow by lambda^-60 = 48 besides. 2^12 q is that with a factor 2 to spare.
TEST(Fixed, EveryDenseVariantRunsIn16And32Bits) {
    int variants = 0, all = 0;
    for_each(Variants<V>{}, [&]<class F>() {
        ++all;
        for_each(Variants<double>{}, [&]<class D>() {
            if constexpr (std::string_view(F::name) == std::string_view(D::name)) {
                ++variants;
                EXPECT_LT((error<F, D>(9, 16)), std::ldexp(1, 12 - 9)) << F::name;
                EXPECT_LT((error<F, D>(25, 32)), std::ldexp(1, 12 - 25)) << F::name;
                EXPECT_GT((error<F, D>(9, 16)), 16 * (error<F, D>(25, 32))) << F::name;
            }
        });
    });
    EXPECT_EQ(variants, all);
    EXPECT_GE(all, 15);
}

/// P grows as lambda^-k where nothing excites it: what a step says, and whether anything had overflowed when it was
/// done.
struct Said {
    bool sound, overflowed;
};
template <class F>
std::vector<Said> run_into_overflow(Overflow overflow) {
    FixedScope const scope({16, 9, FixedRounding::nearest, overflow});
    F filter(problem_of<F>(2, 0.75, 16));
    std::vector<Said> out;
    Vector<V> const psi(Vector<V>::Constant(2, V(0)));
    FixedEvents so_far;
    for (int k = 0; k < 30; ++k) {
        Health health = Health::sound;
        so_far = so_far + fixed_events([&] { health = filter.update(psi, V(0.5)).health; });
        out.push_back({health == Health::sound, so_far.broken()});
    }
    return out;
}
/// Sound until something overflows; not sound from the next step on, for ever.
bool overflow_is_reported(std::vector<Said> const& said) {
    bool good = !said.front().overflowed && said.back().overflowed;
    for (size_t k = 0; k < said.size(); ++k) {
        if (!said[k].overflowed) good = good && said[k].sound;
        if (k > 0 && said[k - 1].overflowed) good = good && !said[k].sound;
    }
    return good;
}
TEST(Fixed, OverflowIsABreakdownThatTheStepReports) {
    for (Overflow const overflow : {Overflow::saturate, Overflow::wrap})
        for_each(
            TypeList<Conventional<V>, ConventionalTwoSided<V>, Symmetric<V>, Joseph<V>, JosephRankTwo<V>, Kalman<V>,
                     Potter<V>, Carlson<V>, CarlsonDelta<V>, Ud<V>, UdDelta<V>, InverseQr<V>, InverseQrDelta<V>>{},
            [&]<class F>() { EXPECT_TRUE(overflow_is_reported(run_into_overflow<F>(overflow))) << F::name; });
    EXPECT_FALSE(overflow_is_reported(std::vector<Said>(30, {true, false})));
    EXPECT_FALSE(overflow_is_reported({{true, false}, {true, true}, {true, true}}));
    EXPECT_FALSE(overflow_is_reported({{false, false}, {false, true}, {false, true}}));
}

/// The bits of z and R, and the events, of a block filter folded by so many threads.
std::pair<std::vector<std::int64_t>, FixedEvents> folded(unsigned threads) {
    FixedScope const scope({32, 20, FixedRounding::down});
    Records records{.psi = Matrix<double>(3, 400), .y = Vector<double>(400), .names = {}};
    Index k = 0;
    run_rows(3, 400, Seed{4}, [&](Vector<double> const& psi, double y) {
        records.psi.col(k) = psi;
        records.y[k++] = y;
    });
    std::vector<std::int64_t> words;
    FixedEvents const events = fixed_events([&] {
        auto const filter = fold_all<QrBlock<V>>(problem_of<QrBlock<V>>(3, 1, 16), RowsInMemory(records), threads, 50);
        Matrix<V> const R = filter.stored().F;
        Vector<V> const theta = filter.theta();
        for (Index i = 0; i < R.size(); ++i) words.push_back(R(i).word());
        for (Index i = 0; i < 3; ++i) words.push_back(theta[i].word());
    });
    return {words, events};
}
TEST(Fixed, TheFormatAndTheCountsGoWithTheWorkToOtherThreads) {
    auto const [words, events] = folded(1);
    EXPECT_GT(events.peak, 0);
    EXPECT_NEAR(std::ldexp(double(words.back()), -20), 0.25,
                0x1p-8);  // truncation: up to half a unit of bias from each of 400 rows and more
    EXPECT_EQ(folded(3), folded(1));
}

}  // namespace
}  // namespace rlslab
