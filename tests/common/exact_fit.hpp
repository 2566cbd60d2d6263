// Least squares in rationals, by elimination; uses nothing of the library except its data types.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/records.hpp>

#include <cmath>

namespace rlslab::exact_fit {

struct Fit {
    Vector<Rational> theta, residuals;
    Matrix<Rational> inverse;  // (Phi'Phi)^-1
    Rational J;
    double sigma2(Index freedom) const { return static_cast<double>(Rational(J / freedom)); }
    double sd(Index i, Index freedom) const {
        return std::sqrt(static_cast<double>(Rational(J / freedom * inverse(i, i))));
    }
};

/// Of a positive definite matrix, by Gauss and Jordan: no pivoting.
inline Matrix<Rational> inverse(Matrix<Rational> A) {
    Index const d = A.rows();
    Matrix<Rational> X = Matrix<Rational>::Constant(d, d, Rational(0));
    for (Index i = 0; i < d; ++i) X(i, i) = 1;
    for (Index i = 0; i < d; ++i) {
        Rational const pivot = A(i, i);
        for (Index j = 0; j < d; ++j) A(i, j) /= pivot, X(i, j) /= pivot;
        for (Index r = 0; r < d; ++r) {
            if (r == i) continue;
            Rational const factor = A(r, i);
            for (Index j = 0; j < d; ++j) A(r, j) -= factor * A(i, j), X(r, j) -= factor * X(i, j);
        }
    }
    return X;
}

/// (Phi'W Phi)^-1 Phi'W Y, w_k = lambda^(N-1-k); Phi'Phi must be regular. J is weighted.
inline Fit of(Records const& records, Rational const& lambda = 1) {
    Index const d = records.parameters(), N = records.rows();
    Matrix<Rational> M = Matrix<Rational>::Constant(d, d, Rational(0));
    Vector<Rational> b = Vector<Rational>::Constant(d, Rational(0)), theta = b, weight(N);
    weight[N - 1] = 1;
    for (Index k = N - 1; k > 0; --k) weight[k - 1] = weight[k] * lambda;
    for (Index k = 0; k < N; ++k)
        for (Index i = 0; i < d; ++i) {
            Rational const x = weight[k] * Rational(records.psi(i, k));
            for (Index j = 0; j < d; ++j) M(i, j) += x * Rational(records.psi(j, k));
            b[i] += x * Rational(records.y[k]);
        }
    Matrix<Rational> const P = inverse(M);
    for (Index i = 0; i < d; ++i)
        for (Index j = 0; j < d; ++j) theta[i] += P(i, j) * b[j];
    Fit out{theta, Vector<Rational>(N), P, 0};
    for (Index k = 0; k < N; ++k) {
        Rational e(records.y[k]);
        for (Index i = 0; i < d; ++i) e -= Rational(records.psi(i, k)) * out.theta[i];
        out.residuals[k] = e;
        out.J += weight[k] * e * e;
    }
    return out;
}

/// P(chi^2_n > x): erfc or exp, then the recurrence in n. Abramowitz & Stegun, 26.4.4, 26.4.5, 26.4.8.
inline double chi_squared_tail(int n, double x) {
    double p = n % 2 ? std::erfc(std::sqrt(x / 2)) : std::exp(-x / 2);
    for (int m = n % 2 ? 1 : 2; m < n; m += 2)
        p += std::exp(m / 2.0 * std::log(x / 2) - x / 2 - std::lgamma(m / 2.0 + 1));
    return p;
}

/// P(|T_n| < t). Abramowitz & Stegun, 26.7.3 and 26.7.4.
inline double student_inside(int n, double t) {
    double const angle = std::atan(t / std::sqrt(double(n))), c = std::cos(angle), pi = std::acos(-1.0);
    if (n % 2) {
        double sum = 0, term = c;
        for (int m = 3; m <= n; m += 2, term *= c * c * (m - 3) / double(m - 2)) sum += term;
        return 2 / pi * (angle + (n == 1 ? 0 : std::sin(angle) * sum));
    }
    double sum = 0, term = 1;
    for (int m = 2; m <= n; m += 2, term *= c * c * (m - 3) / double(m - 2)) sum += term;
    return std::sin(angle) * sum;
}

/// P(F_{m,n} > x), m even: a finite sum. Abramowitz & Stegun, 26.6.4.
inline double f_tail(int m, int n, double x) {
    double const y = n / (n + m * x);
    double sum = 0, term = 1;
    for (int i = 0; i < m / 2; ++i) {
        sum += term;
        term *= (n + 2.0 * i) / (2.0 * i + 2) * (1 - y);
    }
    return std::pow(y, n / 2.0) * sum;
}

}  // namespace rlslab::exact_fit
