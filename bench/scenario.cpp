// Makes the scenarios and certifies their solutions, each when it is first needed.
#include "bench/scenario.hpp"

#include <rlslab/core/random.hpp>

#include <algorithm>
#include <map>

namespace rlslab::bench {
namespace {

double rounded_to_float(double x) { return double(float(x)); }

/// y = psi'theta + noise for theta_i = 1, -1/2, 1/3 ..., rounded to float, as psi already is.
Scenario measured(Problem<double> problem, Matrix<double> psi, Index scored, Seed seed) {
    Vector<double> theta(psi.rows());
    for (Index i = 0; i < theta.size(); ++i) theta[i] = (i % 2 ? -1.0 : 1.0) / double(i + 1);
    Vector<double> y = psi.transpose() * theta;
    for (double& v : y) v = rounded_to_float(v + 0.1 * seed.bell());
    Records records{.psi = std::move(psi), .y = std::move(y)};
    std::vector<CertifiedSolution> exact = certified(problem, records, {scored});
    return {std::move(problem), std::move(records), scored, std::move(exact.front())};
}

Matrix<double> delay_line(Index size, Index rows, Seed& seed) {
    Matrix<double> psi(size, rows);
    for (Index k = 0; k < rows; ++k) {
        for (Index i = size - 1; i > 0; --i) psi(i, k) = k > 0 ? psi(i - 1, k - 1) : 0.0;
        psi(0, k) = rounded_to_float(seed.bell());
    }
    return psi;
}

/// The scenario under this key, made by make() the first time.
template <class Key, class Make>
Scenario const& once(std::map<Key, Scenario>& made, Key const& key, Make make) {
    auto found = made.find(key);
    if (found == made.end()) found = made.emplace(key, make()).first;
    return found->second;
}

}  // namespace

Index stretch_rows(Index size) { return std::clamp<Index>(2048 / size, 8, 256); }

Scenario const& tapped_delay_line(Index size) {
    static std::map<Index, Scenario> made;
    return once(made, size, [size] {
        Seed seed{1};
        Index const scored = 2 * size + 100;
        Matrix<double> psi = delay_line(size, scored + stretch_rows(size), seed);
        Problem<double> const problem{
            .size = size, .forgetting = rounded_to_float(0.99), .prior = Prior<double>{.variance = 10}};
        return measured(problem, std::move(psi), scored, seed);
    });
}

Scenario const& rows_of_window(Index size) {
    static std::map<Index, Scenario> made;
    return once(made, size, [size] {
        Scenario const& all = tapped_delay_line(size);
        Index const rows = window_rows(size), first = all.scored - rows;
        Records kept{.psi = all.records.psi.middleCols(first, rows), .y = all.records.y.segment(first, rows)};
        CertifiedSolution exact = certified(all.problem, kept, {rows}).front();
        return Scenario{all.problem, std::move(kept), rows, std::move(exact)};
    });
}

Scenario const& window_of_delay_line(Index size) {
    static std::map<Index, Scenario> made;
    return once(made, size, [size] {
        Scenario out = tapped_delay_line(size);
        Problem<double> problem = out.problem;
        for (Index k = window_rows(size); k < out.scored; ++k) problem.prior->variance /= problem.forgetting;
        out.exact = certified(problem, rows_of_window(size).records, {window_rows(size)}).front();
        return out;
    });
}

Scenario const& batch(Index rows, Index size) {
    static std::map<std::pair<Index, Index>, Scenario> made;
    return once(made, {rows, size}, [=] {
        Seed seed{2};
        Matrix<double> psi = delay_line(size, rows, seed);
        return measured({.size = size, .forgetting = 1, .prior = std::nullopt}, std::move(psi), rows, seed);
    });
}

double digits(CertifiedSolution const& exact, Vector<double> const& theta, int arithmetic_bits) {
    if (!theta.allFinite()) return 0;
    return std::min(exact.theta_digits(theta.unaryExpr([](double x) { return Reference(x); })),
                    arithmetic_bits * std::log10(2.0));
}

}  // namespace rlslab::bench
