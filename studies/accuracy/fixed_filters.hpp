// Every dense variant in fixed-point words behind the erased boundary.
#pragma once

#include <rlslab/arithmetic/fixed_format.hpp>
#include <rlslab/catalogue/any_filter.hpp>

namespace rlslab::studies {

/// Every dense variant in fixed point, in the format of the calling thread's FixedScope. These have no entry in the
/// catalogue because their format is chosen at run time.
std::vector<CatalogueEntry> const& fixed_point_filters();
/// symmetric, ud or qr in the same format, with a rounding after every operation, not after every sum; null for any
/// other.
CatalogueEntry const* rounding_every_operation(std::string_view variant);
/// The symmetric form in significands of any length (PrecisionScope), for comparison.
CatalogueEntry const& symmetric_of_any_length();

}  // namespace rlslab::studies
