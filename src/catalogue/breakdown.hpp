// Tests of any filter's state while it runs.
#pragma once

#include <rlslab/catalogue/any_filter.hpp>

namespace rlslab {

/// What broke: sound if the stored P is positive definite, decided exactly for the stored bits; otherwise indefinite or
/// nonfinite. The stored numbers decide. `last`, what the last step reported, matters only where P is sound: if it is
/// nonfinite and theta is not finite, so is the answer.
Health breakdown(AnyFilter const& filter, Arithmetic const& arithmetic, Health last = Health::sound);

/// Whether every number of x is finite.
bool is_finite(Vector<Reference> const& x);

}  // namespace rlslab
