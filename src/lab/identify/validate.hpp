// The fitted model against the whole record: its errors, and the part of the output that it does not explain.
#pragma once

#include "src/lab/identify/estimate.hpp"
#include "src/lab/identify/record.hpp"
#include "src/lab/identify/structure.hpp"

namespace rlslab::identify {

/// rows: all of the record, in the order of the structure's terms; fitted: the first rows, which the estimate is from.
/// If theta is not finite, only `bound` is set.
Validation validate(Record const& record, IdentifyOptions const& options, Structure const& structure, Rows const& rows,
                    Index fitted, Estimation const& estimation);

}  // namespace rlslab::identify
