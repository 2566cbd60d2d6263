// The short answer of a comparison: the variant to use, its cost, and C++ code for it.
#pragma once

#include "compare/compare.hpp"

namespace rlslab {

/// "Ud" for "ud", "InverseQr" for "inverse_qr".
std::string class_of(std::string_view variant);

/// A line for each arithmetic that has a recommendation, and one line for all others.
std::string verdict(Comparison const& comparison);

/// The recommendation for which code is printed: among those in hardware arithmetics the shortest that keeps three digits of theta's worst
/// component (the low end of its spread), otherwise the longest. null: none.
Recommendation const* coded(Comparison const& comparison);

/// A filter in C++ on the problem of a comparison.
struct CodedFilter {
    std::string variant, arithmetic;  ///< of the hardware: float, double or extended
    bool guarded = false;
    std::string remarks = "";         ///< lines of comment above the model
    std::vector<int> exponents = {};  ///< regressor i is taken times 2^exponents[i]; empty: as it is
    int output_exponent = 0;          ///< likewise y
};
/// A C++ file that defines it as `filter`. Comments above it give the model and the order and signs of the regressors. It compiles as it
/// stands. "" for another arithmetic.
std::string code(Comparison const& comparison, CodedFilter const& filter);
/// Of the recommended one; "" when coded() is null.
std::string code(Comparison const& comparison);

}  // namespace rlslab
