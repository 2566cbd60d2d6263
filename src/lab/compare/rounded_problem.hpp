// The problem as one arithmetic stores it, with its exact solutions along every order of rows that is tried; and rows
// whose products and sums are exact there: the normal equations are then formed without an error.
#pragma once

#include <rlslab/catalogue/any_filter.hpp>
#include <rlslab/reference/certified.hpp>

#include <functional>
#include <optional>

namespace rlslab::compare {

/// The rows in one order, and the exact solution at each checkpoint.
struct RowOrder {
    std::vector<Index> rows;  ///< row k of this order is row rows[k] of the record; empty: the record's own order
    std::vector<CertifiedSolution> exact;  ///< one a checkpoint, unresolved where none was wanted; empty: the stored
                                           ///< problem has no exact solution
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

/// The row from which on the digits of many runs are counted: 2 d, or the last.
Index counted_from(Index rows, Index parameters);

/// `round`: how the arithmetic stores a number. `digits`: to which the exact solutions are certified. `solved` is
/// called after each order. The first order, which is drawn as a path, has a solution at every checkpoint if it is
/// `first_whole`; the others from counted_from() on: a solution takes d^3 operations in balls.
RoundedProblem rounded_problem(Records const& records, Problem<double> const& problem,
                               std::function<double(double)> const& round,
                               std::vector<std::vector<Index>> const& orders, int digits,
                               std::function<void()> const& solved = {}, bool first_whole = true);

/// These rows of the record, in this order; all rows where none are named.
Records in_order(Records const& records, std::vector<Index> const& rows);

/// Column i (y is one more) is whole numbers times 2^(e_i), the largest of them 2^(b_i): a product of two columns is a
/// whole number times 2^(e_i + e_j), and a sum of N of them is at most N 2^(b_i + b_j). In an arithmetic of p bits it
/// is exact while
///
///   (1)  N max|psi_i| max|psi_j| + [i = j] / P0_ii <= 2^p 2^(e_i + e_j),   likewise with y
///   (2)  1 / P0_ii is a power of two, not below 2^(e_i + e_i)  or  (1) with it in place of 2^(e_i + e_i)
///
/// For lambda = 1, a diagonal P0 and theta0 = 0. Returns the largest such N; nothing where the record has more rows, or
/// a power of two in it is not normal there.
std::optional<Index> exact_rows(Records const& stored, Problem<double> const& problem, Arithmetic const& arithmetic);

}  // namespace rlslab::compare
