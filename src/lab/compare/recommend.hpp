// Which variant to use in an arithmetic, and why; or why none.
#pragma once

#include "src/lab/compare/compare.hpp"

namespace rlslab::compare {

/// Meant for single rows: neither a variant that takes blocks of them, nor one whose operations are in another library.
bool takes_single_rows(Result const& result);
/// Never broke down, in no order of the rows, and has digits.
bool is_sound(Result const& result);

/// Digits of theta's worst component that nine tenths of the counts must reach for an answer to be of use: 3, if no
/// number is given.
double wanted_digits(CompareOptions const& options);
/// The loss of a variant to these.
Loss loss_of(Result const& result, std::vector<Result const*> const& sound);
/// Variants that never broke down, in the order in which they are recommended:
///   (1) a usable one before one that is not
///   (2) one whose `low` is at most half a digit behind another's; of others the one that is least behind
///   (3) the least loss first, counted in tenths of a digit, as printed
///   (4) of equals the preferred one
///   (5) before all that, where its sums are exact, `information`, if it is usable and within half a digit by (2), (3)
std::vector<Result const*> ranked(std::vector<Result const*> sound, double wanted, bool exact_sums = false);

/// The recommendation for one arithmetic of a comparison. Variants that take blocks of rows, and those whose operations
/// are in another library, are not recommended: they are not meant for single rows.
Recommendation recommend(Arithmetic const& arithmetic, Comparison const& comparison);

}  // namespace rlslab::compare
