// The choice of an order: every number of it in rationals and closed forms, every threshold from both sides. From a
// system to a record and back: registers, batch and order-recursive least squares, identify.
#include "tests/common/exact_fit.hpp"
#include "tests/common/laws.hpp"
#include "tests/common/random_stable.hpp"
#include "tests/identify/said.hpp"

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/model/fit.hpp>
#include <rlslab/model/order_recursive.hpp>
#include <rlslab/model/order_recursive_qr.hpp>
#include <rlslab/studies/scenarios.hpp>

#include <map>
#include <numeric>
#include <set>

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
    out.y = simulate(model, out.inputs, coloured_noise(n, {colour}, Seed{seed}));
    out.inputs.push_back(out.y);
    for (Signal& x : out.inputs)
        for (double& v : x) v = std::round(64 * v) / 64;
    out.y = out.inputs.back(), out.inputs.pop_back();
    return out;
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

/// By the formulas that tests/identify/numbers.cpp looks at.
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
            exact_fit::Fit const exact = exact_fit::of(
                {.psi = all.X.topLeftCorner(42, all.columns(n)).transpose(), .y = all.y.head(42), .names = {}});
            double const J = static_cast<double>(exact.J), N = 42, d = double(fit.parameters);
            EXPECT_EQ(fit.order, n);
            EXPECT_EQ(fit.parameters, Index(inputs) * (n + 1) + n + (inputs == 1));
            EXPECT_NEAR(fit.J / J, 1, 1e-13);
            EXPECT_NEAR(fit.aic, criteria(J, 42, fit.parameters).aic, 1e-11);
            EXPECT_NEAR(fit.bic, criteria(J, 42, fit.parameters).bic, 1e-11);
            EXPECT_NEAR(fit.fpe / criteria(J, 42, fit.parameters).fpe, 1, 1e-12);
            // F-test: for two more parameters its tail is (J_n / J_(n-1))^((N-d)/2).
            if (n > 0) {
                double const F = (before - J) / 4 / (J / (N - d)),
                             p = inputs == 1 ? std::pow(J / before, (N - d) / 2) : exact_fit::f_tail(4, int(N - d), F);
                EXPECT_NEAR(fit.p / p, 1, 1e-9);
            }
            before = J;
            auto const rounded = [](auto const& x) {
                return Vector<double>(x.unaryExpr([](Rational const& v) { return static_cast<double>(v); }));
            };
            EXPECT_NEAR(fit.ljung_box / ljung_box(rounded(exact.residuals), 25, n).p, 1, 1e-9);
            Vector<double> const predicted = all.X.bottomLeftCorner(15, fit.parameters) * rounded(exact.theta);
            EXPECT_NEAR(fit.held_out, fit_percent(all.y.tail(15), predicted), 1e-9);
            EXPECT_TRUE(std::isnan(choose_order(all, 3, 0).fits[size_t(n)].held_out)) << "without such rows";
        }
    }
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
    for (auto const& [rows, order, lags] : std::vector<std::array<int, 3>>{
             {1000, 1, 25}, {1000, 12, 25}, {1000, 13, 26}, {1000, 20, 40}, {25, 1, 24}, {26, 1, 25}})
        EXPECT_EQ(ljung_box_lags(rows, order), lags) << rows << ' ' << order;
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

