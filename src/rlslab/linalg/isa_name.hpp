// The words for the instruction sets, in answers and on command lines.
#pragma once

#include <rlslab/linalg/dispatch.hpp>

namespace rlslab {

constexpr char const* name_of(Isa isa) {
    constexpr char const* names[] = {"baseline", "avx2", "avx512"};
    return names[static_cast<int>(isa)];
}

}  // namespace rlslab
