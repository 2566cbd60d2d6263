// What the probes of a running filter show of its error of P, beside that error in 257 bits.
#pragma once

#include "src/lab/compare/compare.hpp"
#include "src/lab/compare/rounded_problem.hpp"

#include <map>

namespace rlslab::compare {

/// Probes that --certify gives each filter.
inline constexpr Index probes_of_compare = 3;

/// Result::probed of each form in float or double that takes probes. `rounded`: by the name of the arithmetic.
void probe(std::vector<Result>& results, std::map<std::string_view, RoundedProblem> const& rounded);

}  // namespace rlslab::compare
