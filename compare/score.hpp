// How many digits one variant keeps in one arithmetic along the record, and how much that depends on luck.
#pragma once

#include "compare/compare.hpp"
#include "compare/stored_problem.hpp"

namespace rlslab {

/// The 10 %, 50 % and 90 % points of these numbers (nearest rank, the outer ones rounded outwards), to a tenth: as printed. Numbers
/// that are absent count as the least. Expects at least one.
Spread spread_of(std::vector<std::optional<double>> const& digits);

/// The entry over the stored problem: once for each order of rows, and where rounding is stochastic at least four times, each with
/// draws of its own. Digits are counted at each checkpoint, breakdown is looked for after each row.
Result score(Entry const& entry, StoredProblem const& stored, std::uint64_t seed);

}  // namespace rlslab
