// A guarded filter: which signal fires on which fault, and that none does on clean rows.
#include <rlslab/adapt/guard.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;

constexpr double lambda = 0.98;
Problem<double> const problem{.forgetting = lambda, .prior = Prior<double>{.variance = 100}};

template <class F, GuardPolicy policy = resetting>
Guarded<F, policy> warm(int rows = 500, unsigned seed = 71) {
    Guarded<F, policy> g(problem);
    run_rows(g, rows, Seed{seed});
    return g;
}

// --- no signal -------------------------------------------------------------------------------------------------------

template <class F>
void check_clean() {
    using T = typename F::scalar;
    Problem<T> const same{.forgetting = T(lambda), .prior = Prior<T>{.variance = 100}};
    Guarded<F> guarded(same);
    F bare(same);
    run_rows(guarded, 20000, Seed{72});
    run_rows(bare, 20000, Seed{72});
    auto const& n = guarded.counts();
    EXPECT_EQ(n.rows, 20000);
    EXPECT_EQ(n.unusable + n.outliers + n.changes + n.windups + n.breakdowns, 0) << F::name;
    EXPECT_TRUE(identical(guarded.filter(), bare)) << F::name;
    EXPECT_NEAR(double(guarded.noise_variance()) / 0.015625, 1, 0.5) << F::name;
}
TEST(Guarded, LeavesTheFiltersBitsOnCleanRows) {
    check_clean<Ud<double, 4>>();
    check_clean<Ud<float, 4>>();
    check_clean<JosephRankTwo<double, 4>>();
    check_clean<Qr<double, 4>>();
}
/// An outlier in each hundred rows: all are seen, and nothing else is.
void check_memory(Index noise_memory) {
    Guarded<Ud<double, 4>> g(problem, {.noise_memory = noise_memory});
    Seed seed{73};
    double psi[4];
    for (int k = 0; k < 2000; ++k) {
        double const y = draw(seed, psi);
        g.update(psi, y + (k % 100 == 99 && k > 1000 ? 50 : 0));
    }
    EXPECT_NEAR(std::log2(g.noise_variance() / 0.015625), 0, 1)
        << noise_memory;  // as far off as the median of 60 numbers may be
    EXPECT_EQ(g.counts().outliers, 10) << noise_memory;
    EXPECT_EQ(g.counts().changes, 0) << noise_memory;
}
TEST(Guarded, RemembersTheNoiseOverAnyNumberOfRows) {
    check_memory(200);
    check_memory(std::numeric_limits<int>::max());
    check_memory(Index{1} << 32);
    check_memory(std::numeric_limits<Index>::max());
}
TEST(Guarded, RefusesOptionsThatMakeNoSense) {
    using G = Guarded<Ud<double, 4>>;
    EXPECT_THROW(G(problem, {.largest_variance = -1}), std::invalid_argument);
    EXPECT_THROW(G(problem, {.innovation = NAN}), std::invalid_argument);
    EXPECT_THROW(G(problem, {.noise_memory = 0}), std::invalid_argument);
    EXPECT_THROW(G(problem, {.asymmetry = 0}), std::invalid_argument);
    EXPECT_THROW(G({.size = 3}), std::invalid_argument);
    static_assert(!GuardPolicy{.outlier = Action::reset}.valid() && !GuardPolicy{.breakdown = Action::skip}.valid());
}

// --- data that are not usable ----------------------------------------------------------------------------------------

