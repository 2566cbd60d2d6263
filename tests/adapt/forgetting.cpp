// Rules of forgetting: each keeps the law in its formula block, and what it says of P without excitation.
#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>

#include "tests/adapt/adapt.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace rlslab {
namespace {

using namespace adapt_laws;

constexpr double u = 0x1p-53;
double const zero[3] = {}, constant[3] = {1, 0.5, -2};

template <class F>
double trace_of(F f) {
    return trace(f);
}

TEST(ConstantForgetting, LeavesTheFiltersBits) {
    Forgetting<Ud<double, 3>, ConstantForgetting<double>> ruled({.forgetting = 0.96875});
    Ud<double, 3> bare({.forgetting = 0.96875});
    run_rows(ruled, 50, Seed{1});
    run_rows(bare, 50, Seed{1});
    EXPECT_TRUE(identical(ruled.filter(), bare));
}
TEST(Forgetting, IsAFilterAndHandsOnItsAbilities) {
    using Ruled = Forgetting<Ud<double, 3>, Fortescue<double>>;
    static_assert(RecursiveLeastSquares<Ruled> && TimeUpdates<Ruled> && Inflates<Ruled> && ReportsVariances<Ruled>);
    static_assert(!ForgettingRule<CaoSchwartz<double>, Symmetric<double, 3>>);  // psi'P^-1 psi would cost d^3
    static_assert(
        !ForgettingRule<Fortescue<double>, Guarded<Ud<double, 3>>>);  // would forget from a row that the guard skips
    static_assert(Guardable<Ruled>);
    EXPECT_THROW(Ruled({}, {.noise_variance = 0}), std::invalid_argument);
    EXPECT_THROW(Ruled({}, {.memory = NAN}), std::invalid_argument);
    EXPECT_THROW(Ruled({}, {.least = 1.5}), std::invalid_argument);
    EXPECT_THROW((Forgetting<Ud<double, 3>, Kulhavy<double>>({}, {.forgetting = 0})), std::invalid_argument);
    EXPECT_THROW((Forgetting<Ud<double, 3>, CaoSchwartz<double>>({}, {.least_excitation = -1})), std::invalid_argument);
    EXPECT_THROW((Forgetting<Ud<double, 3>, RotatingRidge<double>>({}, {.ridge = 0})), std::invalid_argument);
    EXPECT_THROW((Forgetting<Ud<double, 3>, CovarianceReset<double>>({}, {.period = 0})), std::invalid_argument);
    EXPECT_THROW((Forgetting<Ud<double, 3>, RandomWalk<double>>({}, {.variance = -1})), std::invalid_argument);
}

// --- Fortescue -------------------------------------------------------------------------------------------------------

/// The lambda of each row, read off D beside a copy that was not discounted.
template <class Rule>
struct Followed {
    Forgetting<Ud<double, 3>, Rule> filter;
    std::vector<double> lambdas = {}, y = {};
    std::vector<std::array<double, 3>> psi = {};

