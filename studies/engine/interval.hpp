// Where the number behind the values of a few seeds lies.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rlslab {

/// [low, high]; unbounded where nothing is known.
struct Interval {
    double low, high;

    bool inside(Interval const& of) const { return of.low <= low && high <= of.high; }
    bool outside(Interval const& of) const { return high < of.low || of.high < low; }
};

/// The risk of a claim's interval to miss its number.
constexpr double claim_risk = 0.001;
/// No interval from fewer seeds.
constexpr size_t fewest_seeds = 5;
/// From so many seeds on order statistics and the bootstrap are used, below them Student's t.
constexpr size_t many_seeds = 20;
constexpr int resamples = 9999;

/// mean -+ t sd / sqrt(n), t the 1 - risk/2 quantile of Student's distribution with n - 1 degrees of freedom.
/// Unbounded for fewer than two values or one that is not finite.
Interval student_interval(std::vector<double> const& x, double risk);

/// From the risk/2 to the 1 - risk/2 quantile of the means of `resamples` resamples of x (Efron 1979, percentiles), which are drawn by
/// SplitMix64 from the seed n: the same for every claim. x is sorted first, so that the order of the seeds does not matter.
Interval bootstrap_interval(std::vector<double> x, double risk);

/// [x_(k), x_(n + 1 - k)] with the greatest k for which P(median outside) <= risk: 2 P(Bin(n, 1/2) < k) <= risk. It needs no distribution.
/// Unbounded where even k = 1 has more risk (n < 11 at 0.001), and for a NaN.
Interval median_interval(std::vector<double> x, double risk);

/// Of a probability that was met `hits` times in `of` (Clopper & Pearson 1934).
Interval proportion_interval(size_t hits, size_t of, double risk);

}  // namespace rlslab
