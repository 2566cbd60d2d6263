// Joseph's products and the units of the columns (docs/theory.md 119): scaling by powers of two changes no bit.
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/joseph.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/symmetric.hpp>

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

namespace rlslab {
namespace {

/// rows x d numbers with the singular values kappa^(-i/(d-1)) sqrt(rows), in random directions, and outputs.
struct Rows {
    Eigen::MatrixXd psi;
    Eigen::VectorXd y;
};
Rows rotated(Index d, Index rows, double kappa, Seed seed) {
    Eigen::MatrixXd A(rows, d), B(d, d);
    for (double& x : A.reshaped()) x = seed.bell();
    for (double& x : B.reshaped()) x = seed.bell();
    Eigen::MatrixXd const V = B.householderQr().householderQ();
    Eigen::VectorXd sizes(d);
    for (Index i = 0; i < d; ++i) sizes[i] = std::pow(kappa, -double(i) / double(std::max<Index>(d - 1, 1)));
    Rows out{A * sizes.asDiagonal() * V.transpose(), Eigen::VectorXd(rows)};
    for (Index k = 0; k < rows; ++k) out.y[k] = out.psi.row(k).sum() + seed.bell() / 8;
    return out;
}
template <class T>
Problem<T> problem(Index d, double forgetting, double variance) {
    return {.size = d, .forgetting = T(forgetting), .prior = Prior<T>{.variance = T(variance)}};
}

/// Scaled by powers of two, the prior along: every stored number is the other times its power of two.
template <class F>
void expect_units_change_no_bit(Index d, double lambda) {
    using T = typename F::scalar;
    Rows const data = rotated(d, 8 * d, 1000, Seed{7});
    Vector<T> size(d);
    for (Index i = 0; i < d; ++i) size[i] = T(std::ldexp(1.0, int(5 * i) - 7));
    Problem<T> const natural = problem<T>(d, lambda, 4096);
    Problem<T> scaled = natural;
    scaled.prior->covariance = Matrix<T>::Zero(d, d).eval();
    for (Index i = 0; i < d; ++i) (*scaled.prior->covariance)(i, i) = T(4096) / (size[i] * size[i]);
    F a(natural), b(scaled);
    for (Index k = 0; k < data.psi.rows(); ++k) {
        Vector<T> psi(d), times(d);
        for (Index i = 0; i < d; ++i) psi[i] = T(data.psi(k, i)), times[i] = psi[i] * size[i];
        Step<T> const x = a.update(psi, T(data.y[k])), y = b.update(times, T(data.y[k]));
        EXPECT_TRUE(x.innovation == y.innovation && x.gamma == y.gamma && x.residual == y.residual) << F::name << k;
        Stored<T> const P = a.stored(), Q = b.stored();
        for (Index j = 0; j < d; ++j) {
            EXPECT_TRUE(a.theta()[j] == b.theta()[j] * size[j]) << F::name;
            for (Index i = 0; i < d; ++i)
                EXPECT_TRUE(P.F(i, j) == Q.F(i, j) * size[i] * size[j]) << F::name << k << i << j;
        }
    }
}
TEST(Units, OfPowersOfTwoChangeNoBitOfJosephsProducts) {
    auto const in = []<class T>() {
        for (Index const d : {1, 2, 4, 9})
            for (double const lambda : {1.0, 0.96875}) {
                expect_units_change_no_bit<Joseph<T>>(d, lambda);
                expect_units_change_no_bit<JosephRankTwo<T>>(d, lambda);
                expect_units_change_no_bit<Symmetric<T>>(d, lambda);
            }
    };
    in.template operator()<double>();
    in.template operator()<float>();
    in.template operator()<BFloat16>();
}

}  // namespace
}  // namespace rlslab
