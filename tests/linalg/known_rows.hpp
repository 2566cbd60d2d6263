// Numbers that rows are made of, and equality to the bit.
#pragma once

#include "tests/common/each_isa.hpp"
#include "tests/common/same.hpp"
#include "tests/common/twins.hpp"

#include <rlslab/linalg/sweeps.hpp>

#include <cmath>
#include <limits>

namespace rlslab::known_rows {

/// Rows of white noise; with zeros of both signs and whole rows of them; of every magnitude; with infinities and NaN
/// besides. mild: a few zeros and other scales.
enum class Kind { ordinary, zeros, scaled, special, mild };
constexpr Kind kinds[] = {Kind::ordinary, Kind::zeros, Kind::scaled, Kind::special};

template <class T>
T number(Seed& seed, Kind kind) {
    T const x = T(seed.bell());
    auto const chance = seed.next() % 16;
    if (kind == Kind::ordinary) return x;
    if (kind == Kind::mild)
        return chance == 0 ? T(0) : chance == 1 ? -T(0) : std::ldexp(x, chance == 2 ? 20 : chance == 3 ? -20 : 0);
    if (chance < 4) return chance % 2 ? T(0) : -T(0);
    if (kind == Kind::zeros) return x;
    if (chance < 10) return std::ldexp(x, int(seed.next() % 2001 - 1000) / (sizeof(T) == 8 ? 1 : 8));
    if (chance == 10) return std::numeric_limits<T>::denorm_min() * T(1 + seed.next() % 9);
    if (kind == Kind::special && seed.next() % 64 == 0) {
        T const bad[] = {std::numeric_limits<T>::infinity(), -std::numeric_limits<T>::infinity(),
                         std::numeric_limits<T>::quiet_NaN()};
        return bad[seed.next() % 3];
    }
    return x;
}

using rlslab::same;

/// So many rows of d such numbers.
template <class T>
twins::Rows rows_of(Index d, Index count, Kind kind, Seed seed) {
    twins::Rows out;
    for (Index k = 0; k < count; ++k) {
        out.push_back({Vector<double>(d), 0, 1, k});
        for (double& x : out.back().psi) x = double(number<T>(seed, kind));
        out.back().y = double(number<T>(seed, kind));
    }
    return out;
}

/// run(set, evaluate) for the registers of each instruction set, whichever of them dispatch.hpp would choose.
template <class T, class Run>
void on_each_set(Run run) {
    run("16 bytes",
        []<class K>(K const& k) { kernels::portable::run_outlined<kernels::portable::InRegisters<K, T, 16>>(k); });
#ifdef __x86_64__
    if (kernels::best_isa() >= Isa::avx2)
        run("AVX2", []<class K>(K const& k) { kernels::avx2::run_outlined<kernels::avx2::InRegisters<K, T, 32>>(k); });
    if constexpr (sizeof(T) == 8)
        if (kernels::best_isa() >= Isa::avx512)
            run("AVX-512",
                []<class K>(K const& k) { kernels::avx512::run_outlined<kernels::avx512::InRegisters<K, T, 64>>(k); });
#endif
}

}  // namespace rlslab::known_rows
