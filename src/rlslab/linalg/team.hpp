// Threads that share the work on one block of rows. Who wants more than one calls use_threads (many/threads.hpp), so
// that a filter needs no threads to compile.
#pragma once

#include <rlslab/core/matrices.hpp>

#include <algorithm>
#include <atomic>

namespace rlslab::detail {

/// One of `count` threads that do the same work.
struct Seat {
    Index i = 0, count = 1;
    void* meeting = nullptr;
    /// Returns when all have come here.
    void wait() const;
    /// This one's columns of from ... to - 1, which begin at multiples of `step` from `from` on.
    struct Columns {
        Index from, to;
    };
    Columns share(Index from, Index to, Index step) const {
        Index const steps = (to - from + step - 1) / step;
        return {from + steps * i / count * step, std::min(to, from + steps * (i + 1) / count * step)};
    }
    /// Columns of a lower triangle of n, as many numbers for each thread.
    Columns share_of_triangle(Index n) const {
        auto const end = [&](Index part) {
            Index column = 0;
            for (Index left = n * (n + 1) / 2 * part / count; column < n && left > 0; ++column) left -= n - column;
            return part == count ? n : std::min(n, (column + 7) / 8 * 8);
        };
        return {end(i), end(i + 1)};
    }
};
struct Team {
    std::atomic<Index> threads{1};
    void (*run)(Index threads, void (*work)(void* with, Seat const&), void* with) = nullptr;
    void (*wait)(void* meeting) = nullptr;
};
inline Team the_team;
inline void Seat::wait() const {
    if (count > 1) the_team.wait(meeting);
}
/// How many threads to share a block's work among. Room is made for so many, and in_team is given the same number.
inline Index threads_of_team() { return the_team.threads.load(std::memory_order_acquire); }
/// work(seat) in each of the threads, or in this one alone where the work is too small to share: less than some 10^6
/// multiplications. Each result is one thread's: the bits are the same.
template <class Work>
void in_team(Index threads, double multiplications, Work work) {
    if (threads < 2 || multiplications < 1e6) work(Seat{});
    else
        the_team.run(
            threads, [](void* with, Seat const& seat) { (*static_cast<Work*>(with))(seat); }, &work);
}

}  // namespace rlslab::detail
