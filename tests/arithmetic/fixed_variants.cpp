// The dense variants in fixed point: digits, overflow as a breakdown, formats and counts over threads.
#include <rlslab/many/fold_all.hpp>
#include <rlslab/arithmetic/fixed.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using V = VariableFixed;

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
