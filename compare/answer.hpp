// The short answer: which variant, at what price, and the code to paste.
#pragma once

#include "compare/compare.hpp"

namespace rlslab {

/// "Ud" for "ud", "InverseQr" for "inverse_qr".
std::string class_of(std::string_view variant);

/// A line for each arithmetic with a recommendation, one for all without.
std::string verdict(Comparison const& comparison);

/// The recommendation the code is for: of those in hardware arithmetics the shortest that keeps three digits of theta's worst component
/// (the low end of its spread), else the longest; null: none.
Recommendation const* coded(Comparison const& comparison);

/// C++ that defines the recommended filter as `filter`, the model and the regressors' order and signs in comments above it; "" when
/// coded() is
/// null. A file of its own: it compiles as it stands.
std::string code(Comparison const& comparison);

}  // namespace rlslab
