// Everything goes through the triangle R of Phi: its solves, or its singular values.
#include <rlslab/model/fit.hpp>

#include <rlslab/linalg/reflections.hpp>
#include <rlslab/linalg/triangles.hpp>
#include <rlslab/reference/distributions.hpp>

#include <algorithm>
#include <numeric>

namespace rlslab {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// R = L' and z = Q'Y, blocks of rows folded in one after another.
struct Triangle {
    Square<double> L;
    Column<double> z;
    explicit Triangle(Records const& records) : L(records.size()), z(records.size()) {
        Index const d = records.size(), N = records.rows();
        constexpr Index block = 64;
        Rows<double> A;
        for (Index k = 0; k < N; k += block) {
            Index const rows = std::min(block, N - k);
            A.resize(rows, d + 1);
            for (Index i = 0; i < rows; ++i) {
                for (Index j = 0; j < d; ++j) A(i, j) = records.psi(j, k + i);
                A(i, d) = records.y[k + i];
            }
            fold(1.0, L, z, A);
        }
    }
};

/// (R'R)^-1 = R^-1 R^-T, a column at a time.
Matrix<double> inverse_gram(Square<double> const& L) {
    Index const d = L.size();
    Matrix<double> out(d, d);
    for (Index j = 0; j < d; ++j) {
        Column<double> unit(d);
        unit[j] = 1;
        out.col(j) = solve_outer(L, unit);
    }
    return out;
}

/// W = V S by plane rotations of the columns of W = R' Q': one-sided Jacobi. Then R' = W U', singular values |w_j|.
struct Singular {
    Matrix<double> W, U;    // R' = W U', columns of W orthogonal
    Vector<double> sigma;
    explicit Singular(Square<double> const& L) : W(L.view()), U(Matrix<double>::Identity(L.size(), L.size())), sigma(L.size()) {
        Index const d = L.size();
        auto const inner = [&](Index a, Index b) { return dot(W.col(a).data(), W.col(b).data(), d); };
        auto const turn = [](auto&& x, auto&& y, double c, double s) {
            for (Index i = 0; i < x.size(); ++i) {
                double const t = x[i];
                x[i] = c * t - s * y[i];
                y[i] = s * t + c * y[i];
            }
        };
        for (bool turned = true; turned;) {
            turned = false;
            for (Index p = 0; p < d; ++p)
                for (Index q = p + 1; q < d; ++q) {
                    double const a = inner(p, p), b = inner(q, q), c = inner(p, q);
                    if (!(std::abs(c) > 0x1p-52 * std::sqrt(a) * std::sqrt(b))) continue;    // NaN ends it
                    turned = true;
                    double const tau = (b - a) / (2 * c), t = (tau >= 0 ? 1 : -1) / (std::abs(tau) + std::sqrt(1 + tau * tau));
                    double const cosine = 1 / std::sqrt(1 + t * t);
                    turn(W.col(p), W.col(q), cosine, cosine * t);
                    turn(U.col(p), U.col(q), cosine, cosine * t);
                }
        }
        for (Index j = 0; j < d; ++j) sigma[j] = std::sqrt(inner(j, j));
    }
};

void solve_by_qr(Triangle const& triangle, Fit& out) {
    bool const regular = nonsingular(triangle.L);
    out.rank = 0;
    for (Index i = 0; i < triangle.z.size(); ++i) out.rank += triangle.L(i, i) != 0;
    out.theta = regular ? solved_lower_transposed(triangle.L, triangle.z) : Vector<double>::Constant(triangle.z.size(), nan);
    out.covariance = inverse_gram(triangle.L);
}

void solve_by_normal_equations(Records const& records, Fit& out) {
    Index const d = records.size();
    Square<double> X(d), L(d);
    Column<double> b(d), D(d);
    for (Index k = 0; k < records.rows(); ++k)
        for (Index j = 0; j < d; ++j) {
            for (Index i = 0; i < d; ++i) X(i, j) += records.psi(i, k) * records.psi(j, k);
            b[j] += records.psi(j, k) * records.y[k];
        }
    bool const factors = factor_ldl(X, L, D);
    auto const solved = [&](Column<double> x) {
        solve_lower(L, x);
        for (Index i = 0; i < d; ++i) x[i] = factors ? x[i] / D[i] : nan;
        solve_lower_transposed(L, x);
        return Vector<double>(x.view());
    };
    out.rank = factors ? d : 0;
    out.theta = solved(b);
    out.covariance.resize(d, d);
    for (Index j = 0; j < d; ++j) {
        Column<double> unit(d);
        unit[j] = 1;
        out.covariance.col(j) = solved(unit);
    }
}

/// R = U W': theta = sum over what is kept of w_j (u_j'z) / sigma_j^2.
void solve_by_svd(Triangle const& triangle, Index rows, double tolerance, Fit& out) {
    Index const d = triangle.z.size();
    Singular const s(triangle.L);
    std::vector<Index> order(size_t(d), 0);
    std::iota(order.begin(), order.end(), Index(0));
    std::ranges::stable_sort(order, [&](Index a, Index b) { return s.sigma[a] > s.sigma[b]; });
    double const least = (tolerance < 0 ? double(std::max(rows, d)) * 0x1p-53 : tolerance) * s.sigma[order[0]];
    out.theta = Vector<double>::Zero(d);
    out.covariance = Matrix<double>::Zero(d, d);
    out.singular.resize(d);
    for (Index place = 0; place < d; ++place) {
        Index const j = order[size_t(place)];
        double const sigma = out.singular[place] = s.sigma[j];
        if (!(sigma > least)) continue;
        ++out.rank;
        double const along = dot(s.U.col(j).data(), triangle.z.data(), d) / sigma / sigma;
        for (Index i = 0; i < d; ++i) {
            out.theta[i] += s.W(i, j) * along;
            for (Index k = 0; k < d; ++k) out.covariance(i, k) += (s.W(i, j) / sigma) * (s.W(k, j) / sigma) / sigma / sigma;
        }
    }
}

}  // namespace

