// Residuals and values that are too large to be like the others.
#pragma once

#include <rlslab/model/signals.hpp>

#include <optional>

namespace rlslab::identify {

/// The largest |e| over the root mean square of these residuals, if so large a one is found among as many normal ones with probability
/// 0.1 % at most; or the first of half its size in the `lags` rows before it. NaN: no residual.
struct Largest {
    Index at;
    double deviations, share;  ///< share: of the sum of squares
};
std::optional<Largest> too_large(Signal const& residuals, Index lags = 0);

/// The value farthest from the others' mean, among the `first` ones; NaN: no value.
struct Spike {
    Index row = 0;          ///< of the record, from 1
    double deviations = 0;  ///< in standard deviations of the others
};
Spike largest_spike(Signal const& u, Index first);

}  // namespace rlslab::identify
