// Variants in significands that round at random, behind the erased boundary.
#pragma once

#include "studies/definiteness/random_rounding.hpp"

#include <rlslab/catalogue/any_filter.hpp>

namespace rlslab::studies {

/// symmetric, joseph, joseph_rank_two, ud, carlson, inverse_qr, qr, with the rounding of the calling thread's
/// RandomRoundingScope while the filter is made and fed. Throws std::logic_error for another variant.
CatalogueEntry const& randomly_rounded(std::string_view variant);

}  // namespace rlslab::studies
