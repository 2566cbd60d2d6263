// The words claims are written in: numbers drawn from tables, how sure their seeds make them, and whether they are where they should be.
#pragma once

#include "studies/engine/interval.hpp"
#include "studies/engine/study.hpp"

#include <concepts>

namespace rlslab::studies {

/// What is estimated from the seeds' numbers x_1 ... x_n, each of the rows of one seed. The shapes that each is admitted for stand in
/// interval.hpp.
enum class Estimate {
    middle,     ///< their median, whatever their shape: errors, ratios, slopes
    mean,       ///< their mean: normal numbers, averages of many
    geometric,  ///< 10 to the mean of log10 x_i, where log10 x_i is such a number
    quadratic,  ///< the root of the mean of x_i^2, sums of squares of normal numbers
    share,      ///< the mean of x_i in [0, 1]: of each seed's rows, how many
    most,       ///< in most seeds x_i lies in the band: fewer than half of all seeds lie outside
    every,      ///< each x_i lies in the band; that no number of seeds shows. One outside refutes it
    proven,     ///< so does each, and the claim names the proof (Basis::proof)
    fixed       ///< nothing: the number of all rows does not depend on a seed
};

/// A number of a table. Where the table has a column of replicates, which only change the seed, it is computed of each seed's rows, and
/// estimated over the seeds.
class Number {
    std::function<double(Table const&)> of_;
    std::function<Interval(Table const&)> bounds_;  // empty: the number itself
    Estimate estimate_ = Estimate::middle;
    std::string replicate_ = "replicate";

public:
    template <class F>
        requires(std::invocable<F const&, Table const&> && !std::same_as<std::remove_cvref_t<F>, Number>)
    Number(F of, Estimate estimate = Estimate::middle) : of_(std::move(of)), estimate_(estimate) {}
    /// One that rows without a number leave within bounds.
    template <class F, class Bounds>
    Number(F of, Bounds bounds) : of_(std::move(of)), bounds_(std::move(bounds)) {}

    double operator()(Table const& table) const { return of_(table); }
    /// Where the number lies: at itself, or anywhere if it is NaN.
    Interval bounds(Table const& table) const;
    Estimate estimate() const { return estimate_; }
    std::string const& replicate() const { return replicate_; }
    /// The same, estimated so.
    Number as(Estimate estimate) const;
    /// The same, where another column tells the seeds apart.
    Number over(std::string replicate) const;
};

/// The least-squares slope of log10 y against log10 x over rows where both are positive and finite; NaN for fewer than two. A row that
/// broke down (y infinite or NaN) counts as censored: the slope lies where any y not below the greatest finite one can put it, and
/// likewise for y = 0.
Number slope(std::string x, std::string y);
/// The same of ln y against x: the rate of an exponential.
Number rate(std::string x, std::string y);
/// The least-squares slope of y against x.
Number linear_slope(std::string x, std::string y);
Number mean(std::string column);
Number median(std::string column);
/// Each seed's least, its greatest: a claim about most runs.
Number least(std::string column);
Number greatest(std::string column);
Number root_mean_square(std::string column);
/// The errors of one variant over those of another on the same data, as the geometric mean over a seed's rows: of tables with
/// the columns "variant" and "error".
Number ratio_of_errors(std::string variant, std::string other);

double median(std::vector<double> values);

/// Every group's number lies in [from, to]: "0.99 [0.98, 1.00] (joseph, lambda 0.9) ... 1.01 [1.00, 1.02] (symmetric, lambda 1), 20 seeds,
/// each by itself". Over fewer than 11 seeds there is no interval.
///   holds       each group's interval of risk 0.001 lies inside the band (a false claim does so with probability 0.001 at most)
///   fails       some group's interval of risk 0.001 / groups lies outside of it (a true claim: 0.001 at most)
///   undecided   else
/// `most`: holds where each group's share of seeds outside is below a half but for a risk of 0.001, which 10 seeds show if none is
/// outside; fails where some group's is above. `every`: fails by one seed outside, else it is undecided. `proven`: holds unless one seed
/// fails it. A number that no seed changes has itself as interval. NaN fails, as does no group at all: a claim about nothing is a mistake.
Finding within(Table const& table, std::vector<std::string> const& by, Number const& number, double from, double to);

/// The cells of this column are the value in each row; for claims such as "never indefinite". Over the seeds as `within` says for most,
/// every, proven; in a table without a column of replicates by its rows alone.
Finding everywhere(Table const& table, std::string const& column, Cell const& value, Estimate seeds = Estimate::most);

/// The probability that was met `hits` times in `runs` independent ones lies in [from, to]: its interval is Clopper & Pearson's.
Finding proportion(size_t hits, size_t runs, double from, double to);

}  // namespace rlslab::studies