template <class F>
void check_unusable() {
    auto g = warm<F>();
    auto const before = g.filter();
    for (double bad : {double(NAN), double(INFINITY), -double(INFINITY), 0x1p600}) {
        EXPECT_EQ(g.update({1.0, bad, 0.0, 0.0}, 1.0).health, Health::nonfinite);
        EXPECT_EQ(g.signal(), GuardSignal::unusable);
        EXPECT_EQ(g.update({1.0, 0.0, 0.0, 0.0}, bad).health, Health::nonfinite);
    }
    EXPECT_TRUE(identical(g.filter(), before)) << F::name;
    EXPECT_EQ(g.counts().unusable, 8);
    EXPECT_EQ(g.update({1.0, 0.0, 0.0, 0.0}, 1.0).health, Health::sound) << F::name;
}
TEST(Guarded, NeverShowsTheFilterWhatIsNotFinite) {
    check_unusable<Ud<double, 4>>();
    check_unusable<Qr<double, 4>>();
    Ud<double, 4> bare(problem);  // for ever
    bare.update({1.0, NAN, 0.0, 0.0}, 1.0);
    run_rows(bare, 500, Seed{1});
    EXPECT_TRUE(std::isnan(bare.theta()[0]));
}
/// Also where P is indefinite and s negative; and in a format that only the run knows the range is that format's.
TEST(Guarded, NeverShowsTheFilterWhatIsOutOfRange) {
    auto g = warm<Conventional<double, 4>, reporting>();
    g.form().P(1, 1) = -1e-3;
    EXPECT_EQ(g.update({0.0, 1e200, 0.0, 0.0}, 1.0).health, Health::nonfinite);
    EXPECT_EQ(g.signal(), GuardSignal::unusable);
    PrecisionScope const precision(RunTimeFormat{binary16});
    using T = VariablePrecision;
    Guarded<Ud<T, 1>, reporting> of_the_run({.size = 1, .prior = Prior<T>{.variance = T(1)}});
    of_the_run.update({T(1000)}, T(1));
    EXPECT_EQ(of_the_run.signal(), GuardSignal::unusable);
}
/// Scales far from 1, against the model: what the squares of the arithmetic cannot hold is kept out; what it took for
/// data is forgotten as lambda^k, ln(2^500) / 0.02 = 17 000 rows at most.
TEST(Guarded, SurvivesEveryScale) {
    for (int e = -1070; e <= 1020; e += 55) {
        auto g = warm<Ud<double, 4>>();
        double const x = std::ldexp(1.0, e);
        for (int k = 0; k < 20; ++k) g.update({k % 4 == 0 ? x : 0, k % 4 == 1 ? -x : 0, x, 0.0}, k % 2 ? x : 1.0);
        run_rows(g, 20000, Seed{5});
        EXPECT_TRUE(g.theta().allFinite()) << e;
        EXPECT_NEAR(g.theta()[1], -2, 0.2) << e;
    }
}
/// The form whose asymmetry grows as lambda^-k (docs/theory.md 28): reported every thousand rows, and reset.
TEST(Guarded, KeepsTheConventionalFormAlive) {
    Conventional<double, 4> bare(problem);
    run_rows(bare, 20000, Seed{72});
    EXPECT_FALSE((covariance_of(bare) - covariance_of(bare).transpose()).cwiseAbs().maxCoeff() < 1);
    auto g = warm<Conventional<double, 4>>(20000, 72);
    EXPECT_GT(g.counts().breakdowns, 5);
    EXPECT_LT(g.counts().breakdowns, 30);
    EXPECT_EQ(g.counts().outliers + g.counts().changes + g.counts().unusable, 0);
    EXPECT_NEAR(g.theta()[1], -2, 0.2);
}

// --- the innovation test ---------------------------------------------------------------------------------------------

