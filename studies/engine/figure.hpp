// A study's plots worked out from its table: rows become curves. What draws them is in report/.
#pragma once

#include "report/figure.hpp"
#include "studies/engine/study.hpp"

namespace rlslab::studies {

/// Numbers that a logarithmic axis cannot show (0, NaN, infinity) are left out of the curve.
std::vector<report::Figure> figures(Study const& study, Table const& table);

}  // namespace rlslab::studies
