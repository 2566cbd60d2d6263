// Runs a filter over rows and compares it with the exact solution at some of them.
#pragma once

#include <rlslab/studies/scenarios.hpp>

#include <concepts>

namespace rlslab::studies {

/// Feeds the rows before each exact solution's step, and then calls `compare(exact)` for it. The steps increase.
void at_each(std::vector<CertifiedSolution> const& solutions, AnyFilter& filter, Records const& records,
             std::invocable<CertifiedSolution const&> auto compare) {
    Index row = 0;
    for (CertifiedSolution const& exact : solutions) {
        process_rows(filter, records, row, exact.step());
        row = exact.step();
        compare(exact);
    }
}

}  // namespace rlslab::studies
