// Every dense variant in fixed-point words behind the erased boundary.
#pragma once

#include <rlslab/arithmetic/fixed_format.hpp>
#include <rlslab/catalogue/any_filter.hpp>

namespace rlslab::studies {

/// Every dense variant in the words that the FixedScope of the calling thread has while the filter is made, fed and asked. Not in the
/// catalogue, for the reason that significands of any length are not: the format is the question.
std::vector<Entry> const& fixed_point_filters();
/// symmetric, ud or qr in such words where every operation is rounded, not every sum; null for any other.
Entry const* rounding_every_operation(std::string_view variant);
/// The symmetric form in significands of any length (PrecisionScope), to compare with.
Entry const& symmetric_of_any_length();

}  // namespace rlslab::studies
