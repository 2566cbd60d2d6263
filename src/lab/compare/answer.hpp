// The answer of a comparison: which variant to use in an arithmetic, and why, or why none; its cost, and code for it.
#pragma once

#include "src/lab/compare/compare.hpp"

namespace rlslab::compare {

/// Meant for single rows: neither a variant that takes blocks of them, nor one whose operations are in another library.
bool takes_single_rows(Result const& result);
/// Never broke down, in no order of the rows, and has digits.
bool is_sound(Result const& result);

/// Digits of theta's worst component that nine tenths of the counts must reach for an answer to be of use; default 3.
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

// --- in words, and as code -------------------------------------------------------------------------------------------

/// "Ud" for "ud", "InverseQr" for "inverse_qr".
std::string class_of(std::string_view variant);

/// For each arithmetic with a recommendation the digits it keeps, and the digits that it and others lose; one line for
/// all arithmetics with the same reason against one. Lines are broken at `width`.
std::string verdict(Comparison const& comparison, size_t width = std::string::npos);

/// The recommendation for which code is printed: that in the shortest hardware arithmetic which has one. null: none.
Recommendation const* coded(Comparison const& comparison);

/// A filter on the problem of a comparison.
struct CodedFilter {
    std::string variant, arithmetic;  ///< of the hardware: float or double
    bool guarded = false;
    std::vector<int> exponents = {};  ///< regressor i is taken times 2^exponents[i]; empty: as it is
    int output_exponent = 0;          ///< likewise y
};
/// What code is printed for: "board", "c", "cpp", "python".
std::vector<std::string_view> code_words();
inline constexpr Index largest_on_a_board = 64;
/// A file that makes it. Comments in it give the model and the order and signs of the regressors. It compiles as it
/// stands. "" for another arithmetic. For
///   board   C++ without a heap, guarded where the form can be: `take` and `theta`, in units of the record. Of at most
///           largest_on_a_board parameters, and no composition but a guard that keeps no rows
///   c       C99 on rlslab.h: `new_filter`; with exponents also `take` and `theta`
///   cpp     C++ on the headers: `filter`
///   python  on the package: `f`
std::string code(Comparison const& comparison, CodedFilter const& filter, std::string_view word = "cpp");
/// Of the one that keeps the wanted digits, or without them of the recommended one; "" where there is none.
std::string code(Comparison const& comparison, std::string_view word = "cpp");
/// Code in lines of at most `width` letters where it has blanks: a comment and the lines that continue it go on as one.
std::string folded(std::string const& code, size_t width);

}  // namespace rlslab::compare
