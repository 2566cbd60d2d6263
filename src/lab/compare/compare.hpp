// `rlslab compare`: every variant in every arithmetic on one set of records, against the certified reference.
#pragma once

#include <rlslab/catalogue/composition.hpp>
#include "src/lab/report/provenance.hpp"
#include "src/lab/report/messages.hpp"

#include <rlslab/catalogue/any_filter.hpp>
#include <rlslab/model/default_prior.hpp>
#include <rlslab/reference/certified.hpp>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace rlslab::compare {

/// If the prior moves theta by more than this, nothing is recommended: it then matters more than a variant's accuracy.
inline constexpr double most_prior_bias = 0.01, most_component_bias = 0.1;

struct CompareOptions {
    double forgetting = 1;                      ///< lambda
    std::optional<double> p0 = {};              ///< c^2 of P0 = c^2 I; absent: the prior scaled to the data
    double prior_times = 1;                     ///< c of that prior is multiplied by this power of two
    std::vector<std::string> variants = {};     ///< empty: all
    std::vector<std::string> arithmetics = {};  ///< empty: all
    std::optional<double> digits = {};  ///< that the recommended variant keeps of theta's worst component; absent: 3
    Composition composition = {};  ///< around each variant; only in float and double, and in the record's order of rows
    std::uint64_t seed = 1;        ///< of stochastic rounding, and of the orders of rows
    int threads = 0;               ///< 0: all cores; the results do not depend on it
    bool timings = true;           ///< false: ns_per_update is left out
    bool certify = false;  ///< probes in each filter of float and double (composed_score.hpp); without a composition
};

/// One value for each of the three measures of accuracy: theta in norm, its worst component, P in the Frobenius norm.
template <class X>
struct PerMeasure {
    X theta, worst, covariance;
    static constexpr std::array<X PerMeasure::*, 3> all() {
        return {&PerMeasure::theta, &PerMeasure::worst, &PerMeasure::covariance};
    }
};
/// -log10 of a relative error, at most the digits the arithmetic has, negative when the error exceeds the answer;
/// absent where there is no finite answer.
using Digits = PerMeasure<std::optional<double>>;

/// The spread of digits over the checkpoints of some runs: nine tenths of them are at least `low`, a half at least
/// `median`, a tenth at least `high`. Rounded to a tenth of a digit, as printed; -infinity: there was no finite answer.
struct Spread {
    double low, median, high;
    friend bool operator==(Spread const&, Spread const&) = default;
};

/// The first step at which P (as stored: decided exactly) was not positive definite, or something was not finite.
struct Breakdown {
    Index step;   ///< from 1; 0: the prior itself, as this arithmetic stores it
    Health kind;  ///< indefinite or nonfinite
};

/// What a variant keeps in other orders of the rows than the record's.
struct OtherOrders {
    int runs = 0, broken = 0;  ///< orders tried, and in how many the variant broke down
    std::optional<PerMeasure<Spread>> spread = {};
};

/// What probes show at the last row of ||D^-1 (Phat P^-1 - I) D||_F, D_jj = 2^round(log2 sqrt(P_jj)) of P0.
struct Probed {
    double estimate, bound;       ///< of a Certificate
    std::optional<double> truth;  ///< in 257 bits; absent of `information`, whose factor the probes look at
};

/// Digits of P from the rows alone (prior_law.hpp), as the median of the spread: about so many, or at least so many.
struct Predicted {
    double digits;
    bool at_least;
};

