// All three methods use the triangle R of Phi: its solutions, or its singular values.
#include <rlslab/model/fit.hpp>

#include <rlslab/input/constant.hpp>
#include <rlslab/linalg/reflections.hpp>
#include <rlslab/linalg/triangles.hpp>
#include <rlslab/reference/distributions.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rlslab {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Powers of two that scale every column of Phi, and Y, to entries below 1. This scaling is exact. Except for overflow
/// and underflow it commutes with all later operations, so that a fit does not depend on the units of the data.
struct Units {
    std::vector<int> psi;  // e_j
    int largest = 0, y;

    template <class Numbers>
    static double size_of(Numbers const& x) {
        double size = 0;
        for (double const v : x) size = std::max(size, std::abs(v));
        return size;
    }
    static int above(double size) { return size > 0 && std::isfinite(size) ? std::ilogb(size) + 1 : 0; }
    explicit Units(Records const& records) : psi(size_t(records.parameters()), 0), y(above(size_of(records.y))) {
        double most = 0;
        for (Index j = 0; j < records.parameters(); ++j) {
            double const size = size_of(records.psi.row(j));
            psi[size_t(j)] = above(size);
            most = std::max(most, size);
        }
        largest = above(most);
    }
};

/// The records in these units.
Records scaled(Records const& records, Units const& units) {
    Records out{
        .psi = Matrix<double>(records.parameters(), records.rows()), .y = Vector<double>(records.rows()), .names = {}};
    for (Index k = 0; k < records.rows(); ++k) {
        for (Index j = 0; j < records.parameters(); ++j)
            out.psi(j, k) = std::scalbn(records.psi(j, k), -units.psi[size_t(j)]);
        out.y[k] = std::scalbn(records.y[k], -units.y);
    }
    return out;
}

/// R = L' and z = Q'Y, blocks of rows folded in one after another.
struct Triangle {
    StateMatrix<double> L;
    StateVector<double> z;
    explicit Triangle(Records const& records) : L(records.parameters()), z(records.parameters()) {
        Index const d = records.parameters(), N = records.rows();
        constexpr Index block = 64;
        Matrix<double> A;
        for (Index k = 0; k < N; k += block) {
            Index const rows = std::min(block, N - k);
            A.resize(rows, d + 1);
            for (Index i = 0; i < rows; ++i) {
                for (Index j = 0; j < d; ++j) A(i, j) = records.psi(j, k + i);
                A(i, d) = records.y[k + i];
            }
            reflect_block_into(1.0, L, z, A);
        }
    }
};

/// The inverse of what `solved` solves for, d x d, a column at a time.
Matrix<double> inverse_by(Index d, auto const& solved) {
    Matrix<double> out(d, d);
    for (Index j = 0; j < d; ++j) {
        StateVector<double> unit(d);
        unit[j] = 1;
        out.col(j) = solved(unit);
    }
    return out;
}

/// W = V S by plane rotations of the columns of W = R' Q': one-sided Jacobi. Then R' = W U', singular values |w_j|.
///
/// W's rows are scaled so that the largest is about 1. Numbers below 2^-480 are set to zero, and pairs with a column
/// shorter than 2^-450 are not rotated: all squares are then normal numbers, and c is accurate where it is compared.
/// (With one such column the rotations did not end.) About ten sweeps are usual. After fifteen, a pair counts as
/// orthogonal if rounding alone may cause its product: otherwise one in some thousands of problems of lower rank did
/// not end, at any scale.
struct Singular {
    static constexpr double least = 0x1p-440;  // of the largest singular value: smaller ones are not known to any digit
    static constexpr int most_sweeps = 60;
    Matrix<double> W, U;  // R' = W U', columns of W orthogonal
    Vector<double> sigma;
    int sweeps = 0;
    bool orthogonal = false;

