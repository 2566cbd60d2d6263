// Rows whose products and sums are exact in an arithmetic: the normal equations are then formed without an error.
#pragma once

#include <rlslab/catalogue/any_filter.hpp>

#include <optional>

namespace rlslab::compare {

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
