// Plants at rest, periods, counts, natural units, changes and levels. Sums are loops in order, powers are correctly
// rounded: the same bits on any machine.
#include "studies/published/drawn_problem.hpp"

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::studies {
namespace {

double decades(double from, double to, Seed& seed) { return correctly::pow(10, from + (to - from) * seed.uniform()); }
double log_uniform(double from, double to, Seed& seed) { return from * correctly::pow(to / from, seed.uniform()); }
double random_sign(Seed& seed) { return seed.uniform() < 0.5 ? -1 : 1; }

Vector<double> theta_of(DrawnProblem const& p, Seed& seed) {
    Vector<double> out(p.size);
    for (Index i = 0; i < p.size; ++i) out[i] = random_sign(seed) * decades(-0.5, 0.5, seed) / p.sigma[size_t(i)];
    return out;
}

/// The newest sample first; u begins before the first row, so that its line is full.
Matrix<double> delay_line(std::vector<double> const& u, Index size) {
    Matrix<double> psi(size, Index(u.size()) - size + 1);
    for (Index k = 0; k < psi.cols(); ++k)
        for (Index i = 0; i < size; ++i) psi(i, k) = u[size_t(k + size - 1 - i)];
    return psi;
}
Matrix<double> white(DrawnProblem const& p, Seed& seed) {
    Matrix<double> psi(p.size, p.rows);
    for (Index k = 0; k < p.rows; ++k)
        for (Index i = 0; i < p.size; ++i) psi(i, k) = p.sigma[size_t(i)] * (p.offset + seed.bell());
    return psi;
}

Matrix<double> regressors_of(DrawnProblem const& p, Seed& seed) {
    std::vector<double> u(size_t(p.rows + p.size - 1), 0.0);
    auto const line = [&](auto const& sample) {
        for (size_t k = 0; k < u.size(); ++k) u[k] = sample(k);
        return delay_line(u, p.size);
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
    Matrix<double> psi = white(p, seed);
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
    p.size = Index(std::lround(correctly::pow(2, 1 + 2 * seed.uniform())));
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
    p.theta = theta_of(p, seed);
    for (Index i = 0; p.kind == "changes" && i < 2 + Index(4.99 * share); ++i) p.later.push_back(theta_of(p, seed));
    return p;
}

Records everyday_realisation(DrawnProblem const& p, Seed rows, Seed noise) {
    Records out{.psi = regressors_of(p, rows), .y = Vector<double>(p.rows), .names = {}};
    double squares = 0;
    for (Index k = 0; k < p.rows; ++k) {
        size_t const part = size_t(k * Index(p.later.size() + 1) / p.rows);
        Vector<double> const& theta = part == 0 ? p.theta : p.later[part - 1];
        double sum = 0;
        for (Index i = 0; i < p.size; ++i) sum += out.psi(i, k) * theta[i];
        out.y[k] = sum, squares += sum * sum / double(p.rows);
    }
    double const deviation = p.noise * std::sqrt(squares);
    for (Index k = 0; k < p.rows; ++k) {
        out.y[k] += deviation * noise.bell();
        if (p.kind == "counts") out.y[k] = std::round(out.y[k] * (p.regressors == "counts" ? 1 : 64));
    }
    return out;
}

}  // namespace rlslab::studies
