// The covariance to which that of extended least squares tends.
#pragma once

#include <rlslab/core/matrices.hpp>

#include <Eigen/LU>
#include <cmath>
#include <vector>

namespace rlslab::identify {

/// The standard deviations of the limit Sigma / N of docs/theory.md 89, from its rows phi (d x N; 0 where one is
/// missing), P and sigma^2: with z = phi / C, A = P sum phi z' and M = A - I/2
///   M X + X M' = sigma^2 P,        sd_i = sqrt(X_ii)
/// by doubling, with F = A^-1 (A - I) and in units of sqrt P_ii:  X = F X F' + A^-1 sigma^2 P A^-T
/// NaN where M has an eigenvalue with a real part of 0 or less: there is no such limit. C must be stable.
inline Vector<double> limit_deviations(Matrix<double> const& phi, std::vector<double> const& c, Matrix<double> const& P,
                                       double sigma2) {
    Index const d = phi.rows();
    Matrix<double> z = phi;
    for (Index k = 0; k < phi.cols(); ++k)
        for (Index i = 1; i <= std::min<Index>(k, Index(c.size())); ++i) z.col(k) -= c[size_t(i - 1)] * z.col(k - i);
    Vector<double> const unit = P.diagonal().cwiseSqrt();
    Matrix<double> const scaled = unit.cwiseInverse().asDiagonal() * P * unit.cwiseInverse().asDiagonal(),
                         A = scaled * (unit.asDiagonal() * phi * (z.transpose() * unit.asDiagonal())),
                         I = Matrix<double>::Identity(d, d), inverse = A.inverse();  // A = M + I/2
    Matrix<double> F = inverse * (A - I), X = inverse * scaled * inverse.transpose();
    for (int j = 0; j < 60 && F.squaredNorm() > 1e-40 && F.allFinite(); ++j) {
        X += (F * X * F.transpose()).eval();
        F = (F * F).eval();
    }
    if (!(F.squaredNorm() <= 1e-40)) return Vector<double>::Constant(d, NAN);
    return std::sqrt(sigma2) * unit.cwiseProduct(X.diagonal().cwiseSqrt());
}

}  // namespace rlslab::identify
