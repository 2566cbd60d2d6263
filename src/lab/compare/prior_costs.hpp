// What a prior costs the forms that store P, against the best one of its shape; and what a start costs those that
// correct theta row by row.
#pragma once

#include "src/lab/compare/compare.hpp"

namespace rlslab::compare {

/// A loss below this is no reason for a warning.
inline constexpr double least_prior_loss = 0.5;

/// For each arithmetic of the comparison that rounds to nearest, has at most 53 bits and holds data and prior:
/// `symmetric` (for all that update P by a difference), then `joseph`; predicted by prior_law.hpp. Empty with a
/// composition, with lambda < 1, and where there is no law. Costs O(d^2) operations in 257 bits for each of at most
/// max(4 d, 4e4 / d^2) rows and 14 priors: up to a second.
/// `comparison` is what compare returned for these records.
std::vector<PriorCost> prior_costs(Records const& records, Comparison const& comparison);

/// For the same arithmetics and records, with the prior of the comparison: (5) of prior_law.hpp, and its loss to a
/// start that has theta at once. One pass over those rows; fourteen where the loss is half a digit or more.
std::vector<StartCost> start_costs(Records const& records, Comparison const& comparison);

/// The sentence on what the start costs; "" where it is less than half a digit everywhere.
std::string start_cost_text(Comparison const& comparison);

/// The sentence on --p0; "" where it is scaled to the data, or costs less than half a digit everywhere.
std::string prior_cost_text(Comparison const& comparison);

}  // namespace rlslab::compare
