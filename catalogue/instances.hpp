// What one arithmetic's object library contributes to the catalogue.
#pragma once

#include <rlslab/lab/any_filter.hpp>

namespace rlslab {

struct Instances {
    Arithmetic arithmetic;
    std::vector<Entry> entries;  ///< Entry::arithmetic is still to be set
};

/// The instances of the I-th arithmetic of the list; defined by catalogue/instances.cpp compiled for that I.
template <int I>
Instances instances();

}  // namespace rlslab
