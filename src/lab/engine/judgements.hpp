// The functions of claims: a statistic of a table, its interval over the seeds, and the verdict of a band on it.
#pragma once

#include <rlslab/studies/interval.hpp>
#include <rlslab/studies/study.hpp>

#include <concepts>

namespace rlslab::studies {

/// What is estimated from x_1 ... x_n, where x_i is computed from the rows of seed i. interval.hpp names the
/// distributions for which each interval is valid.
enum class Estimate {
    middle,     ///< the median, for any distribution: errors, ratios, slopes
    mean,       ///< the mean: of normal numbers, or of averages of many
    geometric,  ///< 10 to the mean of log10 x_i, for log10 x_i as in `mean`
    quadratic,  ///< the root of the mean of x_i^2, for sums of squares of normal numbers
    share,      ///< the mean of x_i in [0, 1]: a share of each seed's rows
    most,       ///< x_i lies in the band for most seeds: for more than half of all
    every,      ///< every x_i lies in the band. One outside refutes it; no number of seeds proves it
    proven,     ///< every x_i lies in the band, by the proof that the claim names (Basis::proof)
    fixed       ///< nothing: the statistic of all rows does not depend on a seed
};

class Selection;

/// A number computed from a table. If the table has a column of replicates (which change only the seed), it is computed
/// from the rows of each seed and estimated over the seeds.
class Statistic {
    std::function<double(Table const&)> of_;
    std::function<Interval(Table const&)> bounds_;  // empty: the number itself
    Estimate estimate_ = Estimate::middle;
    std::string replicate_ = "replicate";

public:
    template <class F>
        requires(std::invocable<F const&, Table const&> && !std::same_as<std::remove_cvref_t<F>, Statistic>)
    Statistic(F of, Estimate estimate = Estimate::middle) : of_(std::move(of)), estimate_(estimate) {}
    /// A statistic that rows without a number confine to bounds.
    template <class F, class Bounds>
    Statistic(F of, Bounds bounds) : of_(std::move(of)), bounds_(std::move(bounds)) {}

    double operator()(Table const& table) const { return of_(table); }
    /// The interval that holds the number: the number itself, or everything if it is NaN.
    Interval bounds(Table const& table) const;
    Estimate estimate() const { return estimate_; }
    std::string const& replicate() const { return replicate_; }
    /// The same with this estimate.
    Statistic as(Estimate estimate) const;
    /// The same with another column of replicates.
    Statistic over(std::string replicate) const;
    /// The same of these rows, as a median without bounds.
    Statistic on(Selection rows) const;
};
/// A number less another, or over it; over the replicates of the first the median. `x.on(rows) / x.on(others)`: of two
/// kinds of rows.
Statistic operator-(Statistic a, Statistic b);
Statistic operator/(Statistic a, Statistic b);

/// The least-squares slope of log10 y against log10 x over rows where both are positive and finite; NaN for fewer than
/// two. A row that broke down (y infinite or NaN) counts as censored: the slope lies where any y not below the greatest
/// finite one can put it, and likewise for y = 0.
Statistic slope(std::string x, std::string y);
/// The same of ln y against x: the rate of an exponential.
Statistic rate(std::string x, std::string y);
/// The least-squares slope of y against x.
Statistic linear_slope(std::string x, std::string y);
/// The number of the one row that a seed has.
Statistic number(std::string column);
Statistic sum(std::string column);
Statistic mean(std::string column);
Statistic median(std::string column);
/// The least and the greatest number of each seed's rows: for claims about most runs.
Statistic least(std::string column);
Statistic greatest(std::string column);
Statistic root_mean_square(std::string column);
/// Of the groups of a seed's rows, the share for which it holds.
Statistic share_of_groups(std::vector<std::string> by, std::function<bool(Table const& group)> holds);
/// The geometric mean over a seed's rows of (error of one variant) / (error of another on the same data). The table has
/// the columns "variant" and "error".
Statistic ratio_of_errors(std::string variant, std::string other);

double median(std::vector<double> values);

/// Judges that the statistic of every group lies in [from, to]: "0.99 [0.98, 1.00] (joseph, lambda 0.9) ... 1.01 [1.00,
/// 1.02] (symmetric, lambda 1), 20 seeds, each by itself". Fewer than 11 seeds give no interval.
///   holds       each group's interval of risk 0.001 lies inside the band (a false claim does so with probability 0.001
///               at most)
///   fails       some group's interval of risk 0.001 / groups lies outside of it (a true claim: 0.001 at most)
///   undecided   otherwise
/// `most` holds if in each group fewer than half of all seeds lie outside, at a risk of 0.001: 10 seeds suffice if none
/// lies outside. It fails if in some group more than half do. `every` fails if one seed lies outside, and is undecided
/// otherwise. `proven` holds unless one seed lies outside. The interval of `fixed` is the number itself. NaN fails. A
/// table without rows fails too.
Judgement within(Table const& table, std::vector<std::string> const& by, Statistic const& number, double from,
                 double to);

/// Judges that every cell of the column is the value: for claims such as "never indefinite". `seeds` is most, every or
/// proven, as in `within`. A table without a column of replicates is judged by its rows alone.
Judgement everywhere(Table const& table, std::string const& column, Cell const& value, Estimate seeds = Estimate::most);

/// Rows of a table: all of them, or those that Table::where leaves, once or several times. A claim is made of one
/// before there is a table.
class Selection {
    std::function<Table(Table const&)> of_ = [](Table const& table) { return table; };

public:
    Selection() = default;
    template <std::invocable<Table const&> F>
    Selection(F of) : of_(std::move(of)) {}

    Table operator()(Table const& table) const { return of_(table); }
    Selection where(std::string column, Cell value) const;
    Selection where(std::string column, std::function<bool(double)> holds) const;
    Selection where(std::string column, std::vector<std::string> words) const;
    /// Judges these rows; or each group of them by itself, with its name.
    Judge judged(Judge by) const;
    Judge each_judged(std::vector<std::string> by, Judge group) const;
};
inline Selection const all_rows;
/// The same of all rows.
inline Selection where(std::string column, Cell value) { return all_rows.where(std::move(column), std::move(value)); }
inline Selection where(std::string column, std::function<bool(double)> holds) {
    return all_rows.where(std::move(column), std::move(holds));
}
inline Selection where(std::string column, std::vector<std::string> words) {
    return all_rows.where(std::move(column), std::move(words));
}
/// For `where`: the numbers up to x, from x on, below it, above it, and in [from, to].
std::function<bool(double)> at_most(double x);
std::function<bool(double)> at_least(double x);
std::function<bool(double)> below(double x);
std::function<bool(double)> above(double x);
std::function<bool(double)> between(double from, double to);

/// `within` and `everywhere` of the selected rows of the table that a claim is judged by.
Judge within(Selection const& rows, std::vector<std::string> const& by, Statistic const& number, double from,
             double to);
Judge everywhere(Selection const& rows, std::string const& column, Cell const& value, Estimate seeds = Estimate::most);

/// A judge for each of these, with its name, together.
Judge of_each(std::vector<std::string> const& names, std::function<Judge(std::string const&)> const& judge);

/// holds: the interval lies inside the band; fails: outside of it.
Verdict verdict_of(Interval const& shown, Interval const& band);

/// Judges that a probability lies in [from, to], from `hits` hits in independent `runs`, by the interval of Clopper &
/// Pearson.
Judgement proportion(size_t hits, size_t runs, double from, double to);

}  // namespace rlslab::studies
