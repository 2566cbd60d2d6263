// The digits that one variant keeps in one arithmetic along the record, how much they vary with the draws of the
// roundings and with the order of rows, and when a stored P that loses its symmetry will be indefinite.
#pragma once

#include "src/lab/compare/compare.hpp"
#include "src/lab/compare/rounded_problem.hpp"

#include <functional>

namespace rlslab::compare {

/// The antisymmetric part of P in the conventional form is only divided by lambda at each row (docs/theory.md 28, law
/// ii), while P itself keeps its size. With a_k = max |P_ij - P_ji| / sqrt(P_ii P_jj) after row k, the guard's measure,
///
///   (1) P is indefinite at about row k + ln(1 / a_k) / -ln lambda
///
/// Told where the largest |P_ij - P_ji| grew by this law from each look to the next, over the second half of them: a
/// form that computes both products damps it, and it goes up and down.
class Foretold {
public:
    /// looks: how many there will be; lambda as stored.
    Foretold(double forgetting, size_t looks) : forgetting_(forgetting), looks_(looks) {}
    void look(Index row, Stored<Reference> const& stored);
    /// (1) after the last look; none: lambda is 1, a factor is stored, or the law does not hold.
    std::optional<double> row() const;

private:
    double forgetting_;
    size_t looks_, seen_ = 0;
    Index last_ = 0;
    double largest_ = 0, share_ = 0;
    bool grows_ = true;
};

/// "11000": two digits, as many as it has.
double rounded_row(double row);

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
    std::optional<double> foretold = {};  ///< row, if it did not break down: Foretold
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

/// Draw i of the roundings: every psi and y times a factor near 1 (draw 0: 1; then 15/16, 31/32, 29/32 ...; none below
/// 27/32). theta is the same and every intermediate result is rounded at another place. P0 stays as it is. The factors
/// have few bits, so that whole numbers stay whole numbers of few bits.
Records drawn(Records records, size_t draw);

/// Draws are taken four at a time, until `settled`; at most 16, and at most as many as make 2^17 rows. One
/// with a composition.
inline constexpr size_t draws_at_a_time = 4;
size_t most_draws(Index rows, CompareOptions const& options = {});

/// Whether a further draw could change what is named: a form for single rows that never broke down, whose loss is at
/// most two digits.
bool is_contender(Result const& result, std::vector<Result const*> const& sound);

/// Whether the draws tell enough. `runs` are those of `results`, entry by entry, of one arithmetic; `before` is what
/// the draws before the last four named. They do
///   (1) where nothing is named
///   (2) where what is named was named before
///   (3) where in each measure the mean over the draws of what it lacks to the best, by medians, and two standard
///       errors of that mean are at most half a digit
bool settled(std::vector<Result const*> const& results, std::vector<Runs const*> const& runs,
             std::vector<Index> const& checkpoints, std::string const& named, std::string const& before);

}  // namespace rlslab::compare