TEST(Guarded, SkipsOneOutlierAndSaysSo) {
    for (unsigned seed : {71, 72, 73}) {
        auto g = warm<Ud<double, 4>>(500, seed);
        auto const before = g.filter();
        double psi[4];
        Seed rows{seed + 100};
        double const y = draw(rows, psi);
        g.update(psi, y + 1e6 * 0.125);
        EXPECT_EQ(g.signal(), GuardSignal::outlier);
        EXPECT_EQ(g.counts().outliers, 1);
        EXPECT_TRUE(identical(g.filter(), before));
        auto watched = warm<Ud<double, 4>, reporting>(500, seed);
        watched.update(psi, y + 1e6 * 0.125);
        EXPECT_EQ(watched.signal(), GuardSignal::outlier);
        EXPECT_GT((watched.theta() - before.theta()).norm(), 100);
    }
}
/// At c standard deviations of the innovation, s that of the filter's own P: a millionth less passes, a millionth more
/// does not.
template <class F>
void check_threshold() {
    using T = typename F::scalar;
    Problem<T> const same{.forgetting = T(lambda), .prior = Prior<T>{.variance = 100}};
    T const c = 6, part = std::same_as<T, float> ? T(1e-3) : T(1e-6);
    for (unsigned seed : {71, 72, 73}) {
        Guarded<F, reporting> g(same);
        run_rows(g, 500, Seed{seed});
        Seed rows{seed + 100};
        T psi[4];
        draw(rows, psi);
        F filter = g.filter();
        auto const [e, s] = detail::look_at(filter, Regressor<T>(psi, 4), T(0));
        F after = filter;
        EXPECT_NEAR(double(T(lambda) / s), double(after.update(psi, T(0)).gamma), 1e-4) << F::name;
        T const edge = c * std::sqrt(g.noise_variance() * s / T(lambda));
        for (T side : {T(-1), T(1)}) {
            auto inside = g, beyond = g;
            inside.update(psi, side * edge * (T(1) - part) - e);
            beyond.update(psi, side * edge * (T(1) + part) - e);
            EXPECT_EQ(inside.signal(), GuardSignal::none) << F::name << seed;
            EXPECT_EQ(beyond.signal(), GuardSignal::outlier) << F::name << seed;
        }
    }
}
TEST(Guarded, TestsTheInnovationAgainstItsOwnVariance) {
    for_each(TypeList<Conventional<double, 4>, Symmetric<double, 4>, Potter<double, 4>, Ud<double, 4>, Ud<float, 4>,
                      InverseQr<double, 4>, Information<double, 4>, Qr<double, 4>, Gentleman<double, 4>>{},
             []<class F>() { check_threshold<F>(); });
}
/// Exact data, whose innovations are rounding alone: rows of another size are no outliers.
TEST(Guarded, AllowsForRoundingWhereThereIsNoNoise) {
    Guarded<Ud<double, 4>> g(problem);
    Seed rows{71};
    double psi[4];
    for (int k = 0; k < 3000; ++k) {
        draw(rows, psi, 0);
        double const unit = k < 1000 ? 1 : k % 2 ? 1000 : 0.001;
        double y = 0;
        for (int i = 0; i < 4; ++i) psi[i] *= unit, y += psi[i] * (i % 2 ? -(i + 1) / 3.0 : (i + 1) / 3.0);
        g.update(psi, y);
    }
    EXPECT_EQ(g.counts().outliers + g.counts().changes, 0);
}
/// Largest error of theta in 5000 rows, one in twenty of them 100 standard deviations off; from row 500 on.
template <GuardPolicy policy>
std::pair<double, Index> with_outliers(unsigned seed, double share) {
    Guarded<Ud<double, 4>, policy> g(problem);
    Seed rows{seed};
    double psi[4], sum = 0;
    for (int k = 0; k < 5000; ++k) {
        double y = draw(rows, psi);
        if (k > 100 && rows.uniform() < share) y += 12.5 * rows.bell();
        g.update(psi, y);
        if (k >= 500)
            for (int i = 0; i < 4; ++i) sum += std::pow(g.theta()[i] - (i % 2 ? -(i + 1) : i + 1), 2);
    }
    return {std::sqrt(sum), g.counts().changes};
}
TEST(Guarded, LosesLittleToOneOutlierInTwenty) {
    for (unsigned seed : {71, 72, 73}) {
        auto const [clean, no_change] = with_outliers<resetting>(seed, 0);
        auto const [guarded, changes] = with_outliers<resetting>(seed, 0.05);
        EXPECT_LT(guarded, 2 * clean) << seed;
        EXPECT_EQ(no_change + changes, 0) << seed;
        EXPECT_GT(with_outliers<reporting>(seed, 0.05).first, 5 * clean) << seed;
    }
}
/// Rows until theta is within 1/2 of its new value after a change of sign.
template <GuardPolicy policy>
int rows_to_recover(unsigned seed) {
    auto g = warm<Ud<double, 4>, policy>(500, seed);
    Seed rows{seed + 7};
    double psi[4];
    for (int k = 1; k < 2000; ++k) {
        double const y = draw(rows, psi, 0.125, -1);
        g.update(psi, y);
        if (std::abs(g.theta()[1] - 2) < 0.5 && std::abs(g.theta()[3] - 4) < 0.5) return k;
    }
    return 2000;
}
TEST(Guarded, TakesAChangeForAChange) {
    for (unsigned seed : {71, 72, 73}) {
        EXPECT_LE(rows_to_recover<resetting>(seed), 20) << seed;
        EXPECT_GT((rows_to_recover<GuardPolicy{.outlier = Action::skip}>(seed)), 1000)
            << seed;  // what skipping alone makes of it
    }
}

