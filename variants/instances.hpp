// What one arithmetic's object library contributes to the catalogue.
#pragma once

#include <rlslab/erased.hpp>

namespace rlslab {

struct Instances {
    Arithmetic arithmetic;
    std::vector<Entry> entries;    ///< Entry::arithmetic is still to be set
};

/// The instances of the I-th arithmetic of the list; defined by variants/instances.cpp compiled for that I.
template <int I>
Instances instances();

}  // namespace rlslab
