// A composition in words, and as C++.
#pragma once

#include <rlslab/catalogue/composition_text.hpp>
#include "src/lab/compare/compare.hpp"

namespace rlslab::compare {

/// "against the certified least-squares solution of the rows in the window".
std::string against_text(Comparison const& comparison);

/// What happened to one of the filters: "factored anew 3 times, 2 outliers"; "".
std::string counts_text(Comparison const& comparison, Result const& result);

/// What is odd about the composition on this record, a sentence each.
std::vector<std::string> composition_warnings(Comparison const& comparison);

/// The headers of <rlslab/adapt/...> that the composition needs, a line each.
std::string composition_includes(Composition const& composition);
/// The definition of `filter` around the type, which stands as text, of problem, which is defined above it.
std::string composition_code(Composition const& composition, std::string const& type, std::string const& variant,
                             std::string const& scalar, Index size);

}  // namespace rlslab::compare
