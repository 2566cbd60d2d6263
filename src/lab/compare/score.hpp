// The digits that one variant keeps in one arithmetic along the record, and how much they vary with the draws of the
// roundings and with the order of rows.
#pragma once

#include "src/lab/compare/compare.hpp"
#include "src/lab/compare/rounded_problem.hpp"

#include <functional>

namespace rlslab::compare {

/// -log10(|error| / |size|): infinity for no error, -infinity where the size alone is 0, NaN for what is not finite.
double digits_of(Reference const& error, Reference const& size);
/// The number of digits, at most `most`; absent for NaN.
std::optional<double> at_most(double digits, double most);

/// The 10 %, 50 % and 90 % points of these numbers (nearest rank), rounded to a tenth as printed, the outer ones
/// outwards. Absent numbers count as the least. Expects at least one number.
Spread spread_of(std::vector<std::optional<double>> const& digits);

/// One pass of a filter over the rows in one order.
struct Run {
    std::vector<Digits> digits;  ///< at each checkpoint; empty: the problem has no exact solution
    std::optional<Breakdown> breakdown;
    std::optional<double> foretold = {};  ///< row, if it did not break down (foretold.hpp)
    std::optional<double> asymmetry;  ///< max |F_ij - F_ji| / max |F_ij| of what is stored at the end; 0 for factors
    bool factor;
    Vector<Reference> theta;  ///< after the last row
};
/// The filter takes the rows of the problem in this order (empty: the record's), `block` at a time. Breakdown is tested
/// after each block. `digits_at(c)` compares the filter with the reference at checkpoint c, after the rows up to it. It
/// may be empty.
Run run(AnyFilter& filter, Arithmetic const& arithmetic, Index block, RoundedProblem const& rounded,
        std::vector<Index> const& order, std::function<Digits(size_t)> const& digits_at);
/// The runs of one entry: in the record's order, and in others.
struct Runs {
    std::vector<Run> own, others;
};
/// The result of these runs: digits count from row 2 d on.
Result result_of(CatalogueEntry const& entry, RoundedProblem const& rounded, Runs const& runs);

/// One run of an entry, in the order of this number. `draws`: of stochastic rounding.
Run run_of(CatalogueEntry const& entry, RoundedProblem const& rounded, size_t order, Seed draws);
/// The seed of the draws of a run.
Seed seed_of_run(std::uint64_t seed, size_t run);
/// Once in each order of rows, the first of which is the record's; none where the problem is not in range.
Runs runs_of(CatalogueEntry const& entry, RoundedProblem const& rounded, std::uint64_t seed);

/// The result of runs_of, with four draws where rounding is stochastic.
Result score(CatalogueEntry const& entry, RoundedProblem const& rounded, std::uint64_t seed);

}  // namespace rlslab::compare
