// From a system to a record and back: registers, batch and order-recursive least squares, identify.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/studies/scenarios.hpp>
#include "tests/common/laws.hpp"
#include "tests/common/random_stable.hpp"
#include "tests/identify/said.hpp"

#include <rlslab/model/order_recursive.hpp>
#include <rlslab/model/order_recursive_qr.hpp>

namespace rlslab {
using namespace identify;
using namespace report;
using namespace studies;
namespace {

// --- signals ---------------------------------------------------------------------------------------------------------

TEST(Signals, APrbsHasItsPeriodItsBalanceAndItsCorrelation) {
    for (int m = 2; m <= 20; ++m) {
        Index const M = (Index(1) << m) - 1;
        Signal const u = prbs(m, 2 * M);
        std::vector<bool> seen(size_t(M) + 1, false);  // every register state but zero comes once: maximal length
        Index ones = 0, states = 0;
        for (Index k = 0; k < M; ++k) {
            size_t state = 0;
            for (Index i = 0; i < m; ++i) state = state << 1 | size_t(u[size_t(k + i)] > 0);
            states += !seen[state];
            seen[state] = true;
            ones += u[size_t(k)] > 0;
        }
        EXPECT_EQ(states, M) << m;
        EXPECT_EQ(ones, (M + 1) / 2) << m;
        for (Index lag : {Index(1), M / 2, M - 1}) {
            long sum = 0;
            for (Index k = 0; k < M; ++k) sum += long(u[size_t(k)] * u[size_t(k + lag)]);
            EXPECT_EQ(sum, -1) << m << ' ' << lag;
        }
    }
    EXPECT_EQ(prbs(3, 14, 2)[0], prbs(3, 14, 2)[1]);
    EXPECT_THROW(prbs(1, 5), std::invalid_argument);
    EXPECT_THROW(prbs(21, 5), std::invalid_argument);
}

// --- batch -----------------------------------------------------------------------------------------------------------

TEST(Batch, ThreeWaysAgreeWithTheCertifiedMinimiser) {
    Records const records = laws::noise_records(6, 200, Seed{5});
    Problem<double> const problem{.size = 6, .prior = std::nullopt};
    CertifiedSolution const exact = certified(problem, records, {200}).front();
    for (FitBy by : {FitBy::normal_equations, FitBy::qr, FitBy::svd}) {
        Fit const f = fit(records, by);
        EXPECT_GT(exact.theta_digits(f.theta.cast<Reference>()), 14.5) << name_of(by);
        EXPECT_EQ(f.rank, 6);
        Matrix<double> const P = exact.covariance().cast<double>() * f.sigma2;
        EXPECT_LT((f.covariance - P).norm(), 1e-13 * P.norm()) << name_of(by);
        EXPECT_LT(f.lower[0], f.theta[0]);
    }
}
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
        Vector<Rational> const theta = recursion.theta(),
                               gradient = Phi.transpose().lazyProduct(Y - Vector<Rational>(Phi.lazyProduct(theta)));
        EXPECT_TRUE(gradient == Vector<Rational>(Vector<Rational>::Zero(d))) << d;
        EXPECT_TRUE(Matrix<Rational>(G.lazyProduct(Matrix<Rational>(recursion.covariance()))) ==
                    Matrix<Rational>(Matrix<Rational>::Identity(d, d)))
            << d;
        Vector<Rational> const eps = Y - Vector<Rational>(Phi.lazyProduct(theta));
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
    Records const records = [] {
        Records out = laws::noise_records(6, 100, Seed{8});
        for (Index j = 1; j < 6; ++j) out.psi.row(j) = out.psi.row(j - 1) + 1e-1 * out.psi.row(j);
        return out;
    }();
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
        for (std::string const& variant : words(joined(factor_forms(), {"qr_block"}))) {
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

/// With forgetting the estimate scatters as its own standard deviation says.
TEST_F(Options, StandardDeviationsHoldWithForgetting) {
    int inside = 0;
    constexpr int records = 200;
    for (std::uint64_t k = 0; k < records; ++k) {
        Data const record =
            simulated({-0.5}, {0, 1}, white_noise(400, Seed{k}), times(white_noise(400, Seed{5000 + k}), 0.5));
        Identified const m = run({.order = 1, .detrend = false, .forgetting = 0.95, .validate = 0}, record);
        inside += m.parameters[2].lower <= 1 && 1 <= m.parameters[2].upper;
    }
    EXPECT_NEAR(inside / double(records), 0.95, 0.06);  // four standard deviations of 200 draws
}
TEST(Identify, TheHeatExchangersStandstillIsNamed) {
    std::string const file = RLSLAB_SOURCE_DIR "/../shared/data/heat_exchanger.csv";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
    Identified const m = identify::identify(file, {.inputs = {"u"}, .output = "y", .order = 4});
    ASSERT_FALSE(m.warnings().empty());
    EXPECT_THAT(m.warnings().front(), Names("u 100"));
}

/// The model that the recursion ends with predicts the held-out third as a batch QR does at the same order.
TEST(Identify, RealRecordsAreFittedAsABatchFitsThem) {
    for (auto name : {"hair_dryer", "heat_exchanger", "gas_furnace"}) {
        std::string const file = std::string(RLSLAB_SOURCE_DIR "/../shared/data/") + name + ".csv";
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
    }
}

}  // namespace
}  // namespace rlslab