// --- windup ----------------------------------------------------------------------------------------------------------

TEST(Guarded, CapsWindupAndMovesNoBitOfTheta) {
    auto g = warm<Ud<double, 4>>();
    Vector<double> const before = g.theta();
    double most = 0;
    for (int k = 0; k < 20000; ++k) {
        g.update({0.0, 0.0, 0.0, 0.0}, 0.1);
        if (k % 100 == 0) most = std::max(most, covariance_of(g.filter()).diagonal().maxCoeff());
    }
    EXPECT_EQ(Vector<double>(g.theta()), before);
    EXPECT_LE(most, 1600 * std::pow(lambda, -4) * (1 + 1e-12));
    EXPECT_GT(g.counts().windups, 0);
    auto watched = warm<Ud<double, 4>, reporting>();
    for (int k = 0; k < 20000; ++k) watched.update({0.0, 0.0, 0.0, 0.0}, 0.1);
    EXPECT_GT(covariance_of(watched.filter()).maxCoeff(), 1e100);
    EXPECT_GT(watched.counts().windups, 10000);
}

/// From a factor of P^-1 the variance of theta_j is that where the later ones are known, at most P_jj; a cap sets it.
template <class F>
void check_windup_of_information() {
    auto watched = warm<F, reporting>();
    for (Index j = 0; j < 4; ++j)
        EXPECT_LE(watched_variance(watched, j), variance(watched, j) * (1 + 1e-12)) << F::name << j;
    EXPECT_NEAR(watched_variance(watched, 3) / variance(watched, 3), 1, 1e-12) << F::name;
    auto g = warm<F>();
    Vector<double> const before = g.theta();
    double most = 0;
    for (int k = 0; k < 20000; ++k) {
        g.update({0.0, 0.0, 0.0, 0.0}, 0.1);
        watched.update({0.0, 0.0, 0.0, 0.0}, 0.1);
        for (Index j = 0; j < 4; ++j) most = std::max(most, watched_variance(g, j));
    }
    EXPECT_LE((Vector<double>(g.theta()) - before).norm(), 1e-6) << F::name;
    EXPECT_LE(most, 1600 * std::pow(lambda, -4) * (1 + 1e-9)) << F::name;
    EXPECT_GT(g.counts().windups, 0) << F::name;
    EXPECT_GT(watched.counts().windups, 10000) << F::name;
}
/// In binary16 R_jj = 335 has a square that overflows, and P_jj = 8.9e-6 is a number.
TEST(Guarded, KnowsAFactorWhoseSquareOverflowsForSound) {
    Guarded<Qr<Half, 4>, reporting> g({.forgetting = Half(0.999), .prior = Prior<Half>{.variance = Half(100)}});
    Seed rows{71};
    double x[4];
    for (int k = 0; k < 3000; ++k) {
        Half const y(draw(rows, x));
        g.update({Half(10 * x[0]), Half(10 * x[1]), Half(10 * x[2]), Half(10 * x[3])}, y);
    }
    EXPECT_GT(double(g.filter().stored().F(0, 0)), 256);
    EXPECT_EQ(g.counts().breakdowns, 0);
}
TEST(Guarded, CapsWindupOfAFactorOfTheInformation) {
    check_windup_of_information<Qr<double, 4>>();
    check_windup_of_information<Gentleman<double, 4>>();
}

