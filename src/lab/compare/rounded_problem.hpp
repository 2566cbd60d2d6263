// The problem as one arithmetic stores it, with its exact solutions along every order of rows that is tried.
#pragma once

#include <rlslab/catalogue/any_filter.hpp>
#include <rlslab/reference/certified.hpp>

#include <functional>

namespace rlslab::compare {

/// The rows in one order, and the exact solution at each checkpoint.
struct RowOrder {
    std::vector<Index> rows;  ///< row k of this order is row rows[k] of the record; empty: the record's own order
    std::vector<CertifiedSolution> exact;  ///< one a checkpoint; empty: the stored problem has no exact solution
};

/// Data, lambda and P0 rounded to an arithmetic, as its variants are given them, with the exact solutions of that
/// problem.
struct RoundedProblem {
    Problem<double> problem;
    Records records;
    bool in_range;  ///< lambda and P0 as stored are positive and finite
    std::vector<RowOrder> orders;
};

/// The rows after which digits are counted: at most 40, evenly spread, the last row among them.
std::vector<Index> checkpoints_of(Index rows);

/// 0 ... rows-1 in an order drawn by Fisher and Yates' method.
std::vector<Index> shuffled(Index rows, Seed& draws);

/// The orders of rows that are tried: the record's, and where lambda = 1 three others, drawn from the seed. With
/// forgetting the order is part of the problem.
std::vector<std::vector<Index>> row_orders(Index rows, double forgetting, std::uint64_t seed);

/// `round`: how the arithmetic stores a number. `digits`: to which the exact solutions are certified. `solved` is
/// called after each order.
RoundedProblem rounded_problem(Records const& records, Problem<double> const& problem,
                               std::function<double(double)> const& round,
                               std::vector<std::vector<Index>> const& orders, int digits,
                               std::function<void()> const& solved = {});

/// These rows of the record, in this order; all rows where none are named.
Records in_order(Records const& records, std::vector<Index> const& rows);

}  // namespace rlslab::compare
