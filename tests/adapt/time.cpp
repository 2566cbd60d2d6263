// Discount, inflation, reset and removal: each does to P, theta and X what its line says, in every form that offers it.
#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/remove.hpp>
#include <rlslab/adapt/forgetting.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using namespace adapt_laws;

constexpr double u = 0x1p-53;

/// The forms, one filter of each; symmetric and conventional share one.
void for_each_form(auto law) {
    for_each(
        TypeList<Conventional<double, 4>, JosephRankTwo<double, 4>, Potter<double, 4>, Carlson<double, 4>,
                 Ud<double, 4>, InverseQr<double, 4>, Qr<double, 4>, Gentleman<double, 4>, Information<double, 4>>{},
        law);
}
template <class F>
F warm(double lambda = 0.96875) {
    F f({.forgetting = lambda, .prior = Prior<double>{.variance = 4}});
    run_rows(f, 40, Seed{3});
    return f;
}
template <class F>
constexpr bool keeps_theta = !ReportsInformation<F>;

// The budgets: X is read off a factor, or inverted, at a condition number below 100; a law's own roundings are a few u
// of max |P|.
constexpr double budget = 2000 * u;

// --- discount --------------------------------------------------------------------------------------------------------

/// How far P is from P_before / lambda; infinite where a stored theta changed a bit.
template <class F, class Operation>
double discount_error(Operation operation, double lambda) {
    F f = warm<F>();
    Matrix<double> const P = covariance_of(f);
    Vector<double> const theta = f.theta();
    operation(f, lambda);
    double const moved = (f.theta() - theta).cwiseAbs().maxCoeff();
    if (moved > (keeps_theta<F> || lambda == 1.0 / 16 ? 0 : budget)) return INFINITY;
    return relative(covariance_of(f), Matrix<double>(P / lambda));
}
TEST(Discount, DividesPAndLeavesTheta) {
    for_each_form([]<class F>() {
        for (double lambda : {0.99, 0.5, 1.0 / 16, 1.0}) {
            EXPECT_LE(discount_error<F>([](F& f, double l) { discount(f, l); }, lambda), budget) << F::name << lambda;
        }
        EXPECT_GT(discount_error<F>([](F& f, double l) { discount(f, l * l); }, 0.99), budget) << F::name;
        EXPECT_GT(discount_error<F>(
                      [](F& f, double l) {
                          discount(f, l);
                          f.update(Vector<double>(Vector<double>::Constant(4, 1e-3)), 1);
                      },
                      0.99),
                  budget)
            << F::name;
    });
}
TEST(Discount, OfAGapIsThatOfItsTicks) {
    for_each_form([]<class F>() {
        F gap = warm<F>(), ticks = gap;
        discount(gap, std::pow(0.96875, 8));
        for (int k = 0; k < 8; ++k) ticks.update(Vector<double>(Vector<double>::Zero(4)), 0);
        EXPECT_LE(relative(covariance_of(gap), covariance_of(ticks)), budget) << F::name;
    });
}

/// The same lambda at each row leaves the same bits, one's own or another's.
template <class F, class Operation>
bool setting_lambda_is_having_it(Operation operation) {
    F given = warm<F>(0.875), set({.forgetting = 0.5, .prior = Prior<double>{.variance = 4}});
    operation(set, 0.875);
    run_rows(set, 40, Seed{3});
    return identical(given, set);
}
TEST(Forgetting, IsSetBitForBit) {
    for_each_form([]<class F>() {
        EXPECT_TRUE(setting_lambda_is_having_it<F>([](F& f, double l) { set_forgetting(f, l); })) << F::name;
        EXPECT_FALSE(setting_lambda_is_having_it<F>([](F& f, double l) { set_forgetting(f, l + 4 * u); })) << F::name;
    });
}

// --- inflation -------------------------------------------------------------------------------------------------------

double const direction[] = {1, -0.5, 2, 0.25};

