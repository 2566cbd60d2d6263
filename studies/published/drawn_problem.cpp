// Sums are loops in order, powers are correctly rounded: the same bits on any machine.
#include "studies/published/drawn_problem.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/studies/spectra.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::studies {
namespace {

double power(double base, double exponent) { return correctly::pow(base, exponent); }
/// 10^x, x uniform.
double decades(double from, double to, Seed& seed) { return power(10, from + (to - from) * seed.uniform()); }
double log_uniform(double from, double to, Seed& seed) { return from * power(to / from, seed.uniform()); }
size_t one_of(size_t count, Seed& seed) { return size_t(seed.uniform() * double(count)); }
double random_sign(Seed& seed) { return seed.uniform() < 0.5 ? -1 : 1; }

std::vector<double> spectrum_of(std::string const& shape, Index size, double kappa) {
    if (size == 1) return {1};
    if (shape != "clustered") return singular_values(shape, size, kappa);
    std::vector<double> out(size_t(size), 1 / kappa);
    std::fill_n(out.begin(), (size + 1) / 2, 1.0);
    return out;
}

Matrix<double> permutation(Index size, Seed& seed) {
    Matrix<double> out = Matrix<double>::Identity(size, size);
    for (Index j = size - 1; j > 0; --j) out.col(j).swap(out.col(Index(one_of(size_t(j + 1), seed))));
    return out;
}

Vector<double> theta_of(DrawnProblem const& p, Seed& seed) {
    Vector<double> theta(p.size);
    bool const line = p.regressors == "delay line";
    if (p.direction == "v_1") return line ? Vector<double>(Vector<double>::Ones(p.size)) : Vector<double>(p.V.col(0));
    if (p.direction == "v_d") {
        for (Index i = 0; i < p.size; ++i) theta[i] = line ? (i % 2 ? -1 : 1) : p.V(i, p.size - 1);
        return theta;
    }
    for (Index i = 0; i < p.size; ++i) theta[i] = seed.bell();
    if (p.direction == "sparse") {
        Index const kept = Index(one_of(size_t(p.size), seed));
        for (Index i = 0; i < p.size; ++i)
            if (seed.uniform() < 0.5 && i != kept) theta[i] = 0;
    }
    return theta;
}

/// x_k = pole x_{k-1} + w_k, once or twice, where (1 + pole) / (1 - pole) is kappa or its root: the condition of a long
/// delay line. The line's rows have the newest sample first.
Matrix<double> delay_line_of(DrawnProblem const& p, Seed& seed) {
    double const ratio = p.order == 1 ? p.kappa : std::sqrt(p.kappa), pole = (ratio - 1) / (ratio + 1);
    Index const transient = Index(std::min(1e4, 10 / (1 - pole)));
    Matrix<double> psi(p.size, p.rows);
    std::vector<double> line(size_t(p.size), 0.0);
    double once = 0, twice = 0;
    for (Index k = -transient - p.size; k < p.rows; ++k) {
        once = pole * once + (1 - pole) * seed.bell();
        twice = pole * twice + (1 - pole) * once;
        std::rotate(line.begin(), line.end() - 1, line.end());
        line[0] = p.order == 1 ? once : twice;
        for (Index i = 0; k >= 0 && i < p.size; ++i) psi(i, k) = line[size_t(i)];
    }
    return psi;
}

Matrix<double> white_of(DrawnProblem const& p, Seed& seed) {
    Matrix<double> psi = Matrix<double>::Zero(p.size, p.rows);
    for (Index k = 0; k < p.rows; ++k)
        for (Index j = 0; j < p.size; ++j) {
            double const w = p.sigma[size_t(j)] * seed.bell();
            for (Index i = 0; i < p.size; ++i) psi(i, k) += w * p.V(i, j);
        }
    return psi;
}

template <class Numbers>
double root_mean_square_of(Numbers const& x) {
    double sum = 0;
    for (Index k = 0; k < x.size(); ++k) sum += x[k] * x[k] / double(x.size());
    return std::sqrt(sum);
}

}  // namespace

