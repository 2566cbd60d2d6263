// Variants in binary64 with another evaluation, behind the erased boundary.
#pragma once

#include <rlslab/catalogue/any_filter.hpp>

namespace rlslab::studies {

/// The dense variants but conventional, kalman and qr_block, by name; evaluation: "lanes" (as the library has it, and
/// bit for bit the catalogue's), "fused", "forward", "backward". Throws std::logic_error for another.
CatalogueEntry const& evaluated(std::string_view variant, std::string_view evaluation);

}  // namespace rlslab::studies
