// Rounding a problem, and solving it exactly along each order of its rows.
#include "src/lab/compare/rounded_problem.hpp"

#include <algorithm>
#include <cmath>
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

RoundedProblem rounded_problem(Records const& records, Problem<double> const& problem,
                               std::function<double(double)> const& round,
                               std::vector<std::vector<Index>> const& orders, int digits,
                               std::function<void()> const& solved) {
    RoundedProblem out{as_stored(problem, round), as_stored(records, round), false, {}};
    Prior<double> const& prior = *out.problem.prior;
    Vector<double> const P0 =
        prior.covariance ? Vector<double>(prior.covariance->diagonal()) : Vector<double>{{prior.variance}};
    out.in_range = is_forgetting_factor(out.problem.forgetting) && (P0.array() > 0).all() && P0.allFinite();
    for (std::vector<Index> const& rows : orders) {
        RowOrder order{rows, {}};
        if (out.in_range)
            order.exact = certified(out.problem, in_order(out.records, rows), checkpoints_of(records.rows()), digits);
        if (!order.exact.empty() && order.exact.back().status() != Status::certified) order.exact.clear();
        out.orders.push_back(std::move(order));
        if (solved) solved();
    }
    return out;
}

}  // namespace rlslab::compare
