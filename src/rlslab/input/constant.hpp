// Whether numbers are all the same: asked of a record's own numbers, before means are taken off.
#pragma once

#include <cmath>
#include <optional>

namespace rlslab {

/// The number that all of x are (NaN: missing, left out); none if two differ, or all are missing. The mean of 0.1, 0.1
/// ... is another number when it is computed as a sum: what is left of each then is rounding, and looks like data.
template <class X>
std::optional<double> constant_value(X const& x) {
    std::optional<double> out;
    for (double const v : x) {
        if (std::isnan(v)) continue;
        if (!out) out = v;
        else if (v != *out) return std::nullopt;
    }
    return out;
}

}  // namespace rlslab
