// The description of a model, line by line: the same words on a terminal and on a page.
#pragma once

#include "src/lab/identify/identify.hpp"

namespace rlslab::identify {

/// "12.34 %"; "-" for an unknown number.
std::string percent_text(double x);
/// A number to so many significant digits; "-" for an unknown one.
std::string number_text(double x, int digits);
/// a1, b0, b0[u2], c.
std::vector<std::string> parameter_names(Identified const& model);
/// The record, how it was estimated, with which prior.
std::vector<std::string> data_lines(Identified const& model);
/// The order of excitation of each input.
std::vector<std::string> input_lines(Identified const& model);
/// The structure, the order that each criterion suggests, and the equation with its signs.
std::vector<std::string> order_lines(Identified const& model);
/// The parameters of a noise model or of instruments: name, regressor, estimate, sd, least squares, shift.
std::vector<std::string> cured_header();
std::vector<std::vector<std::string>> cured_rows(Cured const& cured);
/// How they were estimated; then, below the table, what their residuals say.
std::string cured_title(Cured const& cured);
std::vector<std::string> cured_lines(Cured const& cured);
/// Poles, zeros, gain, fit, residuals, arithmetic, and what may make the model better.
std::vector<std::string> result_lines(Identified const& model);

}  // namespace rlslab::identify
