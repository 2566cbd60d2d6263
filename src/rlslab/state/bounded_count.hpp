// A count that has an end, as a saved state holds it.
#pragma once

#include <rlslab/core/encoding.hpp>

#include <algorithm>

namespace rlslab {

/// A count from 0 to `most`. `most` is the reader's own and not written; what is beyond it is not read, so that no file
/// makes a program reach outside its memory.
template <class N>
struct BoundedCountOf {
    N n = 0;  ///< one, or one for each lane
    std::ptrdiff_t most = 0;
};
using BoundedCount = BoundedCountOf<std::ptrdiff_t>;
template <class N>
struct Encoding<BoundedCountOf<N>> {
    static constexpr std::size_t size = Encoding<N>::size;
    static void write(BoundedCountOf<N> const& x, std::byte* to) { Encoding<N>::write(x.n, to); }
    static bool read(std::byte const* from, BoundedCountOf<N>& x) {
        auto const within = [&x](std::ptrdiff_t n) { return 0 <= n && n <= x.most; };
        if (!Encoding<N>::read(from, x.n)) return false;
        if constexpr (requires { x.n.value; }) return std::all_of(x.n.value.begin(), x.n.value.end(), within);
        else return within(x.n);
    }
};

}  // namespace rlslab
