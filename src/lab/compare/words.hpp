// Sentences and numbers that the text and the page of a comparison have in common.
#pragma once

#include "src/lab/compare/compare.hpp"

#include <rlslab/catalogue/composition_text.hpp>

#include <fmt/format.h>

namespace rlslab::compare {

/// The width of the widest table, and of the text around it.
inline constexpr size_t text_width = 114;

/// If the mean of y is more standard deviations than this, and no regressor is constant, a warning says so.
inline constexpr double most_offset = 2;

/// Digits to a tenth, below -9.9 to one; "-" where there are none.
std::string tenths(double digits);

/// "none", "indefinite at 25", "in 2 of 4 draws", "in 1 of 3 orders" (other ones than the record's), "about row 11000".
std::string breakdown_text(Result const& result);

/// The number as the format prints it; "-" where there is none.
template <class X>
std::string known(std::optional<X> const& x, char const* format) {
    return x ? fmt::format(fmt::runtime(format), *x) : "-";
}

/// The diagonal of P0 that is scaled to the data.
std::vector<double> diagonal_of(DefaultPrior const& prior);

/// "as stored: lambda 0.9906, rank 5 of 5; rounding the data leaves 2.3 digits of the exact theta"
std::string rounding_text(RoundingEffect const& effect, Comparison const& comparison);

/// What "about row 11000" means; "" where nothing is foretold.
std::string foretold_text(Comparison const& comparison);

/// Digits of theta in three other orders of the rows, in this arithmetic: of the named form, and of those shown whose
/// `low` or `mid` of anything is more than half a digit from that in the record's order. "": there is one order.
std::string other_orders_text(Comparison const& comparison, std::string_view arithmetic);

/// Whether text shows the variant: one of the ten to use, `conventional`, one that is named, or asked for.
bool is_shown(Comparison const& comparison, std::string_view variant);

/// The variant to use in this arithmetic, or "": the recommendation, or what keeps the digits that are wanted.
std::string recommended_in(Comparison const& comparison, std::string_view arithmetic);
/// Whether this result is of that variant.
bool is_recommended(Comparison const& comparison, Result const& result);

/// What the probes of --certify are, and whether the truth is below their bounds.
std::string probes_sentence(Comparison const& comparison);

/// The prior, and what it does to theta.
std::string prior_text(Comparison const& comparison);

/// Warnings: what is wrong with the question, and the remedy; a sentence each.
std::vector<std::string> warnings(Comparison const& comparison);

/// "against the certified least-squares solution of the rows in the window".
std::string against_text(Comparison const& comparison);

/// What happened to one of the filters: "factored anew 3 times, 2 outliers"; "".
std::string counts_text(Comparison const& comparison, Result const& result);

}  // namespace rlslab::compare
