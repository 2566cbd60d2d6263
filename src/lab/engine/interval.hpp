// Confidence intervals from the values of a few seeds.
#pragma once

#include <cstddef>
#include <vector>

namespace rlslab::studies {

/// [low, high]; unbounded if nothing is known.
struct Interval {
    double low, high;

    bool inside(Interval const& of) const { return of.low <= low && high <= of.high; }
    bool outside(Interval const& of) const { return high < of.low || of.high < low; }
};

/// The probability that a claim's interval misses its number, both sides together.
constexpr double claim_risk = 0.001;
/// Fewer seeds give no interval. The median lies between the least and the greatest of 11 but for a risk of 2^-10.
constexpr size_t fewest_seeds = 11;

// Each interval is valid for the distributions named with it. In 10^5 simulated claims on these it misses its number
// with at most 1.5 times the probability `risk` (tests/studies/coverage.cpp). If all values are equal, only the
// median's interval is a point.

/// [x_(k), x_(n + 1 - k)] with the greatest k for which P(median outside) <= risk: 2 P(Bin(n, 1/2) < k) <= risk. For
/// every distribution. Unbounded if even k = 1 has more risk (n < 11 at 0.001), and for a NaN.
Interval median_interval(std::vector<double> x, double risk);

/// For a mean: mean -+ t sd / sqrt(n), where t is the 1 - risk/2 quantile of Student's distribution with n - 1 degrees
/// of freedom. For normal numbers and averages of a hundred or more. Unbounded for fewer than two values, for equal
/// values and for a value that is not finite.
Interval student_interval(std::vector<double> const& x, double risk);

/// For the mean of x_i >= 0 that are sums of squares: chi-squared with Satterthwaite's freedom f = 2 mean^2 /
/// var(mean), its quantiles by Wilson & Hilferty's cube of a normal number, here of Student's t because f is estimated:
/// t has (n - 1) f / (f + n) degrees of freedom. For squares of normal numbers, one or many a seed. Unbounded like
/// student_interval.
Interval square_interval(std::vector<double> const& x, double risk);

/// For a probability, from `hits` hits in `of` independent runs (Clopper & Pearson 1934). Also for the mean of n
/// shares, one a seed, with `hits` their sum and `of` = n: as wide as if all runs of a seed had the same outcome.
Interval proportion_interval(double hits, double of, double risk);

}  // namespace rlslab::studies
