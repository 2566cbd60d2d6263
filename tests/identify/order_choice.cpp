// The choice of an order: every number of it in rationals and closed forms, every threshold from both sides.
#include "src/lab/identify/order.hpp"
#include "tests/common/exact_fit.hpp"

#include <rlslab/model/difference.hpp>

#include <gtest/gtest.h>

#include <functional>

namespace rlslab {
using namespace identify;
namespace {

constexpr double level = 0.01;  // of whiteness and of the F-test, as documented

struct Data {
    std::vector<Signal> inputs;
    Signal y;
};
/// Numbers with few digits, so that rationals stay short: a noisy system of order 2.
Data noisy(size_t inputs, Index n, std::uint64_t seed, double colour = 0) {
    DifferenceEquation model{.a = {-0.9, 0.4}, .b = {}, .delay = 0, .c = 0};
    Data out;
    for (size_t j = 0; j < inputs; ++j) {
        out.inputs.push_back(white_noise(n, Seed{seed + 10 * j + 1}));
        model.b.push_back({0.5, 1.0 + double(j), -0.25});
    }
    Signal xi = coloured_noise(n, {colour}, Seed{seed});
    out.y = simulate(model, out.inputs, xi);
    for (Signal* x : {&out.y})
        for (double& v : *x) v = std::round(64 * v) / 64;
    for (Signal& x : out.inputs)
        for (double& v : x) v = std::round(64 * v) / 64;
    return out;
}
Records rows_of(OrderColumns const& all, int order, Index held_out) {
    Index const N = all.y.size() - held_out;
    return {.psi = all.X.topLeftCorner(N, all.columns(order)).transpose(), .y = all.y.head(N), .names = {}};
}

TEST(OrderColumns, AreTheEquationInTheOrderOfItsRecursion) {
    Signal u, v, y;
    for (int k = 0; k < 30; ++k) u.push_back(k), v.push_back(100 + k), y.push_back(1000 + k);
    OrderColumns const c = order_columns({u, v}, y, 2, {1, 3}, true);
    EXPECT_EQ(c.columns(0), 3);
    EXPECT_EQ(c.columns(2), 9);
    ASSERT_EQ(c.X.rows(), 25);  // 2 lags and a delay of 3
    EXPECT_EQ(c.y[0], 1005);
    EXPECT_EQ(Vector<double>(c.X.row(0).transpose()), (Vector<double>{{4, 102, 1, -1004, 3, 101, -1003, 2, 100}}));
    EXPECT_THROW(order_columns({u}, y, 12, {0}, false), std::invalid_argument);
    EXPECT_THROW(order_columns({u}, y, 2, {}, false), std::invalid_argument);
}

TEST(OrderCriteria, AreTheirFormulas) {
    EXPECT_DOUBLE_EQ(criteria(8, 8, 2).aic, 4);
    EXPECT_DOUBLE_EQ(criteria(8, 8, 2).bic, 2 * std::log(8.0));
    EXPECT_DOUBLE_EQ(criteria(8, 8, 2).fpe, 10.0 / 6);
    EXPECT_DOUBLE_EQ(criteria(8 * std::exp(1.5), 8, 3).aic, 12 + 6);
    EXPECT_DOUBLE_EQ(criteria(8 * std::exp(1.5), 8, 3).bic, 12 + 3 * std::log(8.0));
    EXPECT_DOUBLE_EQ(criteria(24, 8, 3).fpe, 3 * 11.0 / 5);
}

TEST(OrderCriteria, AreThoseOfTheRationalFitsOfEveryOrder) {
    for (size_t const inputs : {1u, 3u}) {
        Data const data = noisy(inputs, 60, 3 * inputs);
        Index const held_out = 15;
        OrderColumns const all = order_columns(data.inputs, data.y, 3, std::vector<int>(inputs, 0), inputs == 1);
        OrderChoice const choice = choose_order(all, 3, held_out);
        ASSERT_EQ(choice.fits.size(), 4u);
        EXPECT_EQ(choice.rows, 42);
        double before = 0;
        for (int n = 0; n <= 3; ++n) {
            OrderFit const& fit = choice.fits[size_t(n)];
            Records const records = rows_of(all, n, held_out);
            exact_fit::Fit const exact = exact_fit::of(records);
            double const J = static_cast<double>(exact.J), N = 42, d = double(fit.parameters);
            EXPECT_EQ(fit.order, n);
            EXPECT_EQ(fit.parameters, Index(inputs) * (n + 1) + n + (inputs == 1));
            EXPECT_NEAR(fit.J / J, 1, 1e-13);
            EXPECT_NEAR(fit.aic, N * std::log(J / N) + 2 * d, 1e-11);
            EXPECT_NEAR(fit.bic, N * std::log(J / N) + d * std::log(N), 1e-11);
            EXPECT_NEAR(fit.fpe / (J / N * (N + d) / (N - d)), 1, 1e-12);
            // F-test: for two more parameters its tail is (J_n / J_(n-1))^((N-d)/2).
            if (n > 0 && inputs == 1) {
                EXPECT_NEAR(fit.p / std::pow(J / before, (N - d) / 2), 1, 1e-9);
            }
            if (n > 0 && inputs == 3) {
                EXPECT_NEAR(fit.p / exact_fit::f_tail(4, int(N - d), (before - J) / 4 / (J / (N - d))), 1, 1e-9);
            }
            before = J;
            // Ljung and Box.
            Rational Q = 0;
            for (Index lag = 1; lag <= 25; ++lag) {
                Rational r = 0;
                for (Index k = lag; k < 42; ++k) r += exact.residuals[k] * exact.residuals[k - lag];
                Q += r * r / (exact.J * exact.J) / (42 - lag);
            }
            EXPECT_NEAR(fit.ljung_box / exact_fit::chi_squared_tail(25 - n, 42 * 44 * static_cast<double>(Q)), 1, 1e-9);
            // One step ahead over the last 15 rows.
            double missed = 0, spread = 0, mean = 0;
            for (Index k = 42; k < 57; ++k) mean += all.y[k] / 15;
            for (Index k = 42; k < 57; ++k) {
                double e = all.y[k];
                for (Index i = 0; i < fit.parameters; ++i) e -= all.X(k, i) * static_cast<double>(exact.theta[i]);
                missed += e * e, spread += (all.y[k] - mean) * (all.y[k] - mean);
            }
            EXPECT_NEAR(fit.held_out, 100 * (1 - std::sqrt(missed / spread)), 1e-9);
        }
    }
}
TEST(OrderCriteria, WithoutHeldOutRowsThereIsNoFitOfThem) {
    Data const data = noisy(1, 60, 3);
    for (OrderFit const& fit : choose_order(order_columns(data.inputs, data.y, 2, {0}, false), 2, 0).fits)
        EXPECT_TRUE(std::isnan(fit.held_out));
}

TEST(LjungBox, IsLjungAndBox) {
    // Residuals 1, -1, 1, -1, 2: r_1 = (-1 - 1 - 1 - 2)/8 = -5/8, r_2 = (1 + 1 + 2)/8 = 1/2; Q = 5 x 7 (25/64/4 +
    // 1/4/3).
    Vector<double> const eps{{1, -1, 1, -1, 2}};
    LjungBox const w = ljung_box(eps, 2, 1);
    EXPECT_DOUBLE_EQ(w.Q, 35 * (25.0 / 256 + 1.0 / 12));
    EXPECT_EQ(w.lags, 2);
    EXPECT_EQ(w.freedom, 1);
    EXPECT_NEAR(w.p, std::erfc(std::sqrt(w.Q / 2)), 1e-15);
    EXPECT_EQ(ljung_box(eps, 2, 0).freedom, 2);
    EXPECT_NEAR(ljung_box(eps, 2, 0).p, std::exp(-w.Q / 2), 1e-15);
    EXPECT_EQ(ljung_box(eps, 2, 2).freedom, 1) << "one at least";
    EXPECT_EQ(ljung_box(eps, 2, 7).freedom, 1);
    EXPECT_EQ(ljung_box(Vector<double>::Zero(5), 2, 1).p, 1);
    EXPECT_EQ(ljung_box(Vector<double>::Zero(5), 2, 1).Q, 0);
    EXPECT_TRUE(std::isnan(ljung_box(Vector<double>{{1, INFINITY, 1}}, 1, 0).p));
    EXPECT_FALSE(ljung_box(Vector<double>{{1, INFINITY, 1}}, 1, 0).white());
    EXPECT_TRUE(std::isnan(ljung_box(Vector<double>::Constant(3, NAN), 1, 0).p));
    // One that is missing takes its pairs with it: r_1 = (1 2 + 2 1)/10 and r_2 = (1 1 + 1 2)/10, of two pairs each.
    LjungBox const gap = ljung_box(Vector<double>{{1, 2, 1, NAN, 2}}, 2, 1);
    EXPECT_NEAR(gap.Q, 4 * 6 * (0.4 * 0.4 / 2 + 0.3 * 0.3 / 2), 1e-14);
    EXPECT_THROW(ljung_box(eps, 5, 0), std::invalid_argument);
    EXPECT_THROW(ljung_box(eps, 0, 0), std::invalid_argument);
}
TEST(LjungBox, PassesAtOnePercentAndLooksAtSoManyLags) {
    EXPECT_TRUE((LjungBox{0, 0.01, 1, 1}).white());
    EXPECT_FALSE((LjungBox{0, std::nextafter(0.01, 0), 1, 1}).white());
    EXPECT_EQ(ljung_box_lags(1000, 1), 25);
    EXPECT_EQ(ljung_box_lags(1000, 12), 25);
    EXPECT_EQ(ljung_box_lags(1000, 13), 26);
    EXPECT_EQ(ljung_box_lags(1000, 20), 40);
    EXPECT_EQ(ljung_box_lags(25, 1), 24);
    EXPECT_EQ(ljung_box_lags(26, 1), 25);
}

/// y = 3 u with an error of +-f 2^-44 max|y|, alternating: residuals of rounding alone below f = 1, correlated ones
/// above.
TEST(RoundingAlone, IsToldFromResidualsAtTwoToTheMinus44) {
    EXPECT_DOUBLE_EQ(rounding_alone(10, 4), 10 * 0x1p-84);
    for (double const f : {0.9, 1.1}) {
        Signal u = white_noise(64, Seed{9}), y(64);
        for (double& x : u) x = std::round(16 * x) / 16;
        u[10] = 4;
        for (size_t k = 0; k < 64; ++k) {
            ASSERT_LE(std::abs(u[k]), 4);
            y[k] = 3 * u[k] + (k % 2 ? 1 : -1) * f * 12 * 0x1p-44;
        }
        OrderFit const fit = choose_order(order_columns({u}, y, 1, {0}, false), 1, 0).fits[0];
        double const nothing = 63 * 144 * 0x1p-88;
        if (f < 1) {
            EXPECT_NEAR(fit.J / nothing, 1, 1e-9);
            EXPECT_EQ(fit.ljung_box, 1);
        } else {
            EXPECT_GT(fit.J / nothing, 1.1);
            EXPECT_LT(fit.ljung_box, 1e-9);
        }
    }
}

/// The choice as documented, by another hand: so many levels of whiteness and of the F-test.
struct Choice {
    int order, f_test;
};
Choice chosen(OrderChoice const& c, double white, double improves) {
    Choice out{0, 0};
    double least_white = INFINITY, least = INFINITY;
    int any = 0;
    for (OrderFit const& f : c.fits) {
        if (f.order == 0) continue;
        if (f.bic < least) least = f.bic, any = f.order;
        if (f.p < improves) out.f_test = f.order;
    }
    for (OrderFit const& f : c.fits)
        if (f.order >= any && f.ljung_box >= white && f.bic < least_white) least_white = f.bic, out.order = f.order;
    if (out.order == 0) out.order = any;
    return out;
}
TEST(OrderChoices, FollowTheirRuleAndItsLevels) {
    int white_low = 0, white_high = 0, f_low = 0, f_high = 0, by_bic = 0, by_white = 0, none = 0;
    for (std::uint64_t seed = 0; seed < 600; ++seed) {
        Data const data = noisy(1, 90, 1000 + 40 * seed, -0.3);
        OrderChoice const c = choose_order(order_columns(data.inputs, data.y, 4, {0}, false), 4, 20);
        Choice const should = chosen(c, level, level);
        EXPECT_EQ(c.order, should.order) << seed;
        EXPECT_EQ(c.f_test, should.f_test) << seed;
        for (auto const& [criterion, order] :
             {std::pair(&OrderFit::aic, c.aic), {&OrderFit::bic, c.bic}, {&OrderFit::fpe, c.fpe}})
            for (OrderFit const& f : c.fits)
                if (f.order > 0) {
                    EXPECT_LE(c.fits[size_t(order)].*criterion, f.*criterion) << seed;
                }
        bool const any_white =
            std::ranges::any_of(c.fits, [&](OrderFit const& f) { return f.order >= c.bic && f.ljung_box >= level; });
        (any_white ? c.order == c.bic ? by_bic : by_white : none) += 1;
        EXPECT_EQ(c.why, !any_white ? "the least BIC; neither there nor above do the residuals pass for white"
                         : c.order == c.bic
                             ? "the least BIC, and its residuals pass for white"
                             : "the least BIC among orders whose residuals pass for white (without that: " +
                                   std::to_string(c.bic) + ")");
        // The trial can tell the level from its neighbours.
        white_low += chosen(c, 0.8 * level, level).order != should.order,
            white_high += chosen(c, 1.25 * level, level).order != should.order;
        f_low += chosen(c, level, 0.8 * level).f_test != should.f_test,
            f_high += chosen(c, level, 1.25 * level).f_test != should.f_test;
    }
    for (int const count : {white_low, white_high, f_low, f_high, by_bic, by_white}) EXPECT_GT(count, 0);
    std::printf("told apart: white %d %d, F %d %d; chosen by BIC %d, by whiteness %d, none white %d\n", white_low,
                white_high, f_low, f_high, by_bic, by_white, none);
}
TEST(OrderChoices, EndWhereTheColumnsDependOnOneAnother) {
    // y = 2 u[k] + u[k-1] exactly: y[k-1] is a combination of u[k-1] and u[k-2], so that order 2 brings no new column.
    Signal u = white_noise(80, Seed{4}), y(80, 0.0);
    for (double& x : u) x = std::round(16 * x);
    for (size_t k = 1; k < 80; ++k) y[k] = 2 * u[k] + u[k - 1];
    OrderChoice const c = choose_order(order_columns({u}, y, 3, {0}, false), 3, 0);
    EXPECT_EQ(c.fits.size(), 2u);
    EXPECT_EQ(c.order, 1);
}
/// A column of which a part of 2^-90 of its square is new still counts; what rounding leaves is 2^-100 or so.
TEST(OrderChoices, CallColumnsDependentBelowTwoToTheMinus90) {
    for (int const exponent : {-44, -47}) {
        OrderColumns c{Matrix<double>(40, 3), Vector<double>(40), 1, false};
        Seed seed{3};
        for (Index k = 0; k < 40; ++k) {
            c.y[k] = seed.bell(), c.X(k, 0) = k % 2 ? 1 : -1, c.X(k, 1) = seed.bell();
            c.X(k, 2) = c.X(k, 0) + std::ldexp(k % 4 < 2 ? 1.0 : -1.0,
                                               exponent);  // orthogonal to X(k, 0), half of it or so to X(k, 1)
        }
        EXPECT_EQ(choose_order(c, 1, 0).fits.size(), exponent == -44 ? 2u : 1u) << exponent;
    }
}

}  // namespace
}  // namespace rlslab
