// Fast forms on a record whose regressors are a delay line: a table of their own beside that of the variants.
#pragma once

#include "src/lab/compare/compare.hpp"

namespace rlslab::compare {

/// Whether row k is row k - 1 moved on by one place, with a new number in the first: d >= 2 samples of one signal, the
/// newest first, without a gap.
bool is_delay_line(Records const& records);

/// Every fast form in float and double (those of `arithmetics`) on the record, with forgetting and the energy delta =
/// 1 / p0; empty unless it is a delay line. Fast forms start with zeros in their line, so that the first d - 1 rows are
/// others than those of the variants. Digits are those of the prediction errors in the rows after the checkpoints,
/// against y - psi'theta with the certified theta of the rows before, for the data as the arithmetic stores them.
std::vector<FastResult> score_fast_forms(Records const& records, double forgetting, double p0,
                                         std::vector<std::string_view> const& arithmetics,
                                         std::vector<Index> const& checkpoints);

}  // namespace rlslab::compare
