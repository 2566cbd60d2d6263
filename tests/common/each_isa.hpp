// A test on each instruction set that this machine has.
#pragma once

#include <rlslab/linalg/dispatch.hpp>
#include <rlslab/linalg/kernels/each_isa.hpp>

#include <string_view>

namespace rlslab {

inline constexpr Isa all_isas[] = {Isa::baseline, Isa::avx2, Isa::avx512};
constexpr std::string_view name_of(Isa isa) {
    constexpr std::string_view names[] = {"baseline", "avx2", "avx512"};
    return names[static_cast<int>(isa)];
}

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
