// Definiteness is decided by the proven rank; everything else is sums in order.
#include <rlslab/model/excitation.hpp>

#include <rlslab/model/fit.hpp>
#include <rlslab/reference/certified.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab {
namespace {

/// v_k = [x_k ... x_{k-n+1}] as the regressors of records with y = 0.
Records windows(Signal const& x, Index n) {
    Index const rows = Index(x.size()) - n + 1;
    Records out{.psi = Matrix<double>(n, rows), .y = Vector<double>::Zero(rows), .names = {}};
    for (Index k = 0; k < rows; ++k)
        for (Index i = 0; i < n; ++i) out.psi(i, k) = x[size_t(k + n - 1 - i)];
    return out;
}

/// The resolution of a file with a fixed number of decimals, or of a converter: the largest power of ten, up to 1, of which all numbers are
/// multiples; otherwise the smallest distance between two numbers, if nearly all are multiples of that. A signal of a few levels (PRBS,
/// steps) was made with these levels, not rounded to them. The result is at least 2^-42 of the largest number: computed data carry about a
/// thousand rounding errors of binary64, and measured data are coarser.
double resolution_of(Signal const& x) {
    Signal sorted = x;
    std::ranges::sort(sorted);
    double const rounding = 0x1p-42 * std::max(std::abs(sorted.front()), std::abs(sorted.back()));
    constexpr size_t few = 20;
    size_t levels = 1;
    for (size_t k = 1; k < sorted.size(); ++k) levels += sorted[k] != sorted[k - 1];
    if (levels <= few) return rounding;
    for (double scale = 1; scale <= 1e12; scale *= 10)
        if (std::ranges::all_of(x,
                                [&](double v) { return std::abs(v * scale - std::nearbyint(v * scale)) <= 0x1p-50 * std::abs(v * scale); }))
            return std::max(1 / scale, rounding);
    double unit = INFINITY;
    for (size_t k = 1; k < sorted.size(); ++k) {
        double const gap = sorted[k] - sorted[k - 1];
        // Decimals are stored with a rounding error: a gap of that size is no gap.
        if (gap > 1e-12 * std::max(std::abs(sorted[k]), std::abs(sorted[k - 1]))) unit = std::min(unit, gap);
    }
    if (!std::isfinite(unit)) return rounding;
    size_t multiples = 0;
    for (double const v : x) {
        double const quotient = (v - sorted.front()) / unit;
        multiples += std::abs(quotient - std::nearbyint(quotient)) < 1e-3;
    }
    return double(multiples) >= 0.99 * double(x.size()) ? std::max(unit, rounding) : rounding;
}

}  // namespace

Signal correlation(Signal const& x, Signal const& y, Index most) {
    Index const N = Index(x.size());
    expects(x.size() == y.size() && 0 <= most && most < N, "two signals of equal length, and lags shorter than they are");
    Signal out(size_t(most + 1), 0.0);
    for (Index lag = 0; lag <= most; ++lag) {
        double sum = 0;
        for (Index k = lag; k < N; ++k) sum += x[size_t(k)] * y[size_t(k - lag)];
        out[size_t(lag)] = sum / double(N);
    }
    return out;
}

Matrix<double> correlation_matrix(Signal const& x, Index n) {
    expects(1 <= n && n <= Index(x.size()), "an order between 1 and the number of samples");
    Records const v = windows(x, n);
    Matrix<double> R = Matrix<double>::Zero(n, n);
    for (Index k = 0; k < v.rows(); ++k)
        for (Index j = 0; j < n; ++j)
            for (Index i = 0; i < n; ++i) R(i, j) += v.psi(i, k) * v.psi(j, k);
    for (double& r : R.reshaped()) r /= double(v.rows());
    return R;
}

bool diagonally_dominant(Matrix<double> const& R) {
    for (Index i = 0; i < R.rows(); ++i) {
        double others = 0;
        for (Index j = 0; j < R.cols(); ++j) others += j == i ? 0 : std::abs(R(i, j));
        if (!(others < R(i, i))) return false;
    }
    return true;
}

Excitation excitation(Signal const& u, Index most, std::function<void(double)> const& progress) {
    expects(!u.empty() && most >= 1, "a record, and an order of at least 1");
    Excitation out;
    out.resolution = resolution_of(u);
    while (out.constant_at_start < Index(u.size()) && u[size_t(out.constant_at_start)] == u[0]) ++out.constant_at_start;
    if (out.constant_at_start == 1) out.constant_at_start = 0;
    double const noise = out.resolution * std::sqrt(4.0 / 12);  // roots are compared: squares may underflow
    bool unbroken = true;
    for (Index n = 1; n <= most && 2 * n - 1 <= Index(u.size()); ++n) {
        Records const v = windows(u, n);
        Problem<double> const problem{.size = n, .prior = std::nullopt};
        ExcitationOrder at{n, certified(problem, v, {v.rows()}).front().status() == Status::certified, INFINITY, 0, false};
        if (at.definite) {
            at.condition = condition(v, 1);
            double const largest = fit(v, FitBy::svd).singular[0];
            double const root = largest / at.condition / std::sqrt(double(v.rows()));
            at.least = root * root;
            at.resolved = root > noise;
            out.exact_order = n;
        }
        out.orders.push_back(at);
        unbroken = unbroken && at.definite && at.resolved;
        if (unbroken) out.order = n;
        if (!at.definite) break;
        if (progress && n < most) progress(double(n) / double(most) * (double(n) / double(most)) * (double(n) / double(most)));
    }
    if (progress) progress(1);
    return out;
}

}  // namespace rlslab
