// The report: one HTML file that opens offline, with everything a reader needs to believe or repeat it.
#pragma once

#include "figure.hpp"
#include "run.hpp"

namespace rlslab {

/// Text for HTML, "+- " as a plus-minus sign.
std::string escaped(std::string_view text);

/// Where a figure of the page is to stand.
std::string figure_html(Figure const& figure);

/// Tables as CSV, by name.
using Tables = std::vector<std::pair<std::string, std::string>>;

/// A page of its own around the body. Its plots are drawn by Plotly and its formulas by Temml where the program was built with
/// them (`./lab report` sees to it); without them its plots are the SVG files beside it.
std::string page(std::string const& title, std::string const& body, std::vector<Figure> const& drawn, Tables const& tables);

/// Questions, formulas, plots, tables, claims with their verdicts, provenance.
std::string report_html(std::vector<Outcome> const& outcomes, RunOptions const& options);

}  // namespace rlslab