/// How far P is from P_before + c a a'; infinite where theta moved or a pivot is not positive.
template <class F, class Operation>
double inflation_error(Operation operation, double c) {
    F f = warm<F>();
    Matrix<double> P = covariance_of(f);
    Vector<double> const theta = f.theta(), a = Eigen::Map<Vector<double> const>(direction, 4);
    operation(f, c);
    P += c * a * a.transpose();
    if ((f.theta() - theta).cwiseAbs().maxCoeff() > (keeps_theta<F> || c == 0 ? 0 : budget * (1 + c))) return INFINITY;
    for (Index j = 0; j < 4; ++j)
        if (!(variance(f, j) > 0)) return INFINITY;
    return relative(covariance_of(f), P);
}
template <class F>
void check_inflation() {
    if constexpr (Inflates<F>) {
        auto const right = [](F& f, double c) { inflate(f, c, direction); };
        for (double c : {1e-3, 1.0, 1e3}) EXPECT_LE(inflation_error<F>(right, c), budget * (1 + c)) << F::name << c;
        EXPECT_GT(inflation_error<F>([](F& f, double c) { inflate(f, c * (1 + 1e-9), direction); }, 1.0), budget)
            << F::name;
        F f = warm<F>(), same = f;
        inflate(f, 0.0, direction);
        EXPECT_TRUE(identical(f, same)) << F::name;
        auto const K = f.gain();
        Matrix<double> const P = covariance_of(f);
        Vector<double> const a = K;
        inflate(f, 2.0, K);  // its own
        EXPECT_LE(relative(covariance_of(f), Matrix<double>(P + 2 * a * a.transpose())), budget) << F::name;
    } else {
        EXPECT_EQ(F::name, "potter");
    }
}
TEST(Inflate, AddsARankOneTermAndLeavesTheta) {
    for_each_form([]<class F>() { check_inflation<F>(); });
}
TEST(Inflate, KeepsASymmetricPSymmetric) {
    auto f = warm<Symmetric<double, 4>>();
    inflate(f, 0.1, direction);
    EXPECT_EQ(covariance_of(f), Matrix<double>(covariance_of(f).transpose()));
    remove(f, Regressor<double>(direction, 4), 1.0, 1e-3);
    EXPECT_EQ(covariance_of(f), Matrix<double>(covariance_of(f).transpose()));
}
TEST(Symmetry, IsHeldAgainstTheRootOfBothVariances) {
    auto f = warm<Conventional<double, 4>>();
    auto& P = f.form().P;
    P(1, 1) = 4;
    P(2, 2) = 9;
    P(1, 2) = 1;
    P(2, 1) = -0.5;  // 1.5 / sqrt(4 x 9) = 1/4
    EXPECT_TRUE(symmetric_within(f, 0.25, 1, 2) && symmetric_within(f, 0.5, 2, 1));
    EXPECT_FALSE(symmetric_within(f, 0.24, 1, 2) || symmetric_within(f, 0.24, 2, 1));
    P(1, 1) = -4;
    EXPECT_FALSE(symmetric_within(f, 1.0, 1, 2) || symmetric_within(f, 1.0, 1, 1));
    P(1, 1) = 4;
    P(1, 2) = NAN;
    EXPECT_FALSE(symmetric_within(f, 1.0, 1, 2));
    P(1, 2) = P(2, 1) = 0;
    P(2, 2) = NAN;
    EXPECT_FALSE(symmetric_within(f, 1.0, 1, 2) || symmetric_within(f, 1.0, 2, 1));
    static_assert(MayLoseSymmetry<JosephRankTwo<double>> && !MayLoseSymmetry<Symmetric<double>> &&
                  !MayLoseSymmetry<Forgetting<Symmetric<double>, RotatingRidge<double>>> &&
                  !MayLoseSymmetry<Potter<double>>);
}

// --- single numbers --------------------------------------------------------------------------------------------------

TEST(Signals, AreThoseOfP) {
    for_each_form([]<class F>() {
        F f = warm<F>();
        Matrix<double> const P = covariance_of(f);
        for (Index j = 0; j < 4; ++j) EXPECT_NEAR(variance(f, j) / P(j, j), 1, budget) << F::name;
        EXPECT_NEAR(trace(f) / P.trace(), 1, budget) << F::name;
        Vector<double> const psi = Eigen::Map<Vector<double> const>(direction, 4);
        if constexpr (ReportsInformationAlong<F>) {
            EXPECT_NEAR(information_along(f, direction) / psi.dot(P.inverse() * psi), 1, budget) << F::name;
        }
    });
}

// --- reset -----------------------------------------------------------------------------------------------------------

TEST(Reset, MakesPAMultipleOfIAndKeepsTheta) {
    for_each_form([]<class F>() {
        F f = warm<F>();
        Vector<double> const theta = f.theta();
        reset(f, 16.0, f.theta());
        EXPECT_EQ(covariance_of(f), Matrix<double>(16 * Matrix<double>::Identity(4, 4))) << F::name;
        EXPECT_LE((f.theta() - theta).cwiseAbs().maxCoeff(), keeps_theta<F> ? 0 : 8 * u * theta.norm()) << F::name;
        F fresh({.forgetting = 0.96875, .prior = Prior<double>{.variance = 16, .theta = theta}});
        run_rows(f, 20, Seed{9});
        run_rows(fresh, 20, Seed{9});
        EXPECT_LE(relative(covariance_of(f), covariance_of(fresh)), budget) << F::name;
        EXPECT_LE((f.theta() - fresh.theta()).norm(), budget * theta.norm()) << F::name;
    });
}

// --- removal ---------------------------------------------------------------------------------------------------------

