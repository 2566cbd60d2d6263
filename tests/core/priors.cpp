// A full P0 as people have it: an inverse, or what a filter reports; and the P0 that is taken where none is given.
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

namespace rlslab {
namespace {

template <class F>
Problem<typename F::scalar> with(Matrix<typename F::scalar> const& P) {
    using T = typename F::scalar;
    return {.size = P.rows(), .prior = Prior<T>{.covariance = P}};
}
template <class F>
std::string refusal(Matrix<typename F::scalar> const& P) {
    try {
        F f(with<F>(P));
        return "";
    } catch (std::invalid_argument const& error) {
        return error.what();
    }
}
Matrix<double> noise(Index rows, Index columns, Seed seed) {
    Matrix<double> X(rows, columns);
    for (Index j = 0; j < columns; ++j)
        for (Index i = 0; i < rows; ++i) X(i, j) = seed.bell();
    return X;
}
Matrix<double> upper_mirrored(Matrix<double> P) {
    for (Index j = 0; j < P.cols(); ++j)
        for (Index i = 0; i < j; ++i) P(j, i) = P(i, j);
    return P;
}

/// Inverses of 2 to 10 parameters, in units from 1e-4 to 1e4: nearly each differs from its transpose by rounding. The
/// upper triangle is what a filter takes.
TEST(Priors, MayHaveTheAsymmetryOfRounding) {
    int asymmetric = 0;
    for (Index const d : {2, 3, 4, 6, 10})
        for (std::uint64_t i = 0; i < 20; ++i) {
            Matrix<double> X = noise(3 * d, d, Seed{100 * std::uint64_t(d) + i});
            if (i % 2)
                for (Index j = 0; j < d; ++j) X.col(j) *= std::pow(10, j % 9 - 4);
            Matrix<double> const P = (X.transpose() * X).inverse(), mirrored = upper_mirrored(P);
            asymmetric += !(P == Matrix<double>(P.transpose()));
            Vector<double> const psi = X.row(0).transpose();
            for_each(Variants<double>{}, [&]<class F>() {
                ASSERT_EQ(refusal<F>(P), "") << F::name << ' ' << d << ' ' << i;
                F f(with<F>(P)), g(with<F>(mirrored));
                f.update(psi, 1.0), g.update(psi, 1.0);
                EXPECT_EQ(Vector<double>(f.theta()), Vector<double>(g.theta())) << F::name;
                EXPECT_EQ(f.stored().F, g.stored().F) << F::name;
            });
        }
    EXPECT_GE(asymmetric, 60);
}
/// What a form that stores all of P reports is a prior again: a restart is possible.
TEST(Priors, MayBeTheCovarianceOfAFilter) {
    Matrix<double> const X = noise(60, 4, Seed{3});
    for_each(Variants<double>{}, [&]<class F>() {
        if constexpr (ReportsCovariance<F>) {
            F f({.size = 4, .forgetting = 0.96875});
            for (Index k = 0; k < 60; ++k) f.update(Vector<double>(X.row(k).transpose()), 1.0);
            EXPECT_EQ(refusal<F>(f.covariance()), "") << F::name;
        }
    });
}
TEST(Priors, ThatAreNotSymmetricAreRefusedWithTheRemedy) {
    Matrix<double> P{{1e-8, 3e-5, 0}, {3e-5, 1, 1e3}, {0, 1e3, 1e8}};  // by its scale: 1, 0.3, 0.1
    EXPECT_EQ(refusal<Ud<double>>(P), "");
    for (double const by : {1e-9, -1e-9}) {
        Matrix<double> Q = P;
        Q(2, 1) += by * 1e4;
        EXPECT_EQ(refusal<Ud<double>>(Q), "") << by;
        EXPECT_EQ(refusal<Symmetric<double>>(Q), "") << by;
    }
    for (double const by : {1e-7, -1e-3, 0.5, double(NAN), double(INFINITY)})
        for (auto const& [i, j] : {std::pair<Index, Index>(0, 1), std::pair<Index, Index>(2, 1)}) {
            Matrix<double> Q = P;
            Q(i, j) += by * std::sqrt(P(i, i) * P(j, j));
            EXPECT_THAT(refusal<Ud<double>>(Q), testing::HasSubstr("(P + P')/2")) << by << i << j;
            EXPECT_THAT(refusal<Kalman<double>>(Q), testing::HasSubstr("(P + P')/2")) << by << i << j;
        }
    Matrix<float> const F{{1, 0.5f}, {0.5001f, 1}}, G{{1, 0.5f}, {0.501f, 1}};
    EXPECT_EQ(refusal<Joseph<float>>(F), "");
    EXPECT_NE(refusal<Joseph<float>>(G), "");
}

/// 2^14, and in formats of few exponents half of them: s = lambda + psi'P0 psi stays in their range.
TEST(Priors, KnowTheExponentsOfTheArithmetic) {
    EXPECT_EQ(Prior<float>{}.variance, 16384);
    EXPECT_EQ(Prior<double>{}.variance, 16384);
    EXPECT_EQ(double(Prior<Chopped<bfloat16>>{}.variance), 16384);
    EXPECT_EQ(double(Prior<Chopped<binary16>>{}.variance), 128);
    {
        PrecisionScope const precision(RunTimeFormat{binary16});
        EXPECT_EQ(double(Prior<VariablePrecision>{}.variance), 128);
    }
    using Half = Chopped<binary16>;
    for_each(TypeList<Ud<Half>, UdDelta<Half>, CarlsonDelta<Half>, InverseQrDelta<Half>>{}, []<class F>() {
        int runs = 0;
        for (std::uint64_t run = 0; run < 40; ++run) {
            Seed seed{500 + run};
            F f({.size = 4, .forgetting = Half(0.99)});
            double const scale[] = {3, 1, 0.3, 0.1};
            Health worst = Health::sound;
            for (int k = 0; k < 200; ++k) {
                Half psi[4];
                double y = 0.1 * seed.bell();
                for (int i = 0; i < 4; ++i) psi[i] = Half(scale[i] * seed.bell()), y += double(psi[i]);
                worst = worse(worst, f.update(psi, Half(y)).health);
            }
            runs += worst != Health::sound;
        }
        EXPECT_EQ(runs, 0) << F::name;
    });
}

}  // namespace
}  // namespace rlslab
