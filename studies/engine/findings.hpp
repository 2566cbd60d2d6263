// The words claims are written in: numbers drawn from tables, how sure their seeds make them, and whether they are where they should be.
#pragma once

#include "studies/engine/interval.hpp"
#include "studies/engine/study.hpp"

#include <concepts>

namespace rlslab {

/// What is estimated from the seeds' numbers x_1 ... x_n, each of the rows of one seed.
enum class Estimate {
    mean,       ///< their mean: slopes, rates, differences
    geometric,  ///< 10 to the mean of log10 x_i: ratios, constants
    quadratic,  ///< the root of the mean of x_i^2
    middle,     ///< their median: errors
    every,      ///< nothing: each of them has to lie in the band
    fixed       ///< nothing: the number of all rows does not depend on a seed
};

/// A number of a table. Where the table has a column of replicates, which only change the seed, it is computed of each seed's rows, and
/// estimated over the seeds.
class Number {
    std::function<double(Table const&)> of_;
    Estimate estimate_ = Estimate::mean;
    std::string replicate_ = "replicate";

public:
    template <class F>
        requires(std::invocable<F const&, Table const&> && !std::same_as<std::remove_cvref_t<F>, Number>)
    Number(F of, Estimate estimate = Estimate::mean) : of_(std::move(of)), estimate_(estimate) {}

    double operator()(Table const& table) const { return of_(table); }
    Estimate estimate() const { return estimate_; }
    std::string const& replicate() const { return replicate_; }
    /// The same, estimated so.
    Number as(Estimate estimate) const;
    /// The same, where another column tells the seeds apart.
    Number over(std::string replicate) const;
};

/// The least-squares slope of log10 y against log10 x over rows where both are positive and finite; NaN for fewer than two.
Number slope(std::string x, std::string y);
/// The same of ln y against x: the rate of an exponential.
Number rate(std::string x, std::string y);
/// The least-squares slope of y against x.
Number linear_slope(std::string x, std::string y);
Number mean(std::string column);
Number median(std::string column);
/// Each seed's least, its greatest: a claim about every run.
Number least(std::string column);
Number greatest(std::string column);
Number root_mean_square(std::string column);
/// The errors of one variant over those of another on the same data, as a geometric mean: of tables with the columns "variant" and "error".
Number ratio_of_errors(std::string variant, std::string other);

double median(std::vector<double> values);

/// Every group's number lies in [from, to]: "0.99 [0.98, 1.00] (joseph, lambda 0.9) ... 1.01 [1.00, 1.02] (symmetric, lambda 1), 20 seeds".
/// Over fewer than 5 seeds there is no interval. Below 20 it is Student's t, of log10 x for `geometric`, and for `middle` where all are
/// positive. From 20 on: order statistics for `middle`, else the hull of Student's t and of the bootstrap's percentiles.
///   holds       each group's interval of risk 0.001 lies inside the band (a false claim does so with probability 0.001 at most)
///   fails       some group's interval of risk 0.001 / groups lies outside of it (a true claim: 0.001 at most)
///   undecided   else
/// `every`: fails by one seed outside, holds by 5 and more of which none is. A number that no seed changes has itself as interval. NaN
/// fails, as does no group at all: a claim about nothing is a mistake.
Finding within(Table const& table, std::vector<std::string> const& by, Number const& number, double from, double to);

/// Every row's cell in this column is the value; for claims such as "never indefinite". Fails by one that is not; holds by none in 5 seeds
/// and more, or in a table without a column of replicates.
Finding everywhere(Table const& table, std::string const& column, Cell const& value, std::string const& replicate = "replicate");

/// The probability that was met `hits` times in `runs` independent ones lies in [from, to]: its interval is Clopper & Pearson's.
Finding proportion(size_t hits, size_t runs, double from, double to);

}  // namespace rlslab
