// Questions to ask of any filter on its way.
#pragma once

#include <rlslab/lab/any_filter.hpp>

namespace rlslab {

/// What a filter's stored state shows: "" while P is positive definite, decided exactly for the bits stored, else
/// "indefinite" or "nonfinite".
std::string breakdown(AnyFilter const& filter, Arithmetic const& arithmetic);

bool is_finite(Vector<Reference> const& x);

}  // namespace rlslab
