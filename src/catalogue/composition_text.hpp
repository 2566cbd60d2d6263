// A composition in words.
#pragma once

#include <rlslab/catalogue/composition.hpp>

namespace rlslab {

/// "window of 60 rows; guard reset".
std::string composition_text(Composition const& composition);

/// "factored anew 3 times, 2 outliers"; "" where nothing happened.
std::string counts_text(CompositionCounts const& counts);

}  // namespace rlslab