double fit_percent(Vector<double> const& y, Vector<double> const& predicted) {
    Index const N = y.size();
    double mean = 0, missed = 0, spread = 0;
    for (Index k = 0; k < N; ++k) mean += y[k] / double(N);
    for (Index k = 0; k < N; ++k) {
        missed += (y[k] - predicted[k]) * (y[k] - predicted[k]);
        spread += (y[k] - mean) * (y[k] - mean);
    }
    return missed == 0 ? 100 : 100 * (1 - std::sqrt(missed) / std::sqrt(spread));
}

Fit fit(Records const& records, FitBy by, double confidence, double tolerance) {
    Index const d = records.size(), N = records.rows();
    expects(N >= d && d >= 1, "at least as many rows as parameters");
    expects(0 < confidence && confidence < 1, "a confidence in (0, 1)");
    Fit out;
    switch (by) {
        case FitBy::qr: solve_by_qr(Triangle(records), out); break;
        case FitBy::normal_equations: solve_by_normal_equations(records, out); break;
        case FitBy::svd: solve_by_svd(Triangle(records), N, tolerance, out); break;
    }
    out.residuals.resize(N);
    Vector<double> predicted(N);
    for (Index k = 0; k < N; ++k) {
        predicted[k] = dot(records.psi.col(k).data(), out.theta.data(), d);
        out.residuals[k] = records.y[k] - predicted[k];
        out.J += out.residuals[k] * out.residuals[k];
    }
    Index const freedom = N - out.rank;
    out.sigma2 = freedom > 0 ? out.J / double(freedom) : nan;
    out.percent = fit_percent(records.y, predicted);
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i) out.covariance(i, j) *= out.sigma2;
    double const t = freedom > 0 ? correctly::student_quantile(double(freedom), 0.5 + confidence / 2) : nan;
    out.sd.resize(d), out.low.resize(d), out.high.resize(d);
    for (Index i = 0; i < d; ++i) {
        out.sd[i] = std::sqrt(out.covariance(i, i));
        out.low[i] = out.theta[i] - t * out.sd[i];
        out.high[i] = out.theta[i] + t * out.sd[i];
    }
    return out;
}

}  // namespace rlslab
