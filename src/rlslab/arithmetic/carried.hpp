// What the results of an arithmetic depend on in the calling thread, for other threads that do parts of the same work.
#pragma once

#include <cstdint>

namespace rlslab {

/// Made in the calling thread before the others start, and outlives them. In any of these (or in the calling one), a
/// Carried<T>::Part lives while the part of that number is done: T then computes there as the calling thread would have it,
/// with results that depend on the number of the part, not on the thread. Nothing for most arithmetics; those that take
/// something from their thread specialise it beside their definition.
template <class T>
struct Carried {
    struct Part {
        Part(Carried const&, std::uint64_t) {}
    };
};

}  // namespace rlslab