// --- breakdown -------------------------------------------------------------------------------------------------------

/// Rows until a fault that is done to the state is reported, at most 100; whether theta is right again 200 rows later.
template <class F, GuardPolicy policy, class Damage>
std::pair<int, bool> told_after(Damage damage) {
    auto g = warm<F, policy>();
    damage(g.form());
    Seed rows{9};
    double psi[4];
    int told = 100;
    for (int k = 1; k <= 300; ++k) {
        double const y = draw(rows, psi);
        g.update(psi, y);
        if (told == 100 && g.counts().breakdowns > 0) told = k;
    }
    return {told, std::abs(g.theta()[0] - 1) < 0.2 && std::abs(g.theta()[3] + 4) < 0.2};
}
TEST(Guarded, TellsOfAStateThatBroke) {
    auto const flip = [](auto form) { form.P(1, 1) = -form.P(1, 1); };
    auto const skew = [](auto form) { form.P(0, 2) += 0.5 * form.P(0, 0), form.P(2, 0) -= 0.5 * form.P(0, 0); };
    auto const lose = [](auto form) { form.D[2] = NAN; };
    auto const negative = [](auto form) { form.D[3] = -form.D[3]; };
    auto const singular = [](auto form) { form.L(2, 2) = 0; };
    auto const check = [](auto told, bool repaired) {
        EXPECT_LE(told.first, 5);
        EXPECT_TRUE(!repaired || told.second);
    };
    check(told_after<Conventional<double, 4>, resetting>(flip), true);
    check(told_after<Conventional<double, 4>, rebuilding>(flip), true);
    check(told_after<Conventional<double, 4>, reporting>(flip), false);
    check(told_after<Conventional<double, 4>, resetting>(skew), true);
    check(told_after<Ud<double, 4>, resetting>(lose), true);
    check(told_after<Ud<double, 4>, rebuilding>(lose), true);
    check(told_after<Ud<double, 4>, resetting>(negative), true);
    check(told_after<Qr<double, 4>, resetting>(singular), true);
    EXPECT_FALSE((told_after<Ud<double, 4>, reporting>(lose).second));
}

/// All pairs of P are looked at in d^2/2 rows: what is skew by more than the share is a breakdown, what is by less is
/// not.
TEST(Guarded, LooksAtEachPairOfP) {
    for (Index j = 1; j < 4; ++j)
        for (Index i = 0; i < j; ++i)
            for (double part : {0.5, 2.0}) {
                auto g = warm<Conventional<double, 4>, reporting>();
                auto& P = g.form().P;
                double const skew = part / 1024 * std::sqrt(P(i, i) * P(j, j));
                P(i, j) += skew / 2;
                P(j, i) -= skew / 2;
                for (int k = 0; k < 8; ++k) g.update({0.0, 0.0, 0.0, 0.0}, 0.0);
                EXPECT_EQ(g.counts().breakdowns > 0, part > 1) << i << ' ' << j;
            }
}

// --- compositions ----------------------------------------------------------------------------------------------------

TEST(Guarded, IsAFilterAroundAFilterWithARule) {
    using Ruled = Forgetting<Ud<float, 4>, RotatingRidge<float>>;
    static_assert(RecursiveLeastSquares<Guarded<Ruled>> && TimeUpdates<Guarded<Ruled>>);
    Guarded<Ruled> g({.forgetting = float(lambda), .prior = Prior<float>{.variance = 1}});
    run_rows(g, 300, Seed{3});
    for (int k = 0; k < 5000; ++k) g.update({0.0f, 0.0f, NAN, 0.0f}, 1.0f);
    for (int k = 0; k < 5000; ++k) g.update({0.0f, 0.0f, 0.0f, 0.0f}, 1.0f);
    run_rows(g, 300, Seed{4});
    EXPECT_NEAR(g.theta()[3], -4, 0.2);
    EXPECT_EQ(g.counts().unusable, 5000);
}

