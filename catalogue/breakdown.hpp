// Tests of any filter's state while it runs.
#pragma once

#include <rlslab/catalogue/any_filter.hpp>

namespace rlslab {

/// "" if the stored P is positive definite, decided exactly for the stored bits; otherwise "indefinite" or "nonfinite".
std::string breakdown(AnyFilter const& filter, Arithmetic const& arithmetic);

/// Whether every number of x is finite.
bool is_finite(Vector<Reference> const& x);

}  // namespace rlslab
