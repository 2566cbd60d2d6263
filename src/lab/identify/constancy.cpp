// The filter's steps, summed.
#include "src/lab/identify/constancy.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/catalogue.hpp>

#include <algorithm>

namespace rlslab::identify {
namespace {

struct Lines {
    double a, tail;  ///< of the sum; of the squares on one side
};
constexpr Lines at_5_percent{0.948, 0.025}, at_1_percent{1.143, 0.005};

/// The path with its lines at 5 %. half(r, level): half their distance at r = 1 ... m about `middle`(r).
template <class Middle, class Half>
ConstancyPath path_of(Signal value, Middle middle, Half half) {
    ConstancyPath out;
    double most = 0;
    for (size_t i = 0; i < value.size(); ++i) {
        double const r = double(i + 1), off = std::abs(value[i] - middle(r)), reach = half(r, at_5_percent);
        out.lower.push_back(middle(r) - reach), out.upper.push_back(middle(r) + reach);
        if (off > reach && !out.crosses) out.crosses = Index(i);
        out.surely |= off > half(r, at_1_percent);
        if (off > most) most = off, out.farthest = Index(i);
    }
    out.value = std::move(value);
    return out;
}

double solved_line(Index n, double tail) {
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
        double const c = (low + high) / 2;
        (tail_of_largest_excess(n, c) > tail ? low : high) = c;
    }
    return low;
}

}  // namespace

double tail_of_largest_excess(Index n, double c) {
    double const alpha = double(n + 1) * c;
    double sum = 0, choose = 1;  // n over j
    for (Index j = 0; j <= n; ++j) {
        if (j > 0) choose *= double(n - j + 1) / double(j);
        double const t = (double(j) - alpha) / double(n + 1);
        if (t < 0) continue;
        double const passed = correctly::pow(t, double(j)) * correctly::pow(1 - t, double(n - j));
        sum += choose * passed * (1 + alpha) / (1 + alpha + double(n - j));
    }
    return sum;
}

double squares_line(Index m, double tail) {
    bool const wide = tail == at_1_percent.tail;
    expects(m >= 4 && (wide || tail == at_5_percent.tail), "4 residuals or more, and a level with a line");
    double const n = double(m) / 2 - 1;
    if (n < 60) {
        double const below = solved_line(m / 2 - 1, tail);
        return m % 2 == 0 ? below : (below + solved_line(m / 2, tail)) / 2;
    }
    auto const [a1, a2, a3] = wide ? std::tuple(1.6276236, -0.6703724, -1.2365861)  // Edgerton & Wells
                                   : std::tuple(1.3581015, -0.6701218, -0.8858694);
    return a1 / std::sqrt(n) + a2 / n + a3 / (n * std::sqrt(n));
}

Constancy constancy(Records const& rows, std::vector<Index> const& samples, double rounding) {
    Constancy out;
    Problem<double> const problem{.size = rows.parameters(), .prior = std::nullopt};
    auto const filter = find_entry("qr")->make(problem, Seed{1});
    double J = 0;
    for (Index k = 0; k < rows.rows(); ++k) {
        Step<double> const step = filter->update(rows.sample(k), rows.y[k]);
        if (std::isnan(step.innovation) && out.residuals.empty()) continue;  // theta is not determined yet
        double const w = step.innovation * std::sqrt(step.gamma);            // (1)
        J += w * w;
        out.samples.push_back(samples[size_t(k)]), out.residuals.push_back(w);
    }
    Index const m = Index(out.residuals.size());
    if (m < 4 || !std::isfinite(J) || J <= rounding) return {};
    double const count = double(m), sigma = std::sqrt(J / count);
    Signal sums, squares;
    double sum = 0, square = 0;
    for (double const w : out.residuals) {
        sum += w, square += w * w;
        sums.push_back(sum / sigma), squares.push_back(square / J);
    }
    out.cusum = path_of(
        std::move(sums), [](double) { return 0.0; },  // (2)
        [&](double r, Lines const& l) { return l.a * std::sqrt(count) * (1 + 2 * r / count); });
    double const narrow = squares_line(m, at_5_percent.tail), wide = squares_line(m, at_1_percent.tail);
    out.c0 = narrow;
    out.squares = path_of(
        std::move(squares), [&](double r) { return r / count; },  // (3)
        [&](double, Lines const& l) { return l.tail == at_5_percent.tail ? narrow : wide; });
    return out;
}

}  // namespace rlslab::identify
