// What is said of a model, line by line: the same words on a terminal and on a page.
#pragma once

#include "identify.hpp"

namespace rlslab {

/// The record, and how it was estimated.
std::string data_line(Identified const& model);
/// What each input excites.
std::vector<std::string> input_lines(Identified const& model);
/// The order, and which criterion says what.
std::string order_line(Identified const& model);
/// Poles, zeros, fit, residuals, arithmetic.
std::vector<std::string> result_lines(Identified const& model);

}  // namespace rlslab
