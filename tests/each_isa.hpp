// A test on each instruction set that this machine has.
#pragma once

#include <rlslab/linalg/dispatch.hpp>

namespace rlslab {

/// run() with the kernels of each instruction set; those of the best one are left.
template <class Run>
void on_each_isa(Run run) {
    Isa const best = kernels::isa;
    for (Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
        if (isa > best) break;
        kernels::isa = isa;
        run();
    }
    kernels::isa = best;
}

}  // namespace rlslab
