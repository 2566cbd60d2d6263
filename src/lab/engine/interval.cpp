// Intervals: order statistics, Student's t, chi-squared, and of proportions.
#include <rlslab/studies/interval.hpp>

#include <rlslab/reference/distributions.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace rlslab::studies {
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
double quantile(double freedom, double risk) {
    thread_local std::map<std::pair<double, double>, double> known;
    auto const [at, fresh] = known.try_emplace({freedom, risk}, 0);
    if (fresh) at->second = correctly::student_quantile(freedom, 1 - risk / 2);
    return at->second;
}

/// P(X >= k), X of Bin(n, p), k > 0: as a tail of Fisher's F.
double at_least(double k, double n, double p) {
    double const b = n - k + 1;
    return correctly::fisher_tail(2 * b, 2 * k, k * (1 - p) / (b * p));
}

/// Of the mean of x; 0 where nothing is known: fewer than two values, equal ones, or one that is not finite.
double variance_of_mean(std::vector<double> const& x) {
    if (x.size() < 2 || !finite(x)) return 0;
    double const n = double(x.size()), mean = mean_of(x);
    double squares = 0;
    for (double const v : x) squares += (v - mean) * (v - mean);
    return squares / (n - 1) / n;
}

}  // namespace

Interval student_interval(std::vector<double> const& x, double risk) {
    double const variance = variance_of_mean(x);
    if (!(variance > 0)) return unbounded;
    double const mean = mean_of(x), half = quantile(double(x.size() - 1), risk) * std::sqrt(variance);
    return {mean - half, mean + half};
}

Interval square_interval(std::vector<double> const& x, double risk) {
    double const variance = variance_of_mean(x);
    if (!(variance > 0)) return {0, infinity};
    double const n = double(x.size()), mean = mean_of(x), f = 2 * mean * mean / variance;
    double const t = quantile(std::max(1.0, std::floor((n - 1) * f / (f + n))), risk);
    double const middle = 1 - 2 / (9 * f), half = t * std::sqrt(2 / (9 * f)), least = middle - half,
                 most = middle + half;
    return {mean / (most * most * most), least > 0 ? mean / (least * least * least) : infinity};
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

Interval proportion_interval(double hits, double of, double risk) {
    if (of == 0) return {0, 1};
    thread_local std::map<std::tuple<double, double, double>, Interval>
        known;  // 100 balls each, and groups ask the same
    auto const [at, fresh] = known.try_emplace({hits, of, risk});
    if (!fresh) return at->second;
    // The p at which the tail that starts at `from` is `wanted`: it rises with p.
    auto const where = [&](double from, double wanted) {
        double low = 0, high = 1;
        for (int i = 0; i < 50; ++i) {
            double const p = (low + high) / 2;
            (at_least(from, of, p) < wanted ? low : high) = p;
        }
        return (low + high) / 2;
    };
    return at->second = {hits <= 0 ? 0 : where(hits, risk / 2), hits >= of ? 1 : where(hits + 1, 1 - risk / 2)};
}

}  // namespace rlslab::studies