    void take(double const (&row)[3], double output) {
        Ud<double, 3> undiscounted = filter.filter();
        undiscounted.update(row, output);
        filter.update(row, output);
        lambdas.push_back(undiscounted.stored().D[0] / filter.stored().D[0]);
        psi.push_back({row[0], row[1], row[2]});
        y.push_back(output);
    }
    /// sum of the squares, each with the lambdas that came after it and its own; what is left of the prior is below
    /// 1e-12 by then.
    double cost() const {
        double sum = 0, weight = 1;
        Vector<double> const theta = filter.theta();
        for (size_t k = y.size(); k-- > 0;) {
            weight *= lambdas[k];
            double const e = y[k] - psi[k][0] * theta[0] - psi[k][1] * theta[1] - psi[k][2] * theta[2];
            sum += weight * e * e;
        }
        return sum;
    }
};
/// The relative distance of J from Sigma0, in 700 rows.
template <class Rule>
double distance_from(double sigma0, Rule const& rule, Seed seed) {
    Followed<Rule> f{.filter = Forgetting<Ud<double, 3>, Rule>({.prior = Prior<double>{.variance = 4}}, rule)};
    double psi[3];
    for (int k = 0; k < 1500; ++k) {
        double const y = draw(seed, psi);
        f.take(psi, y);
    }
    return std::abs(f.cost() / sigma0 - 1);
}
/// Fortescue, Kershenbaum & Ydstie's own first order of the rule.
struct FirstOrder : Fortescue<double> {
    template <class F, int N>
    Step<double> update(F& f, RuleMemory<double, N>& m, Regressor<double> psi, double y) const {
        Step<double> const step = f.update(psi, y);
        discount(f, std::max(least, 1 - step.innovation * step.residual / m.strength));
        return step;
    }
};
TEST(Fortescue, HoldsTheSumOfSquares) {
    Fortescue<double> const rule{.noise_variance = 0.005, .memory = 20, .least = 1e-3};
    for (unsigned seed : {71, 72, 73}) EXPECT_LT(distance_from(0.1, rule, Seed{seed}), 1e-9) << seed;
    FirstOrder first;
    static_cast<Fortescue<double>&>(first) = rule;
    EXPECT_GT(distance_from(0.1, first, Seed{71}), 1e-9);
}
TEST(Fortescue, ForgetsNothingWithoutAnError) {
    Forgetting<Ud<double, 3>, Fortescue<double>> f({});
    Ud<double, 3> bare({});
    double psi[3];
    Seed seed{5};
    for (int k = 0; k < 50; ++k) {
        draw(seed, psi);
        f.update(psi, 0);
        bare.update(psi, 0);
    }
    EXPECT_TRUE(identical(f.filter(), bare));
}
TEST(Fortescue, ForgetsAtOnceAfterAChangeAndNotForLong) {
    for (unsigned seed : {71, 72, 73}) {
        Followed<Fortescue<double>> f{.filter = Forgetting<Ud<double, 3>, Fortescue<double>>(
                                          {}, {.noise_variance = 0.02, .memory = 50, .least = 0.1})};
        Seed rows{seed};
        double psi[3];
        for (int k = 0; k < 800; ++k) {
            double const y = draw(rows, psi, 0.125, k < 500 ? 1 : -1);
            f.take(psi, y);
        }
        EXPECT_LT(f.lambdas[500], 0.5) << seed;
        EXPECT_LE(std::count_if(f.lambdas.begin() + 500, f.lambdas.end(), [](double lambda) { return lambda < 0.5; }),
                  6)
            << seed;
        for (double lambda : f.lambdas) EXPECT_GE(lambda, 0.1 * (1 - 8 * u));
    }
}
TEST(Fortescue, KeepsTheTraceBelowItsBoundInSilence) {
    auto const largest = [](double bound) {
        Forgetting<Ud<double, 3>, Fortescue<double>> f({.prior = Prior<double>{.variance = 1}},
                                                       {.noise_variance = 0.02, .memory = 20, .largest_trace = bound});
        run_rows(f, 100, Seed{3});
        Seed noise{4};
        double most = 0;
        for (int k = 0; k < 4000; ++k) {
            f.update(zero, 0.125 * noise.bell());
            most = std::max(most, trace_of(f.filter()));
        }
        return most;
    };
    EXPECT_LE(largest(300), 300 * (1 + 8 * u));
    EXPECT_GT(largest(0), 1e6);  // without the bound
}

// --- directional -----------------------------------------------------------------------------------------------------

/// u'X u before and after the loss along psi, for psi and for the direction in which the rule promises nothing is lost.
template <class F>
struct Lost {
    double along, beside, P_along;
};
template <class F, class Rule>
Lost<F> lost(Rule const& rule, bool before_the_row) {
    F filter({.prior = Prior<double>{.variance = 4}});
    run_rows(filter, 40, Seed{3});
    F measured = filter;
    double const psi[3] = {1, -0.5, 2};
    Vector<double> const a = Eigen::Map<Vector<double> const>(psi, 3);
    RuleMemory<double, 3> memory{.lambda = 1, .a = StateVector<double, 3>(3)};
    rule.update(filter, memory, psi, 1);
    measured.update(psi, 1);
    Matrix<double> const X1 = covariance_of(measured).inverse(), X2 = covariance_of(filter).inverse();
    Matrix<double> const X0 = before_the_row ? Matrix<double>(X1 - a * a.transpose()) : X1;
    Matrix<double> const X = before_the_row ? Matrix<double>(X2 - a * a.transpose()) : X2;
    Vector<double> const kept =
        before_the_row ? Vector<double>{{2, 0, 0}} : Vector<double>{{1, 2, 0}};  // psi'u = 0, or projected below
    Vector<double> v = kept;
    if (before_the_row) v -= a * (a.dot(X0 * kept) / a.dot(X0 * a));  // psi'X u = 0
    return {a.dot(X * a) / a.dot(X0 * a), v.dot(X * v) / v.dot(X0 * v),
            a.dot(X.inverse() * a) / a.dot(X0.inverse() * a)};
}
template <class F>
void check_directions() {
    auto const k = lost<F>(Kulhavy<double>{.forgetting = 0.8}, false);
    EXPECT_NEAR(k.P_along, 1 / 0.8, 1e-12) << F::name;
    EXPECT_NEAR(k.beside, 1, 1e-12) << F::name;
    if constexpr (ReportsInformationAlong<F>) {
        auto const c = lost<F>(CaoSchwartz<double>{.forgetting = 0.8}, true);
        EXPECT_NEAR(c.along, 0.8, 1e-12) << F::name;
        EXPECT_NEAR(c.beside, 1, 1e-12) << F::name;
        EXPECT_GT(std::abs(lost<F>(CaoSchwartz<double>{.forgetting = 0.81}, true).along - 0.8), 1e-12) << F::name;
    }
    EXPECT_GT(std::abs(lost<F>(Kulhavy<double>{.forgetting = 0.81}, false).P_along - 1 / 0.8), 1e-12) << F::name;
}
TEST(Directional, LosesAlongOneDirectionAndNoOther) {
    check_directions<Symmetric<double, 3>>();
    check_directions<Ud<double, 3>>();
    check_directions<InverseQr<double, 3>>();
    check_directions<Qr<double, 3>>();
    check_directions<Gentleman<double, 3>>();
}
TEST(Directional, BoundsTheEigenvaluesWhateverTheRows) {
    constexpr double phi = 0.9, eps = 1e-2;
    Forgetting<Ud<double, 3>, CaoSchwartz<double>> f({.prior = Prior<double>{.variance = 4}},
                                                     {.forgetting = phi, .least_excitation = eps});
    Seed seed{71};
    double longest = 0, least = INFINITY, most = 0;
    for (int k = 0; k < 20000; ++k) {
        double psi[3];
        double y = draw(seed, psi);
        if (k / 500 % 4 == 1) std::copy(constant, constant + 3, psi);
        if (k / 500 % 4 == 2) psi[0] *= 1e-6, psi[1] *= 1e-6, psi[2] *= 1e-6, y = 0.125 * seed.bell();
        double const square = psi[0] * psi[0] + psi[1] * psi[1] + psi[2] * psi[2];
        longest = std::max(longest, square);
        f.update(psi, y);
        if (k % 50 != 0) continue;
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> const P{Eigen::Matrix3d(covariance_of(f.filter()))};
        least = std::min(least, 1 / P.eigenvalues()[2]);
        most = std::max(most, 1 / P.eigenvalues()[0]);
    }
    EXPECT_GE(least, std::min(eps / (1 - phi), 0.25) * (1 - 1e-9));
    EXPECT_LE(most, (longest / (1 - phi)) * (1 + 1e-9));
}
TEST(Directional, WindsUpOnNoiseWithoutAFloorOfExcitation) {
    auto const trace_after = [](auto const& rule) {
        Forgetting<Ud<double, 3>, std::remove_cvref_t<decltype(rule)>> f({.prior = Prior<double>{.variance = 1}}, rule);
        Seed seed{3};
        run_rows(f, 300, seed);
        for (int k = 0; k < 4000; ++k)
            f.update({1e-6 * seed.bell(), 1e-6 * seed.bell(), 1e-6 * seed.bell()}, 0.1 * seed.bell());
        return trace_of(f.filter());
    };
    EXPECT_GT(trace_after(Kulhavy<double>{.forgetting = 0.95}), 1e6);
    EXPECT_LT(trace_after(Kulhavy<double>{.forgetting = 0.95, .least_excitation = 1e-4}), 1);
    EXPECT_LT(trace_after(CaoSchwartz<double>{.forgetting = 0.95, .least_excitation = 1e-4}), 1);
}

// --- ridge, reset, walk ----------------------------------------------------------------------------------------------

/// Without a prior: NaN until the rows determine theta, then theta; the bits of a rule that had waited for that.
template <class F, class Rule>
void check_without_prior(Rule const& rule, char const* what) {
    Forgetting<F, Rule> f({.forgetting = 0.98, .prior = std::nullopt}, rule);
    Seed seed{74};
    double psi[3];
    Health last = Health::nonfinite;
    for (int k = 0; k < 50; ++k) {
        double const y = draw(seed, psi, 0);
        last = f.update(psi, y).health;
        EXPECT_EQ(last, k < 3 ? Health::undetermined : Health::sound) << F::name << what << k;
    }
    EXPECT_LT((Vector<double>(f.theta()) - Vector<double>{{1, -2, 3}}).norm(), 1e-3) << F::name << what;
}
TEST(Rules, WaitUntilTheRowsDetermineTheta) {
    for_each(TypeList<Qr<double, 3>, Information<double, 3>, Gentleman<double, 3>>{}, []<class F>() {
        check_without_prior<F>(RotatingRidge<double>{}, " ridge ");
        check_without_prior<F>(CovarianceReset<double>{.period = 1}, " reset at each row ");
        check_without_prior<F>(CovarianceReset<double>{.period = 2}, " reset ");
        check_without_prior<F>(Kulhavy<double>{}, " kulhavy ");
        check_without_prior<F>(CaoSchwartz<double>{}, " cao ");
        check_without_prior<F>(RandomWalk<double>{.variance = 1e-6}, " walk ");
    });
}

template <class F>
void check_ridge() {
    constexpr double lambda = 0.95, rho = 0.5;
    Forgetting<F, RotatingRidge<double>> f({.forgetting = lambda, .prior = Prior<double>{.variance = 1}},
                                           {.ridge = rho});
    Seed seed{71};
    double psi[3], most = 0;
    for (int k = 0; k < 6000; ++k) {
        double const y = draw(seed, psi);
        if (k < 300) f.update(psi, y);
        else if (k < 2000) f.update(constant, 1 + 0.1 * seed.bell());
        else if (k < 4000) f.update({1e-6 * psi[0], 1e-6 * psi[1], 1e-6 * psi[2]}, 0.1 * seed.bell());
        else f.update(zero, 0.1 * seed.bell());
        F copy = f.filter();
        if (k >= 3) most = std::max(most, trace(copy));
    }
    EXPECT_LE(most, 3 / (rho * lambda * lambda) * (1 + 1e-9)) << F::name;
    F silent = f.filter();
    for (int j = 0; j < 3; ++j)  // row 5999 visited coordinate 2
        EXPECT_NEAR(variance(silent, j) * rho * std::pow(lambda, 2 - j), 1, 1e-12) << F::name;
    F exponential({.forgetting = lambda, .prior = Prior<double>{.variance = 1}});
    for (int k = 0; k < 2000; ++k) exponential.update(zero, 0);
    EXPECT_GT(trace(exponential), 1e40) << F::name;
}
TEST(RotatingRidge, HoldsItsFloorWhateverTheRows) {
    check_ridge<Ud<double, 3>>();
    check_ridge<Qr<double, 3>>();
}
TEST(RotatingRidge, ThatIsProximalChangesNoBitOfTheta) {
    Forgetting<Ud<double, 3>, RotatingRidge<double>> kept({.forgetting = 0.95}, {.ridge = 0.5});
    Forgetting<Ud<double, 3>, RotatingRidge<double>> leaking({.forgetting = 0.95}, {.ridge = 0.5, .toward_zero = true});
    run_rows(kept, 100, Seed{3});
    run_rows(leaking, 100, Seed{3});
    Vector<double> const before = kept.theta(), leaked = leaking.theta();
    for (int k = 0; k < 100; ++k) kept.update(zero, 1), leaking.update(zero, 1);
    EXPECT_EQ(Vector<double>(kept.theta()), before);
    EXPECT_LT(leaking.theta().norm(), 0.5 * leaked.norm());
}
TEST(CovarianceReset, KeepsThetaAndBoundsP) {
    Forgetting<Ud<double, 3>, CovarianceReset<double>> f({.prior = Prior<double>{.variance = 1}},
                                                         {.period = 50, .variance = 2});
    Ud<double, 3> bare({.prior = Prior<double>{.variance = 1}});
    run_rows(f, 50, Seed{3});
    run_rows(bare, 50, Seed{3});
    EXPECT_EQ(Vector<double>(f.theta()), Vector<double>(bare.theta()));
    EXPECT_EQ(covariance_of(f), Matrix<double>(2 * Matrix<double>::Identity(3, 3)));
    EXPECT_LT(trace_of(bare), 1);
}
TEST(RandomWalk, AddsQOverEachRound) {
    Forgetting<Ud<double, 3>, RandomWalk<double>> f({.prior = Prior<double>{.variance = 2}}, {.variance = 0.25});
    for (int k = 0; k < 30; ++k) f.update(zero, 1);
    EXPECT_LE(relative(covariance_of(f), Matrix<double>((2 + 30 * 0.25) * Matrix<double>::Identity(3, 3))), 4 * u);
}
/// P of one coordinate a row beside P of the full Q, on the same rows.
TEST(RandomWalk, StaysBesideTheFullWalk) {
    for (unsigned seed : {71, 72, 73}) {
        constexpr double q = 1e-3;
        Problem<double> const problem{.size = 5, .prior = Prior<double>{.variance = 1}};
        Forgetting<Ud<double, 5>, RandomWalk<double>> rotating(problem, {.variance = q});
        Kalman<double, 5> full(problem, Matrix<double>(q * Matrix<double>::Identity(5, 5)));
        Seed rows{seed};
        double psi[5], furthest = 0;
        for (int k = 0; k < 2000; ++k) {
            double const y = draw(rows, psi);
            rotating.update(psi, y);
            full.update(psi, y);
            if (k > 300) furthest = std::max(furthest, relative(covariance_of(rotating), covariance_of(full)));
        }
        EXPECT_LE(furthest, 0.15) << seed;
        EXPECT_GT(furthest, 1e-3) << seed;
    }
}
/// One parameter, psi = 1: the variance before a row becomes (q + sqrt(q^2 + 4 q)) / 2.
TEST(RandomWalk, HasTheSteadyStateOfTheKalmanFilter) {
    for (double q : {1e-4, 1e-2, 1.0}) {
        Forgetting<Qr<double, 1>, RandomWalk<double>> f({}, {.variance = q});
        for (int k = 0; k < 5000; ++k) f.update({1.0}, 0);
        double const before = (q + std::sqrt(q * q + 4 * q)) / 2;
        Qr<double, 1> copy = f.filter();
        EXPECT_NEAR(variance(copy, 0) / (before / (1 + before)), 1, 1e-12) << q;
    }
}

}  // namespace
}  // namespace rlslab
