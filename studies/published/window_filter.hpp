// Recursive least squares over a sliding window, several ways: a row comes in, a row goes out. Double, sums in order,
// small on purpose.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/stored.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace rlslab::studies {

/// P or P^-1 or R as it slides: double, sums in order, small on purpose. `weight` is lambda^window, that of the row
/// that leaves.
struct WindowFilter {
    static constexpr Index n = 4;
    std::string method;
    double lambda, weight;
    double A[n][n] = {};
    bool broken = false;

    void symmetric_rank_one(double scale, double const* f) {
        for (Index j = 0; j < n; ++j)
            for (Index i = 0; i <= j; ++i) A[i][j] = A[j][i] = A[i][j] + scale * f[i] * f[j];
    }
    /// P -/+ f f' / s, f = P x, s = weight +/- x'f: the conventional formula for a row of this weight, with either
    /// sign.
    void covariance(double const* x, double sign) {
        double f[n], s = 1;
        for (Index i = 0; i < n; ++i) {
            f[i] = 0;
            for (Index j = 0; j < n; ++j) f[i] += A[i][j] * x[j];
        }
        for (Index i = 0; i < n; ++i) s += sign * x[i] * f[i];
        symmetric_rank_one(-sign / s, f);
    }
    void scale(double factor) {
        for (auto& row : A)
            for (double& a : row) a *= factor;
    }
    void rotate_in(double const* row) {  // Givens
        double x[n];
        std::copy(row, row + n, x);
        for (Index k = 0; k < n; ++k) {
            double const r = std::sqrt(A[k][k] * A[k][k] + x[k] * x[k]);
            if (r == 0) continue;
            double const c = A[k][k] / r, s = x[k] / r;
            for (Index j = k; j < n; ++j) {
                double const a = A[k][j];
                A[k][j] = c * a + s * x[j];
                x[j] = c * x[j] - s * a;
            }
        }
    }
    /// LINPACK's dchdd: R'a = x, then rotations that take (a, alpha) to (0, 1), applied to R from below.
    void rotate_out(double const* x) {
        double a[n], c[n], s[n], alpha = 1;
        for (Index i = 0; i < n; ++i) {
            a[i] = x[i];
            for (Index k = 0; k < i; ++k) a[i] -= A[k][i] * a[k];
            a[i] /= A[i][i];
            alpha -= a[i] * a[i];
        }
        if (!(alpha > 0)) return void(broken = true);
        alpha = std::sqrt(alpha);
        for (Index i = n; i-- > 0;) {
            double const r = std::sqrt(alpha * alpha + a[i] * a[i]);
            c[i] = alpha / r, s[i] = a[i] / r, alpha = r;
        }
        for (Index j = 0; j < n; ++j) {
            double carried = 0;
            for (Index i = j + 1; i-- > 0;) {
                double const t = c[i] * carried + s[i] * A[i][j];
                A[i][j] = c[i] * A[i][j] - s[i] * carried;
                carried = t;
            }
        }
    }
    /// Hyperbolic rotations in mixed form: the row of x with the new row of R.
    void mixed_out(double const* row) {
        double x[n];
        std::copy(row, row + n, x);
        for (Index k = 0; k < n; ++k) {
            double const s = x[k] / A[k][k];
            if (!(std::abs(s) < 1)) return void(broken = true);
            double const c = std::sqrt((1 - s) * (1 + s));
            for (Index j = k; j < n; ++j) {
                A[k][j] = (A[k][j] - s * x[j]) / c;
                x[j] = c * x[j] - s * A[k][j];
            }
        }
    }
    void step(double const* in, double const* out) {
        if (broken) return;
        double leaving[n];
        for (Index i = 0; i < n; ++i) leaving[i] = out ? std::sqrt(weight) * out[i] : 0;
        if (method == "covariance") {
            scale(1 / lambda);
            covariance(in, 1);
            if (out) covariance(leaving, -1);
        } else if (method == "information") {
            scale(lambda);
            symmetric_rank_one(1, in);
            if (out) symmetric_rank_one(-1, leaving);
        } else {
            scale(std::sqrt(lambda));
            rotate_in(in);
            if (out) method == "linpack" ? rotate_out(leaving) : mixed_out(leaving);
        }
    }
    Stored<Reference> stored() const {
        using S = Stored<Reference>;
        bool const plain = method == "covariance" || method == "information";
        Matrix<Reference> F(n, n);
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < n; ++j) F(i, j) = plain ? A[i][j] : A[j][i];  // R'
        return {method == "covariance" ? S::Quantity::covariance : S::Quantity::information,
                plain ? S::Form::plain : S::Form::factor, F};
    }
};

}  // namespace rlslab::studies
