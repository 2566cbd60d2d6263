// The report: one HTML file that opens offline and has all that a reader needs to check or repeat the run.
#pragma once

#include <rlslab/studies/figure.hpp>
#include <rlslab/studies/run.hpp>

namespace rlslab::studies {

/// Questions, formulas, plots, tables, claims with their verdicts, provenance.
std::string report_html(std::vector<Outcome> const& outcomes, RunOptions const& options);

}  // namespace rlslab::studies
