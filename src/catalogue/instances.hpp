// The part of the catalogue that the object library of one arithmetic defines.
#pragma once

#include <rlslab/catalogue/any_filter.hpp>

namespace rlslab {

struct Instances {
    Arithmetic arithmetic;
    std::vector<CatalogueEntry> entries;  ///< CatalogueEntry::arithmetic is null; the catalogue sets it
};

/// The instances of the I-th arithmetic of the list. src/catalogue/instances.cpp, compiled for that I, defines it.
template <int I>
Instances instances();
/// The sparse variants, which exist in double: src/catalogue/sparse_instances.cpp. They come after double's own.
std::vector<CatalogueEntry> sparse_entries();

}  // namespace rlslab
