// The certified solution: every exact rational solution lies inside its enclosure, and its status says when there is
// none.
#include "tests/common/exact_fit.hpp"

#include <rlslab/core/random.hpp>
#include <rlslab/reference/certified.hpp>

#include <flint/flint.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <thread>

namespace rlslab {
namespace {

struct Random : Seed {
    double uniform() { return double(std::int64_t(next()) >> 11) * 0x1p-52; }  // in [-1, 1)
};

Records random_records(Index d, Index rows, std::uint64_t seed) {
    Random random{{seed}};
    Records data{.psi = Eigen::MatrixXd(d, rows), .y = Vector<double>(rows), .names = {}};
    for (Index k = 0; k < rows; ++k) {
        for (Index i = 0; i < d; ++i) data.psi(i, k) = random.uniform();
        data.y(k) = random.uniform();
    }
    return data;
}

Matrix<double> random_covariance(Index d, std::uint64_t seed) {
    Random random{{seed}};
    Matrix<double> A(d, d);
    for (double& a : A.reshaped()) a = std::ldexp(std::round(random.uniform() * 64), -6);
    return A * A.transpose() + Matrix<double>::Identity(d, d);  // exact: few bits
}

struct Truth {
    Vector<Rational> theta;
    Matrix<Rational> covariance;
};

enum class Order { as_documented, reversed };

/// The definition in Problem, term by term.
Truth truth(Problem<double> const& problem, Records const& data, Index k, Order order = Order::as_documented) {
    Index const d = problem.size;
    Rational const lambda = problem.forgetting;
    Matrix<Rational> M = Matrix<Rational>::Constant(d, d, Rational(0));
    Vector<Rational> b = Vector<Rational>::Constant(d, Rational(0));
    std::vector<Rational> power{1};
    for (Index i = 0; i < k; ++i) power.push_back(power.back() * lambda);
    if (problem.prior) {
        Matrix<Rational> P0(d, d);
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i)
                P0(i, j) = problem.prior->covariance ? (*problem.prior->covariance)(i, j)
                           : i == j                  ? problem.prior->variance
                                                     : 0;
        Matrix<Rational> const inverse = exact_fit::inverse(P0);
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) {
                M(i, j) += power[size_t(k)] * inverse(i, j);
                if (!problem.prior->theta) continue;
                b(i) += power[size_t(k)] * inverse(i, j) * Rational((*problem.prior->theta)(j));
            }
    }
    for (Index row = 0; row < k; ++row) {
        Rational const weight = power[size_t(order == Order::as_documented ? k - 1 - row : row)];
        for (Index j = 0; j < d; ++j) {
            for (Index i = 0; i < d; ++i) M(i, j) += weight * Rational(data.psi(i, row)) * Rational(data.psi(j, row));
            b(j) += weight * Rational(data.psi(j, row)) * Rational(data.y(row));
        }
    }
    Matrix<Rational> const P = exact_fit::inverse(M);
    Vector<Rational> theta = Vector<Rational>::Constant(d, Rational(0));
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i) theta(i) += P(i, j) * b(j);
    return {theta, P};
}

std::vector<Problem<double>> problems(Index d) {
    std::vector<Problem<double>> all;
    for (double const lambda : {1.0, 31.0 / 32, 0.99}) {
        all.push_back({.size = d, .forgetting = lambda, .prior = std::nullopt});
        all.push_back({.size = d, .forgetting = lambda});
        all.push_back({.size = d, .forgetting = lambda, .prior = Prior<double>{.variance = 0.3}});
        Vector<double> const theta0 = Vector<double>::LinSpaced(d, -0.7, 2.1);
        all.push_back({.size = d, .forgetting = lambda, .prior = Prior<double>{.variance = 3, .theta = theta0}});
        all.push_back({.size = d,
                       .forgetting = lambda,
                       .prior = Prior<double>{.theta = theta0, .covariance = random_covariance(d, 5)}});
    }
    return all;
}