/// A row comes and goes: how far X and theta are from what they were.
template <class F, class Operation>
double removal_error(Operation operation) {
    F f = warm<F>();
    set_forgetting(f, 1.0);
    Matrix<double> const X = covariance_of(f).inverse();
    Vector<double> const theta = f.theta();
    f.update(direction, 3.0);
    operation(f);
    return std::max(relative(Matrix<double>(covariance_of(f).inverse()), X), (f.theta() - theta).norm() / theta.norm());
}
TEST(Remove, TakesBackWhatARowGave) {
    for_each_form([]<class F>() {
        auto const taken_back = [](double y, double w) {
            return [=](F& f) { remove(f, Regressor<double>(direction, 4), y, w); };
        };
        EXPECT_LE(removal_error<F>(taken_back(3, 1)), budget) << F::name;
        EXPECT_GT(removal_error<F>(taken_back(3, 0.999)), budget) << F::name;
        EXPECT_GT(removal_error<F>(taken_back(3.001, 1)), budget) << F::name;
    });
}
/// Every size around the blocks of eight rows, and the diagonal of what is stored stays positive.
template <class F>
void check_sizes() {
    for (unsigned seed : {31, 32, 33})
        for (Index d : {1, 2, 7, 8, 9, 15, 16, 17, 31, 33, 64, 65, 70}) {
            F f({.size = d, .forgetting = 1, .prior = Prior<double>{.variance = 4}});
            Seed numbers{seed};
            Matrix<double> rows(d, 2 * d + 8);
            for (Index k = 0; k < rows.cols(); ++k) {
                for (Index j = 0; j < d; ++j) rows(j, k) = numbers.bell();
                f.update(Vector<double>(rows.col(k)), numbers.bell());
            }
            Matrix<double> const X = covariance_of(f).inverse();
            Vector<double> const theta = f.theta(), psi = rows.col(0) * 100;
            f.update(psi, 3);
            Removal<double> const removal = remove(f, Regressor<double>(psi.data(), d), 3.0, 1.0);
            double const sized =
                200 * u * double(d) * removal.noise / removal.remaining;  // 1e4 u d, 1e8 u d where P is stored
            EXPECT_LE(relative(covariance_of(f).inverse(), X), sized) << F::name << d;
            EXPECT_LE((f.theta() - theta).norm(), sized * theta.norm()) << F::name << d;
            EXPECT_GT(f.stored().F.diagonal().minCoeff(), 0) << F::name << d;
            for (double D : Vector<double>(f.stored().D)) EXPECT_GT(D, 0) << F::name << d;
        }
}
TEST(Remove, TakesBackARowOfAnySize) {
    for_each(TypeList<Conventional<double>, Symmetric<double>, Potter<double>, Carlson<double>, Ud<double>,
                      InverseQr<double>, Qr<double>, Gentleman<double>, Information<double>>{},
             []<class F>() { check_sizes<F>(); });
}
/// 1/w overflows here, while nothing in the formulas of the inflation does.
TEST(Remove, OfARowTooLightToBeSeenChangesNothing) {
    for_each_form([]<class F>() {
        F f = warm<F>();
        F const before = f;
        for (double w : {0x1p-1030, 0x1p-1074}) {
            EXPECT_EQ(remove(f, Regressor<double>(direction, 4), 3.0, w).remaining, 1) << F::name;
            EXPECT_TRUE(identical(f, before)) << F::name;
        }
    });
}
TEST(Remove, RefusesWhatWasNeverTaken) {
    for_each_form([]<class F>() {
        F f = warm<F>();
        F const before = f;
        double const far[] = {100, 0, 0, 0}, lost[] = {NAN, 0, 0, 0};
        EXPECT_TRUE(remove(f, Regressor<double>(far, 4), 1.0, 1.0).refused()) << F::name;
        EXPECT_TRUE(identical(f, before)) << F::name;
        EXPECT_TRUE(remove(f, Regressor<double>(lost, 4), 1.0, 1.0).refused()) << F::name;
        EXPECT_TRUE(identical(f, before)) << F::name;
    });
}
/// Regression: a covariance window elsewhere tests its divisor for == 0 alone, so that a negative one passes.
TEST(Remove, RefusesANegativeRemainderNotOnlyAZero) {
    Ud<double, 1> f({.prior = Prior<double>{.variance = 1}});
    double const psi[] = {2};
    EXPECT_TRUE(remove(f, Regressor<double>(psi, 1), 0.0, 1.0).refused());   // 1 - 4
    EXPECT_TRUE(remove(f, Regressor<double>(psi, 1), 0.0, 0.25).refused());  // 1 - 1
    EXPECT_FALSE(remove(f, Regressor<double>(psi, 1), 0.0, 0.125).refused());
    EXPECT_EQ(variance(f, 0), 2);
}

}  // namespace
}  // namespace rlslab
