// Intervals: Student's t, percentiles of resampled means, order statistics, and of proportions.
#include "studies/engine/interval.hpp"

#include <rlslab/core/random.hpp>
#include <rlslab/reference/distributions.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace rlslab {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Interval unbounded{-infinity, infinity};

bool finite(std::vector<double> const& x) {
    return std::ranges::all_of(x, [](double v) { return std::isfinite(v); });
}
double mean_of(std::vector<double> const& x) {
    double sum = 0;
    for (double const v : x) sum += v;
    return sum / double(x.size());
}

/// Student's quantiles cost a ball computation each; a claim asks the same few again and again.
double quantile(size_t n, double risk) {
    thread_local std::map<std::pair<size_t, double>, double> known;
    auto const [at, fresh] = known.try_emplace({n, risk}, 0);
    if (fresh) at->second = correctly::student_quantile(double(n - 1), 1 - risk / 2);
    return at->second;
}

/// P(X >= k), X of Bin(n, p), k >= 1: as a tail of Fisher's F.
double at_least(size_t k, size_t n, double p) {
    double const a = double(k), b = double(n - k + 1);
    return correctly::fisher_tail(2 * b, 2 * a, a * (1 - p) / (b * p));
}

}  // namespace

Interval student_interval(std::vector<double> const& x, double risk) {
    if (x.size() < 2 || !finite(x)) return unbounded;
    double const n = double(x.size()), mean = mean_of(x);
    double squares = 0;
    for (double const v : x) squares += (v - mean) * (v - mean);
    if (squares == 0) return {mean, mean};
    double const half = quantile(x.size(), risk) * std::sqrt(squares / (n - 1) / n);
    return {mean - half, mean + half};
}

Interval bootstrap_interval(std::vector<double> x, double risk) {
    if (x.size() < 2 || !finite(x)) return unbounded;
    std::ranges::sort(x);
    Seed seed{x.size()};
    std::vector<double> means(resamples);
    for (double& mean : means) {
        double sum = 0;
        for (size_t i = 0; i < x.size(); ++i) sum += x[size_t(seed.uniform() * double(x.size()))];
        mean = sum / double(x.size());
    }
    std::ranges::sort(means);
    size_t const beyond = std::min(size_t(risk / 2 * (resamples + 1)), means.size() / 2);
    size_t const first = beyond > 0 ? beyond - 1 : 0;
    return {means[first], means[means.size() - 1 - first]};
}

Interval median_interval(std::vector<double> x, double risk) {
    if (std::ranges::any_of(x, [](double v) { return v != v; })) return unbounded;
    size_t const n = x.size();
    double term = std::ldexp(1.0, -int(std::min<size_t>(n, 1000))), below = 0;  // P(Bin = k), P(Bin < k + 1)
    size_t k = 0;
    while (k < n / 2 && 2 * (below + term) <= risk) {
        below += term;
        term = term * double(n - k) / double(k + 1);
        ++k;
    }
    if (k == 0) return unbounded;
    std::ranges::sort(x);
    return {x[k - 1], x[n - k]};
}

Interval proportion_interval(size_t hits, size_t of, double risk) {
    if (of == 0) return {0, 1};
    // The p at which the tail that starts at `from` is `wanted`: it rises with p.
    auto const where = [&](size_t from, double wanted) {
        double low = 0, high = 1;
        for (int i = 0; i < 50; ++i) {
            double const p = (low + high) / 2;
            (at_least(from, of, p) < wanted ? low : high) = p;
        }
        return (low + high) / 2;
    };
    return {hits == 0 ? 0 : where(hits, risk / 2), hits == of ? 1 : where(hits + 1, 1 - risk / 2)};
}

}  // namespace rlslab
