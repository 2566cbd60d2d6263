// The Kalman view: where its filter is recursive least squares, to the bit or exactly, and where a walk makes the
// difference.
#include "tests/common/laws.hpp"

#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/kalman.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

TEST(Kalman, WithoutWalkOrForgettingItIsTheConventionalFormBitForBit) {
    for (Index d : {1, 3, 4, 9, 20}) {
        Records const records = laws::noise_records(d, 200, Seed{std::uint64_t(d)});
        Kalman<double> kalman(laws::problem(d));
        Conventional<double> conventional(laws::problem(d));
        for (Index k = 0; k < records.rows(); ++k) {
            Step<double> const a = kalman.update(records.sample(k), records.y[k]),
                               b = conventional.update(records.sample(k), records.y[k]);
            EXPECT_EQ(a.innovation, b.innovation);
            EXPECT_EQ(a.gamma, b.gamma);
        }
        EXPECT_TRUE(kalman.theta() == conventional.theta()) << d;
        EXPECT_TRUE(kalman.covariance() == conventional.covariance()) << d;
        EXPECT_TRUE(kalman.gain() == conventional.gain()) << d;
    }
}

Vector<Rational> rational(Seed& seed, Index n) {
    Vector<Rational> out(n);
    for (Rational& x : out) x = Rational(int(seed.next() % 21) - 10, 3);
    return out;
}

TEST(Kalman, ForgettingInflatesTheCovarianceExactly) {
    Problem<Rational> const problem{
        .size = 3, .forgetting = Rational(9, 10), .prior = Prior<Rational>{.variance = Rational(5)}};
    Kalman<Rational> kalman(problem);
    Conventional<Rational> conventional(problem);
    Seed seed{2};
    for (int k = 0; k < 8; ++k) {
        Vector<Rational> const psi = rational(seed, 3);
        Rational const y = rational(seed, 1)[0];
        Step<Rational> const a = kalman.update(psi, y), b = conventional.update(psi, y);
        EXPECT_EQ(a.gamma, b.gamma);
        EXPECT_EQ(a.residual, b.residual);
    }
    EXPECT_TRUE(Matrix<Rational>(kalman.covariance()) == Matrix<Rational>(conventional.covariance()));
    EXPECT_TRUE(Vector<Rational>(kalman.theta()) == Vector<Rational>(conventional.theta()));
}

/// P- = P / lambda + Q, a walk on top of forgetting: the inverses of 2 x 2 matrices by Cramer's rule, P^-1 = P-^-1 +
/// psi psi'.
TEST(Kalman, AWalkIsAddedToWhatForgettingLeavesExactly) {
    Rational const lambda(9, 10);
    Matrix<Rational> const Q{{Rational(1, 4), Rational(1, 8)}, {Rational(1, 8), Rational(1, 2)}};
    Kalman<Rational> filter({.size = 2, .forgetting = lambda, .prior = Prior<Rational>{.variance = Rational(5)}}, Q);
    auto const inverse = [](Matrix<Rational> const& A) {
        Rational const det = A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0);
        return Matrix<Rational>{{Rational(A(1, 1) / det), Rational(-A(0, 1) / det)},
                                {Rational(-A(1, 0) / det), Rational(A(0, 0) / det)}};
    };
    Matrix<Rational> P{{Rational(5), Rational(0)}, {Rational(0), Rational(5)}};
    Seed seed{4};
    for (int k = 0; k < 6; ++k) {
        Vector<Rational> const psi = rational(seed, 2);
        filter.update(psi, rational(seed, 1)[0]);
        Matrix<Rational> before(2, 2);
        for (Index j = 0; j < 2; ++j)
            for (Index i = 0; i < 2; ++i) before(i, j) = P(i, j) / lambda + Q(i, j);
        Matrix<Rational> X = inverse(before);
        for (Index j = 0; j < 2; ++j)
            for (Index i = 0; i < 2; ++i) X(i, j) += psi[i] * psi[j];
        P = inverse(X);
        EXPECT_TRUE(Matrix<Rational>(filter.covariance()) == P) << k;
    }
}

/// The scalar walk with psi = 1: P settles at the root of P^2 + Q P - Q = 0 (Riccati), and theta follows a step in 1/K
/// rows.
TEST(Kalman, AWalkSettlesWhereTheRiccatiEquationSays) {
    double const Q = 0.01;
    Kalman<double, 1> filter({.size = 1}, Matrix<double>{{Q}});
    for (int k = 0; k < 500; ++k) filter.update(Vector<double>{{1.0}}, 0.0);
    double const stationary = (-Q + std::sqrt(Q * Q + 4 * Q)) / 2;
    EXPECT_NEAR(filter.covariance()(0, 0), stationary, 1e-15);
    double const K = filter.gain()[0];
    for (int k = 0; k < 20; ++k) filter.update(Vector<double>{{1.0}}, 1.0);
    EXPECT_NEAR(filter.theta()[0], 1 - std::pow(1 - K, 20), 1e-14);
    EXPECT_THROW((Kalman<double>({.size = 2}, Matrix<double>{{Q}})), std::invalid_argument);
}

}  // namespace
}  // namespace rlslab