DrawnProblem drawn_problem(Index number, Seed seed) {
    DrawnProblem p{};
    p.word = number % 20 == 7 ? "binary16" : number % 20 == 14 ? "bfloat16" : number / 2 % 2 == 0 ? "float" : "double";
    p.size = number % 100 == 50 ? 32 : Index(std::lround(power(2, 4 * seed.uniform())));
    p.rows = Index(std::lround(log_uniform(double(2 * p.size), 2000, seed)));
    p.regressors = std::vector{"rotated", "units", "delay line"}[one_of(3, seed)];
    p.order = 1 + int(one_of(2, seed));
    p.spectrum = std::vector{"geometric", "one small", "one large", "clustered"}[one_of(4, seed)];
    p.kappa = decades(0, 8, seed);
    double const offset = decades(0, 3, seed);
    p.offset = seed.uniform() < 0.25 ? offset : 0;
    p.intercept = seed.uniform() < 0.25 && p.size > 1;
    p.direction = std::vector{"v_1", "v_d", "generic", "sparse"}[one_of(4, seed)];
    double const noise = decades(-6, 1, seed);
    p.noise = seed.uniform() < 0.125 ? 0 : noise;
    double const memory = log_uniform(std::max(10.0, 2.0 * double(p.size)), 1e4, seed);
    p.forgetting = seed.uniform() < 0.5 ? 1 : 1 - 1 / memory;
    double const given = decades(0, 10, seed);
    p.prior = std::vector{"proposed", "default", "given"}[one_of(3, seed)];
    if (p.prior != "proposed") p.p0 = p.prior == "given" ? given : Prior<double>{}.variance;
    p.sigma = spectrum_of(p.spectrum, p.size, p.kappa);
    p.V = p.regressors == "rotated" ? orthonormal(p.size, p.size, seed) : permutation(p.size, seed);
    p.theta = theta_of(p, seed);
    return p;
}

Records realisation(DrawnProblem const& p, Seed rows, Seed noise) {
    if (!p.kind.empty()) return everyday_realisation(p, rows, noise);
    Matrix<double> psi = p.regressors == "delay line" ? delay_line_of(p, rows) : white_of(p, rows);
    for (Index i = 0; i < p.size; ++i) {
        double const mean = p.offset * root_mean_square_of(psi.row(i));
        double const sign = p.regressors == "delay line" ? 1 : random_sign(rows);
        for (Index k = 0; k < p.rows; ++k) psi(i, k) += sign * mean;
    }
    if (p.intercept) psi.row(p.size - 1).setOnes();
    Records out{.psi = std::move(psi), .y = Vector<double>(p.rows), .names = {}};
    for (Index k = 0; k < p.rows; ++k) {
        double sum = 0;
        for (Index i = 0; i < p.size; ++i) sum += out.psi(i, k) * p.theta[i];
        out.y[k] = sum;
    }
    double const deviation = p.noise * root_mean_square_of(out.y);
    for (Index k = 0; k < p.rows; ++k) out.y[k] += deviation * noise.bell();
    return out;
}

// --- the second distribution: plants at rest, periods, counts, natural units, changes and levels ---------------------

namespace {

Vector<double> everyday_theta_of(DrawnProblem const& p, Seed& seed) {
    Vector<double> out(p.size);
    for (Index i = 0; i < p.size; ++i) out[i] = random_sign(seed) * decades(-0.5, 0.5, seed) / p.sigma[size_t(i)];
    return out;
}

/// The newest sample first; u begins before the first row, so that its line is full.
Matrix<double> line_of(std::vector<double> const& u, Index size) {
    Matrix<double> psi(size, Index(u.size()) - size + 1);
    for (Index k = 0; k < psi.cols(); ++k)
        for (Index i = 0; i < size; ++i) psi(i, k) = u[size_t(k + size - 1 - i)];
    return psi;
}
Matrix<double> everyday_white_of(DrawnProblem const& p, Seed& seed) {
    Matrix<double> psi(p.size, p.rows);
    for (Index k = 0; k < p.rows; ++k)
        for (Index i = 0; i < p.size; ++i) psi(i, k) = p.sigma[size_t(i)] * (p.offset + seed.bell());
    return psi;
}

Matrix<double> regressors_of(DrawnProblem const& p, Seed& seed) {
    std::vector<double> u(size_t(p.rows + p.size - 1), 0.0);
    auto const line = [&](auto const& sample) {
        for (size_t k = 0; k < u.size(); ++k) u[k] = sample(k);
        return line_of(u, p.size);
    };
    if (p.kind == "rest")
        return line(
            [&](size_t k) { return Index(k) < p.rest + p.size - 1 ? 1 + p.jitter * seed.bell() : seed.bell(); });
    if (p.kind == "periodic")
        return line([&](size_t k) {
            if (Index(k) >= p.period) return u[k - size_t(p.period)];
            return p.regressors == "signs" ? random_sign(seed) : seed.bell();
        });
    if (p.regressors == "signs") return line([&](size_t) { return random_sign(seed); });
    Matrix<double> psi = everyday_white_of(p, seed);
    if (p.regressors == "counts")
        for (double& x : psi.reshaped()) x = std::clamp(std::round(2048 + 600 * x), 0.0, 4095.0);
    if (p.regressors == "marks") {
        psi.setZero(), psi.row(p.size - 1).setOnes();
        for (Index k = 0; k < p.rows; ++k)  // the last group has no mark
            if (Index const group = Index(seed.uniform() * double(p.size)); group + 1 < p.size) psi(group, k) = 1;
    }
    if (p.kind == "levels") {
        double level = 0;
        for (Index k = 0; k < p.rows; ++k) psi(p.size - 2, k) = level = k % p.level == 0 ? seed.bell() : level;
        psi.row(p.size - 1).setOnes();
    }
    return psi;
}

}  // namespace

