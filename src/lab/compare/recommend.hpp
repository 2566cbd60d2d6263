// Which variant to use in an arithmetic, and why; or why none.
#pragma once

#include "src/lab/compare/compare.hpp"

namespace rlslab::compare {

/// Meant for single rows: neither a variant that takes blocks of them, nor one whose operations are in another library.
bool takes_single_rows(Result const& result);
/// Never broke down, in no order of the rows, and has digits.
bool is_sound(Result const& result);

/// Whether a comes before b among forms that are equally accurate:
///   (1) a form that propagates a factor before one that propagates P or its inverse: no rounding makes the first
///     indefinite
///   (2) covariance before information: gain and P are at hand, theta needs no solve
///   (3) fewer operations a row
bool preferred(Result const& a, Result const& b);

/// Digits of theta's worst component that nine tenths of the counts must reach for an answer to be of use, if no number
/// is given.
inline constexpr double enough_digits = 3;
double wanted_digits(CompareOptions const& options);
/// Keeps so many, and half a digit of P (the median).
bool is_usable(Result const& result, double wanted = enough_digits);

/// The loss of a variant to these.
Loss loss_of(Result const& result, std::vector<Result const*> const& sound);
/// By how many digits its `low` is below another's, in the measure and against the form where that is most.
double behind(Result const& result, std::vector<Result const*> const& sound);
/// Digits that forms may differ by and count as alike: of `low`, and of what is named beside the best.
inline constexpr double half_a_digit = 0.5;

/// Variants that never broke down, in the order in which they are recommended:
///   (1) a usable one before one that is not
///   (2) one whose `low` is at most half a digit behind another's; of others the one that is least behind
///   (3) the least loss first, counted in tenths of a digit, as printed
///   (4) of equals the preferred one
///   (5) before all that, where its sums are exact, `information`, if it is usable and within half a digit by (2), (3)
std::vector<Result const*> ranked(std::vector<Result const*> sound, double wanted = enough_digits,
                                  bool exact_sums = false);

/// The recommendation for one arithmetic of a comparison. Variants that take blocks of rows, and those whose operations
/// are in another library, are not recommended: they are not meant for single rows.
Recommendation recommend(Arithmetic const& arithmetic, Comparison const& comparison);

}  // namespace rlslab::compare