TEST(Certified, EnclosesTheRationalSolution) {
    for (Index const d : {1, 2, 5})
        for (auto const& problem : problems(d)) {
            Records const data = random_records(d, 70, 100 + std::uint64_t(d));
            // 64 rows are a block of the recursion: steps at, just before and after its edges
            std::vector<Index> const steps{d, d + 1, 17, 63, 64, 65, 70};
            auto const exact = certified(problem, data, steps);
            ASSERT_EQ(exact.size(), steps.size());
            for (size_t s = 0; s < steps.size(); ++s) {
                Truth const t = truth(problem, data, steps[s]);
                ASSERT_EQ(exact[s].status(), Status::certified);
                EXPECT_EQ(exact[s].step(), steps[s]);
                EXPECT_EQ(exact[s].rank(), d);
                EXPECT_TRUE(exact[s].encloses(t.theta)) << "lambda " << problem.forgetting << " step " << steps[s];
                EXPECT_TRUE(exact[s].encloses(t.covariance));
                EXPECT_LE(exact[s].radius(), 1e-30);
                EXPECT_LE(exact[s].covariance_radius(), double(d) * 1e-30);
            }
        }
}

TEST(Certified, EnclosureSeesOneUlpOfLambdaAndTheOrderOfTheWeights) {
    Records const data = random_records(3, 12, 7);
    Problem<double> const problem{.size = 3, .forgetting = 0.99};
    CertifiedSolution const exact = certified(problem, data, {12}).front();
    EXPECT_TRUE(exact.encloses(truth(problem, data, 12).theta));

    Problem<double> off = problem;
    off.forgetting = std::nextafter(0.99, 1.0);
    EXPECT_FALSE(exact.encloses(truth(off, data, 12).theta));
    EXPECT_FALSE(exact.encloses(truth(off, data, 12).covariance));
    EXPECT_FALSE(certified(off, data, {12}).front().encloses(truth(problem, data, 12).theta));

    EXPECT_FALSE(exact.encloses(truth(problem, data, 12, Order::reversed).theta));
    EXPECT_FALSE(exact.encloses(truth(problem, data, 12, Order::reversed).covariance));

    Problem<double> without = problem;
    without.prior = std::nullopt;
    EXPECT_FALSE(exact.encloses(truth(without, data, 12).theta));
}

TEST(Certified, EveryStepAskedForIsTheStepAskedForAlone) {
    Records const data = random_records(4, 130, 9);
    for (double const lambda : {1.0, 0.9}) {
        Problem<double> const problem{.size = 4, .forgetting = lambda};
        std::vector<Index> steps;
        for (Index k = 1; k <= data.rows(); ++k) steps.push_back(k);
        auto const all = certified(problem, data, steps);
        for (Index const k : {1, 2, 64, 100, 130}) {
            CertifiedSolution const alone = certified(problem, data, {k}).front();
            EXPECT_EQ(alone.theta_strings(), all[size_t(k - 1)].theta_strings());
            EXPECT_EQ(alone.step(), all[size_t(k - 1)].step());
        }
        EXPECT_EQ(certified(problem, data, {7, 7}).back().theta_strings(), all[6].theta_strings());
    }
}

TEST(Certified, WildScalesAreExact) {
    Records data = random_records(3, 10, 21);
    data.psi.row(0) *= 1e150;
    data.psi.row(1) *= 1e-150;
    data.psi(2, 4) = 1e300;  // and one entry far from its column
    data.psi(2, 5) = std::numeric_limits<double>::denorm_min();
    for (double const lambda : {1.0, 0.99}) {
        Problem<double> const problem{.size = 3, .forgetting = lambda, .prior = std::nullopt};
        CertifiedSolution const exact = certified(problem, data, {10}).front();
        ASSERT_EQ(exact.status(), Status::certified);
        Truth const t = truth(problem, data, 10);
        EXPECT_TRUE(exact.encloses(t.theta));
        EXPECT_TRUE(exact.encloses(t.covariance));
    }
}