/// One row of the table: in the record's own order, unless it says otherwise.
struct Result {
    CatalogueEntry const* entry;
    Digits last = {};                               ///< at the last row
    std::optional<PerMeasure<Spread>> spread = {};  ///< absent: the stored problem has no exact solution
    int runs = 0, broken = 0;  ///< draws of the roundings (score.hpp), and in how many the variant broke down
    OtherOrders others = {};   ///< where lambda = 1
    std::optional<Breakdown> breakdown = {};   ///< in the first run
    std::optional<double> foretold = {};       ///< row at about which P will be indefinite (score.hpp)
    bool factor = false;                       ///< propagates a factor, which no rounding makes indefinite
    std::vector<Digits> path = {};             ///< at each of the comparison's checkpoints, in the first run
    double worst_low = -INFINITY;              ///< spread->worst.low before it is rounded
    std::vector<Vector<Reference>> ends = {};  ///< theta after the last row of each run, other orders included
    std::optional<double> asymmetry = {};      ///< max |F_ij - F_ji| / max |F_ij| of what is stored; 0 for factors
    std::optional<long> operations = {};       ///< a row: the update, and theta where it is solved for on request
    std::optional<double> ns_per_update = {};
    std::optional<Probed> probed = {};        ///< with options.certify, in the record's own order
    std::optional<Predicted> predicted = {};  ///< absent with a composition, and where there is no law
    // With a composition around the variant:
    std::string obstacle = {};                     ///< why it cannot be; the rest is then empty
    std::vector<CompositionCounts> happened = {};  ///< at each checkpoint
    Index certified_to = 0;  ///< the last checkpoint compared with a certified minimiser; then comes the recursion
};

/// A fast form on a record whose regressors are a delay line (score.hpp).
struct FastResult {
    std::string_view form, arithmetic;
    std::optional<double> digits = {};        ///< of the prediction errors; absent where one is not finite
    std::optional<Breakdown> breakdown = {};  ///< the first step that was not sound
    long operations = 0;                      ///< a row
};

/// The effect of storing the problem in an arithmetic shorter than binary64, before any variant computes with it.
struct RoundingEffect {
    std::string_view arithmetic;
    double forgetting;                        ///< lambda as stored
    Index rank;                               ///< exact, of the regressors as stored
    bool in_range;                            ///< whether lambda and every entry of P0 are positive and finite there
    std::optional<double> theta_digits = {};  ///< in which the exact solutions for given and stored data agree
    double prior_bias = NAN;                  ///< of the stored problem; NaN when the prior alone makes it one
    double component_bias = NAN;              ///< likewise
    bool data_in_range = true;                ///< whether every number of the data is finite there
    bool prior_subnormal = false;             ///< whether an entry of P0 is subnormal there: it and P would lose digits
};

/// A variant's loss, by median, in the measure where that is most: to the best in it of those that never broke down.
struct Loss {
    std::string variant;
    double digits = 0;    ///< infinite: it broke down, or has no answer
    std::string of = "";  ///< "theta", "its worst component", "P"
};

struct Recommendation {
    std::string arithmetic;
    std::string variant;  ///< empty: none
    std::string why;
    bool too_short = false;         ///< none, and a longer arithmetic may have one
    std::vector<Loss> losses = {};  ///< of this variant, the runner-up, and `conventional`: each that was tried, once
    std::string cheapest = {};      ///< of the forms within half a digit that propagate a factor, if it costs less
    Index exact_rows = 0;  ///< `information` is named because its sums are exact, up to so many rows (score.hpp)
};

/// Where the products and sums of the normal equations are exact in an arithmetic (score.hpp).
struct ExactSums {
    std::string_view arithmetic;
    Index rows;  ///< up to which they are, for numbers no larger than the record's
};

/// What the prior costs a form that stores P, in theta against least squares; predicted (docs/theory.md 106).
struct PriorCost {
    std::string_view arithmetic;
    std::string form;  ///< "symmetric", for all that update P by a difference, or "joseph"
    double best_c2;    ///< with which it is predicted to be nearest to least squares: P0 = c^2 I, or diag(c^2 / s_i^2)
    double digits;     ///< predicted with that one
    double loss;       ///< of these digits, by the prior that was given; at most all
};

/// What the start costs the forms that correct theta row by row, with the prior of the comparison; predicted
/// (docs/theory.md 105): they keep the roundings of a theta_k that is large while the rows excite little.
struct StartCost {
    std::string_view arithmetic;
    double digits;                       ///< of theta after the last row
    double loss;                         ///< to a start that has theta at once
    std::optional<double> best_c2 = {};  ///< as in PriorCost; where the loss is half a digit and a smaller one is best
};

