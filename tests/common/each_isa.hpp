// A test on each instruction set that this machine has.
#pragma once

#include <rlslab/linalg/isa_name.hpp>
#include <rlslab/linalg/kernels/each_isa.hpp>

namespace rlslab {

inline constexpr Isa all_isas[] = {Isa::baseline, Isa::avx2, Isa::avx512};

/// run() with the kernels of each instruction set up to the current one, which is left as it was.
template <class Run>
void on_each_isa(Run run) {
    Isa const best = kernels::isa;
    for (Isa isa : all_isas) {
        if (isa > best) break;
        kernels::isa = isa;
        run();
    }
    kernels::isa = best;
}

}  // namespace rlslab
