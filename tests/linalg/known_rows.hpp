// Numbers that rows are made of, and equality to the bit.
#pragma once

#include <rlslab/core/random.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

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

template <class T>
bool same(T a, T b) {
    using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b) || (std::isnan(a) && std::isnan(b));
}
template <class T>
bool same(std::vector<T> const& a, std::vector<T> const& b) {
    return std::ranges::equal(a, b, [](T x, T y) { return same(x, y); });
}

// --- the kernel ------------------------------------------------------------------------------------------------------

}  // namespace rlslab::known_rows
