// A count that has an end, as a saved state holds it.
#pragma once

#include <rlslab/core/encoding.hpp>

namespace rlslab {

/// A count from 0 to `most`. `most` is the reader's own and not written; what is beyond it is not read, so that no file
/// makes a program reach outside its memory.
struct BoundedCount {
    std::ptrdiff_t n = 0, most = 0;
};
template <>
struct Encoding<BoundedCount> {
    static constexpr std::size_t size = Encoding<std::ptrdiff_t>::size;
    static void write(BoundedCount const& x, std::byte* to) { Encoding<std::ptrdiff_t>::write(x.n, to); }
    static bool read(std::byte const* from, BoundedCount& x) {
        return Encoding<std::ptrdiff_t>::read(from, x.n) && 0 <= x.n && x.n <= x.most;
    }
};

}  // namespace rlslab