TEST(Certified, PrecisionRisesWithIllConditioning) {
    for (double const lambda : {1.0, 0.99}) {
        std::vector<int> bits;
        for (Index const d : {4, 8, 12}) {
            Records data{.psi = Eigen::MatrixXd(d, d + 2), .y = Vector<double>::LinSpaced(d + 2, 1, 2), .names = {}};
            for (Index k = 0; k < d + 2; ++k)
                for (Index i = 0; i < d; ++i) data.psi(i, k) = 1.0 / double(i + k + 1);  // Hilbert
            Problem<double> const problem{.size = d, .forgetting = lambda, .prior = std::nullopt};
            CertifiedSolution const exact = certified(problem, data, {d + 2}).front();
            ASSERT_EQ(exact.status(), Status::certified);
            Truth const t = truth(problem, data, d + 2);
            EXPECT_TRUE(exact.encloses(t.theta));
            EXPECT_TRUE(exact.encloses(t.covariance));
            bits.push_back(exact.bits());
        }
        EXPECT_LE(bits[0], bits[1]);
        EXPECT_LT(bits[0], bits[2]);
    }
}

TEST(Certified, PrecisionFollowsThePriorIntoWindUp) {
    // Twin regressors: their difference is known from the prior alone, by 0.9^k of it.
    Records data = random_records(2, 3000, 17);
    data.psi.row(1) = data.psi.row(0);
    Problem<double> const problem{.size = 2, .forgetting = 0.9};
    auto const exact = certified(problem, data, {20, 300, 3000});
    for (auto const& e : exact) EXPECT_EQ(e.status(), Status::certified);
    EXPECT_TRUE(exact[1].encloses(truth(problem, data, 300).theta));
    EXPECT_TRUE(exact[1].encloses(truth(problem, data, 300).covariance));
    EXPECT_GT(exact[2].bits(), 3000 * std::log2(1 / 0.9));
    EXPECT_GT(exact[2].covariance()(0, 0), 1e130);
}

TEST(Certified, UnresolvedIsSaid) {
    // Twins again; after 400 rows the prior is 2^-80000 of the data, and no more than 2^16 bits are carried.
    Records data = random_records(2, 400, 17);
    data.psi.row(1) = data.psi.row(0);
    auto const exact = certified({.size = 2, .forgetting = 0x1p-200}, data, {1, 100, 400});
    EXPECT_EQ(exact[1].status(), Status::certified);
    EXPECT_GT(exact[1].bits(), 20000);
    EXPECT_EQ(exact[2].status(), Status::unresolved);
    EXPECT_TRUE(std::isnan(exact[2].radius()));
    EXPECT_TRUE(isnan(exact[2].covariance()(1, 1)));
}

TEST(Certified, MoreDigitsOnRequest) {
    Records const data = random_records(3, 20, 4);
    Problem<double> const problem{.size = 3, .forgetting = 0.99};
    CertifiedSolution const exact = certified(problem, data, {20}, 500).front();
    ASSERT_EQ(exact.status(), Status::certified);
    EXPECT_TRUE(exact.encloses(truth(problem, data, 20).theta));
    EXPECT_LE(exact.radius(), 1e-300) << "as near to 10^-500 as a double bound goes";
    EXPECT_EQ(exact.theta_strings(400)[0].substr(0, 20),
              certified(problem, data, {20}).front().theta_strings()[0].substr(0, 20));
}

TEST(Certified, ZeroSolutionsAndComponents) {
    Records data = random_records(3, 20, 4);
    data.y = 2 * data.psi.row(0).transpose();  // theta = (2, 0, 0) exactly
    for (double const lambda : {1.0, 0.99}) {
        Problem<double> const problem{.size = 3, .forgetting = lambda, .prior = std::nullopt};
        CertifiedSolution const exact = certified(problem, data, {20}).front();
        ASSERT_EQ(exact.status(), Status::certified);
        EXPECT_EQ(exact.theta_strings(5), (std::vector<std::string>{"2.0000e0", "0", "0"}));
        Vector<Rational> theta(3);
        theta << 2, 0, 0;
        EXPECT_TRUE(exact.encloses(theta));
        Records zero = data;
        zero.y.setZero();
        CertifiedSolution const nothing = certified(problem, zero, {20}).front();
        ASSERT_EQ(nothing.status(), Status::certified);
        EXPECT_EQ(nothing.radius(), 0);
        EXPECT_EQ(nothing.theta_strings(5), (std::vector<std::string>{"0", "0", "0"}));
    }
}