/// The names of output and regressors, for the text and for the printed code.
struct ModelText {
    std::string file, output;                           ///< "sales.csv", "sales[k]"
    std::vector<std::string> regressors;                ///< "-sales[k-1]", "lead[k]", "1"
    std::vector<std::pair<std::string, double>> means;  ///< taken off each column first
    std::vector<std::string> warnings = {};             ///< of the columns
};

struct Comparison {
    Index rows, skipped, size;
    std::vector<std::string> names = {};  ///< of the parameters
    ModelText model = {};
    std::vector<std::string> theta;  ///< the exact minimiser with the prior, for the data as binary64: 30 digits
    std::vector<std::string> least_squares;    ///< the exact minimiser without the prior
    std::vector<double> agreement;             ///< digits in which the two agree, a component each; at most 30
    double radius;                             ///< proven relative error of theta
    int bits;                                  ///< working precision at which it was certified
    double condition;                          ///< kappa_2 of the weighted data matrix
    std::optional<DefaultPrior> scaled_prior;  ///< absent: options.p0 was given
    double prior_bias;       ///< |theta - least squares| / |least squares| in units of the regressors' sizes
    double component_bias;   ///< the same of the worst component (largest_relative_change)
    double offset = 0;       ///< |mean of y| in standard deviations; 0 where a regressor is constant
    CompareOptions options;  ///< with which it was made; the composition with all its numbers
    std::vector<Index> checkpoints;
    std::vector<RoundingEffect> rounding = {};  ///< a line for each arithmetic shorter than binary64
    std::vector<Result> results = {};
    std::vector<Recommendation> recommendations = {};
    std::optional<CertifiedSolution> without_prior = {};  ///< of all rows, as stored in double
    std::vector<ExactSums> exact = {};                    ///< the arithmetics in which sums are exact
    std::vector<PriorCost> prior_costs = {};              ///< where somebody computed them: prior_law.hpp
    std::vector<StartCost> start_costs = {};              ///< likewise
    std::vector<FastResult> fast = {};  ///< empty unless the regressors are a delay line, and with a composition
    std::shared_ptr<struct DigitsAnswer const> digits = {};  ///< with options.digits: it is the answer that is shown
    std::optional<report::Provenance> run = {};              ///< with it JSON, CSV and page say which run they are from
};

/// Least squares of all rows, without a prior. Throws InputError where they do not determine theta (exact rank).
CertifiedSolution least_squares(Records const& records, double forgetting);

/// Throws InputError when the options name an unknown variant or arithmetic, or the regressors are linearly dependent
/// (exact rank). Its stages are "reference" and "comparing".
Comparison compare(Records const& records, CompareOptions const& options, report::StagedProgress const& progress = {});

/// The comparison as text (colour: with ANSI codes; columns: of the terminal to fit, 0: as wide as it is), JSON, CSV.
std::string as_table(Comparison const& comparison, bool colour, size_t columns = 0);
std::string as_json(Comparison const& comparison);
std::string as_csv(Comparison const& comparison);
std::string as_page(Comparison const& comparison);

// --- what is to be said of the record before anything is said of variants: the sentences of `identify` ---------------

/// Where the records' rows stand in their file.
struct InFile {
    std::vector<Index> rows = {};         ///< of each row of the records: the file's row, from 0
    std::vector<long> lines = {};         ///< of each row of the file
    std::vector<double> resolution = {};  ///< of each regressor: the unit to which the file's numbers are rounded
    Index order = 0;                      ///< the longest lag, less the delay
};

/// A sentence for each of
///   (1) regressors that depend on one another but for the rounding of their numbers (doubts.hpp of the model)
///   (2) a row whose residual of least squares, with these weights and without a prior, is too large for a normal
///       distribution
///   (3) regressors whose mean is more than `much_offset` standard deviations off 0, beside a constant: they are nearly
///       parallel to it, and of their parameters about log10 of that number in digits is lost
/// None where theta is not determined. Costs as much as two solutions of the reference.
std::vector<std::string> doubts(Records const& records, CompareOptions const& options,
                                std::vector<std::string> const& regressors, InFile const& in_file);
inline constexpr double much_offset = 10;

/// |mean| in standard deviations; infinite where all numbers are one that is not 0.
double deviations_off_zero(Vector<double> const& x);

}  // namespace rlslab::compare
