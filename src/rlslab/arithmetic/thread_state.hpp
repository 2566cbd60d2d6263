// Passes the state on which an arithmetic's results depend from the calling thread to other threads that do parts of
// its work.
#pragma once

#include <cstdint>

namespace rlslab {

/// Make a ThreadState<T> in the calling thread before the other threads start; it must outlive them. A thread makes a
/// ThreadState<T>::Part with the number of the part that it is about to compute, and destroys it when the part is
/// finished. Meanwhile T computes there with the calling thread's state. The results depend on the number of the part,
/// not on the thread. Most arithmetics have no such state. An arithmetic with a length, a random stream or a tally
/// specialises ThreadState beside its definition.
template <class T>
struct ThreadState {
    struct Part {
        Part(ThreadState const&, std::uint64_t) {}
    };
};

}  // namespace rlslab
