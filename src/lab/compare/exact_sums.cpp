// (1) and (2) of exact_sums.hpp, over the record as it is stored.
#include "src/lab/compare/exact_sums.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace rlslab::compare {
namespace {

/// Whole numbers times 2^unit, none above `largest`; a column of zeros has no unit.
struct Grid {
    int unit = std::numeric_limits<int>::max();
    double largest = 0;
    void take(double x) {
        if (x == 0) return;
        int exponent = 0;
        auto const whole = std::uint64_t(std::ldexp(std::frexp(std::abs(x), &exponent), 53));
        unit = std::min(unit, exponent - 53 + std::countr_zero(whole));
        largest = std::max(largest, std::abs(x));
    }
    bool is_zero() const { return largest == 0; }
};

}  // namespace

std::optional<Index> exact_rows(Records const& r, Problem<double> const& problem, Arithmetic const& a) {
    constexpr double most = 0x1p62;
    Prior<double> const& prior = *problem.prior;
    Index const d = r.parameters();
    if (problem.forgetting != 1 || a.stochastic || !r.psi.allFinite() || !r.y.allFinite()) return {};
    std::vector<Grid> columns(size_t(d) + 1);
    for (Index k = 0; k < r.rows(); ++k) {
        for (Index i = 0; i < d; ++i) columns[size_t(i)].take(r.psi(i, k));
        columns.back().take(r.y[k]);
    }
    double rows = most;
    for (Index i = 0; i < d; ++i)
        for (Index j = i; j <= d; ++j) {
            Grid const &x = columns[size_t(i)], &y = columns[size_t(j)];
            if (x.is_zero() || y.is_zero()) continue;
            int unit = x.unit + y.unit;
            double start = 0;
            if (i == j) {
                double const P0 = prior.covariance ? (*prior.covariance)(i, i) : prior.variance;
                int exponent = 0;
                if (std::frexp(P0, &exponent) != 0.5) return {};
                unit = std::min(unit, 1 - exponent), start = 1 / P0;
            }
            if (unit < a.min_exp || unit + a.digits > a.max_exp) return {};
            rows = std::min(rows, std::floor((std::ldexp(1.0, a.digits + unit) - start) / (x.largest * y.largest)));
        }
    if (!(rows >= double(r.rows()))) return {};
    return Index(rows);
}

}  // namespace rlslab::compare