    Singular(StateMatrix<double> const& L, Units const& units)
        : W(L.view()), U(Matrix<double>::Identity(L.size(), L.size())), sigma(L.size()) {
        Index const d = L.size();
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) {
                W(j, i) = std::scalbn(W(j, i), units.psi[size_t(j)] - units.largest);
                if (std::abs(W(j, i)) < 0x1p-480) W(j, i) = 0;
            }
        auto const inner = [&](Index a, Index b) { return dot(W.col(a).data(), W.col(b).data(), d); };
        auto const turn = [](auto&& x, auto&& y, double c, double s) {
            for (Index i = 0; i < x.size(); ++i) {
                double const t = x[i];
                x[i] = c * t - s * y[i];
                y[i] = s * t + c * y[i];
            }
        };
        while (!orthogonal && sweeps < most_sweeps) {
            orthogonal = true;
            double const rounding = ++sweeps <= 15 ? 0x1p-52 : double(d) * 0x1p-50;
            for (Index p = 0; p < d; ++p)
                for (Index q = p + 1; q < d; ++q) {
                    double const a = inner(p, p), b = inner(q, q), c = inner(p, q);
                    if (std::min(a, b) < 0x1p-900 || !(std::abs(c) > rounding * std::sqrt(a) * std::sqrt(b)))
                        continue;  // NaN ends it
                    orthogonal = false;
                    double const tau = (b - a) / (2 * c),
                                 t = (tau >= 0 ? 1 : -1) / (std::abs(tau) + std::sqrt(1 + tau * tau));
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
    out.theta =
        regular ? solved_lower_transposed(triangle.L, triangle.z) : Vector<double>::Constant(triangle.z.size(), nan);
    out.covariance = inverse_by(triangle.z.size(), [&](StateVector<double> const& unit) {
        return solved_outer(triangle.L, unit);  // (R'R)^-1
    });
}

void solve_by_normal_equations(Records const& records, Fit& out) {
    Index const d = records.parameters();
    StateMatrix<double> X(d), L(d);
    StateVector<double> b(d), D(d);
    for (Index k = 0; k < records.rows(); ++k)
        for (Index j = 0; j < d; ++j) {
            for (Index i = 0; i < d; ++i) X(i, j) += records.psi(i, k) * records.psi(j, k);
            b[j] += records.psi(j, k) * records.y[k];
        }
    bool const factors = factor_ldl(X, L, D);
    auto const solved = [&](StateVector<double> x) {
        solve_lower(L, x);
        for (Index i = 0; i < d; ++i) x[i] = factors ? x[i] / D[i] : nan;
        solve_lower_transposed(L, x);
        return Vector<double>(x.view());
    };
    out.rank = factors ? d : 0;
    out.theta = solved(b);
    out.covariance = inverse_by(d, solved);
}

/// R = U W': theta = sum over what is kept of w_j (u_j'z) / sigma_j^2.
void solve_by_svd(Triangle const& triangle, Units const& units, Index rows, double tolerance, Fit& out) {
    Index const d = triangle.z.size();
    Singular const s(triangle.L, units);
    out.converged = s.orthogonal;
    std::vector<Index> order(size_t(d), 0);
    std::iota(order.begin(), order.end(), Index(0));
    std::ranges::stable_sort(order, [&](Index a, Index b) { return s.sigma[a] > s.sigma[b]; });
    double const relative = tolerance < 0 ? double(std::max(rows, d)) * 0x1p-53 : std::max(tolerance, Singular::least);
    double const least = relative * s.sigma[order[0]];
    out.theta = Vector<double>::Zero(d);
    out.covariance = Matrix<double>::Zero(d, d);
    out.singular.resize(d);
    for (Index place = 0; place < d; ++place) {
        Index const j = order[size_t(place)];
        double const sigma = s.sigma[j];
        out.singular[place] = std::scalbn(sigma, units.largest);
        if (!(sigma > least)) continue;
        ++out.rank;
        double const along = dot(s.U.col(j).data(), triangle.z.data(), d) / sigma / sigma;
        for (Index i = 0; i < d; ++i) {
            out.theta[i] += s.W(i, j) * along;
            for (Index k = 0; k < d; ++k)
                out.covariance(i, k) += (s.W(i, j) / sigma) * (s.W(k, j) / sigma) / sigma / sigma;
        }
    }
}

}  // namespace

double fit_percent(Vector<double> const& y, Vector<double> const& predicted) {
    Index const N = y.size();
    int const unit =
        Units::above(std::max(Units::size_of(y), Units::size_of(predicted)));  // squares neither overflow nor vanish
    auto const at = [unit](Vector<double> const& x, Index k) { return std::scalbn(x[k], -unit); };
    double mean = 0, missed = 0, spread = 0;
    bool const constant = constant_value(y).has_value();
    for (Index k = 0; k < N && !constant; ++k) mean += at(y, k) / double(N);
    if (constant) mean = at(y, 0);
    for (Index k = 0; k < N; ++k) {
        missed += (at(y, k) - at(predicted, k)) * (at(y, k) - at(predicted, k));
        spread += (at(y, k) - mean) * (at(y, k) - mean);
    }
    return missed == 0 ? 100 : 100 * (1 - std::sqrt(missed) / std::sqrt(spread));
}

Fit fit(Records const& given, FitBy by, double confidence, double tolerance) {
    Index const d = given.parameters(), N = given.rows();
    expects(N >= d && d >= 1, "at least as many rows as parameters");
    expects(given.y.size() == N, "an output for each row");
    expects(0 < confidence && confidence < 1, "a confidence in (0, 1)");
    Units const units(given);
    Records const records = scaled(given, units);
    Fit out;
    switch (by) {
        case FitBy::qr: solve_by_qr(Triangle(records), out); break;
        case FitBy::normal_equations: solve_by_normal_equations(records, out); break;
        case FitBy::svd: solve_by_svd(Triangle(records), units, N, tolerance, out); break;
    }
    // theta_i is in units of 2^(e_y - f_i): svd has one unit for all of Phi, the others one for each column.
    std::vector<int> const f = by == FitBy::svd ? std::vector<int>(size_t(d), units.largest) : units.psi;
    Vector<double> theta(d);
    for (Index i = 0; i < d; ++i) theta[i] = std::scalbn(out.theta[i], units.psi[size_t(i)] - f[size_t(i)]);
    out.residuals.resize(N);
    Vector<double> predicted(N);
    for (Index k = 0; k < N; ++k) {
        predicted[k] = dot(records.psi.col(k).data(), theta.data(), d);
        out.residuals[k] = records.y[k] - predicted[k];
        out.J += out.residuals[k] * out.residuals[k];
    }
    Index const freedom = N - out.rank;
    out.sigma2 = freedom > 0 ? out.J / double(freedom) : nan;
    out.percent = fit_percent(records.y, predicted);
    double const t = freedom > 0 ? correctly::student_quantile(double(freedom), 0.5 + confidence / 2) : nan;
    out.sd.resize(d), out.lower.resize(d), out.upper.resize(d);
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i) out.covariance(i, j) *= out.sigma2;
    for (Index i = 0; i < d; ++i) {
        int const unit = units.y - f[size_t(i)];
        out.sd[i] = std::sqrt(out.covariance(i, i));
        out.lower[i] = std::scalbn(out.theta[i] - t * out.sd[i], unit);
        out.upper[i] = std::scalbn(out.theta[i] + t * out.sd[i], unit);
        out.sd[i] = std::scalbn(out.sd[i], unit);
        out.theta[i] = std::scalbn(out.theta[i], unit);
    }
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i)
            out.covariance(i, j) = std::scalbn(out.covariance(i, j), 2 * units.y - f[size_t(i)] - f[size_t(j)]);
    for (double& residual : out.residuals) residual = std::scalbn(residual, units.y);
    out.J = std::scalbn(out.J, 2 * units.y);
    out.sigma2 = std::scalbn(out.sigma2, 2 * units.y);
    return out;
}

}  // namespace rlslab