DrawnProblem everyday_problem(Index number, Seed seed) {
    DrawnProblem p{};
    p.kind = everyday_kinds[size_t(number) % std::size(everyday_kinds)];
    Index const turn = number / Index(std::size(everyday_kinds));
    p.word = turn % 2 == 0 ? "float" : "double";
    p.size = Index(std::lround(power(2, 1 + 2 * seed.uniform())));
    p.rows = Index(std::lround(log_uniform(40 * double(p.size), 4000, seed)));
    double const memory = log_uniform(10 * double(p.size), 2000, seed);
    p.forgetting = turn / 2 % 2 == 0 ? 1 : 1 - 1 / memory;
    double const given = decades(4, 12, seed);
    p.prior = seed.uniform() < 0.25 ? "given" : "proposed";
    if (p.prior == "given") p.p0 = given;
    p.noise = decades(-3, 0, seed);
    p.jitter = decades(-6, -1, seed);
    double const share = seed.uniform();
    p.rest = Index(double(p.rows) * (0.02 + 0.18 * share));
    p.level = Index(double(p.rows) * (0.05 + 0.35 * share));
    p.period = Index(log_uniform(2 * double(p.size), double(p.rows) / 4, seed));
    p.regressors = "white";
    if (p.kind == "rest" || p.kind == "periodic") p.regressors = "delay line";
    if (p.kind == "periodic" && share < 0.5) p.regressors = "signs";
    if (p.kind == "counts") p.regressors = share < 1.0 / 3 ? "counts" : share < 2.0 / 3 ? "signs" : "marks";
    if (p.kind == "units") p.offset = share < 0.5 ? 10 : 0;
    p.sigma.assign(size_t(p.size), 1.0);
    for (double& s : p.sigma)
        if (p.kind == "units") s = decades(-6, 6, seed);
    p.theta = everyday_theta_of(p, seed);
    for (Index i = 0; p.kind == "changes" && i < 2 + Index(4.99 * share); ++i)
        p.later.push_back(everyday_theta_of(p, seed));
    return p;
}

Records everyday_realisation(DrawnProblem const& p, Seed rows, Seed noise) {
    Records out{.psi = regressors_of(p, rows), .y = Vector<double>(p.rows), .names = {}};
    for (Index k = 0; k < p.rows; ++k) {
        size_t const part = size_t(k * Index(p.later.size() + 1) / p.rows);
        Vector<double> const& theta = part == 0 ? p.theta : p.later[part - 1];
        double sum = 0;
        for (Index i = 0; i < p.size; ++i) sum += out.psi(i, k) * theta[i];
        out.y[k] = sum;
    }
    double const deviation = p.noise * root_mean_square_of(out.y);
    for (Index k = 0; k < p.rows; ++k) {
        out.y[k] += deviation * noise.bell();
        if (p.kind == "counts") out.y[k] = std::round(out.y[k] * (p.regressors == "counts" ? 1 : 64));
    }
    return out;
}

}  // namespace rlslab::studies