TEST(Certified, SingularIsProvenByItsRank) {
    Records data = random_records(4, 30, 13);
    data.psi.row(3) = data.psi.row(0);  // twins until row 20
    data.psi(3, 20) = std::nextafter(data.psi(0, 20), 2.0);
    for (double const lambda : {1.0, 0.99}) {
        Problem<double> problem{.size = 4, .forgetting = lambda, .prior = std::nullopt};
        auto const exact = certified(problem, data, {1, 2, 3, 4, 20, 21, 30});
        std::vector<Index> ranks;
        for (auto const& e : exact) {
            ranks.push_back(e.rank());
            EXPECT_EQ(e.status(), e.rank() == 4 ? Status::certified : Status::singular);
        }
        EXPECT_EQ(ranks, (std::vector<Index>{1, 2, 3, 3, 3, 4, 4}));
        EXPECT_TRUE(exact[5].encloses(truth(problem, data, 21).theta)) << "one ulp from singular";
        EXPECT_TRUE(std::isnan(exact[0].radius()));
        EXPECT_TRUE(isnan(exact[0].theta()(2)));
        EXPECT_EQ(exact[0].theta_strings()[0], "nan");
        EXPECT_EQ(exact[0].bits(), 0);

        problem.prior = Prior<double>{};
        EXPECT_EQ(certified(problem, data, {1}).front().status(), Status::certified);
        problem.prior = std::nullopt;
        data.psi.row(2).setZero();
        EXPECT_EQ(certified(problem, data, {20}).front().rank(), 2);
        data = random_records(4, 30, 13);
        data.psi.row(3) = data.psi.row(0);
        data.psi(3, 20) = std::nextafter(data.psi(0, 20), 2.0);
    }
}

TEST(Certified, RankSurvivesTheChosenPrime) {
    // det [[1, 2^61], [1, 1]] = 1 - 2^61 vanishes modulo the Mersenne prime; the integers know better.
    Records data{.psi = Eigen::MatrixXd(2, 2), .y = Vector<double>::Ones(2), .names = {}};
    data.psi << 1, 1, 0x1p61, 1;
    Problem<double> const problem{.size = 2, .prior = std::nullopt};
    EXPECT_EQ(certified(problem, data, {2}).front().rank(), 2);
    EXPECT_EQ(certified(problem, data, {2}).front().status(), Status::certified);
}

TEST(Certified, NonfiniteDataAreUndefinedFromThereOn) {
    double const inf = std::numeric_limits<double>::infinity();
    Records data = random_records(2, 10, 3);
    data.y(6) = inf;
    Problem<double> problem{.size = 2};
    auto const exact = certified(problem, data, {6, 7, 10});
    EXPECT_EQ(exact[0].status(), Status::certified);
    EXPECT_EQ(exact[1].status(), Status::undefined);
    EXPECT_EQ(exact[2].status(), Status::undefined);
    data.psi(0, 0) = std::nan("");
    EXPECT_EQ(certified(problem, data, {1}).front().status(), Status::undefined);

    data = random_records(2, 10, 3);
    problem.prior->variance = inf;
    EXPECT_EQ(certified(problem, data, {3}).front().status(), Status::undefined);
    problem.prior = Prior<double>{.theta = Vector<double>::Constant(2, inf)};
    EXPECT_EQ(certified(problem, data, {3}).front().status(), Status::undefined);
    problem.prior = Prior<double>{.covariance = Matrix<double>::Ones(2, 2)};
    EXPECT_EQ(certified(problem, data, {3}).front().status(), Status::undefined) << "P0 is singular";
}

