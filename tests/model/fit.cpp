// Every number of a batch fit, worked out another way: NIST's certified values, rationals, closed forms by hand.
#include "tests/common/exact_fit.hpp"

#include <rlslab/core/random.hpp>
#include <rlslab/model/fit.hpp>
#include <rlslab/model/regression.hpp>
#include <rlslab/reference/distributions.hpp>
#include <rlslab/reference/scatter.hpp>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

namespace rlslab {
namespace {

std::filesystem::path const nist_folder = RLSLAB_SOURCE_DIR "/studies/data/nist";
Records nist(std::string const& name) {
    CsvFile file(nist_folder / (name + ".csv"));
    std::vector<std::string> regressors = file.names();
    Columns const data = file.read(regressors);
    regressors.pop_back();
    return linear_records(data, regressors, "y");
}

// --- by hand ---------------------------------------------------------------------------------------------------------

/// y = 1, 3, 2, 5 at x = 0, 1, 2, 3: slope 1.1, intercept 1.1, residuals -0.1, 0.8, -1.3, 0.6, J = 2.7, sigma^2 = 2.7 /
/// 2, Phi'Phi = [4 6; 6 14], its inverse [14 -6; -6 4] / 20, mean 2.75, sum of squares about it 8.75.
TEST(FitByHand, AStraightLineThroughFourPoints) {
    Records const line{
        .psi = Matrix<double>{{1, 1, 1, 1}, {0, 1, 2, 3}}, .y = Vector<double>{{1, 3, 2, 5}}, .names = {}};
    for (FitBy by : {FitBy::normal_equations, FitBy::qr, FitBy::svd}) {
        Fit const f = fit(line, by);
        EXPECT_NEAR(f.theta[0], 1.1, 1e-14) << name_of(by);
        EXPECT_NEAR(f.theta[1], 1.1, 1e-14) << name_of(by);
        EXPECT_NEAR(f.residuals[2], -1.3, 1e-14) << name_of(by);
        EXPECT_NEAR(f.J, 2.7, 1e-14) << name_of(by);
        EXPECT_NEAR(f.sigma2, 1.35, 1e-14) << name_of(by);
        EXPECT_NEAR(f.covariance(0, 0), 1.35 * 14 / 20, 1e-14) << name_of(by);
        EXPECT_NEAR(f.covariance(0, 1), -1.35 * 6 / 20, 1e-14) << name_of(by);
        EXPECT_NEAR(f.covariance(1, 1), 1.35 * 4 / 20, 1e-14) << name_of(by);
        EXPECT_NEAR(f.sd[1], std::sqrt(0.27), 1e-14) << name_of(by);
        // Student's quantile of 2 degrees of freedom: c sqrt(2 / (1 - c^2)).
        double const t = 0.95 * std::sqrt(2 / (1 - 0.95 * 0.95));
        EXPECT_NEAR(f.lower[1], 1.1 - t * std::sqrt(0.27), 1e-13) << name_of(by);
        EXPECT_NEAR(f.upper[1], 1.1 + t * std::sqrt(0.27), 1e-13) << name_of(by);
        EXPECT_NEAR(fit(line, by, 0.5).upper[0], 1.1 + 0.5 * std::sqrt(2 / 0.75) * std::sqrt(1.35 * 0.7), 1e-13)
            << name_of(by);
        EXPECT_NEAR(f.percent, 100 * (1 - std::sqrt(2.7 / 8.75)), 1e-12) << name_of(by);
        EXPECT_EQ(f.rank, 2) << name_of(by);
    }
    Fit const f = fit(line, FitBy::svd);  // eigenvalues of [4 6; 6 14]: 9 +- sqrt(61)
    EXPECT_NEAR(f.singular[0], std::sqrt(9 + std::sqrt(61)), 1e-14);
    EXPECT_NEAR(f.singular[1], std::sqrt(9 - std::sqrt(61)), 1e-14);
}
TEST(FitByHand, AsManyRowsAsParametersLeaveNoVariance) {
    Records const two{.psi = Matrix<double>{{1, 1}, {0, 1}}, .y = Vector<double>{{1, 3}}, .names = {}};
    for (FitBy by : {FitBy::normal_equations, FitBy::qr, FitBy::svd}) {
        Fit const f = fit(two, by);
        EXPECT_NEAR(f.theta[1], 2, 1e-15);
        EXPECT_TRUE(std::isnan(f.sigma2)) << name_of(by);
        EXPECT_TRUE(std::isnan(f.sd[0]) && std::isnan(f.lower[0])) << name_of(by);
    }
    Records const three{.psi = Matrix<double>{{1, 1, 1}, {0, 1, 2}},
                        .y = Vector<double>{{1, 3, 2}},
                        .names = {}};  // one degree of freedom: t = tan(pi c / 2)
    Fit const f = fit(three);
    EXPECT_NEAR(f.sigma2, 1.5, 1e-14);
    EXPECT_NEAR(f.upper[1], 0.5 + std::tan(std::acos(-1.0) * 0.475) * std::sqrt(0.75), 1e-12);
}
TEST(FitByHand, ThePercentOfAFit) {
    Vector<double> const y{{1, 2, 3, 4}};
    EXPECT_EQ(fit_percent(y, y), 100);
    EXPECT_NEAR(fit_percent(y, Vector<double>{{2.5, 2.5, 2.5, 2.5}}), 0, 1e-13) << "the mean";
    EXPECT_NEAR(fit_percent(y, Vector<double>{{1, 2, 3, 5}}), 100 * (1 - 1 / std::sqrt(5)), 1e-13);
    EXPECT_NEAR(fit_percent(y, Vector<double>{{4, 3, 2, 1}}), -100, 1e-12);
    Vector<double> const constant{{2, 2}};
    EXPECT_EQ(fit_percent(constant, Vector<double>{{2, 3}}), -INFINITY);
    EXPECT_EQ(fit_percent(constant, constant), 100);
}

/// A tolerance drops directions and their rank, and sigma^2 counts what is kept.
TEST(FitByHand, TheSvdsToleranceIsRelativeToTheLargest) {
    // Columns (1, 0, 0) and (0, 2^-10, 0): singular values 1 and 2^-10; y = (1, 2^-10, 1), J = 1 with both.
    Records const r{
        .psi = Matrix<double>{{1, 0, 0}, {0, 0x1p-10, 0}}, .y = Vector<double>{{1, 0x1p-10, 1}}, .names = {}};
    Fit const both = fit(r, FitBy::svd, 0.95, 0x1p-11), one = fit(r, FitBy::svd, 0.95, 0x1p-10),
              scaled = fit(r, FitBy::svd, 0.95, 0x1.8p-11);
    EXPECT_EQ(both.rank, 2);
    EXPECT_EQ(scaled.rank, 2);
    EXPECT_EQ(one.rank, 1) << "at the tolerance it goes";
    EXPECT_DOUBLE_EQ(both.theta[1], 1);
    EXPECT_EQ(one.theta[1], 0);
    EXPECT_DOUBLE_EQ(both.sigma2, 1);
    EXPECT_DOUBLE_EQ(one.sigma2, (1 + 0x1p-20) / 2);
    // By default max(N, d) u: 3 x 2^-53 of the largest.
    auto const rank = [](double least) {
        return fit(Records{.psi = Matrix<double>{{4, 0, 0}, {0, 4 * least, 0}},
                           .y = Vector<double>{{1, 1, 1}},
                           .names = {}},
                   FitBy::svd)
            .rank;
    };
    EXPECT_EQ(rank(2.9 * 0x1p-53), 1);
    EXPECT_EQ(rank(3.1 * 0x1p-53), 2);
}

// --- NIST's sets: residual standard deviation and standard deviations of the estimates -------------------------------

struct Certified {
    std::string name;
    double residual_sd;
    std::vector<double> sd;
};
/// NIST Statistical Reference Datasets, Linear Regression, certified values (itl.nist.gov/div898/strd); Wampler 1 and 2
/// fit exactly.
std::vector<Certified> const certified_values{
    {"longley",
     304.854073561965,
     {890420.383607373, 84.9149257747669, 0.334910077722432e-01, 0.488399681651699, 0.214274163161675,
      0.226073200069370, 455.478499142212}},
    {"wampler3",
     2360.14502379268,
     {2152.32624678170, 2363.55173469681, 779.343524331583, 101.475507550350, 5.64566512170752, 0.112324854679312}},
    {"wampler4",
     236014.502379268,
     {215232.624678170, 236355.173469681, 77934.3524331583, 10147.5507550350, 564.566512170752, 11.2324854679312}},
    {"wampler5",
     23601450.2379268,
     {21523262.4678170, 23635517.3469681, 7793435.24331583, 1014755.07550350, 56456.6512170752, 1123.24854679312}},
};

TEST(FitOfNist, StandardDeviationsAreTheCertifiedOnes) {
    for (Certified const& set : certified_values) {
        Records const records = nist(set.name);
        Index const d = records.parameters(), freedom = records.rows() - d;
        exact_fit::Fit const rational = exact_fit::of(records);
        Scattered const s = scattered({.size = d, .prior = std::nullopt}, records, {records.rows()}).front();
        double const kappa = condition(records, 1);
        Fit const f = fit(records);
        EXPECT_NEAR(std::sqrt(rational.sigma2(freedom)) / set.residual_sd, 1, 1e-14) << set.name;
        EXPECT_NEAR(std::sqrt(s.scatter.J / s.scatter.freedom) / set.residual_sd, 1, 1e-14) << set.name;
        // R is off by a few kappa u, and so is all that is solved from it; theta's error enters J in second order.
        double const lost = 100 * kappa * 0x1p-53;
        ASSERT_LT(lost, 1e-2) << set.name;
        EXPECT_NEAR(std::sqrt(f.sigma2) / set.residual_sd, 1, lost) << set.name;
        for (Index i = 0; i < d; ++i) {
            EXPECT_NEAR(rational.sd(i, freedom) / set.sd[size_t(i)], 1, 2e-14) << set.name << ' ' << i;
            EXPECT_NEAR(s.scatter.sd[i] * std::sqrt(s.scatter.J / s.scatter.freedom) / rational.sd(i, freedom), 1,
                        1e-14)
                << set.name << ' ' << i;
            EXPECT_NEAR(f.sd[i] / set.sd[size_t(i)], 1, lost) << set.name << ' ' << i;
            double const t = (f.upper[i] - f.theta[i]) / f.sd[i];
            EXPECT_NEAR(exact_fit::student_inside(int(freedom), t), 0.95, 1e-9) << set.name << ' ' << i;
            EXPECT_NEAR((f.upper[i] - f.theta[i]) / (f.theta[i] - f.lower[i]), 1, 1e-9) << set.name << ' ' << i;
        }
    }
}
TEST(FitOfNist, FilipInBalls) {
    Records const records = nist("filip");
    Index const d = records.parameters(), freedom = records.rows() - d;
    exact_fit::Fit const rational = exact_fit::of(records);
    Scattered const s = scattered({.size = d, .prior = std::nullopt}, records, {records.rows()}).front();
    // The file holds the products x^j rounded to binary64, kappa 1.8e15: NIST's digits are those of the exact powers.
    EXPECT_NEAR(std::sqrt(rational.sigma2(freedom)) / 0.334801051324544e-02, 1, 1e-6);
    EXPECT_NEAR(rational.sd(0, freedom) / 298.084530995537, 1, 0.1);
    EXPECT_DOUBLE_EQ(s.scatter.freedom, double(freedom));
    EXPECT_NEAR(s.scatter.J / static_cast<double>(rational.J), 1, 1e-12);
    for (Index i = 0; i < d; ++i)
        EXPECT_NEAR(s.scatter.sd[i] / std::sqrt(static_cast<double>(rational.inverse(i, i))), 1, 1e-12) << i;
}

/// NIST's exact solutions.
Vector<double> solution(std::string const& name, std::string const& which = "theta") {
    static auto const all = nlohmann::json::parse(std::ifstream(nist_folder / "solutions.json"));
    auto const text = all.at(name).at(which).get<std::vector<std::string>>();
    Vector<double> theta(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) theta[Index(i)] = std::stod(text[i]);
    return theta;
}

double residual_sum(Records const& records, Vector<double> const& theta) {
    return (records.y - records.psi.transpose() * theta).squaredNorm();
}

TEST(NistData, LeaveTheCertifiedResidualSums) {
    // Rounding theta and psi' theta moves residuals of about 200 by some 1e-9; a mistyped digit moves the sum far more.
    EXPECT_NEAR(residual_sum(nist("longley"), solution("longley")), 836424.055505915, 1e-2);
    for (auto const& [name, sum] : {std::pair{"wampler1", 0.},
                                    {"wampler3", 83554268.},
                                    {"wampler4", 835542680000.},
                                    {"wampler5", 8355426800000000.}})
        EXPECT_EQ(residual_sum(nist(name), solution(name)), sum) << name;  // integers throughout
    EXPECT_LT(residual_sum(nist("wampler2"), solution("wampler2")), 1e-24);
    EXPECT_NEAR(residual_sum(nist("filip"), solution("filip", "theta_stored")), 0.795851382172941e-3, 1e-9);
}

TEST(NistData, FilipHoldsTheBitsOfRepeatedProducts) {
    auto const filip = nist("filip");
    ASSERT_EQ(filip.parameters(), 11);
    ASSERT_EQ(filip.rows(), 82);
    for (Index k = 0; k < 82; ++k) {
        EXPECT_EQ(filip.psi(0, k), 1);
        for (Index j = 1; j < 11; ++j) EXPECT_EQ(filip.psi(j, k), filip.psi(j - 1, k) * filip.psi(1, k));
    }
}

// --- scatter: with forgetting and with a prior, in rationals ---------------------------------------------------------

TEST(ScatterInRationals, IsPMPAndTheExpectedResidualSum) {
    Seed seed{11};
    Index const d = 3, N = 9;
    Records records{.psi = Matrix<double>(d, N), .y = Vector<double>(N), .names = {}};
    for (Index k = 0; k < N; ++k) {
        for (Index i = 0; i < d; ++i) records.psi(i, k) = double(int(seed.next() % 17) - 8) / 4;
        records.y[k] = double(int(seed.next() % 33) - 16) / 8;
    }
    for (double const lambda : {1.0, 0.75}) {
        for (double const variance : {0.0, 4.0, 0x1p40}) {
            Problem<double> problem{.size = d, .forgetting = lambda, .prior = std::nullopt};
            if (variance > 0) problem.prior = Prior<double>{.variance = variance};
            // The prior as d rows of weight lambda^N that carry no noise.
            Rational const l(lambda), zero(0);
            Matrix<Rational> G = Matrix<Rational>::Constant(d, d, zero), M = G;
            Rational sum_w = 0, w = 1;
            for (Index k = N - 1; k >= 0; --k, w *= l) {
                sum_w += w;
                for (Index i = 0; i < d; ++i)
                    for (Index j = 0; j < d; ++j) {
                        Rational const square = Rational(records.psi(i, k)) * Rational(records.psi(j, k));
                        G(i, j) += w * square, M(i, j) += w * w * square;
                    }
            }
            for (Index i = 0; i < d; ++i)
                if (variance > 0) G(i, i) += w / Rational(variance);
            Matrix<Rational> const P = exact_fit::inverse(G);
            // H = Phi P Phi'W maps y to its prediction: the residuals are (I - H) xi, and E J / sigma^2 is the trace of
            // (I-H)'W(I-H).
            Matrix<Rational> E(N, N);
            Vector<Rational> weights(N);
            for (Index k = N - 1; k >= 0; --k) weights[k] = k == N - 1 ? Rational(1) : Rational(weights[k + 1] * l);
            for (Index a = 0; a < N; ++a)
                for (Index b = 0; b < N; ++b) {
                    Rational h = 0;
                    for (Index i = 0; i < d; ++i)
                        for (Index j = 0; j < d; ++j)
                            h += Rational(records.psi(i, a)) * P(i, j) * Rational(records.psi(j, b));
                    E(a, b) = (a == b ? 1 : 0) - h * weights[b];
                }
            Rational freedom = 0, J = 0;
            for (Index a = 0; a < N; ++a) {
                Rational e = 0;
                for (Index b = 0; b < N; ++b)
                    freedom += weights[a] * E(a, b) * E(a, b), e += E(a, b) * Rational(records.y[b]);
                J += weights[a] * e * e;
            }
            // B = (I-H)'W(I-H), which gives J = xi'B xi: the variance of J is 2 tr B^2 of normal xi.
            Matrix<Rational> B(N, N);
            Rational variance_of_J = 0;
            for (Index a = 0; a < N; ++a)
                for (Index b = 0; b < N; ++b) {
                    B(a, b) = 0;
                    for (Index k = 0; k < N; ++k) B(a, b) += E(k, a) * weights[k] * E(k, b);
                    variance_of_J += B(a, b) * B(a, b);
                }
            Scatter const s = scattered(problem, records, {N}).front().scatter;
            auto const number = [](Rational const& x) { return static_cast<double>(x); };
            EXPECT_NEAR(s.freedom, number(freedom), 1e-12) << lambda << ' ' << variance;
            EXPECT_NEAR(s.student / number(Rational(freedom * freedom / variance_of_J)), 1, 1e-12)
                << lambda << ' ' << variance;
            EXPECT_NEAR(s.J / number(J), 1, 1e-12) << lambda << ' ' << variance;
            for (Index i = 0; i < d; ++i)
                for (Index j = 0; j < d; ++j) {
                    Rational pmp = 0;
                    for (Index a = 0; a < d; ++a)
                        for (Index b = 0; b < d; ++b) pmp += P(i, a) * M(a, b) * P(b, j);
                    EXPECT_NEAR(s.correlation(i, j) * s.sd[i] * s.sd[j] / number(pmp), 1, 1e-12)
                        << lambda << ' ' << variance << ' ' << i << j;
                }
        }
    }
}
/// What Student's quantile of so many degrees of freedom is for: 95 % intervals hold 95 %, also with a short memory.
TEST(ScatterInRationals, IntervalsCoverWithForgetting) {
    constexpr int trials = 2000;
    for (auto const& [d, lambda] : {std::pair<Index, double>{1, 0.75}, {3, 0.875}}) {
        int inside = 0;
        for (std::uint64_t t = 0; t < trials; ++t) {
            Seed seed{0x51ab + 7919 * t};
            Records records{.psi = Matrix<double>(d, 60), .y = Vector<double>(60), .names = {}};
            for (Index k = 0; k < 60; ++k) {
                for (Index i = 0; i < d; ++i) records.psi(i, k) = seed.bell();
                records.y[k] = records.psi(0, k) + 0.5 * seed.bell();
            }
            Scattered const s =
                scattered({.size = d, .forgetting = lambda, .prior = std::nullopt}, records, {60}).front();
            double const sd = s.scatter.sd[0] * std::sqrt(s.scatter.J / s.scatter.freedom);
            inside += std::abs(static_cast<double>(s.exact.theta()[0]) - 1) <=
                      correctly::student_quantile(s.scatter.student, 0.975) * sd;
        }
        EXPECT_NEAR(double(inside) / trials, 0.95, 0.025)
            << d << ' ' << lambda << ": five standard deviations of the count";
    }
}
TEST(ScatterInRationals, AFitWithoutResidualsHasNone) {
    Records const line{
        .psi = Matrix<double>{{1, 1, 1, 1}, {0, 1, 2, 3}}, .y = Vector<double>{{1, 3, 5, 7}}, .names = {}};
    auto const all = scattered({.size = 2, .prior = std::nullopt}, line, {1, 3, 4});
    EXPECT_TRUE(std::isnan(all[0].scatter.J) && std::isnan(all[0].scatter.sd[0])) << "one row does not determine two";
    EXPECT_EQ(all[2].scatter.J, 0);
    EXPECT_EQ(all[2].scatter.freedom, 2);
    EXPECT_NEAR(all[2].scatter.sd[1], std::sqrt(0.2), 1e-15);
    EXPECT_NEAR(all[1].scatter.sd[1], std::sqrt(0.5), 1e-15);
}

}  // namespace
}  // namespace rlslab
