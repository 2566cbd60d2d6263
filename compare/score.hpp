// The digits that one variant keeps in one arithmetic along the record, and how much they vary with the order of rows and the draws.
#pragma once

#include "compare/compare.hpp"
#include "compare/stored_problem.hpp"

namespace rlslab::compare {

/// The 10 %, 50 % and 90 % points of these numbers (nearest rank), rounded to a tenth as printed, the outer ones outwards. Absent numbers
/// count as the least. Expects at least one number.
Spread spread_of(std::vector<std::optional<double>> const& digits);

/// last, spread and worst_low of a result that has its path, from the digits at the checkpoints that count.
void set_spread(Result& result, PerMeasure<std::vector<std::optional<double>>> const& all);

/// max |F_ij - F_ji| / max |F_ij|.
std::optional<double> asymmetry_of(Stored<Reference> const& stored);

/// The result of one entry on the stored problem. It runs once for each order of rows; with stochastic rounding at least four times, each
/// run with its own draws. Digits are counted at each checkpoint, and breakdown is tested after each row.
Result score(CatalogueEntry const& entry, StoredProblem const& stored, std::uint64_t seed);

}  // namespace rlslab::compare
