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

}  // namespace rlslab::studies
