// Outliers: residuals that are too large for a normal distribution, and values far from the others.
#pragma once

#include <rlslab/model/signals.hpp>

#include <optional>

namespace rlslab {

/// The largest |e| of the residuals, if as many normal ones contain one as large with probability 0.1 % at most; or the
/// first residual of half its size in the `lags` rows before it. NaN: no residual.
struct LargestResidual {
    Index at;
    double deviations, share;  ///< |e| in root mean squares of the residuals; share of their sum of squares
};
std::optional<LargestResidual> outlier_in(Signal residuals, Index lags = 0);

/// The value farthest from the mean of the others, among the first `count`; NaN: no value.
struct Spike {
    Index row = 0;          ///< of the record, from 1
    double deviations = 0;  ///< in standard deviations of the others
};
Spike largest_spike(Signal const& u, Index count);

}  // namespace rlslab
