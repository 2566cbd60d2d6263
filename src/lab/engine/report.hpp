// The report: one HTML file that opens offline and has all that a reader needs to check or repeat the run; and the
// figures of a study from its table, which src/lab/report/ draws.
#pragma once

#include "src/lab/report/figure.hpp"
#include <rlslab/studies/run.hpp>

namespace rlslab::studies {

/// One figure for each plot and panel. Curves leave out 0, NaN and infinity on a logarithmic axis. In a plot of cells
/// whose y is a column of words the most frequent word stands in each cell, shaded by its share; the label of a guide
/// names another such column, and lines part cells where its words differ.
std::vector<report::Figure> figures(Study const& study, Table const& table);

/// Questions, formulas, plots, tables, claims with their verdicts, provenance.
std::string report_html(std::vector<Outcome> const& outcomes, RunOptions const& options);

}  // namespace rlslab::studies