// --- what other libraries' guards do, and this one does not ----------------------------------------------------------

/// A guard elsewhere limits how fast tr P falls by scaling P itself: from P0 = 100 I, lambda = 0.995, a first regressor
/// with one entry leaves
/// P_00 = -8, and dense ones an indefinite P in a quarter of the runs at two parameters.
template <int n>
void check_definite() {
    for (unsigned seed = 0; seed < 50; ++seed) {
        Guarded<Conventional<double, n>> g({.forgetting = 0.995, .prior = Prior<double>{.variance = 100}});
        Seed rows{seed};
        double psi[n] = {1};
        for (int k = 0; k < 100; ++k) {
            double const y = k == 0 && seed == 0 ? 1 : draw(rows, psi);
            g.update(psi, y);
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const P{Eigen::MatrixXd(covariance_of(g))};
            EXPECT_GT(P.eigenvalues()[0], 0) << n << " parameters, seed " << seed << ", row " << k;
        }
    }
}
TEST(Guarded, NeverMakesPIndefinite) {
    check_definite<1>();
    check_definite<2>();
    check_definite<4>();
    check_definite<8>();
}
/// Elsewhere weights are read that no step has written yet, and lambda = 0 is taken.
TEST(Guarded, AnswersBeforeTheFirstRowAndRefusesLambdaZero) {
    Vector<double> const theta0{{1.0, -2.0, 3.0, 0.5}};
    Problem<double> const from{.prior = Prior<double>{.theta = theta0}};
    EXPECT_EQ(Vector<double>(Guarded<Ud<double, 4>>(from).theta()), theta0);
    EXPECT_EQ(Vector<double>(Windowed<Ud<double, 4>>(from).theta()), theta0);
    EXPECT_EQ(Vector<double>((Forgetting<Ud<double, 4>, Fortescue<double>>(from).theta())), theta0);
    EXPECT_THROW((Guarded<Ud<double, 4>>({.forgetting = 0})), std::invalid_argument);
    EXPECT_THROW((Windowed<Ud<double, 4>>({.forgetting = 0})), std::invalid_argument);
    EXPECT_THROW((Forgetting<Ud<double, 4>, Fortescue<double>>({.forgetting = 0})), std::invalid_argument);
}

/// Other units of psi by a power of two, with the prior in these units: the same signals, theta scaled exactly.
TEST(Guarded, KnowsNoUnits) {
    for (int e : {-40, -3, 8, 60}) {
        double const unit = std::ldexp(1.0, e);
        Guarded<Ud<double, 4>> one(problem);
        Guarded<Ud<double, 4>> other({.forgetting = lambda, .prior = Prior<double>{.variance = 100 / (unit * unit)}});
        Seed rows{71};
        double psi[4], scaled[4];
        for (int k = 0; k < 3000; ++k) {
            double y = draw(rows, psi, 0.125, k < 2500 ? 1 : -1);
            if (k % 400 == 200) y += 1000;
            for (int i = 0; i < 4; ++i) {
                if (k / 300 % 3 == 2) psi[i] = 0;
                scaled[i] = unit * psi[i];
            }
            one.update(psi, y);
            other.update(scaled, y);
            EXPECT_EQ(one.signal(), other.signal()) << e << ": " << k;
        }
        EXPECT_EQ(Vector<double>(one.theta()), Vector<double>(unit * other.theta())) << e;
        EXPECT_GT(one.counts().outliers, 0);
        EXPECT_GT(one.counts().windups, 0);
    }
}

}  // namespace
}  // namespace rlslab