TEST(Certified, MisuseThrows) {
    Records const data = random_records(2, 10, 3);
    Problem<double> problem{.size = 2};
    EXPECT_THROW(certified(problem, data, {0}), std::invalid_argument);
    EXPECT_THROW(certified(problem, data, {11}), std::invalid_argument);
    EXPECT_THROW(certified(problem, data, {3, 2}), std::invalid_argument);
    EXPECT_THROW(certified(problem, data, {3}, 0), std::invalid_argument);
    EXPECT_THROW(certified({.size = 3}, data, {3}), std::invalid_argument);
    problem.prior->covariance = (Matrix<double>(2, 2) << 2, 1, 0, 2).finished();
    EXPECT_THROW(certified(problem, data, {3}), std::invalid_argument);
    EXPECT_TRUE(certified({.size = 2}, data, {}).empty());
}

TEST(Certified, LongleyToThirtyDigits) {
    constexpr double rows[16][7] = {
        {83.0, 234289, 2356, 1590, 107608, 1947, 60323},  {88.5, 259426, 2325, 1456, 108632, 1948, 61122},
        {88.2, 258054, 3682, 1616, 109773, 1949, 60171},  {89.5, 284599, 3351, 1650, 110929, 1950, 61187},
        {96.2, 328975, 2099, 3099, 112075, 1951, 63221},  {98.1, 346999, 1932, 3594, 113270, 1952, 63639},
        {99.0, 365385, 1870, 3547, 115094, 1953, 64989},  {100.0, 363112, 3578, 3350, 116219, 1954, 63761},
        {101.2, 397469, 2904, 3048, 117388, 1955, 66019}, {104.6, 419180, 2822, 2857, 118734, 1956, 67857},
        {108.4, 442769, 2936, 2798, 120445, 1957, 68169}, {110.8, 444546, 4681, 2637, 121950, 1958, 66513},
        {112.6, 482704, 3813, 2552, 123366, 1959, 68655}, {114.2, 502601, 3931, 2514, 125368, 1960, 69564},
        {115.7, 518173, 4806, 2572, 127852, 1961, 69331}, {116.9, 554894, 4007, 2827, 130081, 1962, 70551}};
    // Decimal data are the definition; ten times x1 makes them integers, and its coefficient a tenth.
    Records data{.psi = Eigen::MatrixXd(7, 16), .y = Vector<double>(16), .names = {}};
    for (Index k = 0; k < 16; ++k) {
        data.psi(0, k) = 1;
        for (Index i = 0; i < 6; ++i) data.psi(i + 1, k) = rows[k][i];
        data.psi(1, k) = std::round(rows[k][0] * 10);
        data.y(k) = rows[k][6];
    }
    CertifiedSolution const exact = certified({.size = 7, .prior = std::nullopt}, data, {16}).front();
    ASSERT_EQ(exact.status(), Status::certified);
    EXPECT_EQ(exact.theta_strings(),
              (std::vector<std::string>{"-3.48225863459581832527689742876e6", "1.50618722713732949699884679430e0",
                                        "-3.58191792925910166168577525360e-2", "-2.02022980381682508565347406204e0",
                                        "-1.03322686717359197549469146328e0", "-5.11041056535807144706642656987e-2",
                                        "1.82915146461355184522976668424e3"}));
}

TEST(Certified, TheSameFromEveryThread) {
    Records const data = random_records(5, 200, 31);
    Problem<double> const problem{.size = 5, .forgetting = 0.97};
    auto const here = certified(problem, data, {50, 200});
    std::array<std::vector<CertifiedSolution>, 4> there;
    std::array<std::thread, 4> threads;
    for (size_t i = 0; i < 4; ++i)
        threads[i] = std::thread([&, i] {
            there[i] = certified(problem, data, {50, 200});
            flint_cleanup();
        });
    for (auto& thread : threads) thread.join();
    for (auto const& answers : there)
        for (size_t s = 0; s < 2; ++s) {
            EXPECT_EQ(answers[s].theta_strings(60), here[s].theta_strings(60));
            EXPECT_EQ(answers[s].radius(), here[s].radius());
        }
}

}  // namespace
}  // namespace rlslab
