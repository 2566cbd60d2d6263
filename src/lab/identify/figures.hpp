// The figures of a page: signals, residuals, orders, and what the model does.
#pragma once

#include "src/lab/identify/clock.hpp"
#include "src/lab/report/figure.hpp"

namespace rlslab::identify {

/// Points with marks, without those that are NaN; a line, broken there; a dashed line, drawn over another.
report::Curve curve(std::string name, size_t place, Signal x, Signal y);
report::Curve line(std::string name, size_t place, Signal x, Signal y);
report::Curve dashed(std::string name, size_t place, Signal x, Signal y);
/// A dashed grey line at y.
report::Curve level(std::string name, double from, double to, double y);
/// from, from + 1, ...; the same as times.
Signal counting(size_t n, double from = 0);
Signal times(Clock const& clock, Index count, double from);

/// Each appends its figures.
void draw_orders(std::vector<report::Figure>& out, Identified const& model);
void draw_outputs(std::vector<report::Figure>& out, Identified const& model);
void draw_correlations(std::vector<report::Figure>& out, Identified const& model);
void draw_constancy(std::vector<report::Figure>& out, Identified const& model);
void draw_trajectory(std::vector<report::Figure>& out, Identified const& model);
void draw_steps(std::vector<report::Figure>& out, Identified const& model);
void draw_frequencies(std::vector<report::Figure>& out, Identified const& model);
void draw_poles(std::vector<report::Figure>& out, Identified const& model);

}  // namespace rlslab::identify
