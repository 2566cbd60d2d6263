// Updates of fixed size as an engineer writes them: loops over arrays, no report, no capacity for anything else. They
// sum and divide in the library's order, so that theta has its bits (tests/bench/baseline.cpp).
#pragma once

#include <rlslab/core/problem.hpp>

#include <cmath>
#include <string_view>

namespace rlslab::bench::by_hand {

/// x'y in the order of rlslab's dot: halves are added, of even and of odd places.
template <int n>
double dot(double const* x, double const* y) {
    if constexpr (n == 1) return x[0] * y[0];
    else if constexpr (n == 2) return x[0] * y[0] + x[1] * y[1];
    else if constexpr (n == 3) return (x[0] * y[0] + x[2] * y[2]) + x[1] * y[1];
    else if constexpr (n == 4) return (x[0] * y[0] + x[2] * y[2]) + (x[1] * y[1] + x[3] * y[3]);
    else if constexpr (n == 5) return ((x[0] * y[0] + x[4] * y[4]) + x[2] * y[2]) + (x[1] * y[1] + x[3] * y[3]);
    else {
        static_assert(n == 6);
        return ((x[0] * y[0] + x[4] * y[4]) + x[2] * y[2]) + ((x[1] * y[1] + x[5] * y[5]) + x[3] * y[3]);
    }
}
/// f_j = A_j'x over the columns of an upper triangle, from the last down.
template <int j, int N>
void upper_dots(double const (&A)[N][N], double const* x, double* f) {
    f[j - 1] = dot<j>(A[j - 1], x);
    if constexpr (j > 1) upper_dots<j - 1>(A, x, f);
}

/// theta, a matrix by columns (P, or its factor), and division by r as rlslab divides: t + t (1 - r) / r.
template <int N>
struct Loops {
    using scalar = double;
    double lambda, correction, theta_[N] = {}, A[N][N] = {};
    Loops(Problem<double> const& problem, double r, double diagonal)
        : lambda(problem.forgetting), correction((1 - r) / r) {
        for (int j = 0; j < N; ++j) A[j][j] = diagonal;
    }
    double divided(double t) const { return t + t * correction; }
    double innovation(double const* x, double y) const { return y - dot<N>(x, theta_); }
    void multiply(double const* x, double* out) const {
        for (int i = 0; i < N; ++i) out[i] = A[0][i] * x[0];
        for (int j = 1; j < N; ++j)
            for (int i = 0; i < N; ++i) out[i] += A[j][i] * x[j];
    }
    void correct(double e, double const* v, double s) {
        for (int i = 0; i < N; ++i) theta_[i] += e * (v[i] / s);
    }
    Eigen::Map<Vector<double, N> const> theta() const { return Eigen::Map<Vector<double, N> const>(theta_); }
};

/// P itself: subtract(P, K, f) is what differs.
template <int N>
struct Plain : Loops<N> {
    explicit Plain(Problem<double> const& p) : Loops<N>(p, p.forgetting, p.prior->variance) {}
    template <class Subtract>
    void update_by(double const* x, double y, Subtract subtract) {
        double f[N], K[N];
        double const e = this->innovation(x, y);
        this->multiply(x, f);
        double const s = this->lambda + dot<N>(x, f);
        for (int i = 0; i < N; ++i) K[i] = f[i] / s;
        subtract(this->A, K, f);
        for (int i = 0; i < N; ++i) this->theta_[i] += e * K[i];
    }
};
template <int N>
struct Conventional : Plain<N> {
    static constexpr std::string_view name = "by_hand_conventional";
    using Plain<N>::Plain;
    void update(Regressor<double> psi, double y) {
        this->update_by(psi.data(), y, [this](auto& P, double const* K, double const* f) {
            for (int j = 0; j < N; ++j)
                for (int i = 0; i < N; ++i) P[j][i] = this->divided(P[j][i] - K[i] * f[j]);
        });
    }
};
template <int N>
struct Symmetric : Plain<N> {
    static constexpr std::string_view name = "by_hand_symmetric";
    using Plain<N>::Plain;
    void update(Regressor<double> psi, double y) {
        this->update_by(psi.data(), y, [this](auto& P, double const* K, double const* f) {
            for (int j = 0; j < N; ++j)
                for (int i = 0; i <= j; ++i) P[j][i] = P[i][j] = this->divided(P[j][i] - K[i] * f[j]);
        });
    }
};
template <int N>
struct Ud : Loops<N> {
    static constexpr std::string_view name = "by_hand_ud";
    double D[N];
    explicit Ud(Problem<double> const& p) : Loops<N>(p, p.forgetting, 1) {
        for (double& x : D) x = p.prior->variance;
    }
    void update(Regressor<double> psi, double y) {
        double f[N], v[N];
        double const *const x = psi.data(), e = this->innovation(x, y);
        upper_dots<N>(this->A, x, f);
        double sum = 0, s = this->lambda;
        for (int j = 0; j < N; ++j) {
            double const g = D[j] * f[j], before = s, mu = f[j] / before;
            sum = j ? sum + f[j] * g : f[j] * g;
            s = this->lambda + sum;
            D[j] = this->divided(D[j] * (before / s));
            for (int i = 0; i < j; ++i) {
                double const t = this->A[j][i];
                this->A[j][i] = t - v[i] * mu;
                v[i] += t * g;
            }
            v[j] = g;
        }
        this->correct(e, v, s);
    }
};
template <int N>
struct Potter : Loops<N> {
    static constexpr std::string_view name = "by_hand_potter";
    explicit Potter(Problem<double> const& p) : Loops<N>(p, std::sqrt(p.forgetting), std::sqrt(p.prior->variance)) {}
    void update(Regressor<double> psi, double y) {
        double f[N], v[N];
        double const *const x = psi.data(), e = this->innovation(x, y);
        for (int j = 0; j < N; ++j) f[j] = dot<N>(this->A[j], x);
        double const s = this->lambda + dot<N>(f, f), q = s + std::sqrt(this->lambda * s);
        this->multiply(f, v);
        for (int j = 0; j < N; ++j) {
            double const g = f[j] / q;
            for (int i = 0; i < N; ++i) this->A[j][i] = this->divided(this->A[j][i] - v[i] * g);
        }
        this->correct(e, v, s);
    }
};
template <int N>
struct Carlson : Loops<N> {
    static constexpr std::string_view name = "by_hand_carlson";
    explicit Carlson(Problem<double> const& p) : Loops<N>(p, std::sqrt(p.forgetting), std::sqrt(p.prior->variance)) {}
    void update(Regressor<double> psi, double y) {
        double f[N], v[N];
        double const *const x = psi.data(), e = this->innovation(x, y);
        upper_dots<N>(this->A, x, f);
        double sum = 0, s = this->lambda;
        for (int j = 0; j < N; ++j) {
            double const before = s, square = f[j] * f[j];
            sum = j ? sum + square : square;
            s = this->lambda + sum;
            double const r = std::sqrt(before / s), m = (f[j] / before) * r;
            for (int i = 0; i < j; ++i) {
                double const t = this->A[j][i];
                this->A[j][i] = this->divided(t * r - v[i] * m);
                v[i] += t * f[j];
            }
            double const t = this->A[j][j];
            this->A[j][j] = this->divided(t * r);
            v[j] = t * f[j];
        }
        this->correct(e, v, s);
    }
};

}  // namespace rlslab::bench::by_hand
