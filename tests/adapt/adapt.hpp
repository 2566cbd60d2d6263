// What the tests of adapt/ share: rows, P of a filter, comparisons.
#pragma once

#include <rlslab/core/random.hpp>
#include <rlslab/core/stored.hpp>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace rlslab::adapt_laws {

/// One row of bell-shaped noise in psi and y = psi'(1, -2, 3, ...) + noise.
template <class T, int N>
T draw(Seed& seed, T (&psi)[N], double noise = 0.125, double sign = 1) {
    double y = noise * seed.bell();
    for (int i = 0; i < N; ++i) {
        psi[i] = T(seed.bell());
        y += double(psi[i]) * sign * (i % 2 ? -(i + 1) : i + 1);
    }
    return T(y);
}
template <class F>
void run_rows(F& f, int rows, Seed seed) {
    typename F::scalar psi[decltype(f.theta())::SizeAtCompileTime];
    for (int k = 0; k < rows; ++k) {
        auto const y = draw(seed, psi);
        f.update(psi, y);
    }
}

/// P in double, from whatever is stored.
template <class F>
Matrix<double> covariance_of(F const& f) {
    auto const stored = f.stored();
    Matrix<double> X = stored.F.template cast<double>();
    if (stored.form == std::remove_cvref_t<decltype(stored)>::Form::factor) {
        Matrix<double> const G = X;
        if (stored.D.size() > 0) X = G * stored.D.template cast<double>().asDiagonal() * G.transpose();
        else X = G * G.transpose();
    }
    if (stored.quantity == std::remove_cvref_t<decltype(stored)>::Quantity::information) return X.inverse();
    return X;
}
inline double relative(Matrix<double> const& a, Matrix<double> const& b) {
    return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

/// The same stored bits and the same theta.
template <class F>
bool identical(F const& a, F const& b) {
    auto const x = a.stored(), y = b.stored();
    return x.F == y.F && x.D == y.D && a.theta() == b.theta();
}

}  // namespace rlslab::adapt_laws
