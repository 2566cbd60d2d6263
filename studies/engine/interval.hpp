// Where the number behind the values of a few seeds lies.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rlslab::studies {

/// [low, high]; unbounded where nothing is known.
struct Interval {
    double low, high;

    bool inside(Interval const& of) const { return of.low <= low && high <= of.high; }
    bool outside(Interval const& of) const { return high < of.low || of.high < low; }
};

/// The risk of a claim's interval to miss its number, on either side together.
constexpr double claim_risk = 0.001;
/// No interval from fewer seeds: of 11 the least and the greatest hold the median but for a risk of 2^-10.
constexpr size_t fewest_seeds = 11;

// Each interval is admitted for the shapes that are named with it. Over 10^5 simulated claims on these it misses its number at most 1.5
// times as often as `risk` says (tests/studies/coverage.cpp). Where all values are equal, only that of the median is a point.

/// [x_(k), x_(n + 1 - k)] with the greatest k for which P(median outside) <= risk: 2 P(Bin(n, 1/2) < k) <= risk. For every shape.
/// Unbounded where even k = 1 has more risk (n < 11 at 0.001), and for a NaN.
Interval median_interval(std::vector<double> x, double risk);

/// Of a mean: mean -+ t sd / sqrt(n), t the 1 - risk/2 quantile of Student's distribution with n - 1 degrees of freedom.
/// For normal numbers, and averages of a hundred or more. Unbounded for fewer than two values, equal values, or one that is not finite.
Interval student_interval(std::vector<double> const& x, double risk);

/// Of the mean of x_i >= 0 that are sums of squares: chi-squared with Satterthwaite's freedom f = 2 mean^2 / var(mean), its quantiles by
/// Wilson & Hilferty's cube of a normal number, and Student's t in place of that, because f is estimated: t has (n - 1) f / (f + n)
/// degrees of freedom. For squares of normal numbers, one or many a seed. Unbounded like student_interval.
Interval square_interval(std::vector<double> const& x, double risk);

/// Of a probability that was met `hits` times in `of` (Clopper & Pearson 1934). For independent runs; and for the mean of n shares, each
/// of one seed, as `hits` of n: that is as wide as if the runs of one seed all came out alike.
Interval proportion_interval(double hits, double of, double risk);

}  // namespace rlslab::studies
