// Which variant to use in an arithmetic, and why; or why none.
#pragma once

#include "compare/compare.hpp"

namespace rlslab {

/// Meant for single rows: neither a variant that takes blocks of them, nor one whose operations are in another library.
bool takes_single_rows(Result const& result);
/// Never broke down, and has digits.
bool is_sound(Result const& result);

/// Whether a comes before b among forms that are equally accurate:
///   (1) a form that propagates a factor before one that propagates P or its inverse: no rounding makes the first indefinite
///   (2) covariance before information: gain and P are at hand, theta needs no solve
///   (3) fewer operations a row
bool preferred(Result const& a, Result const& b);

/// The one to use among variants that never broke down; null: none keeps half a digit (the median) of each measure.
///   (1) best: the least of its three medians is the greatest; of equals the preferred one
///   (2) as good: in all three measures the high end of its spread is at least the low end of the best's
///   (3) the first by preference among those as good
Result const* chosen_of(std::vector<Result const*> const& sound);

/// The recommendation for one arithmetic of a comparison. Variants that take blocks of rows, and those whose operations are in another
/// library, are not recommended: they are not meant for single rows.
Recommendation recommend(Arithmetic const& arithmetic, Comparison const& comparison);

}  // namespace rlslab
