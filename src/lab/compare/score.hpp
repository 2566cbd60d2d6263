// The problem as one arithmetic stores it, with its exact solutions along every order of rows that is tried.
// The digits that one variant keeps in one arithmetic along the record, how much they vary with the draws of the
// roundings and with the order of rows, and when a stored P that loses its symmetry will be indefinite.
#pragma once

#include "src/lab/compare/compare.hpp"

#include <functional>

namespace rlslab::compare {

/// The rows in one order, and the exact solution at each checkpoint.
struct RowOrder {
    std::vector<Index> rows;  ///< row k of this order is row rows[k] of the record; empty: the record's own order
    std::vector<CertifiedSolution> exact;  ///< one a checkpoint, unresolved where none was wanted; empty: the stored
                                           ///< problem has no exact solution
};

/// Data, lambda and P0 rounded to an arithmetic, as its variants are given them, with that problem's exact solutions.
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
    std::optional<Breakdown> breakdown = {};
    std::optional<double> foretold = {};   ///< row, if it did not break down: Foretold
    std::optional<double> asymmetry = {};  ///< max |F_ij - F_ji| / max |F_ij| of what is stored last; 0 for factors
    bool factor;
    Vector<Reference> theta;  ///< after the last row
};
/// The filter takes the rows of the problem in this order (empty: the record's), `block` at a time. Breakdown is tested
/// after each block. `digits_at(c)`, if any, compares it with the reference at checkpoint c, after the rows up to it.
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

/// Draws are taken four at a time, until `settled`; at most 16, and at most 2^17 rows in all. One with a composition.
inline constexpr size_t draws_at_a_time = 4;
size_t most_draws(Index rows, CompareOptions const& options = {});

/// Whether a further draw could change what is named: a form for single rows, never broken, two digits lost at most.
bool is_contender(Result const& result, std::vector<Result const*> const& sound);

/// Whether the draws tell enough. `runs` are those of `results`, entry by entry, of one arithmetic; `before` is what
/// the draws before the last four named. They do
///   (1) where nothing is named
///   (2) where what is named was named before
///   (3) where in each measure the mean over the draws of what it lacks to the best, by medians, and two standard
///       errors of that mean are at most half a digit
bool settled(std::vector<Result const*> const& results, std::vector<Runs const*> const& runs,
             std::vector<Index> const& checkpoints, std::string const& named, std::string const& before);

/// The entries that the options select, each arithmetic's in the catalogue's order, from the shortest arithmetic to the
/// longest. Throws InputError where there is none.
std::vector<CatalogueEntry const*> chosen(CompareOptions const& options);
/// Each once, in their order.
std::vector<Arithmetic const*> arithmetics_of(std::vector<CatalogueEntry const*> const& entries);

/// Whether row k is row k - 1 moved on by one place, with a new number in the first: d >= 2 samples of one signal, the
/// newest first, without a gap.
bool is_delay_line(Records const& records);

/// Every fast form in float and double (those of `arithmetics`) on the record, with forgetting and the energy delta =
/// 1 / p0; empty unless it is a delay line. Fast forms start with zeros in their line, so that the first d - 1 rows are
/// others than those of the variants. Digits are those of the prediction errors in the rows after the checkpoints,
/// against y - psi'theta with the certified theta of the rows before, for the data as the arithmetic stores them.
std::vector<FastResult> score_fast_forms(Records const& records, double forgetting, double p0,
                                         std::vector<std::string_view> const& arithmetics,
                                         std::vector<Index> const& checkpoints);

}  // namespace rlslab::compare
