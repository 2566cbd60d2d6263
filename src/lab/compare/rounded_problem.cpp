// Rounding a problem, and solving it exactly along each order of its rows.
#include "src/lab/compare/score.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace rlslab::compare {

std::vector<Index> checkpoints_of(Index rows) {
    constexpr Index most = 40;
    std::vector<Index> out;
    for (Index i = 1; i <= most; ++i)
        if (Index const k = rows * i / most; k > (out.empty() ? 0 : out.back())) out.push_back(k);
    return out;
}

std::vector<Index> shuffled(Index rows, Seed& draws) {
    std::vector<Index> order(size_t(rows), 0);
    std::iota(order.begin(), order.end(), Index(0));
    for (Index k = rows - 1; k > 0; --k) std::swap(order[size_t(k)], order[size_t(draws.uniform() * double(k + 1))]);
    return order;
}

std::vector<std::vector<Index>> row_orders(Index rows, double forgetting, std::uint64_t seed) {
    constexpr int others = 3;
    std::vector<std::vector<Index>> out(1);
    Seed draws{seed};
    for (int i = 0; forgetting == 1 && i < others; ++i) out.push_back(shuffled(rows, draws));
    return out;
}

Records in_order(Records const& records, std::vector<Index> const& rows) {
    if (rows.empty()) return records;
    Records out{.psi = Eigen::MatrixXd(records.parameters(), Index(rows.size())),
                .y = Vector<double>(Index(rows.size())),
                .names = records.names};
    for (size_t k = 0; k < rows.size(); ++k) {
        out.psi.col(Index(k)) = records.psi.col(rows[k]);
        out.y[Index(k)] = records.y[rows[k]];
    }
    return out;
}

Index counted_from(Index rows, Index parameters) { return std::min(rows, 2 * parameters); }

RoundedProblem rounded_problem(Records const& records, Problem<double> const& problem,
                               std::function<double(double)> const& round,
                               std::vector<std::vector<Index>> const& orders, int digits,
                               std::function<void()> const& solved, bool first_whole) {
    RoundedProblem out{as_stored(problem, round), as_stored(records, round), false, {}};
    Prior<double> const& prior = *out.problem.prior;
    Vector<double> const P0 =
        prior.covariance ? Vector<double>(prior.covariance->diagonal()) : Vector<double>{{prior.variance}};
    out.in_range = is_forgetting_factor(out.problem.forgetting) && (P0.array() > 0).all() && P0.allFinite();
    Index const d = records.parameters(), from = counted_from(records.rows(), d);
    for (std::vector<Index> const& rows : orders) {
        RowOrder order{rows, {}};
        std::vector<Index> steps = checkpoints_of(records.rows());
        if (out.in_range && !(first_whole && out.orders.empty()))
            std::erase_if(steps, [&](Index k) {
                if (k < from) order.exact.emplace_back(k, d, 0, Status::unresolved);
                return k < from;
            });
        if (out.in_range)
            for (CertifiedSolution& at : certified(out.problem, in_order(out.records, rows), steps, digits))
                order.exact.push_back(std::move(at));
        if (!order.exact.empty() && order.exact.back().status() != Status::certified) order.exact.clear();
        out.orders.push_back(std::move(order));
        if (solved) solved();
    }
    return out;
}

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