/// The order and the F-test's, as documented, by another hand: so many levels of whiteness and of the F-test.
std::pair<int, int> chosen(OrderChoice const& c, double white, double improves) {
    int f_test = 0;
    for (OrderFit const& f : c.fits)
        if (f.order > 0 && f.p < improves) f_test = f.order;
    auto const least = [&](auto const& allowed) {
        std::pair<double, int> out{INFINITY, 0};
        for (OrderFit const& f : c.fits)
            if (f.order > 0 && allowed(f)) out = std::min(out, {f.bic, f.order});
        return out.second;
    };
    int const any = least([](auto const&) { return true; }),
              is_white = least([&](auto const& f) { return f.order >= any && f.ljung_box >= white; });
    return {is_white > 0 ? is_white : any, f_test};
}
TEST(OrderChoices, FollowTheirRuleAndItsLevels) {
    std::map<std::string, int> reasons;
    int told_apart[4] = {};  // the trial can tell each level from its neighbours
    for (std::uint64_t seed = 0; seed < 600; ++seed) {
        Data const data = noisy(1, 90, 1000 + 40 * seed, -0.3);
        OrderChoice const c = choose_order(order_columns(data.inputs, data.y, 4, {0}, false), 4, 20);
        auto const should = chosen(c, level, level);
        EXPECT_EQ(std::pair(c.order, c.f_test), should) << seed;
        for (auto const& [criterion, order] :
             {std::pair(&OrderFit::aic, c.aic), {&OrderFit::bic, c.bic}, {&OrderFit::fpe, c.fpe}})
            for (OrderFit const& f : c.fits) EXPECT_LE(c.fits[size_t(order)].*criterion, f.*criterion) << seed;
        bool const any_white =
            std::ranges::any_of(c.fits, [&](OrderFit const& f) { return f.order >= c.bic && f.ljung_box >= level; });
        std::string const why = !any_white         ? "; neither there nor above do the residuals pass for white"
                                : c.order == c.bic ? ", and its residuals pass for white"
                                                   : " among orders whose residuals pass for white (without that: ";
        EXPECT_TRUE(c.why.starts_with("the least BIC" + why)) << c.why;
        EXPECT_TRUE(!any_white || c.order == c.bic || c.why.ends_with(": " + std::to_string(c.bic) + ")")) << c.why;
        ++reasons[why];
        for (int i = 0; i < 4; ++i) {
            double const by = (i % 2 ? 1.25 : 0.8) * level;
            told_apart[i] += chosen(c, i < 2 ? by : level, i < 2 ? level : by) != should;
        }
    }
    EXPECT_EQ(reasons.size(), 3u);
    for (int const count : told_apart) EXPECT_GT(count, 0);
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

// --- signals ---------------------------------------------------------------------------------------------------------

TEST(Signals, APrbsHasItsPeriodItsBalanceAndItsCorrelation) {
    for (int m = 2; m <= 20; ++m) {
        Index const M = (Index(1) << m) - 1;
        Signal const u = prbs(m, 2 * M);
        std::set<size_t> states;  // every register state but zero comes once: maximal length
        for (Index k = 0; k < M; ++k) {
            size_t state = 0;
            for (Index i = 0; i < m; ++i) state = state << 1 | size_t(u[size_t(k + i)] > 0);
            states.insert(state);
        }
        EXPECT_EQ(Index(states.size()), M) << m;
        EXPECT_EQ(std::count(u.begin(), u.begin() + M, 1.0), (M + 1) / 2) << m;
        for (Index lag : {Index(1), M / 2, M - 1})
            EXPECT_EQ(std::inner_product(u.begin(), u.begin() + M, u.begin() + lag, 0.0), -1) << m << ' ' << lag;
    }
    EXPECT_THROW(prbs(1, 5), std::invalid_argument);
    EXPECT_THROW(prbs(21, 5), std::invalid_argument);
}

// --- batch -----------------------------------------------------------------------------------------------------------

TEST(Batch, TheSvdSaysWhatItDropped) {
    Records records = laws::noise_records(4, 60, Seed{6});
    records.psi.row(3) = 2 * records.psi.row(0);
    Fit const f = fit(records, FitBy::svd);
    EXPECT_EQ(f.rank, 3);
    EXPECT_LT(f.singular[3], 1e-14 * f.singular[0]);
    EXPECT_NEAR(f.theta[3], 2 * f.theta[0], 1e-13) << "the shortest of the minimisers";
    EXPECT_THROW(fit(Records{.psi = Matrix<double>(3, 2), .y = Vector<double>(2), .names = {}}), std::invalid_argument);
}

// --- order -----------------------------------------------------------------------------------------------------------

TEST(OrderRecursive, EqualsBatchAtEveryOrderInRationals) {
    Seed seed{7};
    Index const N = 12, most = 7;
    Matrix<Rational> X(N, most);
    Vector<Rational> Y(N);
    for (Index k = 0; k < N; ++k) {
        Y[k] = Rational(int(seed.next() % 19) - 9);
        for (Index j = 0; j < most; ++j) X(k, j) = Rational(int(seed.next() % 19) - 9, 2);
    }
    OrderRecursive<Rational> recursion(Y, most);
    for (Index d = 1; d <= most; ++d) {
        EXPECT_EQ(recursion.append(X.col(d - 1)).health, Health::sound);
        // The normal equations, and P as the Gram matrix's inverse.
        Matrix<Rational> const Phi = X.leftCols(d), G = Phi.transpose().lazyProduct(Phi);
        Vector<Rational> const theta = recursion.theta(), eps = Y - Vector<Rational>(Phi.lazyProduct(theta)),
                               gradient = Phi.transpose().lazyProduct(eps);
        EXPECT_TRUE(gradient == Vector<Rational>(Vector<Rational>::Zero(d))) << d;
        EXPECT_TRUE(Matrix<Rational>(G.lazyProduct(Matrix<Rational>(recursion.covariance()))) ==
                    Matrix<Rational>(Matrix<Rational>::Identity(d, d)))
            << d;
        Rational J = 0;
        for (Rational const& x : eps) J += x * x;
        EXPECT_EQ(recursion.J(), J) << d;
    }
    EXPECT_THROW(recursion.append(X.col(0)), std::invalid_argument);
}
TEST(OrderRecursive, ADependentColumnIsReported) {
    OrderRecursive<Rational> exact(Vector<Rational>(Vector<Rational>::Ones(4)), 2);
    Vector<Rational> const x = Vector<Rational>::Constant(4, Rational(2));
    EXPECT_EQ(exact.append(x).health, Health::sound);
    EXPECT_EQ(exact.append(x).health, Health::indefinite);
    OrderRecursiveQr<double> qr(Vector<double>(Vector<double>::Ones(4)), 2);
    EXPECT_EQ(qr.append(Vector<double>{{1, 0, 0, 0}}).health, Health::sound);
    EXPECT_EQ(qr.append(Vector<double>{{2, 0, 0, 0}}).health, Health::indefinite);
}
TEST(OrderRecursive, TheQrTwinKeepsTwiceTheDigits) {
    Records records = laws::noise_records(6, 100, Seed{8});
    for (Index j = 1; j < 6; ++j) records.psi.row(j) = records.psi.row(j - 1) + 1e-1 * records.psi.row(j);
    Problem<double> const problem{.size = 6, .prior = std::nullopt};
    CertifiedSolution const exact = certified(problem, records, {100}).front();
    OrderRecursive<double> bordered(records.y, 6);
    OrderRecursiveQr<double> qr(records.y, 6);
    for (Index j = 0; j < 6; ++j) {
        bordered.append(records.psi.row(j).transpose());
        qr.append(records.psi.row(j).transpose());
    }
    double const of_qr = exact.theta_digits(qr.theta().cast<Reference>());
    double const of_bordering = exact.theta_digits(Vector<double>(bordered.theta()).cast<Reference>());
    EXPECT_GT(of_qr, 10);
    EXPECT_GT(of_qr, of_bordering + 1);
}

// --- systems come back -----------------------------------------------------------------------------------------------

TEST(Systems, TwoHundredRandomOnesComeBackToTenDigitsByEverySoundVariant) {
    for (int system = 0; system < 200; ++system) {
        int const order = 1 + system % 6;
        DifferenceEquation const model = random_stable(order, Seed{std::uint64_t(1000 + system)});
        for (auto const& pole : poles(model)) EXPECT_LT(std::abs(pole), 1);
        Signal const u = prbs(10, 1500), y = simulate(model, {u}, Signal(u.size(), 0.0));
        Records const records = arx_records(u, y, arx_of_order(order));
        Vector<Reference> theta(records.parameters());
        for (int i = 0; i < order; ++i) theta[i] = model.a[size_t(i)];
        for (int i = 0; i <= order; ++i) theta[order + i] = model.b[0][size_t(i)];
        Reference size = sqrt(Reference(theta.squaredNorm()));
        for (std::string const& variant : studies::words(studies::joined(studies::factor_forms(), {"qr_block"}))) {
            auto const filter = find_entry(variant)->make(
                {.size = records.parameters(), .prior = Prior<double>{.variance = 0x1p60}}, Seed{1});
            filter->update_block(records, 0, records.rows());
            Vector<Reference> const off = filter->theta() - theta;
            Reference const error = sqrt(Reference(off.squaredNorm())) / size;
            EXPECT_LT(error, 1e-10) << variant << " system " << system << " order " << order;
        }
    }
}

// --- identify --------------------------------------------------------------------------------------------------------

/// The model that the recursion ends with predicts the held-out third as a batch QR does at the same order.
TEST(Identify, RealRecordsAreFittedAsABatchFitsThem) {
    for (std::string const name : {"hair_dryer", "heat_exchanger", "gas_furnace"}) {
        std::string const file = RLSLAB_SOURCE_DIR "/../shared/data/" + name + ".csv";
        if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
        Identified const m = identify::identify(file, {.inputs = {"u"}, .output = "y", .order = 4});
        Columns const columns = read_columns(file, {"u", "y"});
        Signal u = columns["u"], y = columns["y"];
        for (double& x : u) x -= m.means[0];
        for (double& x : y) x -= m.means[1];
        Records const all = arx_records(u, y, arx_of_order(4));
        Index const fitted = all.rows() - m.held_out;
        Fit const batch = fit(Records{.psi = all.psi.leftCols(fitted), .y = all.y.head(fitted), .names = {}});
        Vector<double> const predicted = all.psi.rightCols(m.held_out).transpose() * batch.theta;
        EXPECT_GE(m.held_out_one_step, fit_percent(all.y.tail(m.held_out), predicted) - 1e-8) << name;
        bool const stands_still = std::ranges::any_of(m.warnings(), testing::Matches(Names("u 100")));
        EXPECT_TRUE(stands_still || name != "heat_exchanger");
    }
}

}  // namespace
}  // namespace rlslab
