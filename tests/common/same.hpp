// The same bits; a NaN is a NaN.
#pragma once

#include <rlslab/core/problem.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace rlslab {

template <std::floating_point T>
bool same(T a, T b) {
    using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
    return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b) || (std::isnan(a) && std::isnan(b));
}
inline bool same(Step<double> const& a, Step<double> const& b) {
    return same(a.innovation, b.innovation) && same(a.residual, b.residual) && same(a.gamma, b.gamma) &&
           a.health == b.health;
}
/// The first place where the numbers differ, the length of the shorter if one is longer; -1 for none.
template <class T>
long difference(std::vector<T> const& a, std::vector<T> const& b) {
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        if (!same(a[i], b[i])) return long(i);
    return a.size() == b.size() ? -1 : long(std::min(a.size(), b.size()));
}
template <class T>
bool same(std::vector<T> const& a, std::vector<T> const& b) {
    return difference(a, b) < 0;
}

}  // namespace rlslab
